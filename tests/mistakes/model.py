"""Mistakes in robots, springs and what they are read from."""

from tests.mistakes.mutation import mistakes_in

MUTATIONS = [
    *mistakes_in(
        "model/loops",
        ["model/test_loops"],
        {
            "a loop's ends added": (
                "parts.append(each[1] - each[0] if ends else tie[None])",
                "parts.append(each[1] + each[0] if ends else tie[None])",
            ),
            "a loop's drift of one end": ("(each[1] - each[0])[PLANE]", "each[1][PLANE]"),
            "loops that stay as they are": ("q[moving] -= step * min", "q[moving] -= 0.0 * step * min"),
        },
    ),
    *mistakes_in(
        "model/robot",
        ["model/test_loops"],
        {
            "no acceleration of dependent joints": ("T.T @ (self.bias(whole, v) + D @ c)", "T.T @ self.bias(whole, v)"),
            "dependent joints that turn the other way": ("T[~free] = -np.linalg", "T[~free] = np.linalg"),
        },
    ),
    *mistakes_in(
        "model/directions",
        ["hybrid/test_round_feet"],
        {
            "a round foot that slides as it rolls": (
                "found[0] + z * motions[4]",
                "found[0] - z * motions[4]",
            )
        },
    ),
    *mistakes_in(
        "model/directions",
        ["hybrid/test_arc_ends"],
        {"an end of an arc that its foot does not draw to itself": ("- rate**2 * lever", "+ rate**2 * lever")},
    ),
    *mistakes_in(
        "hybrid/span",
        ["hybrid/test_round_feet"],
        {
            "a round foot that lands with its centre, by a guard of one's own": (
                "self.flow.directions.place(model, data, index)",
                "pin.updateFramePlacement(model, data, index).translation",
            )
        },
    ),
    *mistakes_in(
        "model/numbers",
        ["hybrid/test_round_feet"],
        {"a radius that cannot be varied": ("radii[toe] = value", "pass")},
    ),
    *mistakes_in(
        "model/mechanism",
        ["hybrid/test_round_feet"],
        {
            "a radius on which no derivative depends": (
                "other.radii = dict(zip(self.radii, left, strict=True))",
                "list(left)",
            )
        },
    ),
    *mistakes_in(
        "model/round_feet",
        ["hybrid/test_arc_ends"],
        {
            "a foot that stands on the other end of its arc": (
                "self.arc.stop if self.ends[1]",
                "self.arc.stop if self.ends[0]",
            )
        },
    ),
    *mistakes_in(
        "hybrid/arc_ends",
        ["hybrid/test_arc_ends"],
        {"a foot that lies on its chord and goes on": ('ends="fall")', "Reset())")},
    ),
    *mistakes_in(
        "hybrid/rules/latching",
        ["hybrid/test_arc_ends"],
        {
            "a foot that lands on its arc wherever it lands": (
                "**standing(clock.system.robot, q, v)",
                "**standing(clock.system.robot, [0.0] * len(q), v)",
            )
        },
    ),
    *mistakes_in(
        "model/planar",
        ["hybrid/test_round_feet"],
        {"a round foot that slides as it rolls, compiled": ("(-lever[1], lever[0])", "(lever[1], lever[0])")},
    ),
    *mistakes_in(
        "model/planar",
        ["hybrid/test_loops"],
        {"a loop's drift of one end, compiled": ("drifts += [b - a for", "drifts += [b for")},
    ),
    *mistakes_in(
        "model/reach",
        ["gaits/test_reaching"],
        {"a hip that folds the leg": ("((self.hip, hip), (self.knee, knee))", "((self.knee, hip), (self.knee, knee))")},
    ),
    *mistakes_in(
        "model/cable",
        ["model/test_path"],
        {
            "a cable that pushes its start": ("| {i: -dot(d, column)", "| {i: dot(d, column)"),
            "a base that a cable moves": (
                "for i, column in end.columns.items() if i not in start.columns",
                "for i, column in end.columns.items()",
            ),
            "a cable through the pulley": ("ops.maximum(bend - touches, 0.0)", "0.0 * bend"),
            "a cable that the pulley does not lengthen": (" + self.radius * wrapped", ""),
            "a mirrored point where it was": ("(weigh(self.side, x), y, z)", "(x, y, z)"),
        },
    ),
    *mistakes_in(
        "model/path",
        ["model/test_path"],
        {
            "a part of a sum without its weight": ("weight * value)", "value)"),
        },
    ),
    *mistakes_in(
        "model/spatial",
        ["model/test_spatial"],
        {
            "half of Coriolis's acceleration of a slide": ("coriolis = scale(2.0,", "coriolis = scale(1.0,"),
            "no armature in space": ("times(body.armature, a[i])", "0.0"),
            "no armature in D in space": (
                "torque if body.turns else force), body.armature)",
                "torque if body.turns else force), 0.0)",
            ),
            "D in space without the arm": ("add(torque, cross(joints[j].arm, force)), above", "torque, above"),
            "a push that acts at the joint": ("subtract(loads[i][1], cross(offset, own))", "loads[i][1]"),
        },
    ),
    *mistakes_in(
        "model/draft",
        ["model/test_dynamics", "hybrid/test_events", "cases/test_cases", "model/test_planar_joint"],
        {
            "gravity upward": (
                "(np.zeros(model.nv) for _ in range(3))",
                "(np.zeros(model.nv) for _ in range(3)); model.gravity.linear = -model.gravity.linear",
            ),
            "a plane turned the other way": ("math.atan2(length, normal[2])", "-math.atan2(length, normal[2])"),
            "what a plane carries turns with it": ("= back.act(model.inertias[joint])", "= model.inertias[joint]"),
        },
    ),
    *mistakes_in(
        "model/gears",
        ["model/test_gears", "cases/test_cases"],
        {
            "rotors left out": ("armature[row] = reflected", "armature[row] = 0.0"),
            "rotors times N, not N²": ("ratio**2 * self.rotor", "ratio * self.rotor"),
            "an SRDF goes over its URDF": (
                "name: more if own is None",
                "name: more if more is not None",
            ),
        },
    ),
    *mistakes_in(
        "model/unread",
        ["model/test_unread", "cases/test_cases"],
        {
            "what is in what is not read counts as read": (
                "says or not children or any(",
                "says or not children or all(",
            ),
            "a second element passes for the first": ("and below in seen)", "and False)"),
        },
    ),
    *mistakes_in(
        "model/limits",
        ["cases/test_cases"],
        {"limits are told and not exchanged": ("= upper[place], lower[place]", "= lower[place], upper[place]")},
    ),
    *mistakes_in(
        "model/mjcf_motors",
        ["cases/test_cases"],
        {"an actuator's armature times its gear": ("None else gear * gear", "None else abs(gear)")},
    ),
    *mistakes_in(
        "model/mjcf_springs",
        ["crosscheck/test_exported_springs"],
        {
            "a tendon that only pulls pushes": (
                "(LOOSE, spring.rest) if spring.unilateral else (spring.rest,)",
                "spring.rest",
            ),
            "a tendon of the other side": ("coef=spring.path.side * weight", "coef=weight"),
            "a point beside a pulley that leaves the tendon": ("turn = 0.5 * path.side * (low + high)", "turn = 0.0"),
        },
    ),
    *mistakes_in(
        "model/mjcf_loops",
        ["model/test_mjcf_loops"],
        {
            "a belt that turns the other way": ("joints[1]: -slope", "joints[1]: slope"),
            "a written belt the other way round": ("-other / weight", "-weight / other"),
            "a polynomial without its square": ("or not slope or any(higher)", "or not slope"),
            "a pin that is off": ('elif off or said.get("active") == "false"', "elif off"),
        },
    ),
    *mistakes_in(
        "model/loop_data",
        ["model/test_mjcf_loops"],
        {"a pin that is not where its other end is": ("second.actInv(first.act(", "second.actInv(second.act(")},
    ),
    *mistakes_in(
        "model/mjcf_keyframes",
        ["cases/test_cases", "model/test_mjcf_keyframes"],
        {"a keyframe's zero is the joint's own": ("number - place.zero", "number")},
    ),
    *mistakes_in(
        "model/directions",
        ["model/test_directions", "model/test_spatial", "model/test_dynamics", "hybrid/test_equations_of_motion"],
        {
            "rows x and y of a toe": (
                "found = motions[0 : 3 : 4 - self.dimension]",
                "found = motions[: self.dimension]",
            ),
            "round a post the other way": ("(x * motions[1] - y * motions[0])", "(y * motions[0] - x * motions[1])"),
            "a circle's direction that does not turn": (" - (x * vy - y * vx) * (x * vx + y * vy) / radius**3", ""),
            "for any scalars it does not turn": ("- y * drift[0] - turning)", "- y * drift[0])"),
            "a circle about the origin": ("float(place[0]) - self.post[0]", "float(place[0])"),
            "forces round the origin": ("arms = places()[..., :2] - self.post", "arms = places()[..., :2]"),
        },
    ),
    *mistakes_in(
        "model/robot",
        ["model/test_dynamics", "hybrid/test_equations_of_motion"],
        {
            "kinetic energy without rotors": (
                "float(0.5 * rates @ self.mass_matrix(q) @ rates)",
                "float(0.5 * rates @ (self.mass_matrix(q) - np.diag(self.model.armature)) @ rates)",
            ),
            "Jacobian in the toe's own frame": ("self._q(q), index, WORLD_ALIGNED)", "self._q(q), index, pin.LOCAL)"),
            "spatial acceleration for the drift": ("pin.getFrameClassicalAcceleration", "pin.getFrameAcceleration"),
            "a place's x and y": ("np.array([0, 2]) if self.planar", "np.array([0, 1]) if self.planar"),
        },
    ),
    *mistakes_in(
        "model/spring",
        ["model/test_spring"],
        {
            "energy of a spring without the half": ("(0.5 * self.stiffness", "(self.stiffness"),
            "energy of a hardening spring without the quarter": ("0.25 * self.hardening", "0.5 * self.hardening"),
            "a spring that softens": ("(self.stiffness + self.hardening", "(self.stiffness - self.hardening"),
            "a preload that pushes": ("pull = self.preload +", "pull = -self.preload +"),
            "a table beside the stiffness": ("lambda k: k == 0, ", "lambda k: k >= 0, "),
            "energy of a table left out": ("return energy + self._integral(deflection, ops)", "return energy"),
            "a damper that drives": ("return -self.damping", "return self.damping"),
        },
    ),
    *mistakes_in(
        "model/curve",
        ["model/test_curve"],
        {
            "a curve bent beyond its points": ("(slopes[1],)", "(slopes[1], 1.0)"),
            "pieces of a curve that do not end": ("here - after", "here"),
            "an integral that is not from zero": ("-float(whole(0.0))", "0.0"),
        },
    ),
    *mistakes_in(
        "model/planar",
        ["model/test_planar"],
        {
            "planar: half of Coriolis on a slide": ("_scaled(2.0 * spin * v[i],", "_scaled(spin * v[i],"),
            "planar: gravity upward": ("_plane(-robot.model.gravity.linear)", "_plane(robot.model.gravity.linear)"),
            "planar: rotors left out": ("mass_matrix[i][i] + body.armature", "mass_matrix[i][i]"),
            "planar: Steiner's mixed term halved": ("2.0 * _dot(load.moment, arm)", "_dot(load.moment, arm)"),
            "planar: torque of what hangs below left out": ("+ load.torque + _cross(arm, load.force)", "+ load.torque"),
        },
    ),
    *mistakes_in(
        "model/equipping",
        ["model/test_sidecar"],
        {
            "a rotor is held against the robot's by its ratio": (
                "gearbox.ratio**2 * rotor",
                "gearbox.ratio * rotor",
            ),
            "a role's motor goes over a joint's": ('(name != "all", name not in roles)', "name in roles"),
            "a file's side may be beyond the limits": ("- leg.knee_zero) <= 0.0", "- leg.knee_zero) <= -9.0"),
        },
    ),
    *mistakes_in(
        "model/loading",
        ["model/test_sidecar"],
        {"a file goes over the argument": ("own_toes if asked.toes is None else asked.toes", "own_toes or asked.toes")},
    ),
    *mistakes_in(
        "model/settings",
        ["model/test_sidecar"],
        {"a pair has one spring": ("return spring\n    numbers", "return spring\n    return spring\n    numbers")},
    ),
    *mistakes_in(
        "model/origin",
        ["gaits/test_gait", "model/test_origin"],
        {
            "a saved gait forgets what is locked": ('"locked": list(robot.locked)', '"locked": []'),
            "a saved cut forgets its mass": ('"body": cut.body, "of"', '"body": 0.0, "of"'),
            "a cut is not looked at again": ("= not _again(robot)", "= False"),
        },
    ),
    *mistakes_in(
        "model/catalogue",
        ["model/test_motor"],
        {
            "a mass that grows as the torque": ("size ** mass_law().exponent", "size"),
            "a law of assumptions": ('entry[name].verification != "assumption"', "True"),
        },
    ),
    *mistakes_in(
        "model/variants",
        ["model/test_variants"],
        {
            "a knee's motor on the knee": ('* (_kind(name) != "knee")', ""),
            "a rotor of every size": ("model.armature[row] *= size", "pass"),
            "one motor of a pair": ('2.0 if robot.source == "q_spear"', '1.0 if robot.source == "q_spear"'),
        },
    ),
]
