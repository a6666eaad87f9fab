"""Mistakes made on purpose, as data: which text of which file, and the tests that have to notice."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class Mutation:
    """One mistake.

    Attributes:
        name: what is wrong.
        file: where.
        old: the text that is replaced; it occurs once.
        new: the text that replaces it.
        tests: test files, in the order in which they are run.
    """

    name: str
    file: str
    old: str
    new: str
    tests: tuple[str, ...]


def mistakes_in(file: str, tests: Iterable[str], texts: Mapping[str, tuple[str, str]]) -> list[Mutation]:
    """Mutations of one file, by name."""
    files = tuple(f"tests/{test}.py" for test in tests)
    return [Mutation(name, f"spear_pin/{file}.py", old, new, files) for name, (old, new) in texts.items()]


MUTATIONS = [
    *mistakes_in(
        "model/draft",
        ["model/test_dynamics", "hybrid/test_events", "hybrid/test_periodic"],
        {
            "gravity upward": (
                "= armature, rotor_inertia, gear_ratio",
                "= armature, rotor_inertia, gear_ratio; model.gravity.linear = -model.gravity.linear",
            ),
            "rotors left out": ("= transmission.reflected_inertia", "= 0.0"),
        },
    ),
    *mistakes_in(
        "model/transmissions",
        ["model/test_dynamics", "hybrid/test_periodic"],
        {"rotors times N, not N²": ("self.gear_ratio**2", "self.gear_ratio")},
    ),
    *mistakes_in(
        "model/robot",
        ["model/test_dynamics", "hybrid/test_equations_of_motion"],
        {
            "kinetic energy without rotors": (
                "float(0.5 * rates @ self.mass_matrix(q) @ rates)",
                "float(0.5 * rates @ (self.mass_matrix(q) - np.diag(self.model.armature)) @ rates)",
            ),
            "Jacobian in the toe's own frame": ("pin.ReferenceFrame.LOCAL_WORLD_ALIGNED", "pin.ReferenceFrame.LOCAL"),
            "spatial acceleration for the drift": ("pin.getFrameClassicalAcceleration", "pin.getFrameAcceleration"),
            "rows x and y of a toe": ("np.array([0, 2]) if self.planar", "np.array([0, 1]) if self.planar"),
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
        "hybrid/domain",
        ["hybrid/test_torques", "hybrid/test_ledger", "gaits/test_bounding"],
        {
            "spring pushes the wrong way": (
                "self.side * (angle - held[self.rest])",
                "self.side * (held[self.rest] - angle)",
            ),
            "a spring's torque to the wrong side": ("(self.side * spring.torque(", "(spring.torque("),
            "a slack spring still acts": ("return held[self.taut] * (self.side", "return (self.side"),
            "a slack spring stores energy": ("return held[self.taut] * self.spring", "return self.spring"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/pinocchio",
        [
            "hybrid/test_equations_of_motion",
            "hybrid/test_torques",
            "hybrid/test_ledger",
            "hybrid/test_endings",
            "gaits/test_hopping",
        ],
        {
            "damping drives": ("self.held, FLOATS) + drag", "self.held, FLOATS) - drag"),
            "drift dropped in stance": ("drifts.append(", "drifts.append(0.0 * "),
            "spatial acceleration in stance": (
                "pin.getFrameClassicalAcceleration(model, data",
                "pin.getFrameAcceleration(model, data",
            ),
            "rows x and y in stance": (
                "rows.append(pin.getFrameJacobian(model, data, index, WORLD_ALIGNED)[0:3:2])",
                "rows.append(pin.getFrameJacobian(model, data, index, WORLD_ALIGNED)[0:2])",
            ),
            "friction pushes a slipping toe on": (
                "jacobian[1] - friction * SIGN[mode] * jacobian[0]",
                "jacobian[1] + friction * SIGN[mode] * jacobian[0]",
            ),
            "work of slip with the wrong sign": ("slipped += self._forces", "slipped -= self._forces"),
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
                "drag = {i: mount.spring.damping * float(self.v[i]) for i, mount in self._springs}\n"
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
            "drifts left in the world's axes": ("toe: self.axes(*drift, ops) for", "toe: drift for"),
        },
    ),
    *mistakes_in(
        "hybrid/translation",
        ["hybrid/test_slopes"],
        {"moved along a slope without being lifted": ("np.sin(slope) * np.eye", "0.0 * np.eye")},
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
                "ops: dyn.friction_coefficient * dyn.force(toe)[1] + side",
                "ops: 0.5 * dyn.friction_coefficient * dyn.force(toe)[1] + side",
            ),
            "lift-off when the force rises": ("dyn, ops: dyn.force(toe)[1]", "dyn, ops: -dyn.force(toe)[1]"),
            "touchdown a tenth of a millimetre early": (
                "Guard(name, height(toe),",
                "Guard(name, lambda *at: height(toe)(*at) - 1e-4,",
            ),
        },
    ),
    *mistakes_in(
        "hybrid/events",
        ["hybrid/test_events"],
        {"grazing overlooked": ("<= 0.05 * max(before, middle, end)", "<= -1.0")},
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
            "what is only observed is an event at once": ("-math.inf if guard.observes else guard", "guard"),
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
        "hybrid/strikes",
        ["hybrid/test_ledger"],
        {"impact left out of the ledger": (" - impact.loss", "")},
    ),
    *mistakes_in(
        "hybrid/run",
        ["hybrid/test_equations_of_motion", "hybrid/test_torques", "hybrid/test_ledger", "hybrid/test_periodic"],
        {
            "impact not applied": ("v, impulse, work", "_, impulse, work"),
            "nothing is latched anew": (
                "held = latched(held, [reset], q.tolist(), v.tolist(), self.system.law)",
                "held = {**latched(held, [reset], q.tolist(), v.tolist(), self.system.law), **held}",
            ),
            "release left out of the ledger": ("= -in_springs(", "= -0.0 * in_springs("),
            "absolute tolerance ten thousand times looser": ("0.01 * options.rtol", "100.0 * options.rtol"),
        },
    ),
    *mistakes_in(
        "hybrid/run",
        ["hybrid/test_spring_laws"],
        {"integrated across the knots of a table": (", *bends(self.flow, ends, states, solver.dense_output)", "")},
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
        "hybrid/section",
        ["hybrid/test_section"],
        {
            "a direction of velocity missing from the chart": (
                "null_spaces(velocity_rows(jacobians, slides)))",
                "null_spaces(velocity_rows(jacobians, slides))[:, :, 1:])",
            ),
            "a sliding toe held along its path": ("np.column_stack([~slides,", "np.column_stack([slides | True,"),
            "charts on the ground of the first lanes": (
                "heights, jacobians[moving] = self.section.take(moving)",
                "heights, jacobians[moving] = self.section.take(np.arange(len(moving)))",
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
            "any step is taken": ("(1.0 - 0.1 * trials.damping) * trials.norm", "np.inf * trials.norm"),
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
        "hybrid/periodic",
        ["hybrid/test_periodic"],
        {
            "residual of positions only": (
                "np.concatenate([without(translations(system), after[0] - before[0]), after[1] - before[1]])",
                "without(translations(system), after[0] - before[0])",
            ),
            "multipliers by increasing modulus": ("-np.round(np.abs(values), 9)", "np.round(np.abs(values), 9)"),
        },
    ),
    *mistakes_in(
        "gaits/hopping",
        ["gaits/test_hopping", "hybrid/test_torques", "hybrid/test_endings", "hybrid/test_events"],
        {
            "knee driven away from its angle": ("(p.knee_touchdown - q[knee])", "(q[knee] - p.knee_touchdown)"),
            "hip damping drives": ("- p.hip_damping * v[hip]", "+ p.hip_damping * v[hip]"),
            "extends first": ('"flexing": 1.0', '"flexing": -1.0'),
            "square wave of half the frequency": ("0.5 * n / p.frequency", "n / p.frequency"),
            "touchdown angle kept from the first hop": (
                '"knee_touchdown": q[knee]',
                '"knee_touchdown": held.get("knee_touchdown", q[knee])',
            ),
            "spring engaged in flight too": (
                "mounts=fixed,",
                "mounts=(mount,),",
            ),
            "extension limited as well": (
                'return held["compressing"] * spare + (1.0 - held["compressing"])',
                "return spare",
            ),
            "foot placed to the wrong side": ("+ p.foot_placement *", "- p.foot_placement *"),
            "a knee on the ground goes unnoticed": ('fall(["hip", "knee"])', 'fall(["hip"])'),
        },
    ),
    *mistakes_in(
        "model/planar",
        ["model/test_planar"],
        {
            "planar: half of Coriolis on a slide": ("_scaled(2.0 * spin * v[i],", "_scaled(spin * v[i],"),
            "planar: gravity upward": ("joint.acceleration[1] + gravity", "joint.acceleration[1] - gravity"),
            "planar: rotors left out": ("mass_matrix[i][i] + body.armature", "mass_matrix[i][i]"),
            "planar: Steiner's mixed term halved": ("2.0 * _dot(load.moment, arm)", "_dot(load.moment, arm)"),
            "planar: torque of what hangs below left out": ("+ load.torque + _cross(arm, load.force)", "+ load.torque"),
        },
    ),
    *mistakes_in(
        "gaits/virtual_constraints",
        ["gaits/test_virtual_constraints"],
        {
            "virtual constraints: curvature left out": (
                "curvature * (rate * rate) + own - (y[i]",
                "0.0 * curvature * (rate * rate) + own - (y[i]",
            ),
            "virtual constraints: damped by half": ("+ 2.0 * dy[i]) / epsilon", "+ dy[i]) / epsilon"),
            "virtual constraints: other motors forgotten": ("outputs.motors, others)", "outputs.motors, others[:0])"),
            "virtual constraints: slope at the beginning": ("/ rate / (len(shape) + 1)", "/ rate / (len(shape) + 2)"),
            "virtual constraints: held beyond the end": ("height + slope * (s - inside)", "height"),
            "virtual constraints: curved beyond the end": ("curvature - evolution.past * curvature", "curvature"),
            "virtual constraints: a leaning leg's drift left out": (
                "own = slope * phase_drift - drift(outputs.rows[i], q, v, ops)",
                "own = slope * phase_drift",
            ),
            "virtual constraints: a leaning phase's drift left out": ("own = slope * phase_drift -", "own = -"),
        },
    ),
    *mistakes_in(
        "gaits/bounding_law",
        ["gaits/test_bounding_law", "gaits/test_bounding_gaits"],
        {
            "bounding: physical spring added to the virtual one": ("total - dyn.spring_torque(leg.joint)", "total"),
            "bounding: virtual spring pulls": (
                "+ p.virtual_stiffness * flexed)",
                "- p.virtual_stiffness * flexed)",
            ),
        },
    ),
    *mistakes_in(
        "gaits/bounding",
        ["gaits/test_bounding", "gaits/test_fixed_springs"],
        {
            "bounding: lift-off from a double stance into the other one": (
                "leg.toe: _lifts(leg, next_stance, other, spring)",
                "leg.toe: _lifts(leg, stance, leg, spring)",
            ),
            "bounding: spring kept at lift-off": (
                "if spring.rest is not None else (leg.joint,)",
                "if True else (leg.joint,)",
            ),
            "bounding: a fixed spring let go": (
                "release=() if spring.rest is not None else",
                "release=() if False else",
            ),
            "bounding: a fixed spring in stance only": ("bearing if spring.rest is None else legs", "bearing"),
            "bounding: a stance that resumes begins anew": ("if resumed and f", "if not resumed and f"),
            "bounding: feedback at each touchdown": ("if first and not resumed:", "if not resumed:"),
            "bounding: feedback to the wrong leg's angle": ("+ adjust[4 + i]", "+ adjust[5 - i]"),
        },
    ),
    *mistakes_in(
        "model/equipping",
        ["model/test_sidecar"],
        {
            "a file's motor forgets the square of its ratio": (
                "reflected or gearbox.ratio**2 * rotor",
                "reflected or gearbox.ratio * rotor",
            ),
            "a role's motor goes over a joint's": ('(name != "all", name not in roles)', "name in roles"),
            "a file's side may be beyond the limits": ("- leg.knee_zero) <= 0.0", "- leg.knee_zero) <= -9.0"),
        },
    ),
    *mistakes_in(
        "model/loading",
        ["model/test_sidecar"],
        {"a file goes over the argument": ("own_toes if toes is None else _names(toes)", "own_toes or _names(toes)")},
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
        "files",
        ["test_files"],
        {
            "files written in place": ('target.with_name(f".{target.name}.{os.getpid()}.tmp")', "target"),
            "a failed file left behind": ("temporary.unlink", "temporary.exists"),
        },
    ),
    *mistakes_in(
        "hybrid/engines/taylor_single",
        ["hybrid/test_lone_runner"],
        {
            "lane alone: a guard that stays on zero": ("if stays_on_zero(guards[i], values[i], change)", "if False"),
            "lane alone: a kink that stays on zero": (", values[self._kinks[1]])", ", [])"),
        },
    ),
    *mistakes_in(
        "hybrid/lanes/lone_runner",
        ["hybrid/test_lone_runner", "hybrid/test_ties"],
        {
            "lane alone: any number of events in an instant": (" or now.crowd == FEW_AT_ONCE", ""),
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
            "lane alone: time stands still": ("began += sum(spent.values())", "pass"),
            "lane alone: repeated from its beginning": (
                "if came[1] is self._fresh:\n                start, fresh",
                "if False:\n                start, fresh",
            ),
        },
    ),
    *mistakes_in(
        "viz/notebook/sketches",
        ["viz/notebook/test_cards"],
        {
            "multipliers outside the circle look like those inside": ("abs(z) < 1.0)", "abs(z) < 9.0)"),
            "slides drawn as bones": ("if place.translation.any()]", "]"),
        },
    ),
    *mistakes_in(
        "viz/plots/columns",
        ["viz/plots/test_columns"],
        {
            "lines across what is left out": ("gaps(trajectory) + 1", "gaps(trajectory)[:0]"),
        },
    ),
    *mistakes_in(
        "viz/playback/grafting",
        ["viz/playback/test_grafting"],
        {
            "a robot from behind is its mirror image": ("[-1.0, -1.0, 1.0, 1.0]", "[-1.0, 1.0, 1.0, 1.0]"),
            "links drawn as if every joint were at its zero": ("[turn.zero] if", "[0.0] if"),
        },
    ),
    *mistakes_in(
        "viz/playback/meshes",
        ["viz/playback/test_meshes"],
        {
            "a mesh from anywhere": ("path.is_relative_to(folder) and", "True or"),
            "a link to anywhere": ("regular(path).resolve().suffix", "regular(path).suffix"),
            "more faces than a page holds": ("while len(light.faces) > most", "while len(light.faces) > 9 * most"),
        },
    ),
    *mistakes_in(
        "cli/dynamics",
        ["cli/test_dynamics"],
        {"degrees on the command line": ("else np.array(arguments.q)", "else np.radians(arguments.q)")},
    ),
    *mistakes_in(
        "cli/__init__",
        ["cli/test_main"],
        {
            "a mistake ends with status 0": (
                'split())}")\n        return 2',
                'split())}")\n        return 0',
            ),
        },
    ),
]
