"""`spear references`."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import Any

from spear_pin.cli.arguments import Commands, add_command, check_folder, folder
from spear_pin.cli.output import join_lines
from spear_pin.errors import BadFile
from spear_pin.files import parse_json, read_bytes, write_text

SHIPPED = Path(__file__).parents[1] / "references"
LISTED = "*.json", "check.py", "README.md"


def add(commands: Commands) -> None:
    """Declare the command."""
    example = ("spear references --out .", "write the problems, with what checks answers and needs NumPy only")
    summary = "list motions known to 1e-9, or check a simulator's answers"
    parser = add_command(commands, "references", run, summary, example)
    parser.add_argument("answers", nargs="?", metavar="FILE", help="check a simulator's answers in this file (.json)")
    help_out = "write the problems, README.md and check.py into this folder"
    parser.output.add_argument("--out", type=folder, metavar="DIR", help=help_out)


def run(arguments: argparse.Namespace) -> dict[str, Any]:
    """List or write the problems, or check answers."""
    from spear_pin.references import check

    if arguments.out is not None:
        check_folder(arguments.out, str(arguments.out), "an existing folder")
    references = check.read(SHIPPED)
    if arguments.answers is None:
        wide = max(map(len, references))
        rows = {name: each["words"] for name, each in references.items()}
        result: dict[str, Any] = {"problems": rows}
        lines = [f"{name:<{wide}}  {words}" for name, words in rows.items()]
    else:
        found = list(check.lines(references, _answers(arguments.answers, references)))
        wrong = sum(not fine for fine, _ in found)
        lines = [line for _, line in found]
        result = {"checked": lines} | ({"lost": f"{wrong} of the problems have another answer"} if wrong else {})
    written = []
    if arguments.out is not None:
        for path in sorted(each for pattern in LISTED for each in SHIPPED.glob(pattern)):
            written.append(str(write_text(arguments.out / path.name, path.read_text(encoding="utf-8"))))
        lines += ["", f"wrote {len(written)} files into {arguments.out}"]
        result["files"] = written
    return {**result, "text": join_lines(lines)}


def _answers(path: str, references: dict[str, Any]) -> Any:
    """Read and check a file of answers."""
    from spear_pin.references.check import refuse_others

    try:
        answers = parse_json(read_bytes(path).decode())
        refuse_others(references, answers)
    except ValueError as error:
        raise BadFile(path, f"expected answers, as README.md beside the references describes them: {error}") from None
    return answers
