"""Logs from files: the same motion comes back from many ways to write it, and every mistake is one line."""

import io
import re

import numpy as np
import pytest
from scipy.io import savemat

from spear_pin import hopping, load, simulate
from spear_pin.errors import BadValue, SpearError
from spear_pin.studies.logs import Column, Log
from spear_pin.studies.tables.readings import GAP

T = np.arange(0.0, 0.5, 0.002)
KNEE = 0.6 + 0.4 * np.sin(9.0 * T)
TORQUE = 5.0 * np.cos(9.0 * T)
DEGREES = np.degrees(KNEE)


def text(names, *columns, below=(), above=()):
    """A table with a row of names, and perhaps others above or below it."""
    rows = zip(*([*map(repr, np.asarray(column).tolist())] for column in columns), strict=True)
    heads = [*above, names, *below]
    return "\n".join([*heads, *(",".join(row).replace("'", "") for row in rows)]) + "\n"


@pytest.fixture
def put(tmp_path):
    """Writes a file into a folder of its own, and returns its path."""

    def write(content, name="hop.csv", toml=None):
        path = tmp_path / name
        path.parent.mkdir(exist_ok=True)
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        if toml is not None:
            path.with_suffix(".toml").write_text(toml)
        return path

    return write


def same(log, exact=1e-14, **others):
    """Checks a log against the motion."""
    np.testing.assert_allclose(log.t, T, rtol=0, atol=1e-12)
    for name, values in {"knee": KNEE, "knee_torque": TORQUE, **others}.items():
        np.testing.assert_allclose(log[name], values, rtol=exact, atol=exact)


class TestUnits:
    @pytest.mark.parametrize(
        ("names", "sizes"),
        [
            ("time_ms,knee_deg,knee_torque_mNm", (1e3, 180 / np.pi, 1e3)),
            ("t [us],knee [°],knee_torque [N m]", (1e6, 180 / np.pi, 1)),
            ("time (s),knee (mrad),knee_torque (N·m)", (1, 1e3, 1)),
            ("timestamp,knee_turns,knee_torque [mN*m]", (1, 0.5 / np.pi, 1e3)),
        ],
    )
    def test_by_names(self, put, names, sizes):
        values = [size * each for size, each in zip(sizes, (T, KNEE, TORQUE), strict=True)]
        log = Log.read(put(text(names, *values)))
        same(log)
        assert log.remarks == () and not log.synthetic and log.modes is None

    def test_by_a_row_below(self, put):
        same(Log.read(put(text("time,knee,knee_torque", 1e3 * T, DEGREES, 1e3 * TORQUE, below=["ms,deg,mN.m"]))))

    def test_by_units(self, put):
        path = put(text("a,b,c", 1e3 * T, DEGREES, 1e3 * TORQUE))
        columns = {"time": "a", "knee": "b", "knee_torque": "c"}
        same(Log.read(path, columns, {"a": "ms", "b": "degrees", "c": "mNm"}))
        same(
            Log.read(
                path,
                {"time": Column("a", "ms"), "knee": {"column": "b", "unit": "deg"}, "knee_torque": Column("c", "mNm")},
            )
        )

    @pytest.mark.parametrize("beside", ["hop.toml", "log.toml", "leg.toml"])
    def test_by_toml(self, put, beside):
        path = put(text("a,b,c", 1e3 * T, DEGREES, 1e3 * TORQUE))
        rows = ['time = { column = "a", unit = "ms" }', 'knee = { column = "b", unit = "deg" }']
        path.with_name(beside).write_text(
            "\n".join(["[columns]", *rows, 'knee_torque = { column = "c", unit = "mNm" }'])
        )
        map = path.with_name(beside) if beside == "leg.toml" else None  # a file of another name has to be named
        same(Log.read(path, map=map))
        assert [*Log.read(path, {"knee": "b", "time": "a"}).values] == ["knee"]  # what is said goes first
        with pytest.raises(BadValue, match="nothing where `columns` is given"):
            Log.read(path, {"knee": "b"}, map=path.with_name(beside))

    @pytest.mark.parametrize(
        ("name", "size"),
        [
            *(("knee_rate [deg/s]", 180 / np.pi), ("knee_rate_rad_s", 1), ("knee_rate_rpm", 30 / np.pi)),
            *(
                ("knee_rate [dps]", 180 / np.pi),
                ("slide_mm", 1e3),
                ("slide_rate [mm/s]", 1e3),
                ("toe_force [kN]", 1e-3),
            ),
        ],
    )
    def test_of_rates_lengths_and_forces(self, put, name, size):
        log = Log.read(put(text(f"time_s,{name}", T, size * KNEE)))
        (found,) = log.values.values()
        np.testing.assert_allclose(found, KNEE, rtol=1e-14)
        assert log.remarks == ()

    def test_without_any(self, put):
        log = Log.read(put(text("time,knee,knee_torque", T, KNEE, TORQUE)))
        same(log)
        assert log.remarks == (
            "hop.csv: no unit is named, so SI units and radians are taken, of 'knee', 'knee_torque'",
        )


class TestEntries:
    def test_sign_and_zero_in_the_columns_own_unit(self, put):
        path = put(text("time,knee_deg,knee_torque", T, 30.0 - DEGREES, -TORQUE))
        torque = Column("knee_torque", sign=-1)
        same(Log.read(path, {"knee": Column("knee_deg", sign=-1, zero=30.0), "knee_torque": torque}), 1e-13)

    def test_lag(self, put):
        late = np.interp(T - 0.004, T, KNEE)
        log = Log.read(put(text("time,knee,knee_torque", T, late, TORQUE)), {"knee": Column("knee", lag=0.004)})
        assert np.isnan(log["knee"][-2:]).all()
        np.testing.assert_allclose(log["knee"][2:-3], KNEE[2:-3], rtol=1e-9)

    def test_a_torque_of_a_motor(self, put):
        path = put(text("time,knee,tau", T, KNEE, TORQUE))
        log = Log.read(path, {"knee": "knee", "knee_torque": Column("tau", at="motor")})
        same(log)
        assert log.at_motor == {"knee_torque"}

    def test_modes(self, put):
        mode = np.where(T < 0.2, 1, np.where(T < 0.4, 2, 7))
        path = put(text("time,knee,state", T, KNEE, mode))
        log = Log.read(path, {"knee": "knee", "mode": Column("state", modes={"1": "stance", "2": "flight"})})
        assert log.modes.tolist() == np.where(T < 0.2, "stance", np.where(T < 0.4, "flight", "7")).tolist()
        assert [*log.values] == ["knee"] and len(log.remarks) == 1

    def test_a_second_sensor_with_its_own_clock_and_lag(self, put):
        own = np.arange(-0.01, 0.51, 0.0007)
        put(text("t_ms,f_N", 1e3 * (own + 0.006), 50.0 + own), "plate.csv")
        force = Column("f_N", file="plate.csv", lag=0.006)
        log = Log.read(
            put(text("time,knee,knee_torque", T, KNEE, TORQUE)),
            {**{name: name for name in ("knee", "knee_torque")}, "toe_force": force},
        )
        same(log, 1e-12, toe_force=50.0 + T)

    def test_a_hole_of_a_second_sensor_stays_one(self, put):
        own = np.concatenate([np.arange(0.0, 0.2, 0.001), np.arange(0.25, 0.5, 0.001)])
        put(text("t,f", own, own), "plate.csv")
        path = put(text("time,knee", T, KNEE))
        force = Log.read(path, {"knee": "knee", "toe_force": Column("f", file="plate.csv")})["toe_force"]
        hole = (T > 0.2) & (T < 0.25)
        assert np.isnan(force[hole]).all() and np.isfinite(force[T < 0.199]).all()

    def test_an_angle_of_a_second_sensor_goes_on_where_it_wraps(self, put):
        put(text("time,angle_deg", T, (40.0 * T * 180 / np.pi) % 360.0), "encoder.csv")
        log = Log.read(put(text("time,hip", T, KNEE)), {"hip": "hip", "knee": Column("angle_deg", file="encoder.csv")})
        np.testing.assert_allclose(np.diff(log["knee"]), 40.0 * np.diff(T), rtol=1e-9)
        assert any("'angle_deg': the angle jumps by a turn" in remark for remark in log.remarks)


class TestTimes:
    def test_unix_ns(self, put):
        stamps = [1717444672123456789 + round(1e9 * time) for time in T]
        log = Log.read(put(text("stamp,knee", stamps, KNEE)))
        np.testing.assert_allclose(log.t, T, atol=5e-7)
        assert log.begin == pytest.approx(1717444672.123456789)
        assert "taken as ns" in log.remarks[0]

    def test_irregular_times_and_gaps(self, put):
        times = T + 0.0005 * np.sin(70.0 * T)
        times[100:] += 0.1
        log = Log.read(put(text("time_s,knee", times, KNEE)))
        np.testing.assert_array_equal(log.t, times)
        assert any("1 gaps between samples, the longest 0.102 s" in remark for remark in log.remarks) and GAP < 50

    def test_repeated_times_and_rows_without_numbers(self, put):
        times, knee = T.copy(), KNEE.copy()
        times[50], times[70], knee[90] = times[49], np.nan, np.nan
        log = Log.read(put(text("time_s,knee_rad", times, knee)))
        kept = np.delete(np.arange(len(T)), [50, 70])
        np.testing.assert_array_equal(log.t, T[kept])
        np.testing.assert_array_equal(log["knee"], knee[kept])
        for part in (
            "1 of 250 rows without a time",
            "1 rows that repeat a time",
            "'knee_rad' holds no number in 1 of 248",
        ):
            assert any(part in remark for remark in log.remarks)


class TestWraps:
    TURNING = 40.0 * T

    @pytest.mark.parametrize("lost", [[], [3, 100, 101]], ids=["whole", "with holes"])
    def test_an_encoder_that_wraps(self, put, lost):
        shown = np.degrees(self.TURNING) % 360.0
        shown[lost] = np.nan
        log = Log.read(put(text("time_s,knee_deg", T, shown)))
        away = log["knee"] - self.TURNING
        assert np.flatnonzero(np.isnan(away)).tolist() == lost
        np.testing.assert_allclose(away[np.isfinite(away)], away[0], atol=1e-12)
        assert away[0] / (2 * np.pi) == pytest.approx(round(away[0] / (2 * np.pi)), abs=1e-12)

    def test_a_torque_that_jumps_by_as_much_is_none(self, put):
        torque = np.where(T < 0.2, 0.0, 2 * np.pi)
        for names in ("time_s,knee_torque", "time_s,knee_torque_Nm"):
            log = Log.read(put(text(names, T, torque)))
            np.testing.assert_array_equal(log["knee_torque"], torque)
            assert not any("jumps" in remark for remark in log.remarks)


class TestFiles:
    def test_mat_and_npz(self, put):
        columns = {"time": T, "knee": KNEE, "knee_torque": TORQUE}
        for name, save in (("hop.mat", savemat), ("hop.npz", lambda file, each: np.savez(file, **each))):
            file = io.BytesIO()
            save(file, {**columns, "knee_torque": TORQUE[:, None], "note": np.eye(3)})
            same(Log.read(put(file.getvalue(), name)))

    def test_a_saved_trajectory_is_the_log_that_its_table_is(self, tmp_path):
        leg = hopping(load("spear_ii", locked=["boom_x"]))
        run = simulate(leg, leg.guess(), 1, progress=False)
        log, table = (Log.read(each) for each in (run.save(tmp_path / "a.npz"), run.export(tmp_path / "a.csv")))
        np.testing.assert_array_equal(log.t, table.t)
        assert [*log.values] == [*table.values] and {"hip", "knee_rate", "knee_torque"} <= {*log.values}
        for name, values in table.values.items():
            np.testing.assert_array_equal(log[name], values)
        with pytest.raises(SpearError, match="a.mat: it is a trajectory, not columns; `spear export hop.npz --csv`"):
            Log.read(run.export(tmp_path / "a.mat"))

    def test_a_last_line_that_is_cut_off_is_left_out(self, put):
        whole = text("time_s,knee_rad,tau", T, KNEE, TORQUE)
        last = whole.rindex("\n", 0, -1) + 1
        for kept in range(2, 12):  # in its time, which then would go back, or behind it
            log = Log.read(put(whole[: last + kept]))
            assert len(log.t) == len(T) - 1 and "it may be cut off" in log.remarks[0]
        ended = put(text("time_s,knee_rad,tau", T, np.where(T < T[-1], KNEE, np.nan), TORQUE))
        assert len(Log.read(ended).t) == len(T)

    def test_what_a_csv_in_other_units_says_reads_back_exactly(self, put):
        """Numbers of 17 digits lose nothing, and units are one multiplication."""
        log = Log.read(put(text("time_ms,knee_deg,knee_torque_mNm", 1e3 * T, DEGREES, 1e3 * TORQUE)))
        np.testing.assert_array_equal(log["knee"], DEGREES * (np.pi / 180.0))
        np.testing.assert_array_equal(log["knee_torque"], (1e3 * TORQUE) * 1e-3)
        np.testing.assert_array_equal(log.t, (1e3 * T) * 1e-3)

    def test_columns_that_are_not_read_are_told(self, put):
        path = put(text("time_s,knee_rad,current_mV,wheel_rad_s", T, KNEE, T, T))
        log = Log.read(path)
        assert [*log.values] == ["knee"]
        assert log.remarks == ("hop.csv: columns that are not read: 'current_mV', 'wheel_rad_s'",)
        assert Log.read(path, {"knee": "knee_rad"}).remarks == log.remarks

    def test_a_table_of_this_package(self, put):
        names = "t [s],domain,phase,cycle,q_knee [rad],v_knee [rad/s],a_knee [rad/s²],u_knee [N·m],tau_knee [N·m]"
        zeros = 0.0 * T
        log = Log.read(put(text(names, T, zeros, zeros, zeros, KNEE, 2.0 * KNEE, T, TORQUE, T)))
        same(log, knee_rate=2.0 * KNEE)
        assert {*log.values} == {"knee", "knee_rate", "knee_torque"}

    def test_synthetic(self, put):
        assert Log.read(put(text("time_s,knee_rad", T, KNEE, above=["# SYNTHETIC, by hand"]))).synthetic

    def test_a_folder_of_files_that_follow_one_another(self, put):
        put(text("time_s,knee_rad", T + 1.0, KNEE), "run/b.csv")
        put(text("time_s,knee_rad", T, KNEE), "run/a.csv")
        put(text("time_s,f_N", [*T, *(T + 1.0)], [*T, *T]), "run/plate.csv")
        folder = put(
            '[columns]\nknee = "knee_rad"\ntoe_force = { column = "f_N", file = "plate.csv" }', "run/log.toml"
        ).parent
        log = Log.read(folder)
        np.testing.assert_allclose(log.t, [*T, *(T + 1.0)])
        np.testing.assert_array_equal(log["knee"], [*KNEE, *KNEE])
        np.testing.assert_allclose(log["toe_force"], [*T, *T], atol=1e-12)

    def test_a_folder_of_files_that_overlap(self, put):
        put(text("time_s,knee_rad", T, KNEE), "run/a.csv")
        folder = put(text("time_s,knee_rad", T, KNEE), "run/b.csv").parent
        with pytest.raises(
            SpearError, match=r"run: expected logs of one clock.*b.csv begins before .*a.csv ends; or give"
        ):
            Log.read(folder)


GOOD = text("time_s,knee_rad,tau", T, KNEE, TORQUE)
NPZ = io.BytesIO()
np.savez(NPZ, time=T, knee=np.array([object()] * len(T)))
SHORT = io.BytesIO()
np.savez(SHORT, time=T, knee=KNEE[:-1])
MISTAKES = {
    "column": (
        GOOD,
        {"knee": "knee"},
        None,
        "unknown column for 'knee' in .*hop.csv: 'knee'; valid: time_s, knee_rad, tau",
    ),
    "time": (GOOD, {"time": "t", "knee": "knee_rad"}, None, "unknown column for 'time' in .*: 't'; valid: time_s"),
    "unit": (
        GOOD,
        {"knee": Column("knee_rad", "furlong")},
        None,
        "unit of 'knee', column 'knee_rad' of .*: 'furlong'; valid: rad",
    ),
    "unit of another kind": (GOOD, {"knee": Column("tau", "Nm")}, None, "unit of 'knee', .*'Nm'; valid: rad, mrad"),
    "named unit of another kind": (GOOD, {"knee_torque": "knee_rad"}, None, "unit of 'knee_torque'.*'rad'; valid: N·m"),
    "unit without columns": (GOOD, None, {"knee_rad": "furlong"}, "unit of 'knee', .*'furlong'; valid: rad, mrad"),
    "units": (GOOD, {"knee": "knee_rad"}, {"hip": "deg"}, "unknown column in units, of .*: 'hip'; valid: time_s"),
    "sign": (GOOD, {"knee": {"column": "knee_rad", "sign": 2}}, None, "columns.knee.sign is 2; expected 1 or -1"),
    "sign of text": (GOOD, {"knee": {"column": "knee_rad", "sign": "-"}}, None, "columns.knee.sign is '-'; expected"),
    "lag": (
        GOOD,
        {"knee": {"column": "knee_rad", "lag": np.nan}},
        None,
        "columns.knee.lag is nan; expected a finite number",
    ),
    "entry": (
        GOOD,
        {"knee": {"column": "knee_rad", "offset": 1}},
        None,
        "unknown entry of columns.knee 'offset'; valid: column, unit, sign",
    ),
    "entry of time": (
        GOOD,
        {"time": {"column": "time_s", "lag": 1}},
        None,
        "entry of columns.time 'lag'; valid: column, unit",
    ),
    "motor of an angle": (
        GOOD,
        {"knee": {"column": "knee_rad", "at": "motor"}},
        None,
        "entry of columns.knee 'at'; valid",
    ),
    "number": (GOOD, {"knee": 3}, None, "columns.knee is 3; expected the name of a column"),
    "time only": (GOOD, {"time": "time_s"}, None, "no column is a joint's; it has time_s, knee_rad, tau"),
    "modes only": (GOOD, {"mode": "tau"}, None, "no column is a joint's"),
    "lag too long": (GOOD, {"knee": Column("knee_rad", lag=9.0)}, None, "'knee_rad' has no sample at times of .*`lag`"),
    "other file": (GOOD, {"knee": "knee_rad", "toe_force": Column("f", file="no.csv")}, None, "no.csv"),
    "only time": ("time_s\n" + "\n".join(map(str, T)), None, None, "no column is a joint's"),
    "no time": (text("a,b", T, T), None, None, "which column is the time[?] It has a, b; name one as `time`"),
    "twice": (
        text("time_s,knee_deg,knee_rad", T, T, T),
        None,
        None,
        "'knee_deg' and 'knee_rad' both name 'knee'; say which",
    ),
    "few": (text("time_s,knee", T[:9], T[:9]), None, None, "9 rows have a time of their own; expected at least 20"),
    "another clock": (
        text("time_s,knee", np.r_[T, 1.7e9], np.r_[T, 0]),
        None,
        None,
        "jumps by 1.7e[+]09 s after row 250; expected one clock",
    ),
    "nan": (
        text("time_s,knee,hip", T, T * np.nan, T),
        {"knee": "knee"},
        None,
        "column 'knee' holds no number; name another",
    ),
    "words": (text("time_s,knee", T, ["up"] * len(T)), {"knee": "knee"}, None, "holds no number, but 'up' in row 1"),
    "modes of words": (
        text("time_s,knee,m", T, T, ["up"] * len(T)),
        {"knee": "knee", "mode": "m"},
        None,
        "holds 'up' in row 1: write a number",
    ),
}


@pytest.mark.parametrize(("content", "columns", "units", "said"), MISTAKES.values(), ids=MISTAKES)
def test_mistakes(put, content, columns, units, said):
    with pytest.raises(SpearError) as error:
        Log.read(put(content), columns, units)
    assert re.search(said, str(error.value)), str(error.value)


@pytest.mark.parametrize(
    ("toml", "said"),
    [
        ("[columns", "hop.toml: not a TOML file"),
        ("", "hop.toml: it has nothing; expected one table, \\[columns\\]"),
        ("[columns]\n[unit]\n", "it has columns, unit; expected one table"),
        ("[columns]\nknee = 3", "hop.toml: columns.knee is 3"),
        ('[columns]\nknee = { column = "a", unit = 3 }', "hop.toml: columns.knee.unit is 3; expected"),
        ('[columns]\nknee = { column = "a", modes = { up = "b" } }', "entry of columns.knee 'modes'"),
        ('[columns]\nmode = { column = "a", modes = { up = "b" } }', "columns.mode.modes is 'up'; expected numbers"),
    ],
)
def test_mistakes_in_the_toml(put, toml, said):
    with pytest.raises(SpearError, match=said):
        Log.read(put(GOOD, toml=toml))


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        (
            "hop.npz",
            NPZ.getvalue(),
            "not an .npz file that can be read: array 'knee' holds Python objects; expected columns",
        ),
        ("hop.npz", SHORT.getvalue(), "columns of equal length: time has 250, knee has 249"),
        ("hop.npz", b"PK", "not an .npz file"),
        ("run/log.toml", b"[columns]", "there is no log in this folder; expected files that end in .csv"),
    ],
)
def test_damaged_files(put, name, content, said):
    path = put(content, name)
    with pytest.raises(SpearError, match=said):
        Log.read(path.parent if path.suffix == ".toml" else path)
