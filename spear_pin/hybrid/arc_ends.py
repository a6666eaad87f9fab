"""Events of round feet whose arcs have ends: a foot on the ground tips over an end, rolls again, or is overturned."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from spear_pin.hybrid.contact import OPEN
from spear_pin.hybrid.domain import Domain, Guard, Reset
from spear_pin.hybrid.dynamics import Dynamics, Operations
from spear_pin.model.robot import Robot
from spear_pin.model.round_feet import FootArc, parts_of, turned_from


def on_arcs(domain: Domain, robot: Robot) -> Domain:
    """Returns a domain with the events at which its toes come to the ends of their arcs, or back onto these."""
    bearing = {toe for toe, mode in zip(robot.toes, domain.contacts, strict=False) if mode != OPEN} | {*domain.bouncing}
    ends = [end for toe in robot.arcs if toe in bearing for end in _arc_ends(toe, robot.arcs[toe])]
    known = {guard.name for guard in domain.guards}
    return replace(domain, guards=(*domain.guards, *(end for end in ends if end.name not in known)))


def _arc_ends(toe: str, arc: FootArc) -> tuple[Guard, ...]:
    """Returns the events of the ends of a toe's arc; where it lies on both ends the run ends."""
    parts, half = parts_of(toe), arc.stop - arc.middle

    def end(place: int, side: float, pitch: float) -> Guard:
        def inside(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
            here, there = held[parts][place], held[parts][1 - place]
            sine, cosine = ops.sin(arc.pitch(q)), ops.cos(arc.pitch(q))
            past, turned = (side * turned_from(angle, sine, cosine, ops) for angle in (pitch, arc.middle))
            return here * past + there + (1.0 - here - there) * (half - turned)

        def flipped(q: Any, v: Any, held: Any, p: Any) -> Any:
            return {parts: tuple(1.0 - x if i == place else x for i, x in enumerate(held[parts]))}

        return Guard(f"{('first', 'last')[place]}_end:{toe}", inside, Reset(latch=flipped))

    def off_its_chord(t: Any, q: Any, v: Any, held: Any, p: Any, dyn: Dynamics, ops: Operations) -> Any:
        first, last = held[parts]
        return 1.0 - first - last + (last - first) * ops.sin(arc.pitch(q) - arc.middle)

    lies = Guard(f"overturned:{toe}", off_its_chord, ends="fall")
    return lies, end(0, -1.0, arc.start), end(1, 1.0, arc.stop)
