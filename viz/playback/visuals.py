"""Visual geometry of a robot's file: the visible parts of its bodies, their places and colours; meshes are unread."""

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
    """A visible part of a body of a model.

    Attributes:
        body: name of the body.
        joint: index of the joint that moves it.
        placement: pose in the joint's frame, (4, 4).
        shown: the visible part.
        faint: whether it is translucent.
    """

    body: str
    joint: int
    placement: Array
    shown: Shown
    faint: bool = False


def visuals_of(description: Description, model: pin.Model) -> tuple[list[Visual], list[tuple[str, Undrawn]]]:
    """Returns a file's visible parts of a model, and those that are not drawn, with the name of the body.

    Args:
        description: content of the file.
        model: the model that has its bodies.
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
    """Yields names of bodies, each with a function that reads one of its visible parts."""
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
