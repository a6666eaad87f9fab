"""Mistakes in the reading, cutting, shooting and fitting of logs."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "studies/logs/spread",
        ["studies/logs/test_spread"],
        {
            "logs: correlation on one side only": ("float(1.0 + 2.0 * shares", "float(1.0 + 1.0 * shares"),
            "logs: a part too many": ("(1.0 - 1.0 / len(kept))", "(1.0 + 1.0 / len(kept))"),
        },
    ),
    *mistakes_in(
        "studies/fitting",
        ["studies/logs/test_spread"],
        {"logs: what starts explain is a value's": ("seen = own - basis @ (basis.T @ own)", "seen = own")},
    ),
    *mistakes_in(
        "studies/logs/shooting",
        ["studies/logs/test_shooting", "studies/logs/test_fit"],
        {
            "logs: steps of a lower order": ("(k1 + 2.0 * (k2 + k3) + k4)", "(k1 + 3.0 * k2 + k3 + k4)"),
            "logs: torques that are held": ("(torques[k + 1] - torques[k]) / count", "0.0 * torques[k]"),
        },
    ),
    *mistakes_in(
        "studies/logs/played",
        ["studies/logs/test_shooting"],
        {
            "logs: hysteresis along the motion": ("return force - against", "return force + against"),
            "logs: a slack spring with hysteresis": ("against = taut * ", "against = "),
        },
    ),
    *mistakes_in(
        "studies/logs/residuals",
        ["studies/logs/test_residuals", "studies/logs/test_fit"],
        {
            "logs: positions that come early": ("late = arc.t - values[lag]", "late = arc.t + values[lag]"),
            "logs: springs latched where a wrong zero has it": ("at = arc.touchdown - zeros", "at = arc.touchdown"),
            "logs: a second sensor with the first one's noise": ("trust=self.trust * sizes[0] /", "trust=sizes[0] /"),
            "logs: stances and flights in one part": ("((arc.phase.name == FLIGHT) + ", "("),
        },
    ),
    *mistakes_in(
        "studies/logs/arcs",
        ["studies/logs/test_residuals"],
        {
            "logs: nothing left out after touchdown": ("(settle if stance else MARGIN)", "MARGIN"),
            "logs: a base that falls up": ("at[joints.base] - np.array(falls)", "at[joints.base] + np.array(falls)"),
        },
    ),
    *mistakes_in(
        "studies/logs/phases",
        ["studies/logs/test_phases"],
        {"logs: touchdown while the leg still rises": ("(since > rate[leaves] / gravity)", "(since > 0.0)")},
    ),
    *mistakes_in(
        "studies/logs/replaying",
        ["studies/logs/test_replay"],
        {"logs: a replay that stays on the ground": ("if force[-1] < 0.0:", "if force[-1] < -50.0:")},
    ),
]
