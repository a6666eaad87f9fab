"""Visual geometry of a robot's file: what its bodies show, where, and in which colour; meshes not yet read."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np
import pinocchio as pin

from spear_pin.arrays import Array
from spear_pin.model.document import Description
from spear_pin.viz.playback.appearance import Shown, Undrawn
from spear_pin.viz.playback.mjcf_visuals import is_shown, read_geom
from spear_pin.viz.playback.urdf_visuals import read_visual


@dataclass(frozen=True)
class Visual:
    """Something that a body of a model shows.

    Attributes:
        body: name of the body.
        joint: index of the joint that moves it.
        placement: (4, 4) pose in the joint's frame.
        shown: what it is.
        faint: whether it is to be seen through.
    """

    body: str
    joint: int
    placement: Array
    shown: Shown
    faint: bool = False


def visuals_of(description: Description, model: pin.Model) -> tuple[list[Visual], list[tuple[str, Undrawn]]]:
    """What a file shows of a model, and what of it is not drawn, with the name of the body.

    Args:
        description: the file.
        model: has its bodies.
    """
    visuals, faults = [], []
    for body, read in _shown(description):
        try:
            shown = read()
            frame = _frame(model, body)
            placement = np.array((frame.placement * shown.place).homogeneous)
            visuals.append(Visual(body, int(frame.parentJoint), placement, shown))
        except Undrawn as fault:
            faults.append((body, fault))
    return visuals, faults


def _shown(description: Description) -> Iterator[tuple[str, Callable[[], Shown]]]:
    """Names of bodies, each with what reads something that it shows."""
    if description.look is not None:
        for body, said in description.look.geoms:
            if is_shown(said):
                yield body, partial(read_geom, said, description.look)
        return
    palette = {material.get("name"): material for material in description.root.findall("material")}
    for link in description.root.findall("link"):
        for visual in link.findall("visual"):
            yield link.get("name"), partial(read_visual, visual, palette)


def _frame(model: pin.Model, body: str) -> Any:
    index = int(model.getFrameId(body, pin.FrameType.BODY))
    if index >= model.nframes:
        raise Undrawn("a visual", "no such body")
    return model.frames[index]
