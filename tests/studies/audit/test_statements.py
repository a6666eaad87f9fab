"""The statements of the source: that each is whole, that its command runs, and that checking notices."""

import ast
import contextlib
import importlib
import io
import json
import re
import shlex
from dataclasses import asdict, replace
from functools import partial
from pathlib import Path

import pytest

from docs import make_errata
from spear_pin.errors import BadValue
from spear_pin.studies.audit.errata import ERRATA
from spear_pin.studies.audit.printed_designs import SPEAR_II, TABLE_2_4
from spear_pin.studies.audit.statements import (
    ASSUMPTIONS,
    CHAPTERS,
    RULES,
    STATEMENTS,
    VERDICTS,
    Finding,
    averages,
    check,
    command_of,
)
from spear_pin.studies.audit.statements import criteria as c
from spear_pin.studies.audit.statements.chapters import chapter, statement_of
from spear_pin.studies.audit.statements.formula import ASSUMED, Formula
from spear_pin.studies.audit.statements.statement import Statement
from spear_pin.studies.audit.statements.tables import TABULATIONS

BY_ID = {statement.id: statement for statement in STATEMENTS}
FOUND = [statement for statement in STATEMENTS if statement.study is not None]
CHEAP = [  # no simulation behind them
    *CHAPTERS[2],
    *CHAPTERS[3],
    *averages.STATEMENTS,
    *(statement for statement in chapter("chapter4_tables") if statement.id != "resting-angle"),
    *(statement for statement in CHAPTERS[4] if statement.id.startswith("back-")),
    *(BY_ID[name] for name in ("total-mass", "same-shank", "hip-inertia-no-concern", "bounding-knee-sign")),
]
KNOWN = {  # typed here, from calculations of others than the functions under test
    "leg-mass-halved": (0.484, "agrees"),
    "thigh-inertia-halved": (0.359, "agrees"),
    "knee-rotor-spear-ii": (0.02723, "agrees"),
    "knee-rotor-spear-i": (0.00816, "agrees"),
    "flat-rotor-larger": (9.375, "agrees"),
    "hip-rotor-spear-ii": (0.0432, "by construction"),
    "spring-in-series": (1 / 1.01, "by construction"),
    "spring-engaged": (1.0, "by construction"),
    "thigh-balance": (0.008, "by construction"),
    "rotor-energy": ((0.047, 0.027), "by construction"),
    "shank-inertia-quadruped": (0.014 - 0.48 * 0.14**2, "agrees"),
    "effective-rotors": (0.027, "agrees"),
    "angle-to-place": (2.0 * 0.017452 / (9.81 * 0.04 / 8), "cannot be known"),
    "earlier-mount-heavier": (None, "cannot be known"),
    "kinetic-energy": ((0.1636, 0.1932), "differs"),
    "potential-energy": ((18.40, 9.62), "differs"),
    "table-3.1-ratios": (0.432, "differs"),
    "stator-turns": ((0.0018, 0.026), "cannot be known"),
    "flight-law-sign": ((35.15, -4.40), "differs"),
    "settles-in-flight": ((0.502, 0.909), "differs"),
    "mean-stiffness-with-motor": (51.35, "differs"),
    "mean-fit-with-motor": (86.20, "differs"),
    "mean-stiffness-no-motor": (47.99, "agrees"),
    "mean-rest-angle-with-motor": (1.0133, "agrees"),
    "mean-sigma-damping-with-motor": (0.5033, "agrees"),
    "mean-sigma-damping-no-motor": (0.4067, "agrees"),
    "mean-sigma-rest-angle-no-motor": (0.0333, "agrees"),
    "motor-stiffens": (3.37, "differs"),
    "motor-damps": (0.2733, "agrees"),
    "belt-stiffness": ((0.7256, 1.0884), "agrees"),
    "boom-damping": (3.80, "agrees"),
    "square-of-the-ratio": ((1.0, 4.0, 19.36), "by construction"),
    "open-circuit": (24.0**2 / 4 / ((15 * 0.115) ** 2 / 0.26), "agrees"),
    "open-is-no-load": (34.5 / 24.0, "cannot be known"),
    "back-emf": (34.5, "agrees"),
    "back-emf-of-rotor": (2.3, "differs"),
    "speed-on-24-volts": (13.91, "cannot be known"),
    "total-mass": (43.76, "agrees"),
    "load-of-a-leg": (8.75, "agrees"),
    "hip-inertia-no-concern": ((0.188, 0.119), "cannot be known"),
    "similar-260-w": (4.18, "cannot be known"),
    "rotor-a-drawback": (0.027 / 0.008, "agrees"),
    "biped-motors": ((2 * 2.2 + 4.6) / (2.2 + 4.6), "cannot be known"),
    "motor-length": (None, "cannot be known"),
}


def test_there_are_many_and_each_is_called_by_a_name_of_its_own():
    assert len(STATEMENTS) >= 40
    assert len(BY_ID) == len(STATEMENTS)
    assert all(re.fullmatch(r"[a-z0-9.-]+", name) for name in BY_ID)


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda each: each.id)
def test_each_is_whole(statement):
    assert re.search(r"\d", statement.place) and statement.says.endswith(".")
    assert (statement.study is None) == (statement.finds == "")
    assert statement.criterion is not None or statement.unknown, "neither checked, nor said why not"
    assert statement.study is not None or statement.unknown
    assert set(statement.assumes) <= {assumption.id for assumption in ASSUMPTIONS}


@pytest.mark.parametrize("statement", STATEMENTS, ids=lambda each: each.id)
def test_each_has_one_way_to_its_verdict(statement):
    """Judged, by construction or unknown; what stands in for the unknown is a reason in words."""
    assert not (statement.built and statement.unknown)
    assert statement.criterion is not None or not statement.built
    if any(assumption.stands_in for assumption in statement.assumptions):
        assert statement.built or statement.unknown, "an assumption stands in for what is not known"


@pytest.mark.parametrize("statement", [each for each in STATEMENTS if each.others], ids=lambda each: each.id)
def test_what_is_judged_can_be_asked_with_every_alternative(statement):
    for other in statement.others:
        keyword, value = other.given
        assert keyword in statement.study.names, f"{statement.id} is not looked at without it: {other.label}"
        assert ASSUMED[keyword] != value, "an alternative is another than what is assumed"


def test_assumptions_are_named_by_a_statement_and_lead_one_way():
    assert {name for statement in STATEMENTS for name in statement.assumes} == {each.id for each in ASSUMPTIONS}
    assert not [each.id for each in ASSUMPTIONS if each.others and each.settled]


def test_each_verdict_has_a_rule():
    assert tuple(RULES) == VERDICTS


def test_the_page_on_the_source_counts_them():
    page = Path(__file__).parents[3] / "docs" / "explanation" / "source.md"
    text = " ".join(page.read_text(encoding="utf-8").split())
    counts = r"(\d+) agree, (\d+) differ, (\d+) hold by construction, and (\d+) cannot be known"
    found = re.search(rf"\*\*(\d+) statements\*\*, {counts}", text)
    every, *each = map(int, found.groups())
    assert (every, each[2]) == (len(STATEMENTS), sum(bool(statement.built) for statement in STATEMENTS))
    assert sum(each) == every


@pytest.mark.parametrize("statement", FOUND, ids=lambda each: each.id)
def test_each_command_imports_what_there_is(statement):
    python, option, code = shlex.split(statement.command)
    assert (python, option) == ("python", "-c")
    *lines, last = ast.parse(code).body
    assert ast.unparse(last) == ast.unparse(ast.parse(f"print({statement.study.text})"))
    for line in lines:
        if isinstance(line, ast.ImportFrom):
            importlib.import_module(f"{line.module}.{line.names[0].name}")


@pytest.mark.parametrize("statement", [each for each in CHEAP if each.study is not None], ids=lambda each: each.id)
def test_the_command_prints_what_is_found(statement):
    shown = io.StringIO()
    with contextlib.redirect_stdout(shown):
        exec(shlex.split(statement.command)[2], {})
    finding = check(statement)
    assert ast.literal_eval(shown.getvalue()) == pytest.approx(finding.value)


@pytest.mark.parametrize(("name", "expected"), KNOWN.items(), ids=KNOWN)
def test_known_findings(name, expected):
    value, verdict = expected
    finding = check(BY_ID[name])
    assert finding.verdict == verdict and finding.id == name
    assert finding.value == (value if value is None else pytest.approx(value, rel=5e-3))


@pytest.mark.parametrize("name", [name for name, (_, verdict) in KNOWN.items() if verdict == "agrees"])
def test_a_value_that_is_off_differs(name):
    statement = BY_ID[name]
    value = check(statement).value
    for factor in (1.5, 0.5, -1.0, 10.0):
        off = tuple(factor * each for each in value) if isinstance(value, tuple) else factor * value
        if not statement.criterion.holds(off):
            assert check(replace(statement, study=lambda off=off: off)).verdict == "differs"
            return
    pytest.fail("no wrong value is noticed")


class TestCheck:
    STATEMENT = Statement("one", "(1.1)", "One is one.", "one", lambda: 1.0, criterion=c.near(1.0, 0.1))

    def test_agrees(self):
        assert check(self.STATEMENT).verdict == "agrees"

    def test_what_rests_on_the_unprinted_cannot_be_known(self):
        finding = check(replace(self.STATEMENT, unknown="It is not printed."))
        assert (finding.verdict, finding.value, finding.reason) == ("cannot be known", 1.0, "It is not printed.")

    @pytest.mark.parametrize("unknown", ["", "It is not printed."])
    def test_a_failure_is_a_finding_with_a_reason(self, unknown):
        finding = check(replace(self.STATEMENT, study=lambda: 1.0 / 0.0, unknown=unknown))
        assert finding.verdict == "failed" and finding.value is None and "division" in finding.reason

    def test_so_is_a_number_that_is_none(self):
        finding = check(replace(self.STATEMENT, study=lambda: (1.0, float("nan"))))
        assert finding.verdict == "failed" and "nan" in finding.reason

    def test_an_interruption_is_not(self):
        def interrupted():
            raise KeyboardInterrupt

        with pytest.raises(KeyboardInterrupt):
            check(replace(self.STATEMENT, study=interrupted))

    def test_by_construction(self):
        finding = check(replace(self.STATEMENT, built="It is made so."))
        assert (finding.verdict, finding.value, finding.reason) == ("by construction", 1.0, "It is made so.")

    def test_by_construction_and_not_so_is_a_failure(self):
        finding = check(replace(self.STATEMENT, study=lambda: 2.0, built="It is made so."))
        assert finding.verdict == "failed" and "It is made so." in finding.reason

    @pytest.mark.parametrize("value", [1.0, 2.0])
    def test_what_stands_in_for_the_unknown_is_not_judged(self, value):
        finding = check(replace(self.STATEMENT, study=lambda: value, assumes=("prospective-motors",)))
        assert (finding.verdict, finding.value) == ("cannot be known", value) and "260 W" in finding.reason

    @pytest.mark.parametrize(
        ("by_gait", "verdict"),
        [
            ({"least_effort": 1.0, "force_lift_off": 1.05}, "agrees"),
            ({"least_effort": 1.0, "force_lift_off": 2.0}, "cannot be known"),
            ({"least_effort": 2.0, "force_lift_off": 2.0}, "cannot be known"),
        ],
    )
    def test_a_verdict_holds_for_every_alternative(self, by_gait, verdict):
        statement = replace(self.STATEMENT, study=lambda gait="": by_gait.get(gait, 1.0), assumes=("bound",))
        finding = check(statement)
        assert finding.verdict == verdict
        assert [(case.value, case.holds) for case in finding.cases] == [(v, v < 1.1) for v in by_gait.values()]

    def test_so_does_that_it_differs(self):
        statement = replace(self.STATEMENT, study=lambda gait="": 2.0, assumes=("bound",))
        assert check(statement).verdict == "differs"

    def test_there_and_back(self):
        statement = replace(self.STATEMENT, study=lambda gait="": (1.0, 1.0), assumes=("bound",), criterion=c.above(0))
        finding = check(statement)
        assert Finding.of(json.loads(json.dumps(asdict(finding)))) == finding and len(finding.cases) == 2

    def test_command_of_a_partial(self):
        command = command_of(partial(int.from_bytes, b"\x01", byteorder="big"))
        assert command.endswith("print(from_bytes(b'\\x01', byteorder='big'))\"")

    def test_no_command_without_a_formula(self):
        assert self.STATEMENT.command == ""


@pytest.mark.parametrize(
    ("criterion", "good", "bad", "words"),
    [
        (c.near(2.0, 0.1), 2.1, 2.11, "within 0.1 of 2"),
        (c.near((1.0, 2.0), 0.1), (1.1, 1.9), (1.1, 1.8), "within 0.1 of 1; 2"),
        (c.near((1.0, 2.0), 0.1), (1.0, 2.0), 1.0, "within 0.1"),
        (c.near(3.0, 0.0), 3.0, 3.001, "3"),
        (c.about(-10.0, 0.1), -11.0, -11.1, "within 10 % of -10"),
        (c.equal(0.1), (1.09, 1.0), (1.2, 1.0), "within 10 %"),
        (c.below(1.0), (0.5, 0.9), (0.5, 1.0), "below 1"),
        (c.above(1.0), (1.1, 2.0), (1.0, 2.0), "above 1"),
        (c.between(1.0, 2.0), (1.0, 2.0), (0.9, 2.0), "from 1 to 2"),
        (c.rising(), (1.0, 2.0, 3.0), (1.0, 1.0, 3.0), "larger"),
        (c.falling(), (3.0, 2.0), (2.0, 2.0), "smaller"),
        (c.first(c.below(0.0)), (-1.0, 1.0), (1.0, -1.0), "the first below 0"),
        (c.least(1), (2.0, 1.0, 3.0), (1.0, 1.0, 3.0), "number 2 smaller"),
    ],
)
def test_criteria(criterion, good, bad, words):
    assert criterion.holds(good) and not criterion.holds(bad)
    assert words in criterion.text


def test_a_formula_takes_other_values_of_what_is_assumed():
    formula = Formula("[knee * factor for factor in (1, 2)]")
    assert formula() == [1.0, 2.0] and formula(knee=3.0) == [3.0, 6.0]
    assert formula.command == 'python -c "knee = 1.0; print([knee * factor for factor in (1, 2)])"'
    with pytest.raises(TypeError, match="gait"):
        formula(gait="bound")
    with pytest.raises(NameError, match="open"):
        Formula("open('gait')")


class TestErrata:
    def test_the_page_is_written_from_the_data(self):
        assert make_errata.PAGE.read_text(encoding="utf-8") == make_errata.page(), "run: python -m docs.make_errata"

    def test_they_are_shown_by_statements_that_there_are(self):
        named = [name for errata in ERRATA.values() for erratum in errata for name in erratum.shown_by]
        assert len(named) >= 20 and set(named) <= set(BY_ID)


class TestTables:
    @pytest.mark.parametrize(
        "table", [each for chapter in TABULATIONS.values() for each in chapter], ids=lambda t: t.id
    )
    def test_rows_fit_their_head(self, table):
        rows = table.rows()
        assert rows and {len(row) for row in rows} == {len(table.head)}

    def test_the_urdf_has_table_2_4(self):
        (table,) = TABULATIONS[2]
        for name, row in zip(TABLE_2_4, table.rows(), strict=True):
            printed, of_urdf = row[4], row[6]
            assert printed == getattr(SPEAR_II, name)
            assert of_urdf is None or of_urdf == pytest.approx(printed, rel=0.03), name

    def test_the_urdf_has_table_5_1(self):
        (table,) = TABULATIONS[5]
        for label, _, printed, of_urdf in table.rows():
            assert of_urdf is None or of_urdf == pytest.approx(printed, rel=1e-9), label


@pytest.mark.parametrize(
    "said",
    [
        {"study": "nowhere.found"},
        {"study": "switch.nothing"},
        {"study": "switch.off_stiffness(1.0"},
        {"given": [1.0]},
        {"criterion": {"nearly": 1.0}},
        {"criterion": {"near": [1.0, 0.1], "below": 1.0}},
        {"plaice": "Section 1"},
    ],
)
def test_what_is_no_statement_is_named(said):
    with pytest.raises(BadValue, match="statement 'leg-mass'"):
        statement_of("leg-mass", {"place": "Section 1", "says": "It is so."} | said)
