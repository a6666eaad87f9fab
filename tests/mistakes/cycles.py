"""Mistakes in how cycles are run in lanes, mapped on the section, and closed."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "hybrid/section",
        ["hybrid/test_section"],
        {
            "a direction of velocity missing from the chart": (
                "v_bases = null_spaces(np.concatenate([velocity_rows(jacobians, slides), closing], axis=1))",
                "v_bases = null_spaces(np.concatenate([velocity_rows(jacobians, slides), closing], axis=1))[:, :, 1:]",
            ),
            "a sliding toe held along its path": ("np.column_stack([~slides,", "np.column_stack([slides | True,"),
            "charts on the ground of the first lanes": (
                "heights, jacobians[moving] = self.take(moving)",
                "heights, jacobians[moving] = self.take(np.arange(len(moving)))",
            ),
            "half strides seen as they are": ("if self.between_halves(own[0]):", "if False:"),
            "where a state is counts as its change": ("dq[[X, Y, YAW]] = 0.0", "pass"),
            "displacement from where a stride began": (
                "np.concatenate(self.seen(*begins), axis=1)",
                "np.hstack(begins)",
            ),
            "an end that is nowhere has a lowest toe": (" and bool(np.isfinite(q).all())", ""),
            "states are moved where they are kept": ("        q = q.copy()\n", ""),
        },
    ),
    *mistakes_in(
        "hybrid/section",
        ["hybrid/test_periodic"],
        {
            "residual of positions only": (
                "np.concatenate([without(self.translations, ends[0] - begins[0]), ends[1] - begins[1]], axis=1)",
                "without(self.translations, ends[0] - begins[0])",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/newton",
        ["hybrid/test_newton", "hybrid/test_periodic"],
        {
            "steps of differences ten thousand times longer": ("STEP = 1e-5", "STEP = 1e-1"),
            "differences over half their width": ("/ (2.0 * step)", "/ step"),
            "Jacobians updated after every step": ("size / lanes.norm < quick", "size / lanes.norm < np.inf"),
            "any step is taken": (
                "smaller = np.abs(values).max(axis=1) < share",
                "smaller = np.abs(values).max(axis=1) < np.inf",
            ),
            "the residual alone judges a step": ("np.asarray(smaller | nearer)", "np.asarray(smaller)"),
            "steps are not damped": (
                "np.where(lanes.fresh, 0.5 * lanes.damping, 1.0)",
                "np.where(lanes.fresh, 0.0, 1.0)",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/shooting",
        ["hybrid/test_shooting"],
        {
            "targets of other lanes": ("after.measured - self.wanted[lanes]", "after.measured - self.wanted[:1]"),
            "a cycle of no length is one": ("(sum(after.durations.values()) < SHORTEST_CYCLE)", "False"),
        },
    ),
    *mistakes_in(
        "hybrid/newton",
        ["hybrid/test_newton"],
        {
            "steps of any length": ("np.minimum(1.0, longest /", "np.minimum(1.0, np.inf /"),
            "Jacobians are always asked for": ("if always else lanes.differs", "if True else lanes.differs"),
        },
    ),
    *mistakes_in(
        "gaits/leading",
        ["gaits/test_leading"],
        {
            "a step grows at once after one that failed": (
                "growth = 0.5 * (reach - way.done), 1.0",
                "growth = 0.5 * (reach - way.done), 2.0",
            ),
            "steps as long as they like": ("min(growth * step, longest)", "growth * step"),
        },
    ),
    *mistakes_in(
        "hybrid/contact",
        ["hybrid/tangent/test_in_space"],
        {"a toe sets out for too long": ("SETTING_OUT = 4e-5", "SETTING_OUT = 1e-3")},
    ),
    *mistakes_in(
        "gaits/targets",
        ["gaits/measures/test_own_measures"],
        {"half a stride is measured alone": ("range(1, 2 + bool(other.mirrored_toes))", "range(1, 2)")},
    ),
    *mistakes_in(
        "hybrid/events",
        ["hybrid/test_events", "hybrid/test_lanes_in_space"],
        {
            "a guard with patience never rises early": (
                "if not guard.patience or (max(values)",
                "if True or (max(values)",
            )
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/measures",
        ["gaits/measures/test_own_measures"],
        {
            "heights of half strides twice": (
                "Signal(aloft, len(with_partner(self.cycle.system, toe)))",
                "Signal(aloft)",
            )
        },
    ),
    *mistakes_in(
        "hybrid/periodic",
        ["hybrid/test_periodic"],
        {
            "multipliers by increasing modulus": ("-np.round(np.abs(values), 9)", "np.round(np.abs(values), 9)"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/taylor_single",
        ["hybrid/test_lone_runner"],
        {
            "lane alone: a guard that stays on zero": ("if stays_on_zero(guard, values[i], change)", "if False"),
            "lane alone: a kink that stays on zero": ("], later[self._kinks])", "], [])"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/taylor_single",
        ["hybrid/test_taylor_single"],
        {"lane alone: an event that is not found": ("if after[i] < least <= before[i]", "if False")},
    ),
    *mistakes_in(
        "hybrid/engines/taylor",
        ["hybrid/test_taylor_single"],
        {
            "lanes: an event that is not found": (
                "return np.asarray(fell.any(axis=0))",
                "return np.zeros(len(ends), bool)",
            )
        },
    ),
    *mistakes_in(
        "hybrid/engines/taylor_single",
        ["hybrid/test_lanes_in_space"],
        {"lane alone: a bouncing toe sinks": ("if any(later[i] <= 0.0 for i in below):", "if False:")},
    ),
    *mistakes_in(
        "hybrid/lanes/runner",
        ["hybrid/test_lanes"],
        {"lane alone: all is observed": ("self.observed.keys() & lap.observed.keys()", "lap.observed")},
    ),
    *mistakes_in(
        "hybrid/lanes/lone_runner",
        ["hybrid/test_lone_runner", "hybrid/test_ties", "hybrid/test_lanes"],
        {
            "lane alone: an apex is seen again and again": (
                "if self._seen_again(now, domain, end) and",
                "if False and",
            ),
            "lane alone: any number of events in an instant": ("if now.crowd == FEW_AT_ONCE:", "if False:"),
            "lane alone: a cycle of an instant": (" or not whole(now.past)", ""),
            "lane alone: switches go on in the next phase": (
                "now.past, now.t, now.switches = reset.phase, time, 0.0, 0",
                "now.past, now.t = reset.phase, time, 0.0",
            ),
            "lane alone: the first mode that fits": ("if entry.fitness == math.inf", "if entry.fitness > -math.inf"),
        },
    ),
    *mistakes_in(
        "hybrid/lanes/runner",
        ["hybrid/test_lone_runner"],
        {
            "lanes together: an apex is seen again and again": (
                "(self.crowd[group.lanes] > 0) & (end",
                "(group.t < 0.0) & (end",
            ),
            "lane alone: time stands still": ("began += sum(spent.values())", "pass"),
            "lane alone: repeated from its beginning": (
                "if came[1] is self._fresh:\n                start, fresh",
                "if False:\n                start, fresh",
            ),
        },
    ),
]
