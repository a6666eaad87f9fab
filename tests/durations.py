"""Records the processor time of the tests, folder by folder, and compares it with the budgets in `budgets.toml`.

Processor time, of a test and of what it starts, stays the same on a busy machine; wall time does not. Each run prints
its folders, those that take most first. `--durations-json FILE` writes every folder and file. `--budgets NAME` fails
where a folder takes more than its budget of that name, and starts with the files that take longest. One machine takes
more than twice the processor time of another; so budgets are multiplied by how much slower it is, by all folders
together.
"""

import json
import resource
import tomllib
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
BUDGETS = Path(__file__).with_name("budgets.toml")
SHOWN = 0.5  # s: folders that take less are not printed
MARGIN, ALWAYS = 2.0, 30.0  # times the measured seconds, and seconds more, are allowed
SLOWEST = 3.0  # times a quiet machine's seconds that a slow one may take


def processor_time() -> float:
    """Seconds of a processor that this process, and those it has waited for, took so far."""
    usages = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(usage.ru_utime + usage.ru_stime for usage in usages)


class Durations:
    """A plugin that measures in each process, and adds up where the results come together."""

    def __init__(self, target: Path | None, budgets: str | None):
        self.target = target
        self.budgets = tomllib.loads(BUDGETS.read_text(encoding="utf-8"))[budgets] if budgets else None
        self.last = processor_time()
        self.files: Counter[str] = Counter()
        self.tests: Counter[str] = Counter()
        self.slowest: Counter[str] = Counter()

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self):
        """Gives the report of a phase (setup, call, teardown) what has passed since the last one."""
        report = yield
        now = processor_time()
        report.processor_time, self.last = now - self.last, now
        return report

    def pytest_runtest_logreport(self, report):
        """Adds a phase to its file."""
        file = report.nodeid.partition("::")[0]
        self.files[file] += getattr(report, "processor_time", 0.0)
        self.slowest[report.nodeid] += getattr(report, "processor_time", 0.0)
        self.tests[file] += report.when == "call"

    def folders(self) -> Counter[str]:
        """Seconds of a processor by folder."""
        folders: Counter[str] = Counter()
        for file, seconds in self.files.items():
            folders[str(Path(file).parent)] += seconds
        return folders

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items):
        """Puts the files that take longest first, so that no processor waits for the last of them."""
        if self.budgets:
            places = {file: place for place, file in enumerate(self.budgets["first"])}
            items.sort(key=lambda item: places.get(item.nodeid.partition("::")[0], len(places)))

    def exceeded(self) -> list[str]:
        """Says which folders take more than their budgets, or have none."""
        if self.budgets is None:
            return []
        measured, taken = self.budgets["seconds"], self.folders()
        known = taken.keys() & measured.keys()
        slower = sum(taken[folder] for folder in known) / max(sum(measured[folder] for folder in known), 1)
        slower = min(max(slower, 1.0), SLOWEST)
        allowed = {folder: slower * MARGIN * seconds + ALWAYS for folder, seconds in measured.items()}
        return [
            f"{folder} took {seconds:.0f} s of a processor, its budget is {allowed.get(folder, 0.0):.0f} s"
            f" on a machine {slower:.2g} times slower than a quiet one ({BUDGETS.name})"
            for folder, seconds in taken.items()
            if seconds > allowed.get(folder, 0.0)
        ]

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session):
        """Fails a run in which all tests passed, but took too long."""
        if self.exceeded() and session.exitstatus == pytest.ExitCode.OK and not hasattr(session.config, "workerinput"):
            session.exitstatus = pytest.ExitCode.TESTS_FAILED

    def pytest_terminal_summary(self, terminalreporter):
        """Prints the folders, and writes all of them with their files where that is asked for."""
        for each in self.exceeded():
            terminalreporter.write_line(f"TOO LONG: {each}")
        folders = self.folders()
        most = "; ".join(f"{folder} {seconds:.0f} s" for folder, seconds in folders.most_common() if seconds > SHOWN)
        terminalreporter.write_line(f"processor time {sum(folders.values()):.0f} s: {most}")
        if self.target is not None:
            kept = {
                "folders": _rounded(folders),
                "files": _rounded(self.files),
                "tests": {test: seconds for test, seconds in _rounded(self.slowest).items() if seconds > 0.5},
                "counts": dict(sorted(self.tests.items())),
            }
            self.target.write_text(json.dumps(kept, indent=1) + "\n", encoding="utf-8")


def _rounded(seconds: Counter[str]) -> dict[str, float]:
    return {name: round(value, 2) for name, value in seconds.most_common()}
