"""`spear report`."""

from __future__ import annotations

import argparse
from typing import TYPE_CHECKING, Any

from spear_pin.cli.arguments import Commands, add_command, add_open, add_out, check_out
from spear_pin.cli.output import align_lines, join_lines
from spear_pin.cli.python_lines import Program
from spear_pin.errors import BadFile

if TYPE_CHECKING:
    from spear_pin.viz.report import Selection

PAGE, FIGURES = "report.html", "report_figures"
FORMATS = ("svg", "pdf", "png")


def add(commands: Commands) -> None:
    """Declare the command and its arguments."""
    example = ("spear report --only 'fig-5.*' --open", "draw the figures of chapter 5, and open the page")
    summary = "recompute the results of the underlying thesis, draw figures"
    parser = add_command(commands, "report", run, summary, example)
    parser.add_argument(
        "--only", nargs="+", default=[], metavar="ID", help="make these parts, such as 'fig-5.*' (default: all)"
    )
    parser.add_argument("--list", action="store_true", help="list the ids of the parts, and do nothing else")
    parser.add_argument("--no-cache", action="store_true", help="compute everything again, and store nothing")
    parser.add_argument(
        "--figures", choices=FORMATS, help=f"write the figures in this format too, into the folder {FIGURES}"
    )
    add_out(parser, PAGE)
    add_open(parser, PAGE)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """Make the report and write its page, or list the ids of its parts."""
    if not arguments.list:
        check_out(arguments)
    from tqdm import tqdm

    from spear_pin.files import atomic
    from spear_pin.viz.report import SVG, make, select, write_figures
    from spear_pin.viz.report.cache import user_cache
    from spear_pin.viz.report.page import MOST_BYTES, render

    selection = select(arguments.only)
    if arguments.list:
        ids = _ids(selection)
        return {"ids": ids, "text": join_lines(ids)}
    formats = tuple(dict.fromkeys((SVG, arguments.figures or SVG)))
    with tqdm(total=len(selection), unit="item", leave=False, disable=None) as bar:

        def began(name: str) -> None:
            bar.set_postfix_str(name, refresh=False)
            bar.update()

        report = make(selection, None if arguments.no_cache else user_cache(), formats, began)
    page = arguments.out / PAGE
    text = render(report).encode()
    if len(text) > MOST_BYTES:
        raise BadFile(page, f"would have {len(text)} bytes, more than {MOST_BYTES}; make fewer parts with --only")
    with atomic(page) as temporary:
        temporary.write_bytes(text)
    files = [str(page)]
    if arguments.figures:
        files += map(str, write_figures(report, arguments.out / FIGURES, arguments.figures))
    failed = report.failures | {
        name: finding.reason for name, finding in report.findings.items() if finding.verdict == "failed"
    }
    counts = report.counts
    rows = [
        ("statements", ", ".join(f"{count} {verdict}" for verdict, count in counts.items() if count)),
        ("figures, tables", f"{len(report.pictures)}, {len(report.rows)}"),
        *((f"failed: {name}", reason) for name, reason in failed.items()),
        ("files", f"{page}" + (f", {len(files) - 1} in {arguments.out / FIGURES}" if arguments.figures else "")),
    ]
    program = Program()
    program.say_functions(select, make, render)
    return {
        "failed": bool(failed),
        "counts": counts,
        "rows": [_row(statement, report.findings[statement.id]) for statement in selection.statements],
        "failures": failed,
        "bytes": len(text),
        "files": files,
        "opened": page,
        "text": align_lines(rows),
        "python": str(program),
    }


def _ids(selection: Selection) -> list[str]:
    groups = (selection.statements, selection.pictures, selection.tabulations, selection.playbacks)
    return list(dict.fromkeys(part.id for group in groups for part in group))


def _row(statement: Any, finding: Any) -> dict[str, Any]:
    return {
        "id": statement.id,
        "place": statement.place,
        "says": statement.says,
        "printed": statement.printed,
        "found": finding.value,
        "unit": statement.unit,
        "verdict": finding.verdict,
        "criterion": statement.criterion.text if statement.criterion else None,
        "reason": finding.reason,
        "others": [{"assumed": case.label, "found": case.value, "holds": case.holds} for case in finding.cases],
        "assumes": statement.assumes,
        "command": statement.command,
    }
