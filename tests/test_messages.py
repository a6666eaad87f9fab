"""The walker that finds every refusal, and how many lack something."""

import ast

import pytest

from tests.messages import kinds, lacking, messages, names_of, text_of, within

FLAGGED = 58  # at most; what is flagged says to whoever reads it too little of what to do


def texts(program: str) -> list[str]:
    """What the calls of a program that refuse say."""
    tree = ast.parse(program)
    return [
        text_of(call.func.id, call, names_of(tree, functions))
        for call, functions in within(tree)
        if isinstance(call.func, ast.Name)
        and call.func.id in ("BadValue", "BadFile", "SpearError", "UnknownName", "NoGait")
    ]


@pytest.mark.parametrize(
    ("program", "text"),
    [
        ("raise BadValue('rtol', rtol, f'a number > {least:g}')", "rtol is {rtol}; expected a number > {least}"),
        ("raise BadValue('--x', value, expected='one')", "--x is {value}; expected one"),
        ("def f():\n    fault = 'is ' + word\n    raise BadFile(path, 'no ' + 'line')", "{path}: no line"),
        ("def f():\n    why = f'{a} too near'\n    return BadFile(path, why)", "{path}: {a} too near"),
        ("WHY = 'too near'\nraise SpearError(WHY if a else 'far')", "too near"),
        ("raise UnknownName('gait', name, NAMES)", "unknown gait {name}; valid: {NAMES}"),
        ("raise UnknownName('gait', name, NAMES, 'a path')", "unknown gait {name}; valid: {NAMES}, or a path"),
        ("raise NoGait('none', 0.1)", "no gait found: none"),
        ("raise NoGait('none', 0.1, remedy='more')", "no gait found: none; try more"),
        ("raise SpearError(f\"{', '.join({'a': 1})} is bad\")", "{', '.join(('a': 1))} is bad"),
    ],
)
def test_text(program: str, text: str):
    assert texts(program) == [text]


@pytest.mark.parametrize(
    ("kind", "text", "lacks"),
    [
        ("BadValue", "rtol is {rtol}; expected a number > 0", []),
        ("BadValue", "rtol is {rtol}; expected none with it", ["what is valid"]),
        ("BadValue", "name is {name}; expected one of {', '.join(known)}", ["the nearest of a list"]),
        ("BadValue", "name is {name}; expected one of {', '.join(NAMES)}", []),
        ("UnknownName", "unknown gait {name}; valid: {names}", []),
        ("BadFile", "{path}: two columns are alike", ["what to do"]),
        ("BadFile", "{path}: two columns are alike; rename one", []),
        ("BadFile", "{path}: cannot be written: {error.strerror}", []),
        ("SpearError", f"give {'more ' * 50}", ["long"]),
        ("SpearError", "give what was asked", ["the word asked"]),
    ],
)
def test_lacks(kind: str, text: str, lacks: list[str]):
    assert list(lacking(kind, text)) == lacks


def test_classes_of_classes_are_found():
    tree = ast.parse("class A(SpearError): ...\nclass B(errors.A): ...\nclass C(ValueError): ...\n")
    assert kinds([tree]) == {"SpearError", "A", "B"}


@pytest.mark.slow
def test_every_file_is_walked():
    found = messages()
    assert len(found) > 800 and {each.kind for each in found} >= {
        "BadValue",
        "UnknownName",
        "require",
        "ArgumentTypeError",
    }
    assert {each.place.partition("/")[0] for each in found} == {"spear_pin", "viz"}
    assert any("--stiffness" in each.text and each.place.startswith("spear_pin/cli/push_test.py") for each in found)


@pytest.mark.slow
def test_few_lack_anything():
    flagged = [f"{each.place} {each.text}: {', '.join(each.lacks)}" for each in messages() if each.lacks]
    assert len(flagged) <= FLAGGED, "\n".join(["see python -m tests.messages --flagged", *flagged])
