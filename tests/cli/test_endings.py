"""How motions end that commands play: a line and status 1 where one is lost, a refusal where no cycle is whole."""

from dataclasses import replace
from types import SimpleNamespace

import pytest

import spear_pin
from spear_pin import Gait
from spear_pin.cli.endings import lost, notes_of, show_ending
from spear_pin.errors import SpearError
from spear_pin.hybrid.reasons import REASONS
from tests.cli.calls import refused, run
from tests.gaits.feeding import idle


def motion(reason, cycles):
    return SimpleNamespace(complete=reason == "complete", cycles=cycles, reason=reason, message=REASONS[reason])


@pytest.mark.parametrize(
    ("reason", "cycles", "of", "said"),
    [
        ("complete", 3, 1, None),
        ("fall", 3, 1, "falls after 3 strides: a part other than a toe reached the ground"),
        ("fall", 5, 2, "falls after 2 strides: a part"),
        ("overload", 1, 1, "is lost after 1 stride: the control law asked for more torque"),
        ("not_finite", 2, 1, "is lost after 2 strides: the state is no longer finite"),
    ],
)
def test_said(reason, cycles, of, said):
    found = lost(motion(reason, cycles), "stride", of)
    assert (found is None) == (said is None) and (found or "").startswith(said or "")
    assert [name for name, _ in show_ending(found)] == ["the motion"] * (said is not None)
    notes = notes_of({"lost": found, "implausible": ("torque of the knee",)})
    assert notes == [*([f"the motion {found}"] if found else []), "torque of the knee"]


@pytest.mark.parametrize(("reason", "cycles", "of"), [("fall", 0, 1), ("zeno", 1, 2), ("evaluation_cap", 0, 1)])
def test_without_a_whole_cycle_it_is_refused(reason, cycles, of):
    with pytest.raises(SpearError, match=rf"in its first hop: .*{REASONS[reason][:20]}.*; try a smaller --push"):
        lost(motion(reason, cycles), "hop", of, "a smaller --push")


def cut_short(monkeypatch, reason, cycles):
    """Have every motion end so, after so many of its cycles."""
    simulate = spear_pin.simulate

    def shorter(*arguments, **options):
        found = simulate(*arguments, **options)
        ledger = found.ledger if cycles else replace(found.ledger, work=found.ledger.work[:0], change=[])
        return replace(found, reason=reason, message=REASONS[reason], cycles=cycles, ledger=ledger)

    monkeypatch.setattr(spear_pin, "simulate", shorter)


SHORT = (
    ("hop", "--stance-torque", 7.8262),
    pytest.param(("hop", "--robot", "hoppy"), marks=pytest.mark.slow),
    ("bound",),
    pytest.param(("turn", "turn_4"), marks=pytest.mark.slow),
)


@pytest.mark.parametrize("words", SHORT)
@pytest.mark.slow
def test_status_of_a_motion_that_is_lost(capsys, tmp_path, monkeypatch, words):
    """Print, status and page; its files are there to look at."""
    cut_short(monkeypatch, "fall", 1)
    status, out, err = run(capsys, *words, "--cycles", 1, "--rtol", 1e-7, "--out", tmp_path)
    assert (status, err) == (1, "")
    first = out.splitlines()[0]
    assert first.startswith("the motion ") and "falls after 1 " in first
    page = next(tmp_path.glob("*.html")).read_text(encoding="utf-8")
    assert "falls after 1 " in page


@pytest.mark.parametrize("words", SHORT)
def test_one_without_a_whole_cycle_leaves_no_file(capsys, tmp_path, monkeypatch, words):
    cut_short(monkeypatch, "overload", 0)
    said = refused(capsys, *words, "--cycles", 1, "--rtol", 1e-7, "--out", tmp_path)
    assert "in its first" in said and list(tmp_path.iterdir()) == []


@pytest.mark.slow
@pytest.mark.parametrize(("push", "told"), [(99, "in its first stride: "), (1e9, "--push")])
def test_a_push_that_nothing_survives(capsys, tmp_path, push, told):
    """Of a gait with feedback that does nothing, which is quick to play."""
    gait = Gait.load("trot")
    path = idle(gait).save(tmp_path / "idle.json")
    assert told in refused(capsys, "trot", path, "--push", push, "--cycles", 2, "--out", tmp_path)
    assert [each.name for each in tmp_path.iterdir()] == ["idle.json"]
