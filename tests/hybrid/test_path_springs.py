"""Springs by name over the samples of a motion, against laws and lengths in closed form."""

import json
from dataclasses import replace

import numpy as np
import pytest

from spear_pin import Clutch, HoppingLaw, Spring, Trajectory, hopping, load, simulate
from spear_pin.errors import BadFile, UnknownName
from spear_pin.hybrid.trajectory_file import ARRAYS
from spear_pin.model.cable import Anchor, Between
from spear_pin.model.path import Joints

LEG = load("spear_ii", locked=["boom_x"])
START, END, REST = (0.03, 0.0, -0.1), (0.012, 0.0, 0.054), 0.194837478
THIGH = 0.318  # m
SPRINGS = {
    "cable": Spring(8000.0, damping=20.0, rest=REST, path=Between(Anchor("thigh", START), Anchor("shank", END))),
    "knee": Spring(20.0, damping=1.3, clutch=Clutch(on_delay=0.01)),
    "both": Spring(5000.0, damping=0.0, unilateral=False, path=Joints({"knee": 0.03, "hip": -0.006})),
}


@pytest.fixture(scope="module")
def run():
    system = hopping(LEG, HoppingLaw(stance_torque=7.8, hold_extension=True), SPRINGS)
    return simulate(system, system.guess(), rtol=1e-7)


def distance(q):
    """The length of the cable, from the angle of the knee alone."""
    knee = q[:, 2]
    x, z = START[0], START[2] + THIGH  # from the knee's axis, which the shank turns about
    along = np.cos(knee) * END[0] + np.sin(knee) * END[2], np.cos(knee) * END[2] - np.sin(knee) * END[0]
    return np.hypot(along[0] - x, along[1] - z)


def test_lengths_are_those_of_the_paths(run):
    springs = run.springs
    assert springs.names == ("cable", "knee", "both") and springs.units == ("m", "rad", "m")
    wanted = [distance(run.q), run.q[:, 2], 0.03 * run.q[:, 2] - 0.006 * run.q[:, 1]]
    np.testing.assert_allclose(springs.length, np.transpose(wanted), atol=1e-12)


def test_pulls_follow_the_laws(run):
    springs = run.springs
    np.testing.assert_allclose(springs.stretch[:, 0], springs.length[:, 0] - REST, atol=1e-12)
    for k, stiffness in enumerate((8000.0, 20.0, 5000.0)):
        stretch = springs.stretch[:, k] if k == 2 else np.maximum(springs.stretch[:, k], 0.0)  # it pushes, too
        wanted = stiffness * stretch * springs.acts[:, k]
        np.testing.assert_allclose(springs.pull[:, k], wanted, atol=1e-6)
        assert springs.pull[:, k].max() > 0.1


def test_pulls_make_the_torques_of_joints(run):
    """By virtual work: each pull acts on a joint by the change of its path with the joint's angle."""
    h, unit = 1e-6, np.eye(3)
    torque = np.zeros((len(run), 3))
    for joint in (1, 2):
        ahead, back = run.q + h * unit[joint], run.q - h * unit[joint]
        lengths = [[distance(q), q[:, 2], 0.03 * q[:, 2] - 0.006 * q[:, 1]] for q in (ahead, back)]
        slopes = (np.array(lengths[0]) - lengths[1]) / (2 * h)
        torque[:, joint] = -(run.springs.pull * slopes.T).sum(axis=1)
    columns = [run.coordinates.index(joint) for joint in run.spring_joints]
    np.testing.assert_allclose(run.spring, torque[:, columns], atol=1e-6)


def test_when_they_are_engaged(run):
    acts, flies = run.springs.acts, run.phase == "flight"
    assert acts[:, 0].all() and not acts[flies, 2].any() and acts[~flies, 2].all()
    begun, (touched, *_) = run.t[np.flatnonzero(acts[:, 1])[0]], run.named("retouch")
    assert begun == pytest.approx(touched.time + 0.01, abs=1e-9)  # its switch is late
    assert not run.springs.stretch[~acts].any()


class TestLedger:
    def test_closes(self, run):
        ledger = run.ledger
        assert np.abs(ledger.residual).max() < 1e-5 and ledger.kinds[-2:] == ("impact", "released")
        assert ledger["damping"] == ledger["damping:knee"] + ledger["damping:cable"] and not ledger["damping:both"]

    def test_of_two_halves_of_a_spring_is_that_of_the_spring(self, hop, hops):
        half = Spring(hop.system.spring.stiffness / 2, damping=hop.system.spring.damping / 2)
        halves = {"knee": half, "other": replace(half, path=Joints({"knee": 1.0}))}
        ledger = simulate(hopping(LEG, hop.system.law, halves), hop.state).ledger
        for flow in ("damping", "released"):
            np.testing.assert_allclose(ledger[flow], hops.ledger[flow][:1], atol=1e-9)
            for name in halves:
                np.testing.assert_allclose(ledger[f"{flow}:{name}"], hops.ledger[flow][:1] / 2, atol=1e-9)

    def test_has_what_each_spring_releases(self, run):
        """Half of k δ² of those that are latched, at lift-off."""
        lift_off = np.flatnonzero((run.phase[:-1] == "stance") & (run.phase[1:] == "flight"))
        stretch = run.springs.stretch[lift_off]
        knee, both = 10.0 * np.maximum(stretch[:, 1], 0.0) ** 2, 2500.0 * stretch[:, 2] ** 2
        wanted = {"released:cable": 0.0, "released:knee": -knee.sum(), "released:both": -both.sum()}
        assert wanted["released:both"] < -1e-3
        for flow, energy in wanted.items():
            assert run.ledger[flow][0] == pytest.approx(energy, abs=1e-9)
            assert sum(event.work.get(flow, 0.0) for event in run.events) == pytest.approx(energy, abs=1e-9)
        assert run.ledger["released"][0] == pytest.approx(sum(wanted.values()), abs=1e-9)

    def test_of_another_flow(self, run):
        with pytest.raises(UnknownName, match="released"):
            run.ledger["release"]


class TestFiles:
    def test_have_what_was_saved(self, run, tmp_path):
        read = Trajectory.load(run.save(tmp_path / "run.npz"))
        assert read.springs.names == run.springs.names and read.springs.paths == run.springs.paths
        np.testing.assert_array_equal(read.springs.pull, run.springs.pull)
        assert read.units() == run.units()

    def test_of_a_knee_spring_are_as_ever(self, hops, tmp_path):
        with np.load(hops.save(tmp_path / "hops.npz")) as data:
            assert set(data.files) == {"meta", *ARRAYS} and "springs" not in json.loads(str(data["meta"]))
        assert hops.springs is None and not {"pull_knee", "acts_knee"} & {*hops.to_pandas()}

    @pytest.mark.parametrize(
        ("name", "value"),
        [
            ("cable", {"unit": "ft"}),
            ("cable", {"unit": "m", "path": {"knee": 0.0}}),
            ("cable", {"unit": "m", "from": {"body": "thigh"}, "to": {"body": "shank"}}),
            ("cable", 3),
            ("", {"unit": "m"}),
        ],
    )
    def test_with_other_springs_are_refused(self, run, tmp_path, name, value):
        path = run.save(tmp_path / "run.npz")
        with np.load(path) as data:
            arrays = {each: data[each] for each in data.files}
        meta = json.loads(str(arrays["meta"]))
        meta["springs"] = {name: value, **{each: meta["springs"][each] for each in ("knee", "both")}}
        np.savez(path, **arrays | {"meta": np.array(json.dumps(meta))})
        with pytest.raises(BadFile, match=r"is not a saved trajectory"):
            Trajectory.load(path)


def test_parts_have_theirs(run):
    flight = run.in_phase("flight")
    assert len(flight.springs.pull) == len(flight)


class TestTables:
    def test_have_a_column_for_each(self, run):
        frame = run.to_pandas()
        units = frame.attrs["units"]
        assert units["stretch_cable"] == units["length_both"] == "m" and units["length_knee"] == "rad"
        assert units["pull_cable"] == "N" and units["pull_knee"] == "N·m"
        assert list(frame)[-3:] == ["acts_cable", "acts_knee", "acts_both"]
        np.testing.assert_array_equal(frame["pull_cable"], run.springs.pull[:, 0])

    def test_in_a_csv_file(self, run, tmp_path):
        head = run.export(tmp_path / "run.csv").read_text(encoding="utf-8").partition("\n")[0]
        assert {"length_cable [m]", "pull_cable [N]", "pull_knee [N·m]", "acts_both"} <= {*head.strip().split(",")}

    @pytest.mark.extra("xarray")
    def test_in_an_xarray(self, run):
        data = run.to_xarray()
        np.testing.assert_array_equal(data["path_pull"].sel(path_spring="cable"), run.springs.pull[:, 0])

    def test_in_a_mat_file(self, run, tmp_path):
        from scipy.io import loadmat

        read = loadmat(run.export(tmp_path / "run.mat"), simplify_cells=True)["springs"]
        assert [each.strip() for each in read["names"]] == ["cable", "knee", "both"]
        np.testing.assert_array_equal(read["pull"], run.springs.pull)

    def test_of_the_ledger_in_a_mat_file(self, run, tmp_path):
        from scipy.io import loadmat

        ledger = loadmat(run.export(tmp_path / "run.mat"), simplify_cells=True)["ledger"]
        assert ledger["damping_knee"] + ledger["damping_cable"] == ledger["damping"] == run.ledger["damping"]
