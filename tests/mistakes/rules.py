"""Mistakes in the rules of contact, impact and friction."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "hybrid/rules/guards",
        ["hybrid/test_lanes_in_space"],
        {
            "a toe that moves back is not stopped": (
                "Reset(stop=(toe,)), patience=SLOW)",
                "Reset(stop=(toe,)), patience=1.0)",
            )
        },
    ),
    *mistakes_in(
        "hybrid/rules/cone",
        ["hybrid/rules/test_cone"],
        {
            "cross term of the quartic": ("linear[1, 0] + linear[0, 1]", "linear[1, 0] - linear[0, 1]"),
            "a slide that turns back": ("if rate > least", "if rate > -1e9"),
            "friction along the motion": ("np.array([-friction * x", "np.array([friction * x"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/spatial_impact",
        ["hybrid/rules/test_spatial_impact"],
        {
            "a sweep too few": ("range(SWEEPS)", "range(2)"),
            "sticking outside the cone": ("np.hypot(x, y) <= friction * z", "z >= 0.0"),
            "what was received counts twice": ("impulse = (found.impulse - earlier)", "impulse = (found.impulse)"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/surface",
        ["hybrid/test_event_feedback"],
        {"what is added is added twice": ("if not name.startswith(ADDED)}", "}")},
    ),
    *mistakes_in(
        "hybrid/rules/latching",
        ["hybrid/test_event_feedback"],
        {
            "an event sees the law as it was": (
                "latch, p = reset.latch, adjust_law(law, held)",
                "latch, p = reset.latch, law",
            ),
            "feedback wherever a toe touches": ("if begins and reset.adjust", "if reset.adjust"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/impact",
        ["hybrid/rules/test_impact"],
        {
            "friction speeds up what slides in an impact": (
                "slide > 0.0, -friction, friction",
                "slide < 0.0, -friction, friction",
            ),
            "a toe that stops always sticks": ("sticks = abs(a_tn) <= friction * a_tt", "sticks = abs(a_tn) >= 0.0"),
            "loss of an impact without the half": ("loss = -0.5 *", "loss = -1.0 *"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/impact",
        ["hybrid/rules/test_joint_impact", "hybrid/test_double_stance"],
        {
            "joint impact: friction speeds up": (
                "unit[2 * i + 1] - mode * friction * unit[2 * i]",
                "unit[2 * i + 1] + mode * friction * unit[2 * i]",
            ),
            "joint impact: sticks outside the cone": ("max(abs(tangential) - friction * normal, -normal)", "-normal"),
            "joint impact: pulls at a sliding toe": ("abs(rise), -weight * normal)", "abs(rise))"),
            "joint impact: loss without the half": ("work = 0.5 * float(impulse", "work = float(impulse"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/guards",
        ["hybrid/test_events", "hybrid/test_equations_of_motion", "hybrid/test_periodic"],
        {
            "friction cone of half the width": (
                "return dyn.friction_coefficient * normal + side",
                "return 0.5 * dyn.friction_coefficient * normal + side",
            ),
            "lift-off when the force rises": ("dyn, ops: dyn.force(toe)[-1]\n", "dyn, ops: -dyn.force(toe)[-1]\n"),
            "touchdown a tenth of a millimetre early": (
                "Guard(name, height(toe),",
                "Guard(name, lambda *at: height(toe)(*at) - 1e-4,",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/rules/entry",
        ["hybrid/rules/test_entry", "hybrid/test_events"],
        {
            "a guard that rises from zero is an event": ("| (change < -CHANGE)", "| (abs(change) > CHANGE)"),
            "a guard that stays on zero ends its phase only if it falls": (
                " | ((change <= CHANGE) & guard.leaves)",
                "",
            ),
            "what is only observed is an event at once": ("-math.inf if guard.waits else guard", "guard"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/footing",
        ["hybrid/rules/test_footing"],
        {
            "a toe sticks outside the cone": ("abs(tangential) <", "tangential <"),
            "slip that would turn back": ("-STARTS_TO_SLIDE) | (speed > AT_REST)", "-STARTS_TO_SLIDE) | True"),
            "Painlevé's paradox fits": ("fits & posed & keeps & holds", "fits & keeps & holds"),
            "a toe is held down": ("stays & (normal > 0.0)", "stays"),
        },
    ),
    *mistakes_in(
        "hybrid/rules/sliding_impact",
        ["hybrid/rules/test_sliding_impact"],
        {
            "Keller: sliding does not turn": ("[d * -rate[0] + c * rate[1],", "[0.0,"),
            "Keller: friction along the sliding": (
                "-friction * c * r, -friction * d * r, r]",
                "friction * c * r, friction * d * r, r]",
            ),
            "Keller: sticks wherever sliding stops": ('rest.mode == "slip"', "False"),
            "Keller: the end is at rest": ("            return slid, True", "            return slid, False"),
        },
    ),
]
