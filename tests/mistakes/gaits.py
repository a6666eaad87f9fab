"""Mistakes in laws and gaits."""

from tests.mistakes.mutation import mistakes_in

CONTINUED = ["gaits/continuation/test_maps", "gaits/continuation/test_bouncing_ball"]
MUTATIONS = [
    *mistakes_in(
        "gaits/attempts",
        ["gaits/test_clutches"],
        {"switches may be closed at the section": ("    if late:", "    if False:")},
    ),
    *mistakes_in(
        "gaits/orbits/strides",
        ["gaits/orbits/test_steering"],
        {
            "strides: clocks that go on": ("begun = begun + end", "begun = begun + 0.0 * end"),
            "strides: a turn to the right": ("return [end[YAW] - begin[YAW]", "return [begin[YAW] - end[YAW]"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/signs",
        [*CONTINUED, "gaits/continuation/test_kicked_oscillator"],
        {
            "a saddle taken for a torus": ("TORUS if np.abs(pair.imag).max() > 0.0 else SADDLE", "TORUS"),
            "a fold told twice": ("{CROSSING: (FOLD, every), KINK: (KINK, before)}", "{KINK: (KINK, before)}"),
            "a jump taken for a root": ("jumps = abs(test(point)) >", "jumps = -abs(test(point)) >"),
        },
    ),
    *mistakes_in(
        "hybrid/periodic",
        [*CONTINUED, "gaits/continuation/test_kicked_oscillator", "gaits/codesign/test_stability"],
        {
            "a flip where a multiplier is 1": ("1.0 + multipliers,", "1.0 - multipliers,"),
            "pairs with themselves": ("np.triu_indices(len(multipliers), 1)", "np.triu_indices(len(multipliers))"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/gaits",
        ["gaits/continuation/test_space", "gaits/continuation/test_hops"],
        {
            "families: a number's derivative in its own unit": ("rows]) * of_numbers", "rows]) * 1.0"),
            "families: directions in a number's own unit": ("= start * of_numbers", "= start"),
            "families: what is zero has a derivative": ("or vanishing:", "or False:"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/continuing",
        ["gaits/continuation/test_space"],
        {"families: half strides become whole": ("if member.mirrored_toes != system.mirrored_toes:", "if False:")},
    ),
    *mistakes_in(
        "gaits/continuation/gaits",
        ["gaits/continuation/test_space"],
        {
            "families: the section of the robot as it was": (
                "charts = replace(charts, section=section(self.family.member(numbers[0].tolist())))",
                "pass",
            )
        },
    ),
    *mistakes_in(
        "gaits/continuation/gaits",
        ["gaits/continuation/test_hops"],
        {
            "families: lanes on the first one's slope": (
                "charts = replace(charts, section=",
                "return replace(charts, section=",
            )
        },
    ),
    *mistakes_in(
        "hybrid/tangent/seeds",
        ["hybrid/tangent/test_seeds"],
        {
            "derivatives by lengths that a law has built in": ("if name in body_numbers(system.robot):", "if False:"),
            "one step for curves": ("if name.endswith(CURVED):", "if False:"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/stepping",
        CONTINUED,
        {
            "tangents turn back": ("if tangent @ before >= 0.0 else -1.0", "if tangent @ before <= 0.0 else -1.0"),
            "corrections however far": ("<= max(reach, 10.0 * TOLERANCE)", "< np.inf"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/borders",
        ["gaits/continuation/test_maps"],
        {
            "no way but straight on": (
                "_straight_on(problem, inner) or _turned(problem, inner, came)",
                "_straight_on(problem, inner)",
            ),
            "a turn that is not told": ("outer.slope * inner.slope < 0.0", "outer.slope * inner.slope < -2.0"),
            "borders approached by half": ("while length > CLOSEST", "while length > 1e-3"),
        },
    ),
    *mistakes_in(
        "gaits/continuation/differences",
        ["gaits/continuation/test_maps"],
        {"differences across borders": ("not reason and each == order for", "not reason for")},
    ),
    *mistakes_in(
        "gaits/continuation/follow",
        ["gaits/continuation/test_maps"],
        {
            "round and round": ("before < 0.0 <= after", "before < 0.0 <= after < -1.0"),
            "beyond the range": ("if not bounds[0] <= parameter <= bounds[1]:", "if not bounds[0] <= parameter:"),
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/signals",
        ["gaits/sensitivity/test_signals"],
        {
            "derivatives: an integral whose ends stay": (
                "weights @ piece.derivatives + end * stretch.tau - begin * stretch.since",
                "weights @ piece.derivatives",
            ),
            "derivatives: work whose ends stay": (
                "max(end, 0.0) * stretch.tau - max(begin, 0.0) * stretch.since",
                "0.0",
            ),
            "derivatives: a peak at an end that stays": (
                "piece.derivatives[end] + piece.rates[end] * moved",
                "piece.derivatives[end]",
            ),
            "derivatives: a weight that stays": ("(dbottom - dleast)", "dbottom"),
            "derivatives: roots where there are none alone": (
                "hulls.min(axis=-1) <= clear",
                "hulls.min(axis=-1) > clear",
            ),
            "derivatives: turns below the best alone": ("max(axis=1) > above", "max(axis=1) < above"),
            "derivatives: panels that are up in part": ("min(axis=1) >= 0.0", "max(axis=1) >= 0.0"),
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/signals",
        ["gaits/sensitivity/test_margins"],
        {
            "derivatives: a margin whose place stays": (
                "piece.derivatives[BEGIN] + piece.rates[BEGIN] * stretch.since",
                "piece.derivatives[BEGIN]",
            ),
            "derivatives: ends of panels are margins": (
                "hulls[1:, 0] < 0.0",
                "hulls[1:, 0] < np.inf",
            ),
        },
    ),
    *mistakes_in(
        "gaits/sensitivity/measures",
        ["hybrid/tangent/test_bound"],
        {
            "derivatives: a cost by a weight that stays": (
                "Dual(self.robot.weight, self._",
                "Dual(self.robot.weight, 0.0 * self._",
            )
        },
    ),
    *mistakes_in(
        "gaits/measures/of_samples",
        ["test_names", "studies/bound/test_bound"],
        {"names: a pair's torque for a motor's": ("one.u[:, i] / motors_at(joint)", "one.u[:, i]")},
    ),
    *mistakes_in(
        "gaits/measures/catalogue",
        ["test_names", "studies/bound/test_bound"],
        {"names: the effort of pairs": ("square * float(motors_at(joint))", "square * float(motors_at(joint)) ** 2")},
    ),
    *mistakes_in(
        "gaits/measures/signals",
        ["test_names", "studies/bound/test_bound"],
        {"names: friction used under any load": ("self.weight * (PRESSED /", "self.weight * (1e-6 /")},
    ),
    *mistakes_in(
        "gaits/sensitivity/electricity",
        ["gaits/sensitivity/test_electricity"],
        {
            "gears that help where a motor drives": (
                "efficiency ** (-1.0 if drives else 1.0)",
                "efficiency ** (1.0 if drives else -1.0)",
            ),
            "electricity is given back": ("np.where(power > 0.0, power, 0.0)", "power"),
            "power jumps where it stays": ("0.5 * h * (last - begin) * moved", "0.0 * moved"),
            "a reserve at half the no-load speed": (
                "other.times(slope.x, slope.d)",
                "other.times(slope.x, 0.5 * slope.d)",
            ),
            "heat of a resistance that stays": ("+ heat.d[:, None]", "+ 0.5 * heat.d[:, None]"),
            "gears help a reserve": ("in (efficiency, 1.0 / efficiency)", "in (1.0 / efficiency,)"),
        },
    ),
    *mistakes_in(
        "gaits/codesign/step",
        ["gaits/codesign/test_trust_region"],
        {
            "steps go over kinks of the function": ("if ahead <= 0.0:", "if False:"),
            "steps go over kinks of constraints": (
                "(other.c < 0.0) & (left >= local.c)",
                "(other.c < 0.0) & (left < -1e300)",
            ),
        },
    ),
    *mistakes_in(
        "gaits/round_hopping",
        ["gaits/test_round_hopping"],
        {
            "the toe commanded ahead of the wrong side": ("p.placement * (limb.reach", "-p.placement * (limb.reach"),
            "stance pulls at the ground": ("-bezier(p.push_up, s)[0]", "bezier(p.push_up, s)[0]"),
            "a push that does not end": ("s = 1.0 - ops.maximum(1.0 - t / p.push_time, 0.0)", "s = t"),
            "back-EMF drives": ("torques[0] - p.hip_back_emf", "torques[0] + p.hip_back_emf"),
            "back-EMF of lossless gears": ("return gears.efficiency * gear_constant", "return gear_constant"),
            "lift-off as soon as it touches": ("unloaded, into_flight, patience=math.inf)", "unloaded, into_flight)"),
            "a spring in stance only": ("(OPEN,), flight_law, mounts=(mount,),", "(OPEN,), flight_law,"),
        },
    ),
    *mistakes_in(
        "gaits/hopping",
        [
            "gaits/test_hopping",
            "hybrid/test_torques",
            "hybrid/test_endings",
            "hybrid/test_events",
            "gaits/test_path_springs",
        ],
        {
            "knee driven away from its angle": ("(p.knee_touchdown - q[knee])", "(q[knee] - p.knee_touchdown)"),
            "hip damping drives": ("- p.hip_damping * v[hip]", "+ p.hip_damping * v[hip]"),
            "extends first": ('"flexing": 1.0', '"flexing": -1.0'),
            "square wave of half the frequency": ("0.5 * n / p.frequency", "n / p.frequency"),
            "spring engaged in flight too": ("mounts=aloft,", "mounts=springs.standing,"),
            "the hip's motor leaves fixed springs alone": ('hip - dyn.spring_torque("hip")', "hip"),
            "extension limited as well": (
                'return held["compressing"] * spare + (1.0 - held["compressing"])',
                "return spare",
            ),
            "foot placed to the wrong side": ("+ p.foot_placement *", "- p.foot_placement *"),
            "a knee on the ground goes unnoticed": ('fall(["hip", "knee"])', 'fall(["hip"])'),
        },
    ),
    *mistakes_in(
        "gaits/proportions",
        ["gaits/test_proportions"],
        {
            "a leg with loops lands stretched": ("share * depths[", "depths["),
            "its torques do not know its lever": ("scale.force * _slope(depth, lands) /", "scale.force /"),
        },
    ),
    *mistakes_in(
        "gaits/springing",
        [
            "gaits/test_hopping",
            "hybrid/test_torques",
            "gaits/test_fixed_springs",
            "gaits/test_bounding",
            "gaits/test_path_springs",
            "gaits/test_clutches",
            "gaits/test_bounding_switches",
        ],
        {
            "spring kept at lift-off": ("if self.springs[mount.of].rest is None)", "if False)"),
            "a fixed spring let go": ("if self.springs[mount.of].rest is None)", "if True)"),
            "a fixed spring in stance only": ("if spring.rest is not None:", "if False:"),
            "a fixed spring's damper in flight": (
                "found.append(replace(mount, spring=replace(spring, damping=0.0)))",
                "found.append(mount)",
            ),
            "a late spring let go at lift-off": ("elif spring.clutch is not None:", "elif False:"),
            "a joint's damper that acts late": (" != JOINT", " == JOINT"),
            "touchdown angle kept from the first hop": (
                "values_along(mount.along, self.robot, q), str",
                "held.get(str(mount.rest), values_along(mount.along, self.robot, q)), str",
            ),
            "a spring on a leg that bends to the other side": ("path.on(names, leg.side)", "path.on(names)"),
            "a switch that lift-off does not open": ("KEEPS if clutch.hold else RELEASES", "KEEPS"),
        },
    ),
    *mistakes_in(
        "gaits/virtual_constraints",
        ["gaits/test_virtual_constraints"],
        {
            "virtual constraints: curvature left out": (
                "- curvature * (rate * rate)",
                "- 0.0 * curvature * (rate * rate)",
            ),
            "virtual constraints: damped by half": ("+ 2.0 * dy) / epsilon", "+ dy) / epsilon"),
            "virtual constraints: slope at the beginning": ("slope / (len(shape) + 1)", "slope / (len(shape) + 2)"),
            "virtual constraints: held beyond the end": ("height + slope * (s - inside)", "height"),
            "virtual constraints: curved beyond the end": ("curvature - evolution.past * curvature", "curvature"),
            "virtual constraints: a leaning leg's drift left out": (
                "rest = own.drift - tilt * phase.drift",
                "rest = -tilt * phase.drift",
            ),
            "virtual constraints: a leaning phase's drift left out": ("own.drift - tilt * phase.drift", "own.drift"),
        },
    ),
    *mistakes_in(
        "gaits/bounding_law",
        ["gaits/test_bounding_law", "gaits/test_bounding_gaits"],
        {
            "virtual constraints: other motors forgotten": ("outputs.motors, torques)", "outputs.motors, torques[:0])"),
            "bounding: physical spring added to the virtual one": ("total - dyn.spring_torque(leg.joint)", "total"),
            "bounding: virtual spring pulls": (
                "+ p.leg_stiffness * flexed)",
                "- p.leg_stiffness * flexed)",
            ),
        },
    ),
    *mistakes_in(
        "gaits/bounding",
        ["gaits/test_bounding", "gaits/test_fixed_springs", "gaits/test_bounding_switches"],
        {
            "bounding: lift-off from a double stance into the other one": (
                "leg.toe: _lifts(leg, next_stance, other, springing)",
                "leg.toe: _lifts(leg, stance, leg, springing)",
            ),
            "bounding: a stance that resumes begins anew": ("if resumed and f", "if not resumed and f"),
            "bounding: the other leg's switch is not held": ("(*own.leaving, *staying)", "own.leaving"),
            "bounding: a switch that lift-off does not reach": ("(*own.leaving, *staying)", "tuple(staying)"),
            "bounding: a switch that touchdown does not reach": ("springing[leg.name].touching", "()"),
            "bounding: conditions of switches go unnoticed": ("+= own.conditions(leg.toe) if", "+= () if"),
            "bounding: fixed springs unknown in the air": (
                "return {**_kept(springing, q, held), **swings}",
                "return swings",
            ),
        },
    ),
]
