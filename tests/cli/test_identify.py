"""`spear identify`: from a file to a table, and one line for every file that is no record."""

import numpy as np
import pytest

from spear_pin.studies.laboratory import Instrument, synthesize, write_csv
from spear_pin.studies.push_test import WITH_MOTOR, spear_ii
from tests.cli.calls import printed, refused, run, words

CALIBRATION = ["--volts-per-rad", "1.06", "--offset", "0.4"]


@pytest.fixture(scope="module")
def lab(tmp_path_factory):
    """A synthetic record of two releases."""
    made = synthesize(spear_ii(), WITH_MOTOR, 0.075, repeats=2, instrument=Instrument(noise=0.003))
    return write_csv(made, tmp_path_factory.mktemp("lab") / "lab.csv")


def values(estimate):
    return {row["name"]: (row["value"], row["deviation"]) for row in estimate["parameters"] if row["release"] is None}


@pytest.mark.parametrize(
    "smoothing",
    [
        [],
        pytest.param(["--window", "100"], marks=pytest.mark.slow),
        pytest.param(["--window", "100", "--filter", "causal"], marks=pytest.mark.slow),
    ],
    ids=words,
)
def test_truth_is_found(capsys, tmp_path, lab, smoothing):
    shown = printed(capsys, "identify", lab, *CALIBRATION, *smoothing, "--out", tmp_path)
    (estimate,) = shown["estimates"]
    assert estimate["synthetic"] is True and estimate["releases"] == 2 and estimate["warnings"] == []
    for name, truth in (("stiffness", 48.25), ("damping", 1.03), ("rest_angle", 1.0)):
        value, deviation = values(estimate)[name]
        assert abs(value - truth) < 3 * deviation < 0.01 * truth
    assert (tmp_path / "identify.svg").is_file()
    assert shown["leg"].startswith("SPEAR-II")


@pytest.mark.slow
def test_table(capsys, tmp_path, lab):
    status, out, _ = run(capsys, "identify", lab, *CALIBRATION, "--out", tmp_path)
    assert status == 0
    leg, head, row, held, note = out.splitlines()[:5]
    assert leg == "leg: SPEAR-II's, with its masses and inertias; for another leg give --robot"
    assert "stiffness, N·m/rad" in head and "±" in row and "synthetic, not measured" in note
    assert held.endswith("held at coulomb 0, rotor_inertia 0.027")


@pytest.mark.slow
def test_files_side_by_side_and_together(capsys, tmp_path, lab):
    assert "each file once" in refused(capsys, "identify", lab, lab, *CALIBRATION, "--out", tmp_path)
    other = tmp_path / "other.csv"
    other.write_bytes(lab.read_bytes())
    apart = printed(capsys, "identify", lab, other, *CALIBRATION, "--out", tmp_path)["estimates"]
    (joined,) = printed(capsys, "identify", lab, other, *CALIBRATION, "--together", "--out", tmp_path)["estimates"]
    assert [each["releases"] for each in (*apart, joined)] == [2, 2, 4]
    assert values(joined)["stiffness"][1] == pytest.approx(values(apart[0])["stiffness"][1] / np.sqrt(2), rel=0.02)


@pytest.mark.slow
def test_model_without_the_filter_is_biased_and_says_so(capsys, tmp_path, lab):
    shown = printed(capsys, "identify", lab, *CALIBRATION, "--window", "100", "--model-as-is", "--out", tmp_path)
    (estimate,) = shown["estimates"]
    assert values(estimate)["damping"][0] > 1.05 * 1.03
    assert any("biased" in warning for warning in estimate["warnings"])


@pytest.mark.slow
def test_counts_of_a_converter_widen_the_error_bars_and_are_said(capsys, tmp_path):
    made = synthesize(spear_ii(), WITH_MOTOR, 0.075, repeats=1, instrument=Instrument(noise=0.0))
    coarse = write_csv(made, tmp_path / "coarse.csv")
    (estimate,) = printed(capsys, "identify", coarse, *CALIBRATION, "--out", tmp_path)["estimates"]
    assert estimate["steps"] == [pytest.approx(5.0 / 4096 / 1.06, rel=1e-3)]
    assert max(row["inflation"] for row in estimate["parameters"] if row["release"] is None) > 2
    assert any("rounded to steps of 1.15 mrad, more than its noise" in warning for warning in estimate["warnings"])
    for name, truth in (("stiffness", 48.25), ("damping", 1.03), ("rest_angle", 1.0)):
        value, deviation = values(estimate)[name]
        assert abs(value - truth) < 3 * deviation < 0.02 * truth


@pytest.mark.slow
def test_what_was_dropped_is_said(capsys, tmp_path, lab):
    holed = tmp_path / "holed.csv"
    lines = lab.read_text(encoding="utf-8").splitlines()
    lines[200:210] = ["nan,nan"] * 10
    holed.write_text("\n".join(lines), encoding="utf-8")
    status, out, _ = run(capsys, "identify", holed, *CALIBRATION, "--out", tmp_path)
    assert status == 0 and "dropped 10 of" in out
    assert any(
        "dropped 10" in r for r in printed(capsys, "identify", holed, *CALIBRATION, "--out", tmp_path)["remarks"]
    )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (b"", "empty"),
        (b"\x00\x01\x02" * 500, "text"),
        (b"time_s\n" + b"\n".join(b"%g" % (0.001 * i) for i in range(500)), "column"),
        (b"time_s,knee_V\n" + b"\n".join(b"nan,nan" for _ in range(500)), "rows"),
        (b"time_s,knee_V\n" + b"\n".join(b"%g,1.5" % (0.001 * (i % 90)) for i in range(500)), "back"),
        (b"time_s,knee_V\n" + b"\n".join(b"%d,1.5" % i for i in range(500)), "apart"),
        (b"time_s,knee_V\n" + b"\n".join(b"%g,900" % (0.001 * i) for i in range(500)), "rad"),
        (b"time_s,knee_V\n" + b"\n".join(b"%g,1.5" % (0.001 * i) for i in range(5000)), "release"),
        (b"time_s,knee_V\n" + b"\n".join(b"%g,word" % (0.001 * i) for i in range(500)), "no number, but 'word'"),
    ],
    ids=["empty", "binary", "column", "nan", "back", "milliseconds", "units", "still", "words"],
)
def test_damaged_files(capsys, tmp_path, content, said):
    path = tmp_path / "damaged.csv"
    path.write_bytes(content)
    line = refused(capsys, "identify", path, *CALIBRATION, "--out", tmp_path)
    assert said in line and "damaged.csv" in line
    assert not (tmp_path / "identify.svg").exists()


@pytest.mark.parametrize(
    ("options", "named"),
    [
        ([], "calibration"),
        ([*CALIBRATION, "--unit", "rad"], "calibration"),
        ([*CALIBRATION, "--unit", "furlong"], "furlong"),
        ([*CALIBRATION, "--column", "hip"], "hip"),
        ([*CALIBRATION, "--vary", "mass"], "mass"),
        ([*CALIBRATION, "--per-release", "coulomb"], "coulomb"),
        ([*CALIBRATION, "--window", "0"], "window"),
        ([*CALIBRATION, "--window", "100", "--filter", "median"], "median"),
        ([*CALIBRATION, "--model-as-is"], "--window"),
        ([*CALIBRATION, "--loss", "l7"], "l7"),
        ([*CALIBRATION, "--stiffness", "-1"], "stiffness"),
        ([*CALIBRATION, "--after", "0"], "after"),
        (["--volts-per-rad", "0"], "volts_per_rad"),
        (["--offset", "0.4"], "--offset"),
        (["--volts-per-rad", "0.3", "--offset", "0.4"], "calibration"),
    ],
    ids=words,
)
def test_mistakes(capsys, tmp_path, lab, options, named):
    assert named in refused(capsys, "identify", lab, *options, "--out", tmp_path)


def test_a_leg_without_a_robot(capsys, tmp_path, lab):
    assert "--leg is 'FL'; expected only with --robot" in refused(
        capsys, "identify", lab, "--leg", "FL", "--out", tmp_path
    )


def test_missing_file(capsys, tmp_path):
    assert "nowhere.csv" in refused(capsys, "identify", tmp_path / "nowhere.csv", "--out", tmp_path)
