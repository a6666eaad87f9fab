"""Mistakes in derivatives along records of cycles."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["hybrid/tangent/test_hop", "hybrid/tangent/test_grazing", "hybrid/tangent/test_bound", "gaits/test_clutches"],
        {
            "derivatives: sign of the motion after an event": (
                "lag = now.tau if now.behind",
                "lag = -now.tau if now.behind",
            ),
            "derivatives: an event at a fixed time": (
                "stretch.dstate + stretch.end.slopes[:, None] * tau",
                "stretch.dstate",
            ),
            "derivatives: a latch at the section held fixed": (
                "return dict(latch_values(",
                "return value_of(latch_values(",
            ),
            "derivatives: a latch in the cycle held fixed": (
                "now.held = dict(latch_values(",
                "now.held = value_of(latch_values(",
            ),
            "derivatives: phases that last as long": ("0.0) + Dual(arc.end, tau)", "0.0) + Dual(arc.end, 0.0 * tau)"),
            "derivatives: a switch that acts as late": ("Clock(Dual(arc.end, tau)", "Clock(Dual(arc.end, 0.0 * tau)"),
            "derivatives: a schedule that stays": ("due.d + np.zeros(self.c) if", "0.0 * due.d + np.zeros(self.c) if"),
            "derivatives: events that meet stay together": (
                "/ fall if met else now.tau",
                "/ fall if False else now.tau",
            ),
            "derivatives: grazing is not refused": ("if not steepness > GRAZING", "if steepness == -1.0"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["gaits/sensitivity/test_kinks"],
        {
            "derivatives: a kink that stays": (
                "now.tau = now.bent.tau = stretch.since = later(now.bent, stretch)",
                "pass",
            ),
            "derivatives: slopes of the other side of a kink": ("            if kink:\n", "            if False:\n"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["hybrid/test_walkers"],
        {
            "derivatives: a jump that only moves": ("now.dy = derivatives([*q, *v], self.c)", "pass"),
            "derivatives: a jump by fixed numbers": (
                "now.held, self.law, ops=NUMBERS",
                "now.held, self.system.law, ops=NUMBERS",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["hybrid/tangent/test_in_space"],
        {"derivatives: a smooth end is an event": ("        if arc.smooth:  # the", "        if False:  # the")},
    ),
    *mistakes_in(
        "hybrid/tangent/resets",
        ["hybrid/tangent/test_resets"],
        {
            "derivatives: friction drives a sliding toe": (
                "grip = -friction if after[2 * i] > 0.0 else friction",
                "grip = friction if after[2 * i] > 0.0 else -friction",
            ),
            "derivatives: an impact on a border": ("if margin < DEGENERATE", "if margin < -1.0"),
            "derivatives: toes that depend on each other": (
                "if not np.linalg.cond(values[",
                "if False and np.linalg.cond(values[",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/onset",
        ["hybrid/tangent/test_in_space"],
        {
            "a toe that sets out keeps its velocity": ("i] -= each.turning", "i] -= 0.0 * each.turning"),
            "a toe that sets out does not lag behind": ("each.across - each.squares * rates", "each.across"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/section",
        ["gaits/sensitivity/test_sensitivity", "hybrid/tangent/test_in_space", "gaits/test_linear"],
        {
            "derivatives: a toe that a longer leg moves along the ground": ("@ drift\n", "@ (0.0 * drift)\n"),
            "derivatives: a toe that a longer leg lifts": ("([slopes.heights, ", "([0.0 * slopes.heights, "),
            "derivatives in space: the lowest foot leaves the ground": ("dy[Z] -= slopes", "dy[Z] -= 0.0 * slopes"),
            "derivatives in space: an input tells left from right": ("else (xi, -xi):", "else (xi, xi):"),
            "derivatives in space: both feet land at once": ("    if xi is not None:\n", "    if False:\n"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/resets",
        ["hybrid/tangent/test_impacts_in_space"],
        {
            "derivatives in space: the direction of a slide stays": ("turning = mu", "turning = 0.0 * mu"),
            "derivatives in space: what was received stays": ("dimpulse = dtotal - dearlier", "dimpulse = dtotal"),
        },
    ),
    *mistakes_in(
        "hybrid/strikes",
        ["hybrid/tangent/test_impacts_in_space"],
        {"in space: the last impulse alone": ("self.recent[toe] = time, before + own", "self.recent[toe] = time, own")},
    ),
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["gaits/test_round_hopping"],
        {"a pinned toe strikes with friction": ("if pins(self.system", "if False and pins(self.system")},
    ),
    *mistakes_in(
        "gaits/measures/signals",
        ["gaits/test_round_hopping"],
        {"a distance back is negative": ("<= LEAST_STRIDE else abs(stride)", "<= LEAST_STRIDE else stride")},
    ),
    *mistakes_in(
        "gaits/singly",
        ["gaits/test_round_hopping"],
        {"one bad point ends a sweep": ("except SpearError:  # a toe below the ground", "except MemoryError:")},
    ),
    *mistakes_in(
        "hybrid/section",
        ["hybrid/tangent/test_in_space"],
        {"changes of ξ in a fixed heading": ("np.outer([aside, -ahead], dq[YAW])", "0.0")},
    ),
    *mistakes_in(
        "hybrid/tangent/collocation",
        ["hybrid/tangent/test_collocation"],
        {
            "panels ten thousand times rougher": ("TAIL = 1e-11", "TAIL = 1e-7"),
            "a panel begins where the last began": (
                "S, end = begins[i], begins[i + 1]",
                "S, end = begins[0], begins[i + 1]",
            ),
            "positions of the points by once the partial sums": (
                "gauss.twice @ self.K",
                "gauss.partial @ self.K",
            ),
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/along_arcs",
        ["hybrid/tangent/test_in_space"],
        {"friction used is a polynomial": ("_of(normal, pushed) if slides else pushed", "pushed")},
    ),
    *mistakes_in(
        "gaits/sensitivity/margins",
        ["hybrid/tangent/test_in_space"],
        {"a guard that waits has a margin": (" and not (waits and value <= 0.0)", "")},
    ),
    *mistakes_in(
        "hybrid/tangent/points",
        ["hybrid/tangent/test_points"],
        {
            "all panels as short as the shortest": ("np.clip(left, 1.0,", "np.clip(0.0 * left + left.max(), 1.0,"),
            "all panels of one length": (
                "np.interp(np.linspace(0.0, parts[-1], panels + 1), parts, ends)",
                "np.linspace(0.0, ends[-1], panels + 1)",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/dual",
        ["hybrid/test_dual"],
        {
            "the matrix of a system never changes": (
                '"ij...c,...jk->...ikc", dM, x',
                '"ij...c,...jk->...ikc", 0.0 * dM, x',
            )
        },
    ),
    *mistakes_in(
        "hybrid/tangent/terms",
        ["hybrid/tangent/test_terms"],
        {
            "numbers of a robot keep their values": (
                "own != 0.0]\n        return other",
                "own > 0.0]\n        return other",
            )
        },
    ),
    *mistakes_in(
        "hybrid/tangent/cycle",
        ["gaits/sensitivity/test_bounces"],
        {"the flight of a bounce counts to flight": ("counts_to(arc.domain, reset, arc.again)", "arc.domain.phase")},
    ),
    *mistakes_in(
        "hybrid/lanes/lone_runner",
        ["gaits/sensitivity/test_bounces"],
        {
            "a bounce closes a cycle": ("== self._system.section and not again", "== self._system.section"),
            "lane alone: an instant lasts for a cycle": ("now.instant if now.crowd else []", "now.instant"),
        },
    ),
    *mistakes_in(
        "hybrid/lanes/lone_runner",
        ["hybrid/tangent/test_random_hops"],
        {"lane alone: toes that alternate crowd": ("if any(reset is each for each in now.instant):", "if False:")},
    ),
    *mistakes_in(
        "hybrid/tangent/reference_runner",
        ["hybrid/tangent/test_reference_runner"],
        {"a cycle of the reference engine without a cap": ("max_evaluations=EVALUATIONS, ", "")},
    ),
]
