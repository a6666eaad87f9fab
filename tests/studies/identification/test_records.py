"""Units, calibrations, choice of columns, and .mat files."""

import struct

import numpy as np
import pytest
from scipy.io import savemat
from scipy.sparse import csc_matrix

from spear_pin.errors import BadFile, BadValue, SpearError, UnknownName
from spear_pin.studies.identification import Calibration, Record, read_record
from tests.studies.identification.files import ANGLE, T, changed, table, written

POTENTIOMETER = Calibration(volts_per_rad=-1.25, offset=4.0)
VOLTS = -1.25 * ANGLE + 4.0
HEAD_7_3 = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(124) + struct.pack("<H", 0x0200) + b"IM"


def columns(folder, head, t, value):
    """A file of two columns."""
    rows = [f"{a:.9g},{b:.9g}" for a, b in zip(t, value, strict=True)]
    return written(folder, "\n".join([head, *rows, ""]))


def agrees(record):
    np.testing.assert_allclose(record.t, T, rtol=0, atol=1e-9)
    np.testing.assert_allclose(record.angle, ANGLE, rtol=0, atol=1e-7)
    return True


class TestUnits:
    @pytest.mark.parametrize(
        "time",
        [
            *("t", "time", "Time", "time_s", "time [s]", "t(s)", "TIME (sec)", "Zeit/s", "timestamp", "Time (Seconds)"),
            *("time_secs", "timeSec", "Time stamp", "header.stamp [s]", "seconds", "elapsed time (s)", "t （s）"),
        ],
    )
    @pytest.mark.parametrize("knee", ["knee_rad", "angle [radians]", "knee (rad)", "knee rad", "θ/rad", "kneeRad"])
    def test_si(self, tmp_path, time, knee):
        record = read_record(columns(tmp_path, f"{time},{knee}", T, ANGLE))
        assert agrees(record) and record.remarks == () and not record.synthetic

    @pytest.mark.parametrize(
        ("head", "factor"),
        [
            *(
                ("time_ms", 1e3),
                ("Time (milliseconds)", 1e3),
                ("t_msec", 1e3),
                ("t/min", 1 / 60),
                ("time [Minutes]", 1 / 60),
            ),
            *(
                ("time [us]", 1e6),
                ("t (\u00b5s)", 1e6),
                ("t (\u03bcs)", 1e6),
                ("t usec", 1e6),
                ("time_microseconds", 1e6),
            ),
            *(
                ("time_ns", 1e9),
                ("stamp.nanosec", 1e9),
                ("time (Nanoseconds)", 1e9),
                ("timeNs", 1e9),
            ),
        ],
    )
    def test_times(self, tmp_path, head, factor):
        assert agrees(read_record(columns(tmp_path, f"{head},knee_rad", T * factor, ANGLE)))

    @pytest.mark.parametrize(
        ("head", "factor"),
        [
            *((head, 180 / np.pi) for head in ("knee_deg", "knee [°]", "knee (degrees)", "knee (Deg)", "knee°")),
            *((head, 0.5 / np.pi) for head in ("knee [turns]", "knee_rev", "knee (revolutions)")),
            ("knee [mrad]", 1e3),
        ],
    )
    def test_angles(self, tmp_path, head, factor):
        assert agrees(read_record(columns(tmp_path, f"t,{head}", T, ANGLE * factor)))
        told = read_record(columns(tmp_path, f"t,{head}", T, ANGLE * factor), unit=head[4:].strip(" _[]()"))
        assert agrees(told)

    @pytest.mark.parametrize(
        ("head", "problem"),
        [
            (
                "t,knee [furlongs]",
                "unknown unit of 'knee', column 'knee .furlongs.' of .*record.csv: 'furlongs'; valid: rad, mrad, deg",
            ),
            ("t,knee (Nm)", "record.csv: 'Nm'; valid: rad"),
            ("t,knee [s]", "record.csv: 's'; valid: rad"),
            ("t [fortnights],knee_rad", "unit of 'time', .* 'fortnights'; valid: s, ms, us, ns, min, h"),
            ("t [deg],knee_rad", "record.csv: 'deg'; valid: s, ms"),
            ("t,knee [cycles]", "record.csv: 'cycles'; valid: rad"),
        ],
    )
    def test_words_in_brackets_that_are_no_units(self, tmp_path, head, problem):
        path = columns(tmp_path, head, T, ANGLE)
        with pytest.raises(UnknownName, match=problem):
            read_record(path)
        assert agrees(read_record(path, unit="rad", time_unit="s"))

    @pytest.mark.parametrize(
        "unit",
        [
            *(
                "rad/s",
                "rad_s",
                "rad_per_s",
                "deg/s",
                "°/s",
                "rpm",
                "turns/s",
                "rad / s",
                "deg/sec",
                "degrees per second",
            ),
            *(
                "RadPerSec",
                "dps",
                "rad s^-1",
                "rad·s⁻¹",
                "rad/s²",
                "rev/min",
                "U/min",
                "mrad_s",
                "deg_sec",
                "counts/s",
                "Hz",
            ),
        ],
    )
    @pytest.mark.parametrize("written", ["w [{}]", "w_{}", "w {}", "w ({})", "{}"])
    def test_rates_are_no_angles(self, tmp_path, unit, written):
        path = columns(tmp_path, f"time_s,{written.format(unit)}", T, ANGLE)
        with pytest.raises(UnknownName, match="unknown unit of 'knee', column .*record.csv: .*; valid: rad"):
            read_record(path)
        assert agrees(read_record(path, unit="rad"))

    @pytest.mark.parametrize(
        ("time", "knee", "factor"),
        [
            ("Zeit [Sekunden]", "Winkel [Grad]", 180 / np.pi),
            ("Zeit (Sek.)", "Winkel in Grad", 180 / np.pi),
            ("Time (sec.)", "Angle (deg.)", 180 / np.pi),
            ("time sec.", "knee_rad.", 1.0),
            ("Zeit/Sekunden", "Winkel [Umdrehungen]", 0.5 / np.pi),
        ],
    )
    def test_german_and_dots(self, tmp_path, time, knee, factor):
        record = read_record(columns(tmp_path, f"{time},{knee}", T, ANGLE * factor))
        assert agrees(record) and record.remarks == ()

    @pytest.mark.parametrize(("head", "factor"), [("knee_V", 1), ("pot [mV]", 1000), ("pot (volts)", 1), ("pot", 1)])
    def test_volts(self, tmp_path, head, factor):
        path = columns(tmp_path, f"t,{head}", T, VOLTS * factor)
        record = read_record(path, calibration=POTENTIOMETER)
        assert agrees(record)
        assert ["taken as V" in remark for remark in record.remarks] == [True] * (head == "pot")

    def test_given_units_win(self, tmp_path):
        path = columns(tmp_path, "time_s,knee_rad", T * 1e3, np.degrees(ANGLE))
        assert agrees(read_record(path, unit="deg", time_unit="ms"))

    def test_order_does_not_matter(self, tmp_path):
        assert agrees(read_record(columns(tmp_path, "knee_rad,time_s", ANGLE, T)))

    @pytest.mark.parametrize(
        ("head", "t", "value", "problem"),
        [
            ("time_s,knee_rad", T * 1e3, ANGLE, "samples are 1 s apart.*are the times in s"),
            ("time_ms,knee_rad", T, ANGLE, "samples are 1e-06 s apart: are the times in ms"),
            ("time_min,knee_rad", T, ANGLE, "samples are 0.06 s apart.*are the times in min"),
            ("time_s,knee_rad", T, np.degrees(ANGLE), "reaches 71.6[0-9]* rad at .* .is it in rad"),
            ("time_s,knee_rad", T, np.full(400, -7.0), "reaches 7 rad"),
            ("time_s,knee", T, np.degrees(ANGLE), "is it in rad"),
        ],
    )
    def test_wrong_units(self, tmp_path, head, t, value, problem):
        with pytest.raises(BadFile, match=problem):
            read_record(columns(tmp_path, head, t, value))

    def test_calibration_that_cannot_be(self, tmp_path):
        with pytest.raises(BadFile, match="is the calibration right"):
            read_record(columns(tmp_path, "t,knee_V", T, VOLTS), calibration=Calibration(0.01))

    def test_tiny_slope_does_not_overflow(self, tmp_path):
        with pytest.raises(BadFile, match="reaches inf rad"):
            read_record(columns(tmp_path, "t,knee_V", T, VOLTS), calibration=Calibration(1e-320))

    @pytest.mark.parametrize(("head", "calibration"), [("knee_V", None), ("knee_rad", POTENTIOMETER)])
    def test_calibration_missing_or_superfluous(self, tmp_path, head, calibration):
        path = columns(tmp_path, f"t,{head}", T, VOLTS)
        with pytest.raises(BadValue, match=f"record.csv: calibration of '{head}', in {head[5:]}, is") as caught:
            read_record(path, calibration=calibration)
        assert "\n" not in str(caught.value)

    @pytest.mark.parametrize("name", ["unit", "time_unit"])
    def test_unknown_unit(self, tmp_path, name):
        with pytest.raises(UnknownName, match="unknown unit of .*: 'furlong'; valid: "):
            read_record(written(tmp_path, table()), **{name: "furlong"})

    @pytest.mark.parametrize("slope", [0.0, float("nan"), float("inf")])
    def test_bad_calibration(self, slope):
        with pytest.raises(BadValue, match="volts_per_rad is "):
            Calibration(slope)
        with pytest.raises(BadValue, match="offset is "):
            Calibration(1.0, float("nan"))


class TestClocks:
    @pytest.mark.parametrize(
        ("name", "per_second"),
        [("time", 1), ("Time [ms]", 1000), ("stamp", 1000), ("timestamp_us", 10**6), ("%time", 10**9), ("__time", 1)],
    )
    def test_unix(self, tmp_path, name, per_second):
        if per_second >= 1000:
            rows = [str((1_700_000_000_000 + i) * (per_second // 1000)) for i in range(400)]
        else:
            rows = [f"{1_700_000_000 + i // 1000}.{i % 1000:03}" for i in range(400)]
        text = "\n".join([f"{name},knee_rad", *(f"{t},{a:.6f}" for t, a in zip(rows, ANGLE, strict=True)), ""])
        record = read_record(written(tmp_path, text))
        assert record.t[0] == 0.0
        np.testing.assert_allclose(record.t, T, rtol=0, atol=3e-7)
        told = [remark for remark in record.remarks if "names no unit: taken as" in remark]
        assert len(told) == (name in ("stamp", "%time"))

    def test_ros_from_zero(self, tmp_path):
        assert agrees(read_record(columns(tmp_path, "%time,field.position0_rad", T * 1e9, ANGLE)))

    def test_an_offset(self, tmp_path):
        assert agrees(read_record(columns(tmp_path, "t,knee_rad", T - 12.5, ANGLE)))


class TestWraps:
    @pytest.mark.parametrize(
        ("unit", "turn"), [("rad", 2 * np.pi), ("deg", 360.0), ("turns", 1.0), ("counts", 4096.0), ("V", 5.0)]
    )
    @pytest.mark.parametrize("cut", [1.1, 0.9])  # where the encoder wraps, of the angle
    def test_by_a_turn(self, tmp_path, unit, turn, cut):
        wrapped = np.mod(ANGLE - cut, 2 * np.pi) + cut - 2 * np.pi
        calibration = Calibration(turn / (2 * np.pi)) if unit in ("counts", "V") else None
        path = columns(tmp_path, f"t,knee [{unit}]", T, wrapped / (2 * np.pi) * turn)
        record = read_record(path, calibration=calibration)
        np.testing.assert_allclose(record.angle, ANGLE, rtol=0, atol=1e-5)
        first = int(np.flatnonzero(np.abs(np.diff(wrapped)) > 3)[0]) + 1
        assert f"the angle jumps by a turn after row {first}, and " in record.remarks[0] and len(record.remarks) == 1

    def test_beside_a_gap(self, tmp_path):
        wrapped = np.where(T > 0.2, ANGLE - 2 * np.pi, ANGLE)
        wrapped[195:210] = np.nan
        record = read_record(columns(tmp_path, "t,knee_rad", T, wrapped))
        np.testing.assert_allclose(record.angle, np.delete(ANGLE, slice(195, 210)), rtol=0, atol=1e-7)
        assert "after row 195: such jumps are taken out" in record.remarks[1]

    def test_a_jump_that_is_no_turn(self, tmp_path):
        record = read_record(columns(tmp_path, "t,knee_rad", T, np.where(T > 0.2, ANGLE + 3.0, ANGLE)))
        assert "the angle jumps by 3.0" in record.remarks[0] and "rad after row 201" in record.remarks[0]
        np.testing.assert_allclose(record.angle[300:], ANGLE[300:] + 3.0, rtol=0, atol=1e-7)


class TestChoice:
    TABLE = table("n,hip_rad,knee_deg,time_ms,note", row="3{s}0.1{s}57.3{s}{t}{s}x")

    def test_named(self, tmp_path):
        path = written(tmp_path, self.TABLE)
        record = read_record(path, column="knee_deg", time_unit="s")
        np.testing.assert_allclose(record.angle, np.radians(57.3), rtol=1e-15)
        np.testing.assert_allclose(record.t, T, rtol=0, atol=1e-12)
        other = read_record(path, column="hip_rad", time_column="time_ms", time_unit="s")
        np.testing.assert_allclose(other.angle, 0.1, rtol=1e-15)

    @pytest.mark.parametrize("name", ["column", "time_column"])
    def test_missing(self, tmp_path, name):
        path = written(tmp_path, self.TABLE)
        with pytest.raises(UnknownName, match="record.csv: 'ankle'; valid: n, hip_rad, knee_deg, time_ms, note"):
            read_record(path, **{name: "ankle"})

    def test_the_same(self, tmp_path):
        with pytest.raises(BadValue, match="column is 'time_ms'"):
            read_record(written(tmp_path, self.TABLE), column="time_ms", time_column="time_ms")

    def test_text_column(self, tmp_path):
        with pytest.raises(BadFile, match="column 'note' holds no number, but 'x' in row 1: write a number"):
            read_record(written(tmp_path, self.TABLE), column="note", time_unit="s")


class TestRemarks:
    def test_gap(self, tmp_path):
        record = read_record(columns(tmp_path, "t,a_rad", np.where(T > 0.2, T + 0.5, T), ANGLE))
        assert "1 gaps between samples, the longest 0.501 s" in record.remarks[0]

    @pytest.mark.parametrize(("comment", "synthetic"), [("# SYNTHETIC record", True), ("# not SYNTHETIC", False)])
    def test_synthetic(self, tmp_path, comment, synthetic):
        assert read_record(written(tmp_path, f"{comment}\n{table()}")).synthetic is synthetic

    def test_step(self):
        assert Record("x", np.array([0.0, 0.1, 0.2, 0.9]), np.zeros(4)).step == pytest.approx(0.1)

    def test_huge_times(self, tmp_path):
        text = changed(400, "1e308,1", changed(1, "-1.7e308,1"))
        record = read_record(written(tmp_path, text), time_unit="s")
        np.testing.assert_array_equal(record.t, T[1:-1] - T[1])
        assert "dropped 2 of 400 rows" in record.remarks[0]


class TestMat:
    @pytest.mark.parametrize("options", [{}, {"do_compression": True}, {"format": "4"}])
    @pytest.mark.parametrize("shapes", [((1, -1), (-1, 1)), ((-1, 1), (1, -1))])
    def test_vectors(self, tmp_path, shapes, options):
        self.assert_read(tmp_path, shapes, options)

    @pytest.mark.parametrize("options", [{}, {"do_compression": True}])  # format 4 holds matrices only
    def test_a_vector_in_three_dimensions(self, tmp_path, options):
        self.assert_read(tmp_path, ((1, 1, -1), (1, -1)), options)

    @staticmethod
    def assert_read(tmp_path, shapes, options):
        path = tmp_path / "record.mat"
        savemat(path, {"t_s": T.reshape(shapes[0]), "knee_rad": ANGLE.reshape(shapes[1])}, **options)
        assert agrees(read_record(path))

    def test_of_numpy(self, tmp_path):
        np.savez(path := tmp_path / "record.npz", t_s=T, knee_deg=np.degrees(ANGLE), note=np.eye(3))
        assert agrees(read_record(path))

    def test_among_others(self, tmp_path):
        path = tmp_path / "record.mat"
        others = {
            "s": {"t_s": T},
            "info": "a text",
            "rate": 1000.0,
            "m": np.eye(3),
            "c": np.array([T, "x"], dtype=object),
        }
        savemat(path, others | {"knee_V": VOLTS, "time_ms": np.arange(400, dtype=np.int16)})
        assert agrees(read_record(path, calibration=POTENTIOMETER))

    @pytest.mark.parametrize("kind", [np.uint8, np.int8, np.int32, np.uint64, np.float32])
    def test_integers(self, tmp_path, kind):
        path = tmp_path / "record.mat"
        savemat(path, {"time_ms": np.arange(100, dtype=kind), "knee_deg": np.full(100, 57, kind)})
        record = read_record(path)
        np.testing.assert_allclose(record.t, np.arange(100) / 1000, rtol=1e-15)
        np.testing.assert_allclose(record.angle, np.radians(57), rtol=1e-15)

    def test_nan(self, tmp_path):
        path = tmp_path / "record.mat"
        savemat(path, {"t_s": T, "knee_rad": np.where(T == 0.1, np.nan, ANGLE)})
        record = read_record(path)
        np.testing.assert_array_equal(record.angle, np.delete(ANGLE, 100))
        assert "holds no number in 1 of 400 rows" in record.remarks[0]

    @pytest.mark.parametrize(
        ("content", "problem"),
        [
            ({}, "there is only none"),
            ({"s": {"t_s": T, "knee_rad": ANGLE}}, "there is only none"),
            ({"m": np.column_stack([T, ANGLE])}, "there is only none"),
            ({"t_s": T, "knee_rad": csc_matrix(ANGLE.reshape(-1, 1))}, "there is only t_s"),
            ({"t_s": T, "knee_rad": ANGLE > 1}, "there is only t_s"),
            ({"t_s": T, "knee_rad": ANGLE[:-1]}, "columns of equal length: t_s has 400, knee_rad has 399"),
            ({"t_s": T, "knee_rad": ANGLE + 1e-9j}, "knee_rad is complex"),
            ({"t_s": T, "knee_rad": ANGLE, "hip_rad": ANGLE}, "which column is the knee's"),
            ({"t_s": T[:20], "knee_rad": ANGLE[:20]}, "20 rows have a time of their own; expected at least 50"),
        ],
    )
    def test_refused(self, tmp_path, content, problem):
        path = tmp_path / "record.mat"
        savemat(path, content)
        with pytest.raises(BadFile, match=f"record.mat: .*{problem}"):
            read_record(path)

    @pytest.mark.parametrize(
        ("content", "problem"),
        [
            (b"", "empty"),
            (table().encode(), "not a .mat file"),
            (b"\x89HDF\r\n\x1a\n" + bytes(600), "not a .mat file"),
            (HEAD_7_3 + bytes(384) + b"\x89HDF\r\n\x1a\n" + bytes(200), "7.3 file: save it with -v7"),
            (bytes(1000), "empty|not a .mat file|only none"),
            (b"MATLAB 5.0", "not a .mat file"),
        ],
    )
    def test_no_mat_file(self, tmp_path, content, problem):
        with pytest.raises(BadFile, match=f"record.mat: .*({problem})"):
            read_record(written(tmp_path, content, "record.mat"))

    @pytest.mark.parametrize("compressed", [False, True])
    def test_cut_off(self, tmp_path, compressed):
        path = tmp_path / "record.mat"
        savemat(path, {"t_s": T, "knee_rad": ANGLE}, do_compression=compressed)
        content = path.read_bytes()
        for length in [*range(1, 300), *range(300, len(content), 37)]:
            path.write_bytes(content[:length])
            with pytest.raises(SpearError, match="record.mat: ") as caught:
                read_record(path)
            assert "\n" not in str(caught.value)

    def test_too_long(self, tmp_path, monkeypatch):
        monkeypatch.setattr("spear_pin.studies.tables.columns.LARGEST", 399)
        path = tmp_path / "record.mat"
        savemat(path, {"t_s": T, "knee_rad": ANGLE})
        with pytest.raises(BadFile, match="t_s has 400 values; at most 399"):
            read_record(path)
