"""Logs from MCAP files: of JSON, as controllers write them, and of protobuf, as this package does."""

import json
import sys

import numpy as np
import pytest

from spear_pin import hopping, load, simulate
from spear_pin.errors import BadFile, MissingExtra, UnknownName
from spear_pin.studies.logs import Column, Log
from spear_pin.viz.mcap_log import write_mcap

pytestmark = pytest.mark.extra("mcap", "mcap_protobuf")
T = np.arange(0.0, 0.3, 0.002)
BEGIN = 1_717_444_672_000_000_000  # ns
JOINTS, TORQUES = "/joints", "/drive.1"


def joints(time):
    """A message as ROS's JointState, with more beside it."""
    return {
        "name": ["hip", "knee"],
        "position": [float(time), float(np.degrees(time))],
        "effort": [],
        "header": {"frame": "world", "on": True},
        "cloud": [0.0] * 1000,
        "limbs": [{"name": "left", "load": 1.0}, {"load": 2.0}],
        "missing": None,
    }


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    """Angles at some times, torques 1 ms later, and a topic that nobody can decode."""
    from mcap.writer import Writer

    found = tmp_path_factory.mktemp("logs") / "hop.mcap"
    with found.open("wb") as file:
        writer = Writer(file)
        writer.start()
        topics = {name: writer.register_channel(name, "json", 0) for name in (JOINTS, TORQUES)}
        other = writer.register_channel("/camera", "cdr", 0)
        for time in T:
            at = BEGIN + round(1e9 * time)
            writer.add_message(topics[JOINTS], at, json.dumps(joints(time)).encode(), at)
            later = at + 1_000_000
            writer.add_message(topics[TORQUES], later, json.dumps({"tau": [0.5, 1e3 * (time + 0.001)]}).encode(), later)
            writer.add_message(other, at, b"\x00", at)
        writer.finish()
    return found


COLUMNS = {"knee": Column("/joints.knee.position", "deg"), "knee_torque": Column("/drive.1.tau.1", "mNm")}


def test_columns_are_topics_and_fields(path):
    log = Log.read(path, COLUMNS)
    np.testing.assert_allclose(log.t, T, atol=5e-7)
    np.testing.assert_allclose(log["knee"], T, rtol=1e-14)
    assert log.begin == BEGIN * 1e-9
    assert log.remarks == ("hop.mcap: topics in neither JSON nor protobuf: /camera",)


def test_another_topic_is_interpolated(path):
    torque = Log.read(path, COLUMNS)["knee_torque"]
    assert np.isnan(torque[0])
    np.testing.assert_allclose(torque[1:], T[1:], atol=1e-6)


def test_a_toml_file_says_it_too(path):
    path.with_suffix(".toml").write_text('[columns]\nknee = { column = "/joints.knee.position", unit = "deg" }')
    np.testing.assert_array_equal(Log.read(path)["knee"], Log.read(path, COLUMNS)["knee"])
    path.with_suffix(".toml").unlink()


def test_what_it_has_is_listed(path):
    with pytest.raises(BadFile, match=r"say which columns it is about, by `columns` or a TOML file; it has /joints"):
        Log.read(path)
    with pytest.raises(UnknownName) as error:
        Log.read(path, {"knee": "/joints.ankle.position"})
    assert {name for name in error.value.valid if name != "time"} == {
        *("/joints.hip.position", "/joints.knee.position", "/joints.header.on"),
        *("/joints.limbs.left.load", "/joints.limbs.1.load", "/drive.1.tau.0", "/drive.1.tau.1"),
    }


def test_a_damaged_file(path, tmp_path):
    half = tmp_path / "half.mcap"
    for content in (path.read_bytes()[:3000], b"", b"knee\n"):
        half.write_bytes(content)
        with pytest.raises(BadFile, match="not an MCAP file that can be read: "):
            Log.read(half, COLUMNS)


def test_without_the_extra(path, monkeypatch):
    monkeypatch.setitem(sys.modules, "mcap.reader", None)
    with pytest.raises(MissingExtra, match=r"needs mcap, which is not installed: pip install '\.\[logs\]'"):
        Log.read(path, COLUMNS)


@pytest.mark.extra("foxglove_schemas_protobuf")
def test_what_this_package_writes(tmp_path):
    """Joints come from protobuf, also where they are zero; torques from the samples in JSON."""
    system = hopping(load("spear_ii", locked=["boom_x"]))
    hop = simulate(system, system.guess(), cycles=1, samples=40)
    path = write_mcap(system.robot, hop, tmp_path / "hop.mcap")
    columns = {name: f"/joint_states.joints.{name}.position" for name in ("hip", "knee")}
    log = Log.read(path, {**columns, "hip_rate": "/joint_states.joints.hip.velocity", "knee_torque": "/samples.u_knee"})
    times, first = np.unique(np.round(hop.t, 9), return_index=True)
    np.testing.assert_allclose(log.t, times, atol=1e-9)
    at = {name: system.robot.index(name) for name in columns}
    for name, row in at.items():
        np.testing.assert_array_equal(log[name], hop.q[first, row])
    np.testing.assert_array_equal(log["hip_rate"], hop.v[first, at["hip"]])
    np.testing.assert_allclose(log["knee_torque"], hop.u[first, list(hop.actuated).index("knee")], atol=1e-12)
