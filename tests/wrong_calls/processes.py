"""Streams that are closed or full, signals at any moment, environments that are odd: each in a process of its own."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from tests.wrong_calls.case import Process
from tests.wrong_calls.files import record, trajectory

SIGNALS = {"INT": 130, "TERM": 143}
# sends itself a signal when a module begins to be imported, a file gets its name, or a program is started
INTERRUPTED = """
import os, runpy, sys
number, event, name, *sys.argv[1:] = sys.argv[1:]
def watch(what, arguments):
    global event
    if what == event and name in str(arguments[0]):
        event = None
        os.kill(os.getpid(), int(number))
sys.addaudithook(watch)
runpy.run_module("spear_pin", run_name="__main__", alter_sys=True)
"""
HOP = ("hop.npz", "hop.html", "hop.svg")  # in the order in which they are written
PUSH = ("push_test.html", "push_test.npz", "push_test.svg")
BEGUN = ("sweep.zarr.parts", "sweep.zarr.parts/manifest.json")  # a store, for resuming
IMPORTS = (
    *("spear_pin.cli", "argparse", "spear_pin.cli.hop", "numpy", "numpy.linalg", "pinocchio", "lxml"),
    *("scipy.integrate", "spear_pin.studies.hop", "matplotlib.figure", "tqdm"),
)
MOMENTS = (
    *(("import", module, "hop --cycles 1") for module in IMPORTS),
    *(("os.rename", name, "hop --cycles 1") for name in HOP),
    *(("import", module, "bound --cycles 1") for module in ("spear_pin.hybrid.run", "spear_pin.viz.plots.bound")),
    ("os.rename", "bound.html", "bound --cycles 1"),
    *(("os.rename", name, "push-test") for name in PUSH),
    ("os.rename", "lab.csv", "push-test --write-csv lab --repeats 1"),
    ("import", "pandas", "identify lab.csv --volts-per-rad 1"),
    ("import", "casadi", "search"),
    ("import", "heyoka", "sweep hop --over stiffness=47,48"),
    ("import", "zarr", "sweep hop --over stiffness=47,48"),
    ("import", "spear_pin.viz.report", "report --no-cache"),
    ("subprocess.Popen", "bash", "export hop.npz --png"),
    ("os.rename", "hop.png", "export hop.npz --png"),
)
DELAYS = (("hop", (0.3, 1.2, 2.0)), ("export hop.npz --mp4", (1.5, 2.5)), ("search", (3.0,)))
WRITING = (  # each several files, or one
    *(
        "push-test",
        "hop --cycles 1",
        "hop --cycles 1 --save",
        "bound --cycles 1 --save",
        "sensitivity hop --over stiffness",
    ),
    *("export hop.npz --csv", "export hop.npz --mat", "export hop.npz --png --csv"),
)
STREAMS = ("robots", "dynamics q_spear --json", "--help", "hop --help", "--version")
DRAWN_BY = tuple(("MPLBACKEND", value) for value in ("nope", "", "module://nope")) + tuple(
    ("SOURCE_DATE_EPOCH", value) for value in ("abc", "-1", "9" * 30)
)
PRINTED_BY = (
    *(("LC_ALL", value) for value in ("C", "POSIX")),
    *(("PYTHONIOENCODING", value) for value in ("ascii", "ascii:strict", "latin-1")),
    *(("TERM", "dumb"), ("COLUMNS", "x"), ("HOME", "/nowhere")),
)
NO_FOLDER = tuple(
    (name, "/proc/none") for name in ("XDG_CACHE_HOME", "XDG_CONFIG_HOME", "MPLCONFIGDIR", "HOME", "TMPDIR")
)
JUNK = {
    "nothing in it": ": >$kept",
    "junk in it": "echo junk >$kept",
    "JSON of another kind": "echo {} >$kept",
    "half of it": "truncate -s -5 $kept",
    "folders in it": "rm $kept; mkdir $kept",
    "pipes in it": "rm $kept; mkfifo $kept",
    "links that lead nowhere": "ln -sf nowhere $kept",
    "a terabyte": "truncate -s 1T $kept",
}


def cases() -> Iterator[Process]:
    """Every process."""
    yield from streams()
    yield from signals()
    yield from environments()
    yield from disks()


def streams() -> Iterator[Process]:
    """Nobody reads what is printed, or it cannot be written."""
    for line in STREAMS:
        words = tuple(line.split())
        for to in (">/dev/full", ">&-", ">&- 2>/dev/null", ">/dev/full 2>/dev/full", ">&- 2>&- <&-"):
            yield Process(f"spear {line} {to}", words, (2,), f'"$@" {to}')
        for reader in ("| :", "| head -c 0", "| (exec <&-; sleep 0.1)"):
            yield Process(f"spear {line} {reader}", words, (141,), f'"$@" {reader}', lines=0)
        for to in ("2>&-", "2>/dev/full", "<&-"):
            yield Process(f"spear {line} {to}", words, (0,), f'"$@" {to}', lines=0)
    for line in ("dynamics nope", "fly", "hop --cycles x"):
        for to in ("2>&-", "2>/dev/full", "2>&1 >/dev/full"):
            yield Process(f"spear {line} {to}", tuple(line.split()), (2,), f'"$@" {to}')
    yield Process("push-test with all streams closed", ("push-test",), (2,), '"$@" >&- 2>&- <&-', left=PUSH)


def signals() -> Iterator[Process]:
    """At a moment that is given by what the command does just then, and after some time."""
    for signal, status in SIGNALS.items():
        for event, name, line in MOMENTS:
            yield Process(
                f"spear {line}: SIG{signal} at {event} {name}",
                (str(status - 128), event, name, *line.split()),
                (status,),
                lines=0,
                left=BEGUN,
                program=(sys.executable, "-c", INTERRUPTED),
                prepare=_prepared,
            )
        for line, delay in ((line, delay) for line, delays in DELAYS for delay in delays):
            yield Process(
                f"spear {line}: SIG{signal} after {delay} s",
                tuple(line.split()),
                (status,),
                # jobs that bash does not manage would ignore SIGINT
                f'set -m; "$@" & pid=$!; sleep {delay}; kill -{signal} $pid; wait $pid',
                lines=2,  # of CasADi, and of bash
                left=HOP,
                prepare=_prepared,
            )


def environments() -> Iterator[Process]:
    """Variables that libraries trip over, terminals without letters, and a cache with something else in it."""
    for name, value in DRAWN_BY:
        words, heard = ("push-test", "--json"), "push_test.html"
        yield Process(f"{name}={value} spear push-test", words, (0,), environment={name: value}, left=PUSH, heard=heard)
    for name, value in PRINTED_BY:
        given = {name: value, "PYTHONUTF8": "0"}
        for line, heard in (("dynamics spear_ii", "boom_x"), ("push-test --help", "usage: spear push-test")):
            yield Process(f"{name}={value} spear {line}", tuple(line.split()), (0,), environment=given, heard=heard)
        yield Process(f"{name}={value} spear dynamics Fußgänger", ("dynamics", "Fußgänger"), (2,), environment=given)
    for name, value in NO_FOLDER:
        given = {"XDG_CONFIG_HOME": "", name: value}
        yield Process(f"{name}={value} spear push-test", ("push-test",), (0,), environment=given, lines=0, left=PUSH)
    report, page = ("report", "--only", "spring-sign"), ("report.html",)
    yield Process("a cache that is a file", report, (0,), 'touch .cache; "$@"', lines=3, left=page)
    for what, line in JUNK.items():
        spoilt = f'"$@" >/dev/null && for kept in .cache/spear_pin/*; do {line}; done; "$@"'
        yield Process(f"a cache with {what}", report, (0,), spoilt, left=page)


def disks() -> Iterator[Process]:
    """No room for a file, or a folder in its place: nothing is left but what was there."""
    for line in WRITING:
        words = tuple(line.split())
        for kilobytes in (0, 1, 8):
            name = f"spear {line} with room for {kilobytes} kB"
            limited = f'ulimit -f {kilobytes}; "$@"'
            yield Process(name, words, (2,), limited, heard="cannot be written", prepare=_prepared)
        yield Process(f"spear {line} in a folder of folders", words, (2,), heard="Is a directory", prepare=_in_the_way)


def _in_the_way(folder: Path) -> None:
    """Folders by the names of files that commands write."""
    _prepared(folder)
    for stem in ("push_test", "hop", "bound", "sensitivity", "family"):
        for suffix in (".html", ".svg", ".json", ".csv", ".mat", ".png"):
            (folder / f"{stem}{suffix}").mkdir()


def _prepared(folder: Path) -> None:
    record(folder / "lab.csv")
    trajectory(folder / "hop.npz")
