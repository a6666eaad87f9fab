"""A wrong call, how it is made, and the rule that its answer is judged by."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import tempfile
import traceback
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from time import monotonic

from spear_pin.cli import main
from spear_pin.errors import SpearError

ROOT = Path(__file__).parents[2]
LONGEST = 20.0  # s that an answer may take, without waiting for a processor
ENDLESS = 10**9  # bytes of a file that is not read
Prepare = Callable[[Path], object]


@dataclass(frozen=True)
class Answer:
    """What came of a call.

    Attributes:
        status: of the command or process; None: a function returned.
        out: what it printed.
        err: what it complained.
        files: what it left in the folder, by name, that was not there before or had other content.
        problem: what is wrong with it whatever the rule says, or nothing.
    """

    status: int | None
    out: str
    err: str
    files: tuple[str, ...]
    problem: str = ""


@dataclass(frozen=True)
class Command:
    """A command line, run in the harness's process; refused with status 2 and one line, nothing written."""

    words: tuple[str, ...]
    prepare: Prepare = lambda folder: None
    alone = False

    @property
    def name(self) -> str:
        return f"spear {' '.join(word if word and word.isprintable() else ascii(word) for word in self.words)}"

    def answer(self, folder: Path) -> Answer:
        self.prepare(folder)
        before = content(folder)
        with captured() as streams:
            try:
                status = main(self.words)
            except SystemExit as stop:
                status = stop.code
            except Exception:
                traceback.print_exc()
                status = 1
        return Answer(status, *streams, changed(before, content(folder)))

    def verdict(self, answer: Answer) -> str:
        if answer.status != 2:
            return f"status {answer.status} instead of 2"
        if answer.out:
            return "something is printed"
        return _one_line(answer)


@dataclass(frozen=True)
class Function:
    """A call from Python, in the harness's process; it raises a SpearError of one line, and writes nothing."""

    name: str
    call: Callable[[Path], object]
    prepare: Prepare = lambda folder: None
    alone = False

    def answer(self, folder: Path) -> Answer:
        self.prepare(folder)
        before, status, said = content(folder), None, ""
        with captured() as streams:
            try:
                self.call(folder)
            except SpearError as error:
                status, said = 2, f"{error}\n"
            except Exception as error:
                status, said = 1, f"{type(error).__name__}: {error}"
        return Answer(status, streams[0], said + streams[1], changed(before, content(folder)))

    def verdict(self, answer: Answer) -> str:
        if answer.status is None:
            return "it is accepted"
        return _one_line(answer) if answer.status == 2 else "no SpearError"


@dataclass(frozen=True)
class Process:
    """A process of its own, by a line of a shell in which "$@" is the command: streams, signals, environment.

    Attributes:
        name: what is wrong.
        words: of the command.
        statuses: that fit.
        line: of the shell.
        environment: what is different in it.
        lines: on stderr, at most.
        left: names of files that may be left; every one is whole.
        heard: what has to be in stdout or stderr.
        program: what runs the words.
        prepare: makes what the call needs.
    """

    name: str
    words: tuple[str, ...]
    statuses: tuple[int, ...]
    line: str = '"$@"'
    environment: Mapping[str, str] = field(default_factory=dict)
    lines: int = 1
    left: tuple[str, ...] = ()
    heard: str = ""
    program: tuple[str, ...] = (sys.executable, "-m", "spear_pin")
    prepare: Prepare = lambda folder: None
    alone = True

    def answer(self, folder: Path) -> Answer:
        self.prepare(folder)
        before = content(folder)
        with tempfile.TemporaryDirectory() as temporary:
            fresh = {"PYTHONPATH": str(ROOT), "TMPDIR": temporary, "XDG_CACHE_HOME": str(folder / ".cache")}
            shell = ["bash", "-o", "pipefail", "-c", self.line, "bash", *self.program, *self.words]
            process = subprocess.Popen(
                shell,
                stdout=subprocess.PIPE,
                stderr=subprocess.PIPE,
                cwd=folder,
                env={**os.environ, **fresh, **self.environment},
                preexec_fn=heeds_interrupts,
                start_new_session=True,
            )
            try:
                out, err = process.communicate(timeout=LONGEST)
            except subprocess.TimeoutExpired:
                os.killpg(process.pid, signal.SIGKILL)
                out, err = process.communicate()
            problem = f"left in the folder of temporary files: {left}" if (left := os.listdir(temporary)) else ""
        texts = (out.decode(errors="replace"), err.decode(errors="replace"))
        return Answer(process.returncode, *texts, changed(before, content(folder)), problem)

    def verdict(self, answer: Answer) -> str:
        if answer.status not in self.statuses:
            return f"status {answer.status} instead of {' or '.join(map(str, self.statuses))}"
        if "Traceback" in answer.err or answer.err.count("\n") > self.lines:
            return "more is said than is good"
        if self.heard not in answer.out + answer.err:
            return f"nothing about {self.heard!r}"
        return f"left: {', '.join(rest)}" if (rest := set(answer.files) - set(self.left)) else ""


Case = Command | Function | Process


def judged(case: Case) -> tuple[str, float]:
    """What is wrong with the answer to a case, or nothing; and the seconds it took."""
    with tempfile.TemporaryDirectory() as name:
        here, folder = os.getcwd(), Path(name)
        os.chdir(folder)
        begun, waited = monotonic(), _waited()
        try:
            answer = case.answer(folder)
        finally:
            os.chdir(here)
        took = monotonic() - begun - (_waited() - waited)
    problem = answer.problem or case.verdict(answer)
    if not problem and took > LONGEST:
        problem = f"it took {took:.0f} s"
    said = " ".join((answer.err or answer.out).split())
    return (f"{problem}: {said[-160:]}" if problem else ""), took


def _waited() -> float:
    """Seconds that this process has waited for a processor, which others had."""
    return int(Path("/proc/self/schedstat").read_text().split()[1]) / 1e9


def heeds_interrupts() -> None:
    """What a shell starts in the background ignores them, and so does what that starts."""
    signal.signal(signal.SIGINT, signal.SIG_DFL)


def _one_line(answer: Answer) -> str:
    if "Traceback" in answer.err or answer.err.count("\n") != 1 or len(answer.err) < 12:
        return "not one line"
    return f"left: {', '.join(answer.files)}" if answer.files else ""


def content(folder: Path) -> dict[str, bytes | None]:
    """Files by their names, with what is in them; a cache does not count."""
    return {
        path.relative_to(folder).as_posix(): _content(path) if path.is_file() else None
        for path in sorted(folder.rglob("*"))
        if ".cache" not in path.parts
    }


def _content(path: Path) -> bytes:
    """What is in a file, or of what has no end how much."""
    size = path.stat().st_size
    return path.read_bytes() if size < ENDLESS else str(size).encode()


def changed(before: Mapping[str, bytes | None], after: Mapping[str, bytes | None]) -> tuple[str, ...]:
    """Names of what is new, gone or different."""
    return tuple(name for name in {**before, **after} if before.get(name, 0) != after.get(name, 0))


@contextmanager
def captured() -> Iterator[list[str]]:
    """What is written to stdout and stderr, by libraries too."""
    texts: list[str] = []
    kept = [os.dup(number) for number in (1, 2)]
    files = [tempfile.TemporaryFile() for _ in kept]
    streams = sys.stdout, sys.stderr
    try:
        for number, file in enumerate(files, 1):
            os.dup2(file.fileno(), number)
        sys.stdout, sys.stderr = (
            os.fdopen(os.dup(number), "w", encoding="utf-8", errors="backslashreplace") for number in (1, 2)
        )
        yield texts
    finally:
        for stream in (sys.stdout, sys.stderr):
            stream.close()
        sys.stdout, sys.stderr = streams
        for number, (old, file) in enumerate(zip(kept, files, strict=True), 1):
            os.dup2(old, number)
            os.close(old)
            file.seek(0)
            texts.append(file.read().decode(errors="replace"))
            file.close()
