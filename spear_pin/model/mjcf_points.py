"""Points of the bodies of an MJCF file that become frames, and so may be toes: sites and geoms."""

from __future__ import annotations

from typing import Any

import numpy as np
from lxml import etree

from spear_pin.model.mjcf_writing import PLACE, Writing

ENDS = ("sphere",)  # types of geoms of which the middle is where a limb may end


def add_point(writing: Writing, element: Any, body: Any, alone: bool) -> None:
    """Writes a site, the middle of a geom, or the farther end of a geom that leads from one point to another.

    Args:
        writing: state; geoms that are no ends of limbs are noted in it.
        element: a site or a geom.
        body: body that is written.
        alone: whether no body hangs on this one, so that a limb ends here; a geom without a name is then called
            after the body.
    """
    said, name = writing.defaults.of(element), element.get("name")
    kind = said.get("type", "sphere")
    ends = element.tag == "geom" and (kind in ENDS or "fromto" in said)
    if "mesh" in said or not (name or (ends and alone)):
        return
    if element.tag == "geom":
        if name in writing.taken:
            return
        name = writing.name(name or f"{body.get('name')}_geom")
    point = etree.SubElement(body, "site", name=name)
    if "fromto" in said:
        one, other = np.reshape(writing.counted(element, said, "fromto"), (2, 3))
        farther = one if np.linalg.norm(one) > np.linalg.norm(other) else other
        point.set("pos", " ".join(repr(float(number)) for number in farther))
        return
    writing.copy(element, point, said, PLACE)
    if element.tag == "geom" and not ends:
        writing.inside.add(name)
