"""`spear --help` and the help of each command: groups, one screen, plain words, and examples that can be typed."""

import re
import shlex

import pytest

from spear_pin.cli import COMMANDS, _parser
from spear_pin.cli.arguments import commands_of
from tests.cli.calls import run

GROUPS = {
    "robot": ["robots", "dynamics"],
    "gait": ["hop", "bound", "trot", "turn", "search"],
    "study": ["measures", "compare", "sweep", "family", "sensitivity", "uncertainty", "design", "payoff", "references"],
    "lab": ["push-test", "identify", "fit", "replay"],
    "look": ["explore", "export", "report"],
    "set-up": ["doctor", "completion"],
}
NAMES = [name for names in GROUPS.values() for name in names]
RIDDLES = re.compile(r"\b(led|told|held|beside|of each|which is|from cold|apart by|as of)\b")
# options whose values are of another kind from command to command
OTHER = {
    *("--over", "--keep", "--speed", "--noise", "--stiffness", "--damping", "--coulomb", "--rest-angle"),
    *("--knee-motor", "--hip-motor", "--column", "--unit", "--window"),
}


def commands():
    return commands_of(_parser())


def options(name):
    """Options of a command and how their values are called, as its help lists them."""
    parser = commands().choices[name]
    parser.format_help()
    groups = parser._action_groups
    return {option: each.metavar for group in groups for each in group._group_actions for option in each.option_strings}


class TestOfAllCommands:
    def test_groups(self, capsys):
        _, out, _ = run(capsys, "--help")
        found = {}
        for line in out.splitlines():
            if heading := re.fullmatch(r"([\w-]+): .+", line):
                last = found.setdefault(heading[1], [])
            elif name := re.match(r" {2}(\w[\w-]*)  +[a-z]", line):
                last.append(name[1])
        assert {name: each for name, each in found.items() if name in GROUPS} == GROUPS

    def test_groups_are_data(self):
        assert {heading.partition(":")[0]: names for heading, names in commands().groups.items()} == GROUPS
        assert list(commands().groups) == list(COMMANDS) and list(commands().choices) == NAMES

    def test_fits_one_screen(self, capsys, monkeypatch):
        monkeypatch.setenv("COLUMNS", "80")
        lines = run(capsys, "--help")[1].splitlines()
        assert len(lines) <= 43 and max(map(len, lines)) <= 80
        assert lines[0].startswith("usage: spear") and {"-h,", "--version"} <= {line.split()[0] for line in lines[-2:]}

    def test_without_a_command(self, capsys):
        _, shown, _ = run(capsys, "--help")
        assert run(capsys) == (2, "", shown)


@pytest.mark.parametrize("name", NAMES)
class TestOfACommand:
    def test_begins_with_a_sentence_and_an_example(self, capsys, monkeypatch, name):
        monkeypatch.setenv("COLUMNS", "80")
        status, out, err = run(capsys, name, "--help")
        assert (status, err) == (0, "")
        usage, sentence, example = out.split("\n\n")[:3]
        assert usage.startswith(f"usage: spear {name} ") and usage.endswith("[options]")
        assert len(usage.splitlines()) <= 2
        said = next(each.help for each in commands()._get_subactions() if each.dest == name)
        assert " ".join(sentence.split()).startswith(f"{said[0].upper()}{said[1:]}.")
        assert example.startswith("Example: ") and example.splitlines()[-1].startswith("  ")

    def test_its_example_can_be_typed(self, name):
        parser = commands().choices[name]
        line = parser.description.splitlines()[-1].strip()
        words = shlex.split(re.sub(r'^eval "\$\((.*)\)"$', r"\1", line))
        assert words[:2] == ["spear", name]
        found, unknown = _parser().parse_known_args(words[1:])
        assert found.command == name and unknown == []

    def test_has_no_riddles(self, name):
        parser = commands().choices[name]
        for action in parser._actions:
            assert action.help and not RIDDLES.search(action.help), action.option_strings
            assert not re.match(r"(of|by|that|its|in|whose)\b", action.help), action.help

    def test_ends_with_the_options_of_its_output(self, name):
        kept = [option for option in options(name) if option in ("--json", "--save", "--out", "--open")]
        assert list(options(name))[-len(kept) :] == kept
        assert kept == [option for option in ("--json", "--save", "--out", "--open") if option in kept]


def test_an_option_takes_the_same_in_all_commands():
    kinds = {}
    for name in NAMES:
        for option, metavar in options(name).items():
            kinds.setdefault(option, {}).setdefault(metavar, []).append(name)
    assert {option: each for option, each in kinds.items() if len(each) > 1 and option not in OTHER} == {}


def test_a_gait_is_an_argument_or_an_option():
    both = [_parser().parse_args(words).gait for words in (["bound", "slow"], ["bound", "--gait", "slow"], ["bound"])]
    assert both == ["slow", "slow", None]


@pytest.mark.parametrize(
    ("name", "new", "old"), [("compare", "--gait", "--of"), ("search", "--minimize", "--objective")]
)
def test_an_option_keeps_the_name_that_it_had(name, new, old):
    calls = [_parser().parse_args([name, option, "hip"]) for option in (new, old)]
    assert [(call.of if name == "compare" else call.objective) for call in calls] == ["hip", "hip"]


def test_names_stand_apart_or_between_commas():
    apart, between = (["a", "b"], ["a,b"])
    calls = [_parser().parse_args(["identify", "lab.csv", "--vary", *words]) for words in (apart, between)]
    assert [sum(call.vary, []) for call in calls] == [["a", "b"]] * 2
