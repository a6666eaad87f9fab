"""A robot's own look on what was cut out of it: where its links are, by the kinematics of the robot itself."""

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import load, monopod, sagittal, vary
from spear_pin.model.document import describe
from spear_pin.model.legs import find_legs
from spear_pin.viz.playback.grafting import grafted
from spear_pin.viz.playback.looks import FAINT, read_looks
from spear_pin.viz.playback.visuals import visuals_of
from tests.model.legged import quadruped, slider

VISUAL = """<visual><origin xyz="0.01 -0.02 0.03" rpy="0.1 0.2 0.3"/><geometry><box size="0.1 0.1 0.1"/></geometry>
<material name=""><color rgba="0.2 0.3 0.4 1"/></material></visual></link>"""


def dressed(text):
    """A URDF whose links with inertia have a visual each."""
    return text.replace("</inertial></link>", f"</inertial>{VISUAL}")


@pytest.fixture(scope="module", params=["revolute", "continuous"])
def dog(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("robots") / "dog.urdf"
    text = quadruped(hip=-1, kind=request.param, knee_limits=(-2.5, 2.5), ahead=0.03)
    path.write_text(dressed(text), encoding="utf-8")
    return path


def cut_leg(path, name, **options):
    """A monopod of a leg; the front knees flex to the one side, the hind ones to the other."""
    robot = load(path, motors="all")
    legs = find_legs(robot, sides={"FL": -1, "FR": -1, "HL": 1, "HR": 1})
    return monopod(robot, next(leg for leg in legs if leg.name == name), **options)


def placed(robot, q):
    """Poses of what is drawn of a cut, by the body that shows it, and the visuals by that."""
    whole, data = robot.cut.robot, pin.Data(robot.model)
    visuals, faults = visuals_of(describe(whole), whole.model)
    assert not faults
    pin.forwardKinematics(robot.model, data, q)
    found = grafted(robot, robot.cut, visuals)
    assert len({visual.body for visual in found}) == len(found)
    poses = {visual.body: data.oMi[visual.joint].homogeneous @ visual.placement for visual in found}
    return poses, {visual.body: visual for visual in found}


def posed(path, robot, q, base):
    """Poses of what the robot shows, and of its bodies, its root at a pose, its joints at the cut's angles."""
    free = load(path, base="free", motors=[])
    model = free.model
    configuration = pin.neutral(model)
    configuration[:7] = pin.SE3ToXYZQUAT(base)
    for name, turns in robot.cut.angles.items():
        for turn in turns:
            joint = model.joints[model.getJointId(turn.joint)]
            angle = turn.zero + turn.sign * q[robot.index(name)]
            both = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            configuration[joint.idx_q : joint.idx_q + joint.nq] = both
    data = pin.Data(model)
    pin.framesForwardKinematics(model, data, configuration)
    own = pin.SE3(pin.rpy.rpyToMatrix(0.1, 0.2, 0.3), np.array([0.01, -0.02, 0.03])).homogeneous
    bodies = {frame.name: data.oMf[i].homogeneous for i, frame in enumerate(model.frames) if frame.type.name == "BODY"}
    return {name: pose @ own for name, pose in bodies.items()}, bodies


def test_a_sagittal_robot_is_the_whole_robot(dog):
    """Its torso is the floating base; left and right are turned alike."""
    robot = sagittal(load(dog, motors="all"))
    q = np.array([0.7, 0.4, 0.2, 0.3, 0.9, -0.4, 1.2])
    base = pin.SE3(pin.utils.rotate("y", -q[2]), np.array([q[0], 0.0, q[1]]))
    poses, visuals = placed(robot, q)
    wanted, _ = posed(dog, robot, q, base)
    assert len(poses) == 17 and not any(visual.faint for visual in visuals.values())
    for body, pose in poses.items():
        assert pose == pytest.approx(wanted[body], abs=1e-9), body


@pytest.mark.parametrize("leg", ["FL", "HR"])
@pytest.mark.parametrize("locked", [[], ["boom_x"], ["boom_x", "knee"]])
def test_a_monopod_is_its_leg_below_a_faint_trunk(dog, leg, locked):
    """Its hip is the boom's point, its toe in the plane; where x points to the rear, all is turned by half a turn."""
    robot = cut_leg(dog, leg, locked=locked)
    whole = np.array([0.7, 0.4, 0.3, 0.0 if "knee" in locked else 0.9])
    names = ["boom_x", "boom_z", "hip", "knee"]
    if "boom_x" in locked:
        whole[0] = 0.0
    poses, visuals = placed(robot, whole[[name not in locked for name in names]])
    full = cut_leg(dog, leg)
    turned = np.diag([-1.0, -1.0, 1.0]) if robot.cut.mirrored else np.eye(3)
    _, bodies = posed(dog, full, whole, pin.SE3(turned, np.zeros(3)))
    hip, toe = bodies[f"{leg}_thigh"][:3, 3], bodies[f"{leg}_foot"][:3, 3]
    base = pin.SE3(turned, np.array([whole[0] - hip[0], -toe[1], whole[1] - hip[2]]))
    wanted, _ = posed(dog, full, whole, base)
    assert set(poses) == {"trunk", *(f"{leg}_{part}" for part in ("bracket", "thigh", "shank", "foot"))}
    assert [body for body, visual in visuals.items() if visual.faint] == ["trunk"]
    for body, pose in poses.items():
        assert pose == pytest.approx(wanted[body], abs=1e-9), body


def test_both_directions_are_tried(dog):
    assert cut_leg(dog, "FL").cut.mirrored and not cut_leg(dog, "HR").cut.mirrored
    assert cut_leg(dog, "FL").cut.angles["knee"][0].zero != 0.0


def test_rails_stay_where_they_are(tmp_path):
    """What slides on them goes with the hip; they would move through the picture."""
    path = tmp_path / "slider.urdf"
    rail = '<link name="world"><visual><geometry><box size="9 1 1"/></geometry></visual></link>'
    path.write_text(dressed(slider()).replace('<link name="world"/>', rail), encoding="utf-8")
    poses, _ = placed(monopod(load(path, motors="all"), "one"), np.zeros(4))
    assert "trunk" in poses and "world" not in poses


def test_colours(dog):
    shapes = read_looks(cut_leg(dog, "FL")).shapes
    assert {shape.color for shape in shapes} == {(0.2, 0.3, 0.4, 1.0), (0.2, 0.3, 0.4, FAINT)}


def test_shipped_robots_that_are_cut_keep_their_look():
    looks = read_looks(sagittal(load("q_spear_full")))
    assert looks.notes == () and {shape.kind for shape in looks.shapes} >= {"box", "cylinder"}
    whole = read_looks(load("q_spear_full")).shapes
    assert sorted(shape.size for shape in looks.shapes) == sorted(shape.size for shape in whole)


@pytest.mark.parametrize(
    ("change", "note"),
    [("gone", "drawn as bones: "), ("another", "not drawn: a visual of 'belly' (no such body)")],
)
def test_a_file_that_is_not_there_any_more(tmp_path, change, note):
    path = tmp_path / "dog.urdf"
    path.write_text(dressed(quadruped()), encoding="utf-8")
    robot = monopod(load(path, motors="all"), "FL")
    if change == "gone":
        path.unlink()
    else:
        path.write_text(dressed(slider()).replace('"trunk"', '"belly"'), encoding="utf-8")
    looks = read_looks(robot)
    assert looks.notes[0].startswith(note) and len(looks.shapes) == 2


@pytest.mark.parametrize("base", ["free", "fixed"])
def test_whatever_the_base(dog, base):
    """The trunk is the root link, or what is on a floating joint; joints that are locked are in it."""
    q = np.array([0.7, 0.4, 0.2, 0.3, 0.9, -0.4, 1.2])
    locked = ["FL_swing", "HR_swing"]
    one, other = (placed(sagittal(load(dog, **options)), q)[0] for options in ({"base": base, "locked": locked}, {}))
    assert set(one) == set(other)
    for body, pose in one.items():
        assert pose == pytest.approx(other[body], abs=1e-9), body


def test_a_plane_whose_hips_are_moved(dog):
    """Legs stay on their hips."""
    robot = sagittal(load(dog, motors="all"))
    moved = vary(robot, hip_distance=0.6)
    q = np.array([0.7, 0.4, 0.2, 0.3, 0.9, -0.4, 1.2])
    (before, _), (after, _) = placed(robot, q), placed(moved, q)
    for leg, hip in (("HL", "posterior_hip"), ("FR", "anterior_hip")):
        shift = (moved.frame_position(q, hip) - robot.frame_position(q, hip)).tolist()
        assert np.linalg.norm(shift) > 0.01
        for part in ("thigh", "shank", "foot"):
            difference = after[f"{leg}_{part}"] - before[f"{leg}_{part}"]
            assert difference[[0, 2], 3] == pytest.approx(shift) and difference[:, :3] == pytest.approx(0.0, abs=1e-12)
