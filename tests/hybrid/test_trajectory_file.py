"""Saved trajectories that were altered: each is refused in a line that names what is wrong with it."""

import json
import tracemalloc
import zipfile
from io import BytesIO

import numpy as np
import pytest
from numpy.lib import format as npy

from spear_pin import Trajectory, simulate
from spear_pin.errors import BadFile
from spear_pin.hybrid.reasons import REASONS
from spear_pin.hybrid.trajectory_file import ARRAYS, CURRENTS, ELECTRICAL


@pytest.fixture(scope="module")
def whole(hop, tmp_path_factory):
    """The arrays of a saved hop, by name."""
    path = simulate(hop.system, hop.state, rtol=1e-6).save(tmp_path_factory.mktemp("whole") / "hop.npz")
    with np.load(path) as data:
        return {name: data[name] for name in data.files}


@pytest.fixture
def refusal(whole, tmp_path):
    """Saves the hop with other arrays, None for one that is left out, and returns how `load` refuses it."""

    def refuse(**changes):
        path = tmp_path / "hop.npz"
        np.savez(path, **{name: array for name, array in (whole | changes).items() if array is not None})
        with pytest.raises(BadFile, match=r"hop\.npz: is not a saved trajectory") as error:
            Trajectory.load(path)
        text = str(error.value)
        assert "\n" not in text and len(text) < 600
        return text

    return refuse


NUMBERS = [name for name, (kind, *_) in ARRAYS.items() if kind == "f" and name not in CURRENTS]


@pytest.mark.parametrize("name", [name for name in ARRAYS if name not in CURRENTS])
def test_missing(refusal, name):
    assert f"no array '{name}'" in refusal(**{name: None})


@pytest.mark.parametrize("name", ARRAYS)
class TestEveryArray:
    def test_of_another_shape(self, refusal, whole, name):
        array = whole[name]
        others = [array[None], array[..., None], np.zeros((), array.dtype), *(array[:0] for _ in range(len(array) > 0))]
        for axis in range(array.ndim):
            others += [np.repeat(array, 2, axis), np.concatenate([array, array.take([], axis)], axis)[..., None]]
            if array.shape[axis] > 1:
                others.append(array.take(range(array.shape[axis] - 1), axis))
        for other in others:
            if other.shape != array.shape:
                assert "has the shape" in (text := refusal(**{name: other}))
                assert name in text or name == "t"  # all others disagree with that one

    def test_of_another_kind(self, refusal, whole, name):
        array = whole[name]
        for kind in (complex, "S5", np.float32, np.int16, "datetime64[s]", "U4", bool, np.uint64):
            if np.dtype(kind).kind != array.dtype.kind or np.dtype(kind).kind == "f":
                assert f"{name} is of type" in refusal(**{name: np.zeros(array.shape, kind)})

    def test_of_objects(self, refusal, whole, name):
        assert f"{name} is of type object" in refusal(**{name: whole[name].astype(object)})


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("name", NUMBERS)
def test_numbers_are_finite(refusal, whole, name, value):
    altered = whole[name].copy()
    altered.flat[altered.size // 2] = value
    assert f"{name} is not finite everywhere" in refusal(**{name: altered})


@pytest.mark.parametrize("name", ["t", "cycle", "event_time"])
def test_what_runs_backward(refusal, whole, name):
    altered = whole[name].copy()
    altered[-1] = altered[0] - 1
    assert f"{name} runs backward" in refusal(**{name: altered})


def test_cycles_below_zero(refusal, whole):
    assert "cycle begins below 0" in refusal(cycle=whole["cycle"] - 2)


@pytest.mark.parametrize("name", ["domain", "phase"])
def test_a_sample_without_name(refusal, whole, name):
    altered = whole[name].copy()
    altered[3] = ""
    assert f"{name} has an empty name" in refusal(**{name: altered})


@pytest.mark.parametrize("name", ["colour", "electrical_work"])
def test_an_unknown_array(refusal, name):
    assert f"unknown array '{name}'" in refusal(**{name: np.zeros(3)})


class TestMeta:
    @pytest.fixture
    def refused(self, refusal, whole):
        """How a change of the meta data is refused."""

        def refuse(text=None, **changes):
            meta = json.loads(str(whole["meta"])) | changes
            return refusal(meta=np.array(json.dumps(meta) if text is None else text))

        return refuse

    @pytest.mark.parametrize(
        ("text", "part"),
        [
            ("[" * 200_000, "nested too deep"),
            ('{"a":' * 100_000, "nested too deep"),
            ("3", "no JSON object"),
            ("", "Expecting value"),
            ('{"cycles": 1, "cycles": 2}', "'cycles' is there twice"),
            ('{"cycles": NaN}', "NaN is no finite number"),
            ('{"cycles": 1e999}', "1e999 is no finite number"),
            (f'{{"cycles": {"9" * 5000}}}', "is no finite number"),
        ],
        ids=lambda value: value[:12],
    )
    def test_its_text(self, refused, text, part):
        assert part in refused(text)

    @pytest.mark.parametrize("name", ["coordinates", "actuated", "toes", "spring_joints", "flows", "drives"])
    @pytest.mark.parametrize("value", [None, "knee", 3, {"knee": 1}, ["knee", "knee"], [1], [""], [["knee"]], [None]])
    def test_names(self, refused, name, value):
        assert name in refused(**{name: value})

    @pytest.mark.parametrize("coordinates", [[], ["boom_z", "knee"], ["boom_x", "boom_z", "hip", "knee"]])
    def test_of_other_coordinates(self, refused, coordinates):
        refused(coordinates=coordinates)

    @pytest.mark.parametrize("name", ["actuated", "spring_joints"])
    def test_joints_are_coordinates(self, refused, name):
        assert f"{name} is ['elbow']; expected some of boom_z, hip, knee" in refused(**{name: ["elbow"]})

    @pytest.mark.parametrize("name", ["cycles", "evaluations"])
    @pytest.mark.parametrize("value", [None, "1", -1, 1.5, 1.0, True, [1]])
    def test_counts(self, refused, name, value):
        assert f"{name} is {value!r}; expected a whole number >= 0" in refused(**{name: value})

    def test_cycles_are_those_of_the_ledger(self, refused):
        assert "ledger_work has the shape (1, " in refused(cycles=2)

    @pytest.mark.parametrize("name", ["robot", "reason", "message"])
    @pytest.mark.parametrize("value", [None, 3, "", ["complete"], {}])
    def test_texts(self, refused, name, value):
        assert f"{name} is {value!r}; expected" in refused(**{name: value})

    @pytest.mark.parametrize("value", [3, "spear_ii", [], {}, {"source": "spear_ii"}])
    def test_origin(self, refused, value):
        assert "origin" in refused(origin=value)

    def test_origin_of_another_robot(self, refused, whole):
        origin = json.loads(str(whole["meta"]))["origin"] | {"source": "q_spear"}
        assert "robot is 'spear_ii'; expected 'q_spear', the source of its origin" in refused(origin=origin)

    def test_an_unknown_reason(self, refused):
        assert f"reason is 'bored'; expected one of {', '.join(REASONS)}" in refused(reason="bored")

    @pytest.mark.parametrize("name", ["format", "units"])
    def test_format_and_units(self, refused, name):
        assert f"{name} is 'feet'; expected" in refused(**{name: "feet"})

    @pytest.mark.parametrize(
        "event",
        [
            None,
            "touchdown",
            {},
            {"name": "apex", "domain": "flight"},
            {"name": "apex", "domain": "flight", "work": None},
            {"name": "apex", "domain": "flight", "work": {"impact": "1"}},
            {"name": "apex", "domain": "flight", "work": {"impact": True}},
            {"name": 3, "domain": "flight", "work": {}},
            {"name": "apex", "domain": None, "work": {}},
            {"name": "apex", "domain": "flight", "work": {}, "colour": "red"},
        ],
        ids=str,
    )
    def test_events(self, refused, whole, event):
        events = json.loads(str(whole["meta"]))["events"]
        assert "an event is" in refused(events=[*events[:-1], event])

    @pytest.mark.parametrize("events", [None, {}, "apex"])
    def test_events_are_a_list(self, refused, events):
        refused(events=events)


class TestWhatAFileHolds:
    """An archive is not taken at its word."""

    @staticmethod
    def header(shape, kind="<f8"):
        buffer = BytesIO()
        npy.write_array_header_1_0(buffer, {"descr": kind, "fortran_order": False, "shape": shape})
        return buffer.getvalue()

    def load(self, path, **members):
        """Load a file of these members; what is refused takes no memory."""
        with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in members.items():
                archive.writestr(f"{name}.npy", data)
        tracemalloc.start()
        try:
            with pytest.raises(BadFile, match="is not a saved trajectory") as error:
                Trajectory.load(path)
            assert tracemalloc.get_traced_memory()[1] < 10_000_000
        finally:
            tracemalloc.stop()
        return str(error.value)

    def members(self, whole):
        return {name: self.header(array.shape, array.dtype.str) + array.tobytes() for name, array in whole.items()}

    @pytest.mark.parametrize("count", [10**12, 10**30, -1])
    def test_more_is_promised_than_there_is(self, whole, tmp_path, count):
        members = self.members(whole)
        text = self.load(tmp_path / "hop.npz", **members | {"q": self.header((count, 3)) + whole["q"].tobytes()})
        assert "q holds less or more than it says" in text

    def test_an_array_far_too_long(self, whole, tmp_path):
        members = self.members(whole)
        far = self.header((2_000_000,)) + bytes(16_000_000)
        assert "ledger_change has the shape" in self.load(tmp_path / "hop.npz", **members | {"ledger_change": far})

    @pytest.mark.parametrize("content", [b"", b"\x93NUMPY", b"\x93NUMPY\x01\x00\x02\x00{}", b"\x93NUMPY\x07\x00"])
    def test_no_arrays(self, whole, tmp_path, content):
        assert "v is no array" in self.load(tmp_path / "hop.npz", **self.members(whole) | {"v": content})

    def test_an_array_twice(self, whole, tmp_path):
        members = self.members(whole)
        with pytest.warns(UserWarning, match="Duplicate"), zipfile.ZipFile(tmp_path / "hop.npz", "w") as archive:
            for name in [*members, "q"]:
                archive.writestr(f"{name}.npy", members[name])
        with pytest.raises(BadFile, match="an array is there twice"):
            Trajectory.load(tmp_path / "hop.npz")


def test_of_another_machine(whole, tmp_path):
    """Bytes may be in another order."""
    path = tmp_path / "hop.npz"
    swapped = {name: array.astype(array.dtype.newbyteorder(">")) for name, array in whole.items()}
    np.savez(path, **swapped)
    again = Trajectory.load(path)
    for name in ("t", "q", "cycle", "domain"):
        np.testing.assert_array_equal(getattr(again, name), whole[name])
        assert getattr(again, name).dtype == whole[name].dtype


def test_every_array_is_named(whole):
    """What `save` writes is what `load` checks."""
    assert set(whole) == {*ARRAYS, "meta"} and not set(ELECTRICAL) & set(ARRAYS)
