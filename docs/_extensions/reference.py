"""Pages of reference made from the code: the commands of `spear` and the measures of a cycle.

sphinx-argparse and sphinxcontrib-autoprogram leave out the units of options, or their groups and defaults.
"""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterable
from functools import partial
from itertools import groupby
from pathlib import Path
from typing import Any, NamedTuple

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from spear_pin import cli
from spear_pin.cli.arguments import Parser
from spear_pin.gaits.measures import catalogue

COMMON = ("--help", "--json")  # options of every command, which the page names in its text
DEFAULT = re.compile(r" *\(default: ((?:[^()]|\([^()]*\))*)\)|(?:^|; )default: (.*)$")
WIDTH = 90  # of the usage, in characters
UNTITLED = ("positional arguments", "options")
UNSAID = (None, False, [], argparse.SUPPRESS)  # defaults that say nothing


class Option(NamedTuple):
    """An option or an argument of a command.

    Attributes:
        usage: how it is written.
        text: the sentence of the help, without the default.
        default: the default, "required", or nothing.
    """

    usage: str
    text: str
    default: str


def parsers() -> dict[str, Parser]:
    """The parser of each command by its name, in the order of the help."""
    return dict(subparsers(cli._parser()).choices)


def subparsers(parser: Parser) -> Any:
    """The action of a parser that holds the parsers of its commands."""
    return next(action for action in parser._actions if isinstance(action, argparse._SubParsersAction))


def groups() -> dict[str, list[str]]:
    """Names of the commands by the heading of their group in the help; without groups, all under an empty heading."""
    commands = subparsers(cli._parser())
    return getattr(commands, "groups", {"": list(commands.choices)})


def summaries() -> dict[str, str]:
    """The sentence of each command in the help of `spear`."""
    return {action.dest: action.help or "" for action in subparsers(cli._parser())._get_subactions()}


def usage(parser: Parser) -> str:
    """How a command is called."""
    parser.formatter_class = partial(parser.formatter_class, width=WIDTH)  # type: ignore[assignment]
    lines = parser.format_usage().rstrip().splitlines()
    return "\n".join(line[len("usage: ") :] for line in lines)


def described(parser: Parser) -> list[nodes.Element]:
    """What a command does, as paragraphs; lines that are indented are code."""
    made: list[nodes.Element] = []
    for block in (parser.description or "").split("\n\n"):
        for is_code, lines in groupby(block.splitlines(), key=lambda line: line.startswith(" ")):
            text = "\n".join(line.strip() for line in lines)
            made.append(program(text) if is_code else nodes.paragraph("", "", *inline(sentence(text))))
    return made


def program(text: str) -> nodes.literal_block:
    """Lines of a terminal."""
    return nodes.literal_block(text, text, language="none")


class Group(NamedTuple):
    """Options of a command that stand together in its help.

    Attributes:
        title: the heading; empty for those without one.
        text: what it says below its heading.
        options: the options.
    """

    title: str
    text: str
    options: list[Option]


def options(parser: Parser) -> list[Group]:
    """Arguments and options of a command in the order of its help."""
    parser.format_help()  # which may put groups in order
    formatter = parser._get_formatter()
    found = []
    for group in parser._action_groups:
        shown = [each for each in group._group_actions if each.help != argparse.SUPPRESS]
        members = [option_of(each, formatter) for each in shown if not {*COMMON} & {*each.option_strings}]
        if members:
            title = "" if group.title in UNTITLED else group.title or ""
            found.append(Group(title, group.description or "", members))
    return found


def option_of(action: argparse.Action, formatter: argparse.HelpFormatter) -> Option:
    """What the help says of an argument or an option."""
    written = formatter._format_action_invocation(action)
    text = formatter._expand_help(action) if action.help else ""
    said = DEFAULT.search(text)
    if said:
        return Option(written, DEFAULT.sub("", text, count=1), said[1] or said[2])
    if action.required:
        return Option(written, text, "required")
    return Option(written, text, "" if action.default in UNSAID else str(action.default))


def inline(text: str) -> list[nodes.Node]:
    """A line of text; what stands in backquotes is code."""
    parts = text.split("`")
    return [nodes.literal(part, part) if n % 2 else nodes.Text(part) for n, part in enumerate(parts) if part]


def sentence(text: str) -> str:
    """A text of the help as a sentence."""
    first = text[:1].upper() if text[1:2].islower() or text[1:2] == " " else text[:1]
    return f"{first}{text[1:]}".rstrip(".") + "."


def table(heads: tuple[str, ...], rows: Iterable[tuple[list[nodes.Node], ...]], widths: tuple[int, ...]) -> nodes.table:
    """A table of rows of cells."""

    def row(cells: Iterable[list[nodes.Node]]) -> nodes.row:
        return nodes.row("", *(nodes.entry("", nodes.paragraph("", "", *cell)) for cell in cells))

    group = nodes.tgroup("", *(nodes.colspec(colwidth=width) for width in widths), cols=len(heads))
    group += nodes.thead("", row([nodes.Text(head)] for head in heads))
    group += nodes.tbody("", *map(row, rows))
    return nodes.table("", group, classes=["colwidths-given"])


class Made(SphinxDirective):
    """What is made anew wherever the modules that it is made from have changed."""

    def note(self, *modules: Any) -> None:
        """Make the page anew where these modules, or what is beside them, changes."""
        for module in modules:
            for path in Path(module.__file__).parent.glob("*.py"):
                self.env.note_dependency(str(path))

    def section(self, title: list[nodes.Node], name: str) -> nodes.section:
        """A section with an address of its own, such as commands.md#spear-hop."""
        address = nodes.make_id(name)
        found = nodes.section("", nodes.title("", "", *title), ids=[address], names=[address])
        self.state.document.note_explicit_target(found)
        return found


class Commands(Made):
    """The commands of `spear`: a table of all, and a section for each with usage and options."""

    def run(self) -> list[nodes.Node]:
        """The sections."""
        self.note(cli)
        every, says = parsers(), summaries()
        found: list[nodes.Node] = []
        for title, names in groups().items():
            parts = [self.overview(names, says), *(self.command(name, every[name]) for name in names)]
            if title:
                found.append(self.section([nodes.Text(sentence(title).rstrip("."))], f"group {title}"))
                found[-1].extend(parts)
            else:
                found += parts
        return found

    @staticmethod
    def overview(names: list[str], says: dict[str, str]) -> nodes.table:
        """The commands of a group, each with its sentence and a link to its section."""
        rows = (([linked(name)], inline(sentence(says[name]))) for name in names)
        return table(("Command", "What it does"), rows, (25, 75))

    def command(self, name: str, parser: Parser) -> nodes.section:
        """The section of a command."""
        title = f"spear {name}"
        made = self.section([nodes.literal(title, title)], title)
        says, *more = described(parser)
        made += [says, program(usage(parser)), *more]
        for group in options(parser):
            if group.title:
                made += nodes.rubric("", "", *inline(sentence(group.title).rstrip(".")))
            if group.text:
                made += nodes.paragraph("", "", *inline(sentence(group.text)))
            rows = ((code(each.usage), inline(each.text), inline(each.default)) for each in group.options)
            head = "Option" if group.options[0].usage.startswith("-") else "Argument"
            made += table((head, "Meaning", "Default"), rows, (32, 50, 18))
        return made


class Measures(Made):
    """The catalogue of measures as a table, and how to read it."""

    def run(self) -> list[nodes.Node]:
        """The table and the text of the module."""
        self.note(catalogue)
        rows = ((code(each.pattern), inline(each.unit), inline(each.text)) for each in catalogue.CATALOGUE)
        return [table(("Measure", "Unit", "Meaning"), rows, (30, 12, 58))]


def code(text: str) -> list[nodes.Node]:
    """A text as code."""
    return [nodes.literal(text, text)]


def linked(name: str) -> nodes.Node:
    """A command that links to its section."""
    title = f"spear {name}"
    return nodes.reference("", "", nodes.literal(title, title), internal=True, refid=nodes.make_id(title))


def setup(app: Sphinx) -> dict[str, Any]:
    """Register the directives."""
    app.add_directive("commands", Commands)
    app.add_directive("measures", Measures)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
