"""Trajectories on disk: saved and loaded, damaged, exported, never half written."""

import csv
import json
import zipfile
from dataclasses import fields
from io import BytesIO

import numpy as np
import pytest
from scipy.io import loadmat

from spear_pin import Trajectory, simulate
from spear_pin.errors import BadFile, BadValue, UnknownName
from spear_pin.hybrid.trajectory import Event, Ledger


@pytest.fixture(scope="module")
def hop_and_a_bit(hop, hops):
    """From the apex on, so that not everything is in cycle 1."""
    apex = hops.named("apex")[0]
    return simulate(hop.system, (apex.q, apex.v), cycles=2)


@pytest.fixture
def saved(tmp_path, hop_and_a_bit):
    return hop_and_a_bit.save(tmp_path / "hop.npz")


def assert_same(actual, expected):
    """Equal down to types, shapes and bits."""
    assert type(actual) is type(expected)
    if isinstance(expected, np.ndarray):
        assert actual.dtype == expected.dtype
        np.testing.assert_array_equal(actual, expected)
    elif isinstance(expected, (Event, Ledger, Trajectory)):
        for field in fields(expected):
            assert_same(getattr(actual, field.name), getattr(expected, field.name))
    elif isinstance(expected, tuple):
        assert len(actual) == len(expected)
        for pair in zip(actual, expected, strict=True):
            assert_same(*pair)
    else:
        assert actual == expected


class TestSaveAndLoad:
    def test_round_trip(self, saved, hop_and_a_bit):
        again = Trajectory.load(saved)
        for field in fields(Trajectory):
            if field.name != "events":
                assert_same(getattr(again, field.name), getattr(hop_and_a_bit, field.name))
        for event, original in zip(again.events, hop_and_a_bit.events, strict=True):
            assert (event.name, event.domain, event.time) == (original.name, original.domain, original.time)
            for name in ("q", "v_before", "v", "impulse"):
                np.testing.assert_array_equal(getattr(event, name), getattr(original, name))
            assert dict(event.work) == dict(original.work)

    def test_of_a_run_without_events_and_cycles(self, tmp_path, hop):
        failed = simulate(hop.system, hop.state, max_evaluations=100)
        assert failed.events == () and failed.cycles == 0
        again = Trajectory.load(failed.save(tmp_path / "failed.npz"))
        assert again.reason == failed.reason == "evaluation_cap" and not again.complete
        assert again.events == () and again.ledger.work.shape == failed.ledger.work.shape
        np.testing.assert_array_equal(again.q, failed.q)

    def test_path(self, tmp_path, hop_and_a_bit):
        """Written where it was asked for, whatever the suffix."""
        path = tmp_path / "hop.trajectory"
        assert hop_and_a_bit.save(str(path)) == path
        assert Trajectory.load(str(path)).cycles == 2

    def test_the_same_bytes_again(self, tmp_path, saved, hop_and_a_bit):
        assert hop_and_a_bit.save(tmp_path / "again.npz").read_bytes() == saved.read_bytes()

    def test_nothing_is_pickled(self, saved):
        with np.load(saved, allow_pickle=False) as data:
            assert {"t", "q", "v", "a", "force", "meta"} <= set(data.files)
            assert all(data[name].dtype != object for name in data.files)
            assert json.loads(str(data["meta"]))["units"] == "SI, radians"

    def test_saves_into_a_missing_folder(self, tmp_path, hop_and_a_bit):
        with pytest.raises(BadFile, match="cannot be written"):
            hop_and_a_bit.save(tmp_path / "missing" / "hop.npz")


def rewritten(path, **changes):
    """The saved file with some arrays replaced, or left out where the change is None."""
    with np.load(path) as data:
        arrays = {name: data[name] for name in data.files} | changes
    np.savez(path, **{name: array for name, array in arrays.items() if array is not None})


def meta_of(path, **changes):
    with np.load(path) as data:
        meta = json.loads(str(data["meta"])) | changes
    return np.array(json.dumps({name: value for name, value in meta.items() if value is not None}))


def single_array():
    """Content of an npy file."""
    buffer = BytesIO()
    np.save(buffer, np.arange(3))
    return buffer.getvalue()


DAMAGE = {
    "empty": lambda path: path.write_bytes(b""),
    "text": lambda path: path.write_text("t, q\n0.0, 1.0\n"),
    "a single array": lambda path: path.write_bytes(single_array()),
    "cut in half": lambda path: path.write_bytes(path.read_bytes()[: path.stat().st_size // 2]),
    "a few bytes short": lambda path: path.write_bytes(path.read_bytes()[:-7]),
    "another npz": lambda path: np.savez(path, t=np.arange(3)),
    "a zip": lambda path: zipfile.ZipFile(path, "w").close(),
    "no positions": lambda path: rewritten(path, q=None),
    "no meta": lambda path: rewritten(path, meta=None),
    "pickled positions": lambda path: rewritten(path, q=np.array([{"a": 1}], dtype=object)),
    "meta is no JSON": lambda path: rewritten(path, meta=np.array("{")),
    "meta is a JSON string": lambda path: rewritten(path, meta=np.array('"trajectory"')),
    "meta is a JSON list": lambda path: rewritten(path, meta=np.array("[]")),
    "another format": lambda path: rewritten(path, meta=meta_of(path, format="spear_pin trajectory 0")),
    "no reason": lambda path: rewritten(path, meta=meta_of(path, reason=None)),
    "an unknown field": lambda path: rewritten(path, meta=meta_of(path, colour="red")),
    "an event too many": lambda path: rewritten(path, event_time=np.arange(99.0)),
}


class TestDamagedFiles:
    @pytest.mark.parametrize("damage", DAMAGE)
    def test_refused(self, saved, damage):
        DAMAGE[damage](saved)
        with pytest.raises(BadFile, match="hop.npz") as error:
            Trajectory.load(saved)
        assert "\n" not in str(error.value)

    def test_missing(self, tmp_path):
        with pytest.raises(BadFile, match="cannot be read"):
            Trajectory.load(tmp_path / "missing.npz")

    def test_a_folder(self, tmp_path):
        with pytest.raises(BadFile, match="cannot be read"):
            Trajectory.load(tmp_path)

    def test_overwritten_bytes(self, saved):
        """Anywhere in the file: it is refused, or was of no importance."""
        whole = saved.read_bytes()
        rng = np.random.default_rng(4)
        refused = 0
        for place in rng.integers(0, len(whole) - 8, 300):
            saved.write_bytes(whole[:place] + rng.bytes(8) + whole[place + 8 :])
            try:
                Trajectory.load(saved)
            except BadFile:
                refused += 1
        assert refused > 250


class TestExport:
    def test_csv(self, tmp_path, hop_and_a_bit):
        path = hop_and_a_bit.export(tmp_path / "hop.csv")
        with path.open(encoding="utf-8", newline="") as file:
            header, *rows = csv.reader(file)
        assert len(rows) == len(hop_and_a_bit.t)
        columns = dict(zip(header, zip(*rows, strict=True), strict=True))
        assert len(columns) == len(header)
        assert list(columns.pop("domain")) == hop_and_a_bit.domain.tolist()
        assert list(columns.pop("phase")) == hop_and_a_bit.phase.tolist()
        assert list(columns.pop("engaged_knee")) == list(map(str, hop_and_a_bit.engaged[:, 0]))
        assert "q_knee [rad]" in header and "force_z_toe [N]" in header
        numbers = {name.partition(" [")[0]: np.array(column, dtype=float) for name, column in columns.items()}
        np.testing.assert_array_equal(numbers["t"], hop_and_a_bit.t)
        np.testing.assert_array_equal(numbers["cycle"], hop_and_a_bit.cycle)
        for i, name in enumerate(hop_and_a_bit.coordinates):
            np.testing.assert_array_equal(numbers[f"q_{name}"], hop_and_a_bit.q[:, i])
            np.testing.assert_array_equal(numbers[f"v_{name}"], hop_and_a_bit.v[:, i])
            np.testing.assert_array_equal(numbers[f"a_{name}"], hop_and_a_bit.a[:, i])
        for i, name in enumerate(hop_and_a_bit.actuated):
            np.testing.assert_array_equal(numbers[f"u_{name}"], hop_and_a_bit.u[:, i])
            np.testing.assert_array_equal(numbers[f"tau_{name}"], hop_and_a_bit.tau[:, i])
        np.testing.assert_array_equal(numbers["spring_knee"], hop_and_a_bit.spring[:, 0])
        np.testing.assert_array_equal(numbers["force_x_toe"], hop_and_a_bit.force[:, 0, 0])
        np.testing.assert_array_equal(numbers["force_z_toe"], hop_and_a_bit.force[:, 0, 1])

    def test_mat(self, tmp_path, hop_and_a_bit):
        data = loadmat(hop_and_a_bit.export(tmp_path / "hop.mat"), squeeze_me=True)
        for name in ("t", "q", "v", "a", "u", "tau", "friction", "cycle"):
            np.testing.assert_array_equal(data[name], getattr(hop_and_a_bit, name))
        np.testing.assert_array_equal(data["force"], hop_and_a_bit.force[:, 0])
        np.testing.assert_array_equal(data["spring"], hop_and_a_bit.spring[:, 0])
        assert data["domain"].tolist() == hop_and_a_bit.domain.tolist()
        assert data["phase"].tolist() == hop_and_a_bit.phase.tolist()
        assert [name.strip() for name in data["coordinates"]] == list(hop_and_a_bit.coordinates)
        assert [name.strip() for name in data["events"]["name"].item()] == [e.name for e in hop_and_a_bit.events]
        np.testing.assert_array_equal(data["events"]["time"].item(), [e.time for e in hop_and_a_bit.events])
        np.testing.assert_array_equal(data["ledger"]["impact"].item(), hop_and_a_bit.ledger["impact"])

    @pytest.mark.parametrize("name", ["hop", "hop.txt", "hop.csv.gz"])
    def test_another_suffix(self, tmp_path, hop_and_a_bit, name):
        with pytest.raises(BadValue, match=r"ending in \.csv or \.mat"):
            hop_and_a_bit.export(tmp_path / name)
        assert not list(tmp_path.iterdir())

    def test_columns_cover_every_number(self, hop_and_a_bit):
        names, table = hop_and_a_bit.columns()
        assert len(names) == len(set(names)) == table.shape[1]
        assert len(table) == len(hop_and_a_bit.t)


class TestHalfWritten:
    @pytest.mark.parametrize("name", ["hop.npz", "hop.csv", "hop.mat"])
    @pytest.mark.parametrize("problem", [OSError(28, "No space left on device"), KeyboardInterrupt()])
    def test_the_old_file_stays_whole(self, tmp_path, hop_and_a_bit, monkeypatch, name, problem):
        path = tmp_path / name
        path.write_text("old")

        def fail(file, *args, **kwargs):
            file.write(b"half of it")
            raise problem

        monkeypatch.setattr(np, "savez_compressed", fail)
        monkeypatch.setattr("scipy.io.savemat", fail)
        monkeypatch.setattr("pandas.DataFrame.to_csv", lambda table, file, **kwargs: fail(file))
        with pytest.raises(KeyboardInterrupt if isinstance(problem, KeyboardInterrupt) else BadFile):
            hop_and_a_bit.save(path) if name.endswith(".npz") else hop_and_a_bit.export(path)
        assert path.read_text() == "old"
        assert [file.name for file in tmp_path.iterdir()] == [name]


class TestLookUp:
    def test_named(self, hop_and_a_bit):
        assert [event.name for event in hop_and_a_bit.named("touchdown")] == ["touchdown"] * 3
        assert hop_and_a_bit.named("nothing") == ()

    def test_an_unknown_flow(self, hop_and_a_bit):
        with pytest.raises(UnknownName, match="unknown flow 'wind'; valid: motor_hip, motor_knee, damping"):
            hop_and_a_bit.ledger["wind"]

    def test_residual_is_the_change_less_all_flows(self):
        ledger = Ledger(("a", "b"), np.array([[1.0, 2.0], [3.0, -4.0]]), np.array([3.5, 0.0]))
        np.testing.assert_array_equal(ledger.residual, [0.5, 1.0])
        np.testing.assert_array_equal(ledger["b"], [2.0, -4.0])
