"""Calls of the command line, and what each prints."""

import json
import subprocess
import sys
from pathlib import Path

from spear_pin.cli import main
from spear_pin.cli.output import IN_PYTHON

ROOT = Path(__file__).parents[2]


def words(value):
    """The name of a test case, from a list of arguments."""
    return " ".join(value) if isinstance(value, (list, tuple)) else ""


def run(capsys, *arguments):
    """Status, stdout and stderr of a command."""
    try:
        status = main([str(argument) for argument in arguments])
    except SystemExit as stop:
        status = stop.code
    return status, *capsys.readouterr()


def printed(capsys, *arguments):
    """The JSON object a command prints."""
    status, out, err = run(capsys, *arguments, "--json")
    assert status == 0, err
    assert out.count("\n") == 1
    return json.loads(out)


def rows(out):
    """Rows of the text of a command, by what they begin with; the Python that follows is left out."""
    lines = out.partition(f"\n\n{IN_PYTHON}\n")[0].splitlines()
    return {line[:21].rstrip(): line[21:] for line in lines}


def refused(capsys, *arguments):
    """The one line of a command that fails."""
    status, out, err = run(capsys, *arguments)
    assert status == 2
    assert out == ""
    assert err.count("\n") == 1 and err.endswith("\n") and len(err) > 20
    assert "Traceback" not in err
    return err


def loads(*arguments):
    """The modules that are loaded once a command is done, in a process of its own."""
    words = [str(argument) for argument in arguments]
    code = f"import sys; from spear_pin.cli import main; main({words}); print(*sys.modules, file=sys.stderr)"
    process = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT)
    return set(process.stderr.split())
