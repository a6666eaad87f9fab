"""The table of names that have more than one number."""

import math
import tempfile
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

CLOSE, NOTHING = 1e-6, 1e-9  # relative, absolute


@dataclass
class Table:
    """What is said of one subject, by name.

    Attributes:
        values: by name, where it is said, the number, and how far off it may be for it was rounded in print.
    """

    values: dict[str, list[tuple[str, float, float]]] = field(default_factory=dict)

    def add(self, source: str, values: Mapping[str, float] | Iterable[tuple[str, float]], off: float = 0.0) -> None:
        """Take numbers in from a source."""
        for name, value in values.items() if isinstance(values, Mapping) else values:
            if math.isfinite(value):
                self.values.setdefault(name, []).append((source, float(value), off))

    def rounded(self, source: str, name: str, value: float, off: float) -> None:
        """Take a rounded number in, if there are others of its name."""
        if name in self.values:
            self.values[name].append((source, value, off))

    @property
    def shared(self) -> list[str]:
        """Names that more than one source says."""
        return sorted(name for name, said in self.values.items() if len({source for source, *_ in said}) > 1)

    @property
    def apart(self) -> list[str]:
        """Names under which two numbers are not the same."""
        return [name for name in self.shared if not _same(self.values[name])]


def _same(said: Sequence[tuple[str, float, float]]) -> bool:
    exact = [value for _, value, off in said if not off]
    if not exact:
        return True
    size = max(map(abs, exact))
    if max(exact) - min(exact) > max(CLOSE * size, NOTHING):
        return False
    return all(abs(value - exact[0]) <= off * (1.0 + 1e-9) + CLOSE * size for _, value, off in said if off)


def main(words: Sequence[str]) -> int:
    """Compare the subjects that are named, or all; 1 where a name has two numbers."""
    from tests.names.subjects import SUBJECTS

    chosen = words or list(SUBJECTS)
    if unknown := [word for word in chosen if word not in SUBJECTS]:
        print(f"unknown subject {unknown[0]!r}; there are {', '.join(SUBJECTS)}")
        return 2
    return max(_compared(name, SUBJECTS[name]) for name in chosen)


def _compared(name: str, fill: Callable[[Table, Path], None]) -> int:
    table = Table()
    with tempfile.TemporaryDirectory() as folder:
        fill(table, Path(folder))
    sources = {source for said in table.values.values() for source, *_ in said}
    print(f"{name}: {len(table.shared)} names of {len(table.values)} are said by two or more of {len(sources)} sources")
    for each in table.apart:
        print(f"  {each}")
        for source, value, _ in table.values[each]:
            print(f"    {value:<24.15g} {source}")
    return int(bool(table.apart))
