"""The command line as a process: its signals, its streams, its environment."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from tests.slow import slow_but
from tests.wrong_calls.processes import INTERRUPTED

ROOT = Path(__file__).parents[1]
SPEAR = [sys.executable, "-m", "spear_pin"]
NUMBERS = pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM], ids=lambda number: number.name)

ASCII = {"PYTHONIOENCODING": "ascii"}
IMPORTS = (
    *("argparse", "numpy", "numpy.linalg", "pinocchio", "lxml"),
    *("scipy.integrate", "spear_pin.viz.player", "matplotlib.figure"),
)


def heeds_interrupts():
    """What a shell starts in the background ignores them, and so does what that starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def ended(command, folder, **changed):
    """What a process printed, and its status."""
    environment = {**os.environ, "PYTHONPATH": str(ROOT), "TMPDIR": str(folder), **changed}
    return subprocess.run(
        command, capture_output=True, cwd=folder, env=environment, timeout=100, preexec_fn=heeds_interrupts
    )


class TestSignals:
    @NUMBERS
    @pytest.mark.parametrize(
        ("event", "name"),
        [
            ("import", "spear_pin.cli"),
            *(pytest.param("import", name, marks=pytest.mark.slow) for name in IMPORTS),
            *(pytest.param("os.rename", name, marks=pytest.mark.slow) for name in ("hop.npz", "hop.html", "hop.svg")),
        ],
    )
    def test_nothing_is_left_and_nothing_said(self, tmp_path, number, event, name):
        command = [sys.executable, "-c", INTERRUPTED, str(int(number)), event, name, "hop", "--cycles", "1"]
        process = ended(command, tmp_path)
        assert (process.returncode, process.stderr) == (128 + number, b"")
        files = ["hop.npz", "hop.html", "hop.svg"]
        assert process.stdout == b"" or name in files  # figures are printed before pictures are drawn
        assert os.listdir(tmp_path) == []

    def test_one_that_a_library_swallows_comes_again(self, tmp_path):
        script = (
            "import os, signal, spear_pin.cli\n"
            "def main():\n"
            "    try:\n"
            "        os.kill(os.getpid(), signal.SIGTERM)\n"
            "    except BaseException: pass\n"
            "    while True: pass\n"
            "spear_pin.cli.main = main\n"
            "from spear_pin.__main__ import main; main()"
        )
        process = ended([sys.executable, "-c", script], tmp_path)
        assert (process.returncode, process.stderr) == (143, b"")

    def test_what_is_ignored_stays_so(self, tmp_path):
        """As in a background job."""
        script = "import signal, os; signal.signal(signal.SIGINT, signal.SIG_IGN)\n" + INTERRUPTED
        process = ended([sys.executable, "-c", script, "2", "import", "spear_pin.cli", "--version"], tmp_path)
        assert process.returncode == 0 and process.stdout.startswith(b"spear ")


class TestStreams:
    @pytest.mark.parametrize(
        "words", slow_but(["robots", "robots --json", "--help", "hop --help", "--version"], "robots", "--help")
    )
    @pytest.mark.parametrize("to", [">/dev/full", ">&-"])
    def test_what_cannot_be_printed(self, tmp_path, words, to):
        process = ended(["bash", "-c", f'"$@" {to}', "bash", *SPEAR, *words.split()], tmp_path)
        assert process.returncode == 2 and process.stdout == b""
        assert process.stderr.startswith(b"spear: the output cannot be written to stdout: ")
        assert process.stderr.count(b"\n") == 1

    @pytest.mark.parametrize("words", ["robots --json", "--help"])
    def test_what_nobody_reads(self, tmp_path, words):
        """As `spear robots | head -0` does; the status is that of the signal that ends other programs then."""
        process = ended(["bash", "-o", "pipefail", "-c", '"$@" | :', "bash", *SPEAR, *words.split()], tmp_path)
        assert (process.returncode, process.stderr) == (141, b"")

    @pytest.mark.parametrize("to", ["2>/dev/full", "2>&-"])
    def test_what_cannot_be_complained_about(self, tmp_path, to):
        for words, status in (("dynamics spear_iii", 2), ("fly", 2), ("--version", 0)):
            process = ended(["bash", "-c", f'"$@" {to}', "bash", *SPEAR, *words.split()], tmp_path)
            assert process.returncode == status and process.stderr == b""
            assert bool(process.stdout) == (status == 0)  # an error is no result

    @pytest.mark.slow
    def test_a_file_does_not_take_the_place_of_a_closed_stream(self, tmp_path):
        process = ended(["bash", "-c", '"$@" >&- 2>&- <&-', "bash", *SPEAR, "push-test"], tmp_path)
        assert process.returncode == 2
        assert (tmp_path / "push_test.html").read_text().rstrip().endswith("</html>")


class TestEnvironment:
    @pytest.mark.parametrize(
        "changed",
        slow_but([ASCII, {"LC_ALL": "C", "PYTHONUTF8": "0"}], ASCII),
        ids=str,
    )
    def test_letters_that_the_terminal_does_not_have(self, tmp_path, changed):
        shown = ended([*SPEAR, "push-test", "--help"], tmp_path, **changed)
        assert shown.returncode == 0 and rb"N\xb7m/RAD" in shown.stdout
        refused = ended([*SPEAR, "dynamics", "Fußgänger"], tmp_path, **changed)
        assert refused.returncode == 2 and refused.stderr.startswith(b"spear: unknown robot 'Fu\\")
        data = ended([*SPEAR, "robots", "--json"], tmp_path, **changed)
        assert json.loads(data.stdout)["robots"]

    @pytest.mark.slow
    @pytest.mark.parametrize("changed", [{"MPLBACKEND": "nope"}, {"SOURCE_DATE_EPOCH": "abc"}], ids=str)
    def test_what_figures_in_files_have_no_use_for(self, tmp_path, changed):
        process = ended([*SPEAR, "push-test", "--json"], tmp_path, **changed)
        assert process.returncode == 0 and process.stderr == b""
        assert len(json.loads(process.stdout)["files"]) == 3
