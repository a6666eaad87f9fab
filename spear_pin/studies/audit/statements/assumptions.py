"""Assumptions of this package, where the source prints nothing; each statement names the assumptions it uses."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from spear_pin.studies.prose import read


@dataclass(frozen=True)
class Other:
    """An alternative to an assumption.

    Attributes:
        label: label in words.
        given: arguments, as (keyword, value), with which it calls a statement's study.
    """

    label: str
    given: tuple[str, Any]


@dataclass(frozen=True)
class Assumption:
    """A number, or a reading of the text, that the source leaves open.

    An assumption with neither `others` nor `settled` replaces an unknown. A statement that uses it neither agrees nor
    differs.

    Attributes:
        id: name in the code.
        what: what the source leaves open.
        here: the number or reading that replaces it.
        others: alternatives with which a statement that uses it is checked, too.
        settled: why a statement that uses it may be judged all the same.
    """

    id: str
    what: str
    here: str
    others: tuple[Other, ...] = ()
    settled: str = ""

    @property
    def stands_in(self) -> bool:
        """Whether a statement that uses this assumption cannot be judged."""
        return not (self.others or self.settled)


ASSUMPTIONS = tuple(
    Assumption(id, **each | {"others": tuple(Other(**other) for other in each.get("others", ()))})
    for id, each in read("spear_pin.studies.audit", "assumptions.toml").items()
)
