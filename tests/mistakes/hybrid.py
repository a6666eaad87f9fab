"""Mistakes in what happens in hybrid motion, and in who runs it."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "hybrid/sampled",
        ["hybrid/test_sampled"],
        {
            "torques act before their latency": (
                "self._sample_time + self._latency, tuple",
                "self._sample_time, tuple",
            ),
            "a sample reads the torques that act": ("self._domains.get(domain.key) or", "domain or"),
            "a sample is left out": ("            self._taken += 1\n", "            self._taken += 2\n"),
        },
    ),
    *mistakes_in(
        "hybrid/controller",
        ["viz/controller/test_tracking", "viz/controller/test_controller"],
        {
            "gains push away": ("gains = 0.0 - slopes[:, motors]", "gains = 0.0 + slopes[:, motors]"),
            "damping is that of the coordinates before": ("nv + i for i in motors", "nv + i - 1 for i in motors"),
            "toes bear in the air": ("i in segment.domain.on_ground", "i not in segment.domain.on_ground"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/sliding",
        ["hybrid/test_equations_of_motion", "gaits/orbits/test_embedding"],
        {
            "friction pushes a slipping toe on": ("- self.friction * along", "+ self.friction * along"),
            "a toe sets out with the force that holds it": ("tuple(-force / size", "tuple(force / size"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/sliding",
        ["hybrid/test_sliding"],
        {
            "a toe that moves back has its velocity's direction": (" or speeds[toe] <= SLOW)", ")"),
            "a toe that sets out turns within a step": (
                "return math.inf if toe in self._begun",
                "return SLOW if toe in self._begun",
            ),
            "a toe that sets out takes long steps": ("= min(self.left,", "= max(self.left,"),
        },
    ),
    *mistakes_in(
        "hybrid/modes",
        ["hybrid/test_lanes_in_space"],
        {
            "lanes: a bouncing toe in the air bears": ("not (toe in domain.bouncing and above)", "True"),
            "lanes: any moving toe is in the air": ("up = [is_aloft(height, rate)", "up = [True"),
        },
    ),
    *mistakes_in(
        "hybrid/fields",
        ["hybrid/test_symbolic", "hybrid/test_event_feedback"],
        {
            "numbers of a part of the law stay": (
                "value = with_fields(value, values)",
                "value = with_fields(value, {})",
            ),
            "feedback replaces a number": ("value_in(law, name) + value", "value"),
        },
    ),
    *mistakes_in(
        "hybrid/event_feedback",
        ["hybrid/test_event_feedback"],
        {
            "feedback without limits": ("limit if value > limit else -limit if value < -limit else value", "value"),
            "feedback on either side alike": ("if second else None", "if False else None"),
            "feedback along x instead of the heading": ("c * v[0] + s * v[1], c * v[1] - s * v[0]", "v[0], v[1]"),
            "feedback to no heading": ("q[YAW] - self.heading", "q[YAW]"),
            "feedback halfway compares with the first half": (
                "partial(self._added, self.halfway,",
                "partial(self._added, self.nominal,",
            ),
            "feedback at any event": ("guard.name in (system.section, self.between)", "True"),
        },
    ),
    *mistakes_in(
        "hybrid/parameters",
        ["hybrid/test_event_feedback"],
        {"feedback to the ground's number": ("name not in others", "name")},
    ),
    *mistakes_in(
        "gaits/feedback",
        ["gaits/test_feedback"],
        {
            "gains of the other sign": ("map(_row, -K @", "map(_row, K @"),
            "an input that acts on nothing": ("if not column.any():", "if False:"),
            "inputs of one parity each": ("and not _mixed(B[:d], local.even)", ""),
            "feedback of the speed in the plane alone": (
                "or any(gains)",
                "or any(getattr(system.law, 'speed_gain', ()))",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/symmetry",
        ["gaits/orbits/test_embedding"],
        {"a mirror without adductions": ("-float(np.sign(axes[1] @ (axes[0] * ACROSS)))", "1.0")},
    ),
    *mistakes_in(
        "hybrid/engines/binding",
        ["hybrid/test_equations_of_motion", "hybrid/test_loops", "gaits/test_hopping"],
        {
            "drift dropped in stance": (
                "drifts.append(directions.accelerated(",
                "drifts.append(0.0 * directions.accelerated(",
            ),
            "spatial acceleration in stance": (
                "pin.getFrameClassicalAcceleration(model, data",
                "pin.getFrameAcceleration(model, data",
            ),
            "rows x and y in stance": (
                "rows.append(directions.along(model, data, index, jacobian))",
                "rows.append(jacobian[0:2])",
            ),
            "loops without drift": (
                "drifts.append(self._closure.drift(data))",
                "drifts.append(0.0 * self._closure.drift(data))",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/rules/footing",
        ["hybrid/test_loops"],
        {"a guided toe held along the ground": ("if toe in self._guided or", "if")},
    ),
    *mistakes_in(
        "hybrid/rules/footing",
        ["hybrid/test_heel_and_toe"],
        {
            "heel and toe both held along the ground": ("or lead < i else 0", "else 0"),
            "a foot's grip is that of one toe": ("dynamics.friction_coefficient * whole)", "grip)"),
            "all force along the ground on each toe": ("share * each for each", "1.0 * each for each"),
        },
    ),
    *mistakes_in(
        "hybrid/soundness",
        ["hybrid/test_heel_and_toe"],
        {"toes of one body slide differently": ("SIGN.get(mode, 0.0) for toe", "0.0 for toe")},
    ),
    *mistakes_in(
        "hybrid/rules/impact",
        ["hybrid/test_heel_and_toe"],
        {
            "heel and toe share an impulse equally": ("if normal else 0.5", "if False else 0.5"),
            "a foot that bounced keeps its last speed": ("up <= LIFTS", "up < 0.0"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/resets",
        ["hybrid/test_heel_and_toe"],
        {"derivatives: heel and toe depend on each other": ("if row % 2 or (leads", "if True or (leads")},
    ),
    *mistakes_in(
        "hybrid/rules/entry",
        ["hybrid/test_heel_and_toe"],
        {"a heel that rises slowly falls": ("1e-5, 1e-4)  # s: how far", "1e-5)  # s: how far")},
    ),
    *mistakes_in(
        "hybrid/strikes",
        ["hybrid/test_loops"],
        {"an impact opens loops": ("robot.nv)) if robot.closure is None else", "robot.nv)) if True else")},
    ),
    *mistakes_in(
        "hybrid/lanes/impacts",
        ["hybrid/test_loops"],
        {"lanes: an impact opens loops": ("if rows else None", "if False else None")},
    ),
    *mistakes_in(
        "hybrid/elimination",
        ["hybrid/test_loops"],
        {"a compiled impact opens loops": ("    if not loops:\n", "    if True:\n")},
    ),
    *mistakes_in(
        "hybrid/engines/pinocchio",
        [
            "hybrid/test_equations_of_motion",
            "hybrid/test_torques",
            "hybrid/test_ledger",
            "hybrid/test_endings",
            "gaits/test_hopping",
            "gaits/test_path_springs",
        ],
        {
            "damping drives": ("lever * (pull.force + pull.drag)", "lever * (pull.force - pull.drag)"),
            "the last spring of a joint counts alone": ("_passive[index] += lever", "_passive[index] = lever"),
            "work of slip with the wrong sign": ("slipped += force", "slipped -= force"),
            "joint friction left out": (
                "applied + self.friction if self._has_friction else applied",
                "applied",
            ),
            "Painlevé's pivot always positive": (
                "1.0 / float(inverse_pivots[row])",
                "abs(1.0 / float(inverse_pivots[row]))",
            ),
            "torque in the trajectory without the damper's": (
                "return [float(self._applied[index]) for index in self._actuated]",
                "drag = {i: -lever * pull.drag for pull in self.pulls for i, lever in pull.slope.items()}\n"
                "        return [float(self._applied[index]) + drag.get(index, 0.0) for index in self._actuated]",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/contact",
        ["hybrid/test_contact"],
        {"a constraint without its drift": ("approach[:, 0] += drift", "approach[:, 0] += 0.0 * drift")},
    ),
    *mistakes_in(
        "hybrid/ground",
        ["hybrid/test_slopes", "hybrid/test_symbolic"],
        {
            "downhill for uphill": ("ops.sin(self.slope)", "-ops.sin(self.slope)"),
            "distance from the ground as on the level": ("self.height * ops.cos(self.slope)", "self.height"),
            "drifts left in the world's axes": ("toe: self.seen_in(drift, ops) for", "toe: drift for"),
        },
    ),
    *mistakes_in(
        "hybrid/translation",
        ["hybrid/test_slopes"],
        {"moved along a slope without being lifted": ("np.sin(slope) * np.eye", "0.0 * np.eye")},
    ),
    *mistakes_in(
        "hybrid/lanes/modes",
        ["hybrid/test_lanes_in_space"],
        {"lanes: a bouncing toe sinks": ("np.asarray(falls.any(axis=0))", "np.zeros(len(group), bool)")},
    ),
    *mistakes_in(
        "hybrid/engines/taylor_single",
        ["hybrid/test_lanes_in_space"],
        {"lane alone: a bouncing toe falls": ("if values[i] <= tolerance]", "if values[i] <= 0.0]")},
    ),
    *mistakes_in(
        "hybrid/events",
        ["hybrid/test_events"],
        {
            "grazing overlooked": ("<= 0.05 * max(before, middle, end)", "<= -1.0"),
            "patience for a toe that has risen": ("and not self._rises(i, nodes, interpolant)", ""),
        },
    ),
    *mistakes_in(
        "hybrid/span",
        ["hybrid/test_quick_events"],
        {
            "no part of a step is looked at closely": (
                "waiting += reversed(span.halves())",
                "yield span.begin, span.end, UNKNOWN",
            ),
            "the second half of a step comes first": ("reversed(span.halves())", "span.halves()"),
            "nothing shorter than 10 µs is looked for": ("LEAST if short <= MANY else SHORTEST", "SHORTEST"),
        },
    ),
    *mistakes_in(
        "hybrid/intervals",
        ["hybrid/test_quick_events"],
        {"an interval of a wave has no crest": ("1.0 if peak else max(ends)", "max(ends)")},
    ),
    *mistakes_in(
        "hybrid/own",
        ["hybrid/test_mistaken", "hybrid/test_endings"],
        {
            "what overflows is a mistake": ("NUMERICAL = (OverflowError, ", "NUMERICAL = ("),
            "a torque too many is left out": ("if len(found) != len(joints):", "if len(found) < len(joints):"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/seeds",
        ["hybrid/tangent/test_seeds"],
        {"numbers that are zero are numbers of the motion": ("found = whole[kept]", "found = whole")},
    ),
    *mistakes_in(
        "hybrid/strikes",
        ["hybrid/test_ledger"],
        {
            "impact left out of the ledger": (
                "jacobian.T @ impulse[toes].ravel()",
                "0.0 * v",
            )
        },
    ),
    *mistakes_in(
        "hybrid/run",
        ["hybrid/test_equations_of_motion", "hybrid/test_torques", "hybrid/test_ledger", "hybrid/test_periodic"],
        {
            "impact not applied": ("v, impulse, work", "_, impulse, work"),
            "nothing is latched anew": (
                "begins=begins, clock=clock\n        )\n        # a clutch",
                "begins=begins, clock=clock\n        ) | held\n        # a clutch",
            ),
            "release left out of the ledger": ("= -in_springs(", "= -0.0 * in_springs("),
        },
    ),
    *mistakes_in(
        "hybrid/flow_names",
        ["hybrid/test_path_springs"],
        {"all energies are those of the first spring": ("{spring_of(mount, system)}", "{next(iter(system.springs))}")},
    ),
    *mistakes_in(
        "hybrid/integration",
        [
            *(
                "hybrid/test_integration",
                "hybrid/test_equations_of_motion",
                "hybrid/test_torques",
                "hybrid/test_ledger",
            ),
            "hybrid/test_lanes_in_space",
        ],
        {
            "absolute tolerance ten thousand times looser": ("0.01 * options.rtol", "100.0 * options.rtol"),
            "an event's state is not of its time": ("motion.y = _step_to(flow, t0, y0, motion.t)", "pass"),
            "toes that set out take any step": ("min(how.longest, flow.longest)", "how.longest"),
            "a step more than may be": ("flow.evaluations <= most", "flow.evaluations <= 10 * most"),
        },
    ),
    *mistakes_in(
        "hybrid/integration",
        ["hybrid/test_spring_laws"],
        {"integrated across the knots of a table": (", *bends(flow, ends, states, solver.dense_output)", "")},
    ),
    *mistakes_in(
        "hybrid/sampling",
        ["hybrid/test_sliding"],
        {"samples with a direction that a toe has left": ("            if set_out:", "            if False:")},
    ),
    *mistakes_in(
        "hybrid/engines/polynomials",
        ["hybrid/test_taylor_single"],
        {"times since the first step": ("times - self.begins[step]", "times - self.begins[0]")},
    ),
    *mistakes_in(
        "hybrid/sampling",
        ["hybrid/test_simulate"],
        {
            "no sample just before an event": (
                "np.linspace(begin, end, count)",
                "np.linspace(begin, end, count + 1)[:-1]",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/trajectory_tables",
        ["hybrid/test_trajectory", "hybrid/test_trajectory_tables"],
        {
            "degrees in the table": ('("q", one.q, one.coordinates)', '("q", np.degrees(one.q), one.coordinates)'),
        },
    ),
    *mistakes_in(
        "hybrid/column_names",
        ["hybrid/test_column_names", "hybrid/test_trajectory_tables"],
        {
            "velocities in the units of positions": ('("m/s", "rad/s")', '("m", "rad")'),
            "the friction of a slide in N·m": ('("friction", ("N", "N·m"))', '("friction", ("N·m", "N·m"))'),
        },
    ),
    *mistakes_in(
        "hybrid/trajectory_parts",
        ["hybrid/test_trajectory_parts"],
        {
            "the ledger of the cycle before": ("slice(max(first, 1) - 1,", "slice(max(first - 2, 0),"),
            "events of the whole in a part": ("any(begin <= e.time <= end for begin, end in spans)", "spans"),
            "no gap between the phases of a part": (
                "np.flatnonzero(later & elsewhere)",
                "np.flatnonzero(later & ~later)",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/trajectory_file",
        ["hybrid/test_trajectory_file", "hybrid/test_trajectory"],
        {
            "the ledger's changes are not loaded": (
                'arrays["ledger_change"])',
                '0.0 * arrays["ledger_change"])',
            ),
            "numbers need not be finite": ("and not np.isfinite(array).all()", "and np.isinf(array).any()"),
            "time may run backward": ("ORDERED = (", 'ORDERED = ("cycle", "event_time")  # ('),
        },
    ),
    *mistakes_in(
        "hybrid/run",
        ["hybrid/test_walkers"],
        {"no work of a jump": ("in_mechanism(system, domain, held, self.y, kept) - was", "0.0")},
    ),
    *mistakes_in(
        "hybrid/lanes/lone_runner",
        ["hybrid/test_walkers"],
        {"a lone lane does not jump": ("now.y = np.array([*q, *v])", "pass")},
    ),
    *mistakes_in(
        "hybrid/lanes/numbers",
        ["hybrid/test_walkers"],
        {"lanes do not jump": ("replace(group, y=after).take(there)", "group.take(there)")},
    ),
]
