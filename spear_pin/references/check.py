"""Compares a simulator's answers with the references. Needs NumPy only, and this file may be copied beside them.

python check.py ANSWERS.json [FOLDER]   FOLDER has the references, by default that of this file

ANSWERS.json is {"leg_hops": [{"event": "touchdown", "foot": "toe", "time_s": 0.1978, "position": [...],
"velocity": [...]}, ...], ...}: for each problem its events as in the reference's "answer", with all or some of the
numbers "time_s", "position", "velocity" and "energy_J". The n-th touchdown of a foot is compared with the n-th of it,
and so are other events; those that an answer leaves out are listed. It prints a line for each problem.
"""

from __future__ import annotations

import json
import sys
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

LONGEST, SAID = 60, 4  # characters of a name; events of a problem that a line names
QUANTITIES = "time_s", "position", "velocity", "energy_J"


@dataclass(frozen=True)
class Difference:
    """A number of an answer beside the reference's.

    Attributes:
        quantity: one of `QUANTITIES`.
        place: the event, and the coordinate.
        answer: the number.
        reference: the reference's.
        bound: error bound of the reference.
    """

    quantity: str
    place: str
    answer: float
    reference: float
    bound: float

    @property
    def off(self) -> float:
        """How far the answer is from the reference."""
        away = abs(self.answer - self.reference)
        return away if away == away else float("inf")  # NaN is infinitely far

    def __str__(self) -> str:
        times = self.off / self.bound
        return (
            f"{self.quantity} of {self.place} is {self.answer:.9g}, not {self.reference:.9g} ({times:.2g} bounds off)"
        )


def name_events(events: Sequence[Mapping[str, Any]]) -> dict[str, Mapping[str, Any]]:
    """Returns events by names such as "touchdown of toe 2"."""
    found: dict[str, Mapping[str, Any]] = {}
    counts: Counter[str] = Counter()
    for event in events:
        name = event["event"] + (f" of {event['foot']}" if event.get("foot") else "")
        counts[name] += 1
        found[f"{name} {counts[name]}"] = event
    return found


def compare(reference: Mapping[str, Any], events: Sequence[Mapping[str, Any]]) -> tuple[list[Difference], list[str]]:
    """Compares an answer with its reference.

    Args:
        reference: the content of a problem's file.
        events: the answer's events.

    Returns:
        every number that the answer has, and the names of events that it lacks, or that are not in the reference.
    """
    bounds, coordinates = reference["answer"]["bounds"], reference["robot"]["coordinates"]
    right, given = name_events(reference["answer"]["events"]), name_events(events)
    places = {"time_s": [""], "energy_J": ["kinetic", "potential"], "position": coordinates, "velocity": coordinates}
    found = []
    for name in right.keys() & given.keys():
        for quantity in (each for each in QUANTITIES if each in given[name]):
            pair = (np.atleast_1d(np.array(event[quantity], dtype=float)) for event in (given[name], right[name]))
            for place, answer, number in zip(places[quantity], *(part.tolist() for part in pair), strict=True):
                where = f"{name}: {place}" if place else name
                found.append(Difference(quantity, where, answer, number, bounds[quantity]))
    found.sort(key=lambda each: each.off / each.bound, reverse=True)
    missing = [f"no {name}" for name in right if name not in given]
    return found, [*missing, *(f"{name} is no event of it" for name in given if name not in right)]


def refuse_others(references: Mapping[str, Any], answers: Any) -> None:
    """Refuses what are no answers.

    Raises:
        ValueError: they are none; the text names the place.
    """
    if not isinstance(answers, dict):
        raise ValueError("not an object with the events of each problem by its name")
    for name, events in answers.items():
        if not isinstance(events, list):
            raise ValueError(f"{name[:LONGEST]!r} is not a list of events")
        for i, event in enumerate(events):
            if not isinstance(event, dict) or not _is_name(event.get("event")) or not _is_name(event.get("foot", "")):
                raise ValueError(f'event {i} of {name[:LONGEST]!r} is not an object whose "event" and "foot" are names')
            count = {"time_s": 1, "energy_J": 2}
            for quantity in (each for each in QUANTITIES if each in event):
                n = count.get(quantity, len(references[name]["robot"]["coordinates"]) if name in references else 0)
                numbers = event[quantity] if isinstance(event[quantity], list) else [event[quantity]]
                if not all(isinstance(each, (int, float)) for each in numbers) or (n and len(numbers) != n):
                    raise ValueError(f"{quantity} of event {i} of {name[:LONGEST]!r} is not {n} number{'s'[: n != 1]}")


def _is_name(value: Any) -> bool:
    return isinstance(value, str) and value.isprintable() and len(value) <= LONGEST


def lines(references: Mapping[str, Any], answers: Mapping[str, Any]) -> Iterator[tuple[bool, str]]:
    """Returns whether each problem's answer is within the bounds, and a line that says so, or what is wrong."""
    for name, reference in references.items():
        if name not in answers:
            yield True, f"{name}: no answer"
            continue
        differences, others = compare(reference, answers[name])
        wrong = [each for each in differences if each.off > each.bound]
        if not differences and not others:
            yield False, f"{name}: no numbers"
        elif not wrong and not others:
            yield True, f"{name}: ok, {len(differences)} numbers within their bounds"
        else:
            said = [*map(str, wrong[:1]), *others[:SAID]] + [f"{len(others) - SAID} more"] * (len(others) > SAID)
            yield False, f"{name}: OFF, {len(wrong)} of {len(differences)} numbers; {'; '.join(said)}"
    for name in answers.keys() - references.keys():
        yield False, f"{name[:LONGEST]!a}: no problem of this name"


def read(folder: Path) -> dict[str, Any]:
    """Returns the references in a folder by name."""
    found = [json.loads(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.json"))]
    return {each["name"]: each for each in found if isinstance(each, dict) and "answer" in each}


def main(words: Sequence[str]) -> int:
    """Prints the lines; returns 1 if an answer is off."""
    if not 1 <= len(words) <= 2:
        print(__doc__)
        return 2
    answers = json.loads(Path(words[0]).read_text(encoding="utf-8"))
    references = read(Path(words[1]) if len(words) > 1 else Path(__file__).parent)
    refuse_others(references, answers)
    found = list(lines(references, answers))
    print("\n".join(line for _, line in found))
    return 0 if all(fine for fine, _ in found) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
