"""Logs in MCAP files, read back by the format's own library: places, joints, forces, shapes, events and times."""

import json
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest

from spear_pin import Gait, Ground, hopping, load, simulate
from spear_pin.errors import BadValue, MissingExtra
from spear_pin.model.loading import ROBOTS
from spear_pin.model.recut import recut
from spear_pin.viz.mcap_log import ARROW, write_mcap
from spear_pin.viz.playback.looks import read_looks
from tests.hybrid.test_ground import Step

needs_mcap = pytest.mark.extra("mcap", "mcap_protobuf", "foxglove_schemas_protobuf")


@pytest.fixture(scope="module")
def hop():
    """Two hops of SPEAR-II on a slope, and the robot."""
    robot = load("spear_ii")
    system = hopping(robot, ground=Ground(slope=0.05))
    return robot, simulate(system, system.guess(), cycles=2)


@pytest.fixture(scope="module")
def logged(hop, tmp_path_factory):
    """What a file has: messages by topic, each with its time in ns; metadata; attachments."""
    return read(write_mcap(*hop, tmp_path_factory.mktemp("mcap") / "hop.mcap"))


def read(path):
    from mcap.reader import make_reader
    from mcap_protobuf.decoder import DecoderFactory

    topics, kinds = {}, {}
    with path.open("rb") as file:
        reader = make_reader(file, validate_crcs=True, decoder_factories=[DecoderFactory()])
        for schema, channel, message in reader.iter_messages():
            kinds[channel.topic] = schema.name
            decode = DecoderFactory().decoder_for(channel.message_encoding, schema) or json.loads
            topics.setdefault(channel.topic, []).append((message.log_time, decode(message.data)))
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
        attached = {each.name: each.data for each in reader.iter_attachments()}
    return topics, kinds, metadata, attached


def surface(entity):
    """Points of an entity's triangles, and the corners of each."""
    (triangles,) = entity.triangles
    points = np.array([(point.x, point.y, point.z) for point in triangles.points])
    return points, points[np.reshape(triangles.indices, (-1, 3))]


def pose(message):
    """A frame's place in its parent."""
    at, turn = message.translation, message.rotation
    return pin.SE3(pin.Quaternion(turn.w, turn.x, turn.y, turn.z).matrix(), np.array([at.x, at.y, at.z]))


@needs_mcap
class TestHop:
    def test_topics(self, logged):
        assert logged[1] == {
            "/tf": "foxglove.FrameTransforms",
            "/joint_states": "foxglove.JointStates",
            "/scene/robot": "foxglove.SceneUpdate",
            "/scene/ground": "foxglove.SceneUpdate",
            "/scene/forces": "foxglove.SceneUpdate",
            "/events": "foxglove.Log",
            "/samples": "spear_pin.Sample",
        }

    def test_times(self, hop, logged):
        for topic in ("/tf", "/joint_states", "/scene/forces", "/samples"):
            times = 1e-9 * np.array([time for time, _ in logged[0][topic]])
            np.testing.assert_allclose(times, hop[1].t, rtol=0, atol=1e-6)
        for time, message in logged[0]["/joint_states"]:
            assert message.timestamp.seconds * 10**9 + message.timestamp.nanos == time

    def test_places(self, hop, logged):
        robot, trajectory = hop
        for row in (0, 57, -1):
            _, message = logged[0]["/tf"][row]
            found = {each.child_frame_id: pose(each) for each in message.transforms}
            assert {each.parent_frame_id for each in message.transforms} == {"world"}
            assert {"thigh", "shank", "toe"} <= set(found) and "world" not in found
            for name, place in found.items():
                x, z = robot.frame_position(trajectory.q[row], name)
                np.testing.assert_allclose(place.translation, [x, place.translation[1], z], rtol=0, atol=1e-6)

    def test_joints(self, hop, logged):
        _, trajectory = hop
        for symbol, values in (("position", trajectory.q), ("velocity", trajectory.v), ("acceleration", trajectory.a)):
            found = [[getattr(joint, symbol) for joint in each.joints] for _, each in logged[0]["/joint_states"]]
            np.testing.assert_array_equal(found, values)
        assert [joint.name for joint in logged[0]["/joint_states"][0][1].joints] == list(trajectory.coordinates)
        efforts = [[joint.effort for joint in each.joints] for _, each in logged[0]["/joint_states"]]
        np.testing.assert_array_equal(np.array(efforts)[:, [2, 3]], trajectory.tau)

    def test_samples_are_the_columns(self, hop, logged):
        names, table = hop[1].columns()
        np.testing.assert_array_equal([[each[name] for name in names] for _, each in logged[0]["/samples"]], table)
        assert [each["phase"] for _, each in logged[0]["/samples"]] == hop[1].phase.tolist()
        assert [each["engaged_knee"] for _, each in logged[0]["/samples"]] == hop[1].engaged[:, 0].tolist()

    def test_arrows_are_the_forces_in_the_world(self, hop, logged):
        robot, trajectory = hop
        row = int(np.argmax(trajectory.force[:, 0, 1]))
        (entity,) = logged[0]["/scene/forces"][row][1].entities
        (arrow,) = entity.arrows
        x, z = trajectory.ground.world(*trajectory.force[row, 0])
        turn = arrow.pose.orientation
        along = pin.Quaternion(turn.w, turn.x, turn.y, turn.z).matrix()[:, 0]
        np.testing.assert_allclose(along, np.array([x, 0.0, z]) / np.hypot(x, z), rtol=0, atol=1e-9)
        scale = float(logged[2]["spear_pin"]["metres_per_newton_of_arrows"])
        assert arrow.shaft_length + arrow.head_length == pytest.approx(scale * np.hypot(x, z))
        assert scale * np.linalg.norm(trajectory.force, axis=2).max() == pytest.approx(ARROW)
        at = arrow.pose.position
        np.testing.assert_allclose([at.x, at.z], robot.toe_position(trajectory.q[row], "toe"), rtol=0, atol=1e-9)
        flight = int(np.flatnonzero(trajectory.phase == "flight")[5])
        assert not logged[0]["/scene/forces"][flight][1].entities[0].arrows

    def test_the_ground_is_the_slope_under_the_toes(self, hop, logged):
        robot, trajectory = hop
        ((time, update),) = logged[0]["/scene/ground"]
        (entity,) = update.entities
        assert time == 0 and entity.frame_id == "world" and entity.id == "ground"
        points, corners = surface(entity)
        np.testing.assert_allclose(points[:, 2], points[:, 0] * np.tan(0.05), rtol=0, atol=1e-12)
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert (normals[:, 2] > 0).all(), "it is seen from above"
        toes = [robot.toe_position(q, "toe")[0] for q in trajectory.q]
        assert points[:, 0].min() < min(toes) and max(toes) < points[:, 0].max()
        said = json.loads(logged[2]["spear_pin"]["ground"])
        assert (said["slope"], said["height"], said["friction"]) == (0.05, 0.0, 0.8)

    def test_events(self, hop, logged):
        found = [(each.message, each.name) for _, each in logged[0]["/events"]]
        assert found == [(event.name, event.domain) for event in hop[1].events]
        times = [1e-9 * time for time, _ in logged[0]["/events"]]
        np.testing.assert_allclose(times, [event.time for event in hop[1].events], rtol=0, atol=1e-6)

    def test_the_robot(self, hop, logged):
        """Its shapes are where the player draws them, and its file is attached, byte by byte."""
        robot, trajectory = hop
        ((_, update),) = logged[0]["/scene/robot"]
        _, first = logged[0]["/tf"][0]
        frames = {each.child_frame_id: pose(each) for each in first.transforms} | {"world": pin.SE3.Identity()}
        found = [
            frames[entity.frame_id].act(np.array([solid.pose.position.x, solid.pose.position.y, solid.pose.position.z]))
            for entity in update.entities
            for solid in (*entity.cubes, *entity.cylinders, *entity.spheres)
        ]
        data = pin.Data(robot.model)
        pin.forwardKinematics(robot.model, data, trajectory.q[0])
        wanted = [data.oMi[shape.joint].act(shape.center) for shape in read_looks(robot).shapes]
        np.testing.assert_allclose(sorted(map(tuple, found)), sorted(map(tuple, wanted)), rtol=0, atol=1e-6)
        assert logged[3] == {"spear_ii.urdf": ROBOTS["spear_ii"].path.read_bytes()}
        assert logged[2]["spear_pin"]["robot"] == "spear_ii" and logged[2]["spear_pin"]["units"] == "SI, radians"


@needs_mcap
class TestOthers:
    def test_a_plane_has_the_joints_of_the_whole(self, tmp_path):
        """Joints of both legs of a pair turn as the plane's do, with half the effort each."""
        gait = Gait.load("long_stride")
        stride = simulate(gait.system, gait.state, cycles=1)
        whole = load("q_spear_full")
        cut = recut("sagittal", whole, _pairs(whole))
        assert cut.coordinates == stride.coordinates
        topics, _, _, attached = read(write_mcap(cut, stride, tmp_path / "bound.mcap"))
        assert list(attached) == ["q_spear_full.urdf"]
        states = topics["/whole/joint_states"]
        assert len(states) == len(stride.t)
        found = {joint.name: joint for joint in states[40][1].joints}
        for name, turns in cut.cut.angles.items():
            column = stride.coordinates.index(name)
            for turn in turns:
                wanted = turn.zero + turn.sign * stride.q[40, column]
                assert found[turn.joint].position == pytest.approx(wanted, abs=1e-12)
                assert found[turn.joint].velocity == pytest.approx(turn.sign * stride.v[40, column], abs=1e-12)
            effort = sum(turn.sign * found[turn.joint].effort for turn in turns)
            assert effort == pytest.approx(stride.tau[40, stride.actuated.index(name)])

    def test_what_is_not_finite_is_null(self, hop, tmp_path):
        robot, trajectory = hop
        force = trajectory.force.copy()
        force[-1] = np.nan
        failed = replace(trajectory, force=force, reason="not_finite")
        topics, *_ = read(write_mcap(robot, failed, tmp_path / "failed.mcap"))
        assert topics["/samples"][-1][1]["force_z_toe"] is None
        assert not topics["/scene/forces"][-1][1].entities[0].arrows

    def test_a_step_is_drawn(self, hop, tmp_path):
        robot, trajectory = hop
        topics, *_ = read(write_mcap(robot, replace(trajectory, ground=Step(at=0.3)), tmp_path / "step.mcap"))
        points, _ = surface(topics["/scene/ground"][0][1].entities[0])
        for x, _, z in points:
            assert z == pytest.approx(0.02 if x > 0.3 else 0.0, abs=1e-9)
        assert {0.0, 0.02} == set(np.round(points[:, 2], 9))

    def test_what_begins_before_zero_is_shifted(self, hop, tmp_path):
        robot, trajectory = hop
        early = replace(trajectory, t=trajectory.t - 0.5, events=())
        topics, _, metadata, _ = read(write_mcap(robot, early, tmp_path / "early.mcap"))
        assert topics["/tf"][0][0] == 0 and float(metadata["spear_pin"]["time_of_zero"]) == -0.5
        assert topics["/samples"][0][1]["t"] == -0.5

    def test_of_another_robot(self, hop, tmp_path):
        with pytest.raises(BadValue, match="boom_x"):
            write_mcap(load("q_spear"), hop[1], tmp_path / "hop.mcap")
        assert list(tmp_path.iterdir()) == []


def _pairs(whole):
    from spear_pin.model.sagittal import sagittal

    return sagittal(whole).cut.legs


@pytest.mark.parametrize("package", ["mcap.writer", "mcap_protobuf.schema", "foxglove_schemas_protobuf.Log_pb2"])
def test_without_the_extra(hop, tmp_path, monkeypatch, package):
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(MissingExtra, match=r"which is not installed: pip install '\.\[logs\]'"):
        write_mcap(*hop, tmp_path / "hop.mcap")
    assert list(tmp_path.iterdir()) == []


@needs_mcap
def test_in_space(tmp_path):
    """The chain's joints have no frames; forces have three parts."""
    gait = Gait.load(Path(__file__).parents[2] / "examples" / "turn.json")
    robot, stride = gait.system.robot, simulate(gait.system, gait.state, progress=False)
    topics = read(write_mcap(robot, stride, tmp_path / "turn.mcap"))[0]
    row = int(np.argmax(stride.force[:, 0, 2]))
    found = {each.child_frame_id: pose(each) for each in topics["/tf"][row][1].transforms}
    for toe in robot.toes:
        np.testing.assert_allclose(found[toe].translation, robot.frame_position(stride.q[row], toe), atol=1e-6)
    arrow = topics["/scene/forces"][row][1].entities[0].arrows[0].pose.orientation
    ahead = pin.Quaternion(arrow.w, arrow.x, arrow.y, arrow.z).matrix()[:, 0]
    force = stride.force[row, 0]
    np.testing.assert_allclose(ahead, force / np.linalg.norm(force), atol=1e-6)
    assert abs(force[1]) > 10.0
