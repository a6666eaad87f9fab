"""`spear payoff`: the page, what is printed, and that it goes on where it was broken off."""

import json
from dataclasses import replace

import pytest

from tests.cli.calls import ROOT, printed, refused, run
from tests.gaits.bounding_gaits import trajectory
from tests.studies.payoff.stub import Stub, Stubbed, own_figures

CALL = (
    *("payoff", "q_spear", "--speeds", "2,2.5", "--stiffnesses", "40,60", "--bus", "48", "--workers", "1"),
    *("--knee-motor", "assumed_600w", "--knee-ratio", "15", "--hip-motor", "assumed_600w", "--hip-ratio", "15"),
)


@pytest.fixture
def stub(monkeypatch):
    made = Stub(lambda point, start: point.kind == "switched" and point.stiffness == 60.0)
    monkeypatch.setattr("spear_pin.studies.payoff.bounding.BOUNDS", Stubbed(made))
    monkeypatch.setattr("spear_pin.gaits.collocation.casadi", lambda: None)
    for drawer in ("payoff.page", "plots.payoff"):  # of whose motion there is one for all
        monkeypatch.setattr(f"spear_pin.viz.{drawer}.simulate", lambda *given, **named: trajectory("long_stride"))
    return made


CABLE = str(ROOT / "examples" / "biarticular.toml")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("minitaur_leg", "--flight-times", "0.14"), "robot is 'minitaur_leg'; expected a robot without closed loops"),
        (("minitaur_leg", "--leg", "leg"), "expected a robot without closed loops"),
        (
            ("q_spear", "--over", "cable.hip=1e-5:0.03,knee_ratio=3:9"),
            "'cable.hip=1e-05:0.03,knee_ratio=3:9'",
        ),
        (("q_spear", "--flight-times", "0.1,0.2"), "--flight-times is '0.1,0.2'; expected only with --leg"),
        (("spear_ii", "--knee-motor", "spear_ii_knee"), "--bus is None; expected the voltage"),
        pytest.param(
            ("biped",),
            "is fixed (spear robots lists quadrupeds); for hops of one leg type --leg left",
            marks=pytest.mark.extra("casadi"),
        ),
        (("hoppy",), "robot is 'hoppy'; expected one whose leg goes round no post, such as hoppy_leg"),
    ],
)
def test_what_it_refuses(capsys, words, said):
    assert said in refused(capsys, "payoff", *words)


@pytest.mark.extra("heyoka")
@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("spear_ii", "--over", "knee_motor_size=2:3"), "--over knee_motor_size is '2:3'; expected a range with"),
        ((CABLE, "--over", "cable.hip=3:1"), "--over cable.hip is '3:1'; expected a least and a greatest value"),
        (("hoppy_leg", "--flight-times", "9"), "flight_time"),
        ((CABLE,), "--bus is None; expected the voltage of the supply, in V: the nominal one of spear_ii_knee"),
    ],
)
def test_what_it_refuses_leaves_nothing(capsys, tmp_path, words, said):
    """A robot with one leg hops, without --leg."""
    assert said in refused(capsys, "payoff", *words, "--out", tmp_path)
    assert not [*tmp_path.iterdir()]


class TestPayoff:
    @pytest.mark.slow
    def test_page_pictures_and_figures(self, capsys, tmp_path, stub):
        found = printed(capsys, *CALL, "--out", tmp_path)
        assert found["answer"]["verdict"] == "switchable" and found["speed"] == 2.0
        assert (
            found["best"]["switched"]["figures"]["stiffness_per_leg"] == 50.0
            and found["motors"]["knee"]["from"] == "given"
        )
        assert len(found["points"]) == 2 * 5 + 2 and sum("figures" not in each for each in found["points"]) == 2
        said, costs = found["answer"], {kind: each["figures"]["cost"] for kind, each in found["best"].items()}
        assert said["saving"] == said["by_speed"]["2.0"]["saving"]
        assert said["saving"] == {kind: 1 - costs[kind] / costs["none"] for kind in ("fixed", "switched")}
        names = {path.name for path in tmp_path.iterdir()}
        assert names >= {"payoff.html", "payoff_cost.svg", "payoff_saving.svg", "payoff_torque.svg", "payoff.jsonl"}
        page = (tmp_path / "payoff.html").read_text(encoding="utf-8")
        assert "Yes: at 2 m/s a switchable spring of 50 N·m/rad per leg saves 30.0 % of" in page and "it is so" in page
        assert "<td>30.0 %</td>" in page and "<td>10.0 %</td>" in page  # in the table of speeds
        assert page.count("data-play=") == 2 and len(page) < 3_000_000
        assert all(unit in page for unit in ("Stiffness of a leg (N·m/rad)", "N·m for ever"))
        exec(found["python"], {})
        assert capsys.readouterr().out.strip() == said["sentence"]

    @pytest.mark.slow
    def test_a_stiffness_along_a_path_and_what_is_chosen_have_their_own_units(
        self, capsys, tmp_path, stub, monkeypatch
    ):
        words = replace(Stubbed.words, unit="N/m", place="along cable", units={"cable.hip": "m"})
        figures = replace(own_figures(), chosen={"cable.hip": 0.01234})
        monkeypatch.setattr(Stubbed, "words", words)
        monkeypatch.setattr(Stubbed, "over", {"cable.hip": (0.001, 0.03)})
        monkeypatch.setattr("tests.studies.payoff.stub.own_figures", lambda: figures)
        status, out, _ = run(capsys, *CALL, "--out", tmp_path)
        page = (tmp_path / "payoff.html").read_text(encoding="utf-8")
        assert (
            "a switchable spring of 50 N/m per leg with cable.hip 0.0123 m saves" in out
            and ": cable.hip 0.0123 m, peak" in out
        )
        assert status == 0 and "N·m/rad" not in page + out and "50 N/m, cable.hip 0.0123 m, peak knee" in out
        assert "<th>cable.hip (m)</th><td>0.0123</td>" in page
        assert "Would a switchable parallel spring along cable pay off?" in page and "Stiffness of a leg (N/m)" in page

    @pytest.mark.slow
    def test_a_second_call_searches_nothing(self, capsys, tmp_path, stub):
        status, first, _ = run(capsys, *CALL, "--out", tmp_path)
        asked = len(stub.asked)
        first_ratio = CALL.index("--knee-ratio")
        own = (*CALL[:first_ratio], *CALL[first_ratio + 2 :])  # the file has 15 as well
        for call in (CALL, own):
            assert (status, run(capsys, *call, "--out", tmp_path)) == (0, (0, first, "")) and len(stub.asked) == asked
        refused(capsys, "another study", *CALL, "--bus", "24", "--out", tmp_path)

    @pytest.mark.slow
    def test_text(self, capsys, tmp_path, stub):
        status, out, err = run(capsys, *CALL, "--out", tmp_path)
        assert status == 0 and err == ""
        for words in ("answer", "at 2.5 m/s: fixed", "on a finer mesh", "without a gait", "knee motors, given"):
            assert words in out
        assert out.count("at the joint instead of the file's") == 2

    @pytest.mark.slow
    def test_json_has_no_nan(self, capsys, tmp_path, stub):
        stub.fails = lambda point, start: point.kind != "none"
        status, out, _ = run(capsys, *CALL, "--json", "--out", tmp_path)
        assert status == 0 and json.loads(out)["answer"]["saving"] == {"fixed": None, "switched": None}
