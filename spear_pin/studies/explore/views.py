"""Views of a subject, each a function of its knobs and an engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from spear_pin.studies.explore import bounds, hops
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knobs, Subject
from spear_pin.studies.explore.motion import Motion

View = Callable[[Knobs, Engine], Motion]
VIEWS: Mapping[str, Mapping[str, View]] = MappingProxyType({"hop": hops.VIEWS, "bound": bounds.VIEWS})


def views_of(subject: Subject) -> Mapping[str, View]:
    """Returns views by name; the first is shown at the beginning."""
    return VIEWS[subject.kind]
