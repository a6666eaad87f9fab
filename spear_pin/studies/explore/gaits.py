"""Any gait whose numbers a user changes, in the plane or in space, of systems of one's own as well."""

from __future__ import annotations

from collections.abc import Sequence

from spear_pin.errors import require
from spear_pin.gaits.feedback import without_feedback
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.parameters import nonzero, number, numbers_of_law, unit
from spear_pin.kinds import typed
from spear_pin.model.springs import numbers_of_springs
from spear_pin.studies.explore.carried import Carried
from spear_pin.studies.explore.knobs import Knob, about


@typed
def gait_to_explore(gait: Gait, title: str, over: Sequence[str] = (), source: str = "gait.json") -> Carried:
    """Returns a gait whose numbers a user can change, from a half to one and a half times what they are.

    Args:
        gait: a gait; its event feedback is left out.
        title: title of the page.
        over: numbers to change, by the names that `Gait.sensitivity` takes; by default those of springs with their
            switches and paths, ground and law.
        source: name or path of the gait, from which a saved program loads it.

    Raises:
        UnknownName: nothing has a number of a name.
        BadValue: a number is zero, which has no range about it.
    """
    system = (gait := without_feedback(gait)).system
    names = over or nonzero(
        system, dict.fromkeys((*numbers_of_springs(system.springs), "friction", *numbers_of_law(system)))
    )
    return Carried("gait", gait, {name: _knob(gait, name) for name in names}, title, source=source)


def _knob(gait: Gait, name: str) -> Knob:
    value = number(gait.system, name)
    require(name, value, bool, "a number other than zero, which has a range about it")
    return about(name.replace("_", " ").capitalize(), unit(gait.system, name), value, "of the gait", 0.5, 1.5)
