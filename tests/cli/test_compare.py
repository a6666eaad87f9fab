"""`spear compare`: the table, the page, and what is refused."""

import pytest

from spear_pin import Gait
from spear_pin.errors import BadValue
from tests.cli.calls import printed, refused, run


@pytest.mark.slow
def test_gaits_as_a_table(capsys, tmp_path):
    status, out, err = run(capsys, "compare", "long_stride", "long_stride_3.00", "--cycles", 1, "--out", tmp_path)
    assert (status, err) == (0, "")
    speed = next(line for line in out.splitlines() if line.startswith("mean speed"))
    assert speed.split() == ["mean", "speed", "2.5", "3", "+0.5", "+20.0", "m/s"]
    assert "law: anterior_hip_torque" in out


@pytest.mark.slow
def test_two_springs_by_one_command(capsys, tmp_path):
    status, out, err = run(capsys, "compare", "stiffness=40", "stiffness=60", "--cycles", 1, "--out", tmp_path)
    assert (status, err) == (0, "")
    assert "stiffness=40 is stable" in out and "stance torque solved for 0.2 s in the air" in out
    period = next(line for line in out.splitlines() if line.startswith("period"))
    assert period.split() == ["period", "0.6025", "0.5223", "−0.0802", "−13.3", "s"]
    assert (tmp_path / "compare.html").stat().st_size < 5_000_000


@pytest.mark.parametrize(
    "words",
    [
        ("--of", "long_stride_3.00", "long_stride", "stiffness=100"),
        ("long_stride", "--of", "long_stride_3.00", "stiffness=100"),
        ("long_stride", "stiffness=100", "--of", "long_stride_3.00"),
    ],
)
def test_options_stand_anywhere(capsys, tmp_path, monkeypatch, words):
    asked = {}

    def noted(*items, of, **options):
        asked.update(items=items, of=of)
        raise BadValue("items", items, "none")

    monkeypatch.setattr("spear_pin.viz.compare.compare", noted)
    refused(capsys, "compare", *words, "--out", tmp_path)
    assert asked["items"] == ("long_stride", "stiffness=100")
    assert asked["of"].period == Gait.load("long_stride_3.00").period


@pytest.mark.slow
def test_springs_in_the_leg_of_another_robot(capsys, tmp_path):
    """Its hop, for the same time in the air with each, and no number of SPEAR-II's."""
    leg = ("--robot", "q_spear_full", "--leg", "posterior_left", "--body", 5)
    words = (*leg, "stiffness=55", "--flight-time", 0.2, "--cycles", 1, "--out", tmp_path)
    found = printed(capsys, "compare", "stiffness=50", *words)
    assert [(side["label"], side["robot"]) for side in found["sides"]] == [
        ("stiffness=50", "q_spear_full_posterior_left"),
        ("stiffness=55", "q_spear_full_posterior_left"),
    ]
    flights = next(row["values"] for row in found["measures"] if row["measure"] == "flight time")
    assert flights == pytest.approx([0.2, 0.2], abs=1e-6)


@pytest.mark.slow
def test_springs_for_another_flight(capsys, tmp_path):
    words = ("--flight-time", "0.25", "--cycles", "1", "--out", tmp_path)
    found = printed(capsys, "compare", "stiffness=45", "stiffness=50", *words)
    flights = next(row["values"] for row in found["measures"] if row["measure"] == "flight time")
    assert flights == pytest.approx([0.25, 0.25], abs=1e-6)


def test_robots_as_json(capsys, tmp_path):
    found = printed(capsys, "compare", "spear_ii", "q_spear", "--names", "leg", "dog", "--out", tmp_path)
    assert [side["label"] for side in found["sides"]] == ["leg", "dog"]
    mass = next(row for row in found["measures"] if row["measure"] == "mass")
    assert mass["differences"] == [0.0, pytest.approx(36.96)] and mass["unit"] == "kg"
    assert found["parameters"] == [{"parameter": "robot", "values": ["spear_ii", "q_spear"]}]
    assert found["files"] == [str(tmp_path / "compare.html")]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("long_stride",), "2 to 6"),
        (("spear_ii", "nothing"), "unknown gait or robot 'nothing'"),
        (("spear_ii", "q_spear", "--names", "one"), "2 of them"),
        (("spear_ii", "q_spear", "--of", "nothing"), "unknown gait 'nothing'"),
        (("spear_ii", "q_spear", "--cycles", "0"), "a whole number from 1 to 50"),
        (("spear_ii", "stiffness=x"), "expected a number"),
        (("spear_ii", "q_spear", "--out", "none"), "--out"),
        (("spear_ii", "q_spear", "--robot", "hoppy_leg"), "only with springs to compare, such as stiffness=40"),
        (("spear_ii", "q_spear", "--flight-time", "0.3"), "only with springs to compare"),
        (("stiffness=4", "stiffness=5", "--leg", "FL"), "only with --robot"),
        (("stiffness=4", "stiffness=5", "--of", "long_stride", "--flight-time", "0.3"), "left out with --gait"),
        (
            ("--names", "a", "b", "spear_ii", "q_spear"),
            "as many items as names, in front of --names: A B --names NAME NAME",
        ),
        (("spear_ii", "--nothing", "q_spear"), "unknown arguments: --nothing q_spear"),
    ],
)
def test_what_is_wrong_takes_one_line(capsys, tmp_path, monkeypatch, words, said):
    monkeypatch.chdir(tmp_path)
    assert said in refused(capsys, "compare", *words)
    assert not list(tmp_path.iterdir())
