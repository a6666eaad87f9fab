"""Views of a subject, each a function of its knobs and an engine."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from spear_pin.studies.explore import hops
from spear_pin.studies.explore.carried import carry_gait
from spear_pin.studies.explore.engines import Engine
from spear_pin.studies.explore.knobs import Knobs, Subject
from spear_pin.studies.explore.motion import Motion

View = Callable[[Knobs, Engine], Motion]
OF_A_HOP: Mapping[str, View] = MappingProxyType({"settled": hops.settle_hops, "transient": hops.transient})
OF_A_GAIT: Mapping[str, View] = MappingProxyType({"cycle": lambda knobs, engine: carry_gait(knobs)})


def views_of(subject: Subject) -> Mapping[str, View]:
    """Returns views by name; the first is shown at the beginning."""
    return OF_A_HOP if subject.kind == "hop" else OF_A_GAIT
