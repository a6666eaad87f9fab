"""Mistakes in springs, their switches, and brakes."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "hybrid/strikes",
        ["hybrid/test_brakes"],
        {
            "a brake that takes the most energy": ("own, basis.T @ mass_matrix @ v)", "own, own @ basis.T @ v)"),
            "a brake takes no energy": ("@ (after - v) if", "@ (0.0 * v) if"),
            "a brake lifts no toe": ("np.where(leaves, (found[1] @ after)[1::2], 0.0)", "np.zeros(len(toes))"),
        },
    ),
    *mistakes_in(
        "hybrid/brakes",
        ["hybrid/test_brakes"],
        {
            "an event that closes no brake": ("for name in grips), turns=turns)", "for name in ()), turns=turns)"),
            "a brake closes in a phase without an impact": ("Reset(grips=grips, turns=", "Reset(turns="),
            "a condition is met again while a brake waits": ("waits + (1.0 - waits) * when(", "when("),
            "a brake grips although it is to open": ("waits * until(t, q, v, held, p, dyn, ops) +", "waits +"),
            "a toe that a brake lifts stays": ("guards=(*leaving, *domain.guards)", "guards=domain.guards"),
            "a lifted toe takes another along": ("way[1].count(OPEN), default", "-way[1].count(OPEN), default"),
            "a brake that stays closed is opened": ("Turn(name, closed=stays,", "Turn(name, closed=False,"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/symbolic",
        ["hybrid/test_compiled_brakes"],
        {
            "a brake that slips drives": ("found[i] - rub.sign * lever", "found[i] + rub.sign * lever"),
            "a law imposes what a brake keeps it from": ("or self.domain.rubs or", "or"),
            "a brake that sticks moves": ("[*self._terms.loop_rows, *held]", "[*self._terms.loop_rows]"),
        },
    ),
    *mistakes_in(
        "hybrid/lanes/impacts",
        ["hybrid/test_compiled_brakes"],
        {
            "lanes: a brake that takes the most energy": (
                "np.asarray(np.linalg.solve(own, pushed)[:, :, 0]) if",
                "v @ basis[0] if",
            ),
            "lanes: a brake lifts no toe": ("[1::2] * impact.leaves for", "[1::2] * 0.0 for"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/resets",
        ["hybrid/test_compiled_brakes"],
        {
            "derivatives: a brake that moves a path": ("slopes.braked + turned", "turned"),
            "derivatives: a path at rest that may move": ("elif not still:", "elif toes:"),
            "derivatives: a guided toe held along the ground": ("first = 1 if guided[i] or (", "first = 1 if ("),
        },
    ),
    *mistakes_in(
        "hybrid/domain",
        ["gaits/test_hysteresis"],
        {
            "hysteresis drives the motion": ("return -self._if_acting(ops.", "return self._if_acting(ops."),
            "hysteresis lets a chain push": ("ops.maximum(against, force) if spring.unilateral else", ""),
        },
    ),
    *mistakes_in(
        "hybrid/domain",
        ["hybrid/test_torques", "hybrid/test_ledger", "gaits/test_bounding", "gaits/test_clutches"],
        {
            "a slack spring acts and stores energy": ("else held[self.taut] * value", "else value"),
            "a second spring that loses what it stores": (" + held[self.on] * bridged)", ")"),
        },
    ),
    *mistakes_in(
        "hybrid/springs",
        ["hybrid/test_symbolic", "hybrid/test_torques", "gaits/test_path_springs"],
        {
            "a spring that rests where the robot is straight": (
                "path.length(posed([values.get(",
                "path.length(posed([{}.get(",
            ),
            "a force of springs without its lever": ("pull.force * pull.slope[index]", "pull.force"),
            "numbers of a path that are built in": ("return common.path is not None and", "return False and"),
            "a mount has the first spring's numbers": ("return mount.of or next", "return next"),
        },
    ),
    *mistakes_in(
        "hybrid/clutch",
        ["gaits/test_clutches"],
        {
            "a time of a switch that no phase ends": (
                "value - t if name.startswith(DUE)",
                "value if name.startswith(DUE)",
            ),
            "a lift-off that does not call off": (
                "(clutch.on_delay, 1.0 - on) if kind == TOUCHES",
                "(clutch.on_delay, 1.0) if kind == TOUCHES",
            ),
            "a switch that releases after no time": ("clock.t + clutch.hold", "clock.t"),
            "another leg's event calls a switch off": ("held.get(waiting(mount), 0.0), held", "0.0, held"),
            "a clutch that slips where it last gripped": ("GRIPS: (0.0, 1.0)", "GRIPS: (0.0, 0.0)"),
            "a clutch that grips and pulls as at touchdown": (
                "mount.rest: now} if kind == GRIPS",
                "mount.rest: rest} if kind == GRIPS",
            ),
            "a clutch that slips only": ("gives * dyn.pull(name).rate + (1.0 - gives)", "1.0"),
            "the tooth before": ("np.ceil((length", "np.floor((length"),
            "a switch that engages where it last did": ("return on * old + (1.0 - on) * new", "return old"),
            "a spring without play": ("slack = mount.tooth is not None or", "slack = mount.tooth is not None and"),
        },
    ),
    *mistakes_in(
        "hybrid/conditions",
        ["gaits/test_switch_conditions"],
        {
            "a switch that opens while it is open": ("acts_on * held[on] +", "acts_on +"),
            "a turn of the path that may be over": ("if condition.turns else 0.0", "if False else 0.0"),
        },
    ),
    *mistakes_in(
        "hybrid/tangent/stretched",
        ["gaits/sensitivity/test_sensitivity"],
        {"a stretch at a fixed time": ("stretch.end.slopes[:nv, None] * stretch.tau)", "0.0)")},
    ),
    *mistakes_in(
        "hybrid/path_springs",
        ["hybrid/test_path_springs"],
        {
            "springs that pull push": ("0.0 - force, acts", "force, acts"),
            "springs are stretched while not engaged": ("stretch if acts else 0.0", "stretch"),
        },
    ),
]
