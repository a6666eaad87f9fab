"""The checker says which answers are wrong, needs NumPy only, and refuses what are no answers."""

import copy
import json
import subprocess
import sys

import pytest

from spear_pin.cli.references import SHIPPED
from spear_pin.references.check import lines, read, refuse_others
from tests.cli.calls import printed, refused, run

REFERENCES = read(SHIPPED)
RIGHT = {name: reference["answer"]["events"] for name, reference in REFERENCES.items()}


def changed(name, change):
    """The right answers, but one problem's events after a change."""
    answers = copy.deepcopy(RIGHT)
    change(answers[name])
    return answers


def shifted(quantity, event, bounds, place=None):
    def change(events):
        off = bounds * REFERENCES["leg_hops"]["answer"]["bounds"][quantity]
        if place is None:
            events[event][quantity] += off
        else:
            events[event][quantity][place] += off

    return change


WRONG = {
    "late": (shifted("time_s", 3, 2.0), "1 of 45 numbers; time_s of lift_off of toe 1 is"),
    "bent": (shifted("position", 4, -3.0, 2), "position of touchdown of toe 2: knee is"),
    "fast": (shifted("velocity", 0, 1e6, 0), "velocity of touchdown of toe 1: boom_z is"),
    "with less energy": (shifted("energy_J", 2, -2.0, 0), "energy_J of slip 1: kinetic is"),
    "without a slip": (lambda events: events.pop(2), "0 of 36 numbers; no slip 1"),
    "with another": (lambda events: events.append({"event": "stick"}), "stick 1 is no event of it"),
    "of another foot": (
        lambda events: events[0].update(foot="heel"),
        "no touchdown of toe 2; touchdown of heel 1",
    ),
    "without most": (lambda events: events.__delitem__(slice(None)), "no lift_off of toe 1; 1 more"),
    "NaN": (lambda events: events[0].update(time_s=float("nan")), "is nan, not"),
}


@pytest.mark.parametrize("which", WRONG)
def test_it_says_which_answer_is_wrong(which):
    change, said = WRONG[which]
    found = list(lines(REFERENCES, changed("leg_hops", change)))
    (wrong,) = [line for fine, line in found if not fine]
    assert wrong.startswith("leg_hops: OFF, ") and said in wrong
    assert len(found) == len(REFERENCES)


def test_right_ones_and_others():
    assert all(fine and ": ok, " in line for fine, line in lines(REFERENCES, RIGHT))
    within = changed("leg_hops", shifted("velocity", 1, 0.9, 1))
    assert all(fine for fine, _ in lines(REFERENCES, within))
    found = list(lines(REFERENCES, {"leg_hops": RIGHT["leg_hops"], "leg_flies": []}))
    assert [line for fine, line in found if not fine] == ["'leg_flies': no problem of this name"]
    assert sum("no answer" in line for _, line in found) == len(REFERENCES) - 1


BAD = {
    "[]": "not an object",
    '{"leg_hops": 1}': "'leg_hops' is not a list",
    '{"leg_hops": [1]}': "event 0 of 'leg_hops' is not an object whose",
    '{"leg_hops": [{"event": "slip", "position": [1]}]}': "position of event 0 of 'leg_hops' is not 3 numbers",
    '{"leg_hops": [{"event": "slip", "time_s": "x"}]}': "time_s of event 0 of 'leg_hops' is not 1 number",
    '{"leg_hops": [{"event": "slip", "energy_J": [1, null]}]}': "energy_J of event 0 of 'leg_hops' is not 2 numbers",
    '{"leg_hops": [{"event": "slip", "foot": []}]}': "event 0 of 'leg_hops' is not an object whose",
}


@pytest.mark.parametrize("text", BAD)
def test_what_are_no_answers(text, capsys, tmp_path):
    with pytest.raises(ValueError, match=BAD[text]):
        refuse_others(REFERENCES, json.loads(text))
    path = tmp_path / "answers.json"
    path.write_text(text)
    assert BAD[text] in refused(capsys, "references", path)


def test_the_command_lists_and_checks(capsys, tmp_path):
    assert printed(capsys, "references")["problems"].keys() == REFERENCES.keys()
    path = tmp_path / "answers.json"
    path.write_text(json.dumps(RIGHT))
    assert len(printed(capsys, "references", path)["checked"]) == len(REFERENCES)
    path.write_text(json.dumps(changed("leg_hops", WRONG["late"][0])))
    status, out, _ = run(capsys, "references", path)
    assert status == 1 and "leg_hops: OFF" in out


def test_the_copy_needs_numpy_only(capsys, tmp_path):
    """In a process that finds no package of ours, and in isolated mode does not even look beside the file."""
    assert len(printed(capsys, "references", "--out", tmp_path)["files"]) == len(REFERENCES) + 2
    answers = tmp_path / "mine" / "answers.json"
    answers.parent.mkdir()
    answers.write_text(json.dumps(changed("turn", lambda events: events.pop())))
    words = [sys.executable, "-I", tmp_path / "check.py", answers]
    done = subprocess.run(words, capture_output=True, text=True, check=False, cwd=tmp_path)
    assert done.returncode == 1, done.stderr
    assert len(done.stdout.splitlines()) == len(REFERENCES) and "turn: OFF, 0 of " in done.stdout
    code = f"import sys, runpy; runpy.run_path({str(tmp_path / 'check.py')!r}); print(*sys.modules)"
    loaded = subprocess.run(
        [sys.executable, "-I", "-c", code], capture_output=True, text=True, check=True
    ).stdout.split()
    assert not {"spear_pin", "scipy", "pinocchio"} & {*loaded}
