"""A log by itself: what it refuses, what it joins, and how it names what it has."""

import numpy as np
import pytest

from spear_pin.errors import BadValue, UnknownName
from spear_pin.studies.logs import Column, Log

T = np.linspace(0.0, 1.0, 101)


def log(begin=0.0, source="one", **changed):
    return Log(source, T, {"knee": np.sin(T + begin)}, **{"begin": begin, **changed})


class TestJoin:
    def test_in_the_order_of_their_times(self):
        whole = Log.join([log(5.0, "b"), log(3.0, "a")], "both")
        assert whole.source == "both" and whole.begin == 3.0 and len(whole.t) == 202
        np.testing.assert_array_equal(whole.t, [*T, *(T + 2.0)])
        np.testing.assert_allclose(whole["knee"], np.sin(whole.t + 3.0))

    def test_what_only_one_has_is_left_out(self):
        more = Log("more", T, {"knee": T, "hip": T}, modes=np.full(101, "stance"), begin=2.0, remarks=("a",))
        whole = Log.join([log(remarks=("a",)), more], "both")
        assert [*whole.values] == ["knee"] and whole.modes is None and whole.remarks == ("a",)

    def test_modes_and_what_is_synthetic(self):
        modes = np.full(101, "stance")
        whole = Log.join([log(modes=modes), log(2.0, modes=modes, synthetic=True)], "both")
        assert whole.synthetic and whole.modes.tolist() == ["stance"] * 202

    @pytest.mark.parametrize(
        ("parts", "said"),
        [
            ([], "a log at least"),
            ([log(), log(0.9, "other")], "other begins before one ends"),
            ([log(), log(2.0, at_motor=frozenset(["knee_torque"]))], "same torques at motors"),
        ],
    )
    def test_what_does_not_fit(self, parts, said):
        with pytest.raises(BadValue, match=said):
            Log.join(parts, "all")


@pytest.mark.parametrize(
    ("t", "values", "said"),
    [
        (T[::-1], {}, "increase"),
        ([0.0, 0.0], {}, "increase"),
        ([0.0, np.nan], {}, "increase"),
        ([0.0], {}, "two times"),
        (T, {"knee": T[:-1]}, r"values\['knee'\].*101 values"),
    ],
    ids=["back", "twice", "nan", "one", "short"],
)
def test_times_and_values_that_do_not_fit(t, values, said):
    with pytest.raises(BadValue, match=said):
        Log("by hand", np.array(t), values)


def test_a_quantity_that_is_not_there():
    assert repr(log(synthetic=True)) == "Log('one': synthetic, 101 samples in 1 s; knee)"
    with pytest.raises(UnknownName, match="quantity of the log one 'hip'; valid: knee"):
        log()["hip"]


@pytest.mark.parametrize(
    ("entries", "said"),
    [
        ({"sign": 2}, "sign is 2; expected 1 or -1"),
        ({"zero": np.inf}, "zero is inf; expected a finite number"),
        ({"lag": np.nan}, "lag is nan; expected a finite number, in s"),
        ({"at": "gear"}, "at is 'gear'; expected 'joint' or 'motor'"),
        ({"modes": {"up": "flight"}}, "modes is 'up'; expected numbers in the column"),
        ({"unit": 3}, "unit is 3; expected"),
    ],
    ids=str,
)
def test_columns_that_are_none(entries, said):
    with pytest.raises(BadValue, match=said):
        Column("a", **entries)
