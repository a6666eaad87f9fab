"""Writes a gait's law as a C99 controller: source, header, a test that runs a recorded cycle, and a note."""

from __future__ import annotations

import re
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import numpy as np

from spear_pin import __version__
from spear_pin.errors import BadFile
from spear_pin.files import together, write_text
from spear_pin.gaits.collocation import casadi
from spear_pin.gaits.gait import Gait
from spear_pin.hybrid.controller import beginnings, check_controllable, record_samples
from spear_pin.hybrid.fields import flatten
from spear_pin.kinds import typed
from spear_pin.viz.controller.functions import Phase, functions_of, identifier, phases_of
from spear_pin.viz.template import environment

KINDS = "hopping", "bounding"
FILES = "controller.h", "controller.c", "test.c", "README.md"
HELPERS = {"square": "static double square(double x) { return x * x; }\n"}


@typed
def write_controller(gait: Gait, folder: str | Path) -> list[Path]:
    """Writes the law of a hop or of a planar bound as C99, which CasADi derives from the law itself.

    Args:
        gait: the gait.
        folder: folder of the files, which is made if it is missing.

    Returns:
        the files: `controller.h`, `controller.c`, `test.c` and `README.md`.

    Raises:
        BadValue: the gait is of another kind, or has event feedback, a `Clutch` or a fixed spring.
        MissingExtra: CasADi is not installed.
        BadFile: a file cannot be written.

    Example:
        >>> from spear_pin import Gait
        >>> from spear_pin.viz.controller.writing import write_controller
        >>> files = write_controller(Gait.load("long_stride"), "bound_in_c")
        >>> [path.name for path in files]
        ['controller.h', 'controller.c', 'test.c', 'README.md']
    """
    check_controllable(gait.system, KINDS)
    casadi("a controller in C")
    content, folder = _content(gait), Path(folder)
    try:
        folder.mkdir(exist_ok=True)
    except OSError as error:
        raise BadFile(folder, f"cannot be made ({error.strerror}); give a folder in one that exists") from None
    templates = environment()
    texts = {name: templates.get_template(f"controller/{name}").render(content) for name in FILES}
    with together():
        return [write_text(folder / name, text) for name, text in texts.items()]


def _content(gait: Gait) -> dict[str, Any]:
    """Returns what the templates show."""
    system, robot = gait.system, gait.system.robot
    with warnings.catch_warnings():  # latches use NumPy's functions, of which CasADi warns
        warnings.simplefilter("ignore", FutureWarning)
        phases = phases_of(system)
        functions = functions_of(system, phases)
    code = list(functions.values())
    events = list(dict.fromkeys(identifier(event.name) for phase in phases for event in phase.events))
    aloft, standing = (str(event.reset.phase) for event in beginnings(system))
    limits = [robot.limits[name].effort for name in robot.actuated]
    limited = [limit if np.isfinite(limit) else None for limit in limits]
    most = max(len(phase.guards) for phase in phases)
    scheduled = max(1, *(len(phase.schedule) for phase in phases))
    return {
        "title": f"Controller of {robot.name}, {system.kind}",
        "version": __version__,
        "coordinates": list(zip(robot.coordinates, robot.units, strict=True)),
        "joints": list(zip(robot.actuated, limited, strict=True)),
        "limits": ["HUGE_VAL" if limit is None else number(limit) for limit in limited],
        "numbers": _numbers(system.law),
        "phases": [_phase(phase, events, most, scheduled) for phase in phases],
        "events": events,
        "most_held": max(phase.size for phase in phases),
        "most_watched": most,
        "most_scheduled": scheduled,
        "longest": number(system.phase_limit),
        "helpers": "".join(text for name, text in HELPERS.items() if any(f"{name}(" in each for each in code)),
        "functions": code,
        "begins_standing": standing,
        "begins_aloft": aloft,
        "rows": _rows(gait),
    }


def _phase(phase: Phase, events: Sequence[str], most: int, scheduled: int) -> dict[str, Any]:
    names = [identifier(event.name) for event in phase.events]
    padding = [0] * (most - len(phase.guards))
    on_time = [name for name, event in zip(names, phase.events, strict=True) if not event.guards]
    return {
        "name": phase.name,
        "names": [_counted(name, len(flatten([shape]))) for name, shape in phase.held.items()],
        "events": [
            {"name": name, "into": event.reset.phase or ""} for name, event in zip(names, phase.events, strict=True)
        ],
        "watched": len(phase.guards),
        "event_of": [*(events.index(names[i]) for i in phase.guards), *padding],
        "tolerances": [number(each) for each in (*phase.tolerances, *padding)],
        "scheduled": len(phase.schedule),
        "schedule": [number(each) for each in (*phase.schedule, *[0.0] * (scheduled - len(phase.schedule)))],
        "scheduled_event": events.index(on_time[0]) if on_time else -1,
    }


def _counted(name: str, count: int) -> str:
    return f"{name} ({count})" if count > 1 else name


def _numbers(law: Any) -> list[tuple[str, str, str]]:
    units: Mapping[str, str] = getattr(law, "units", {})
    return [(each.name, str(getattr(law, each.name)), _ascii(units.get(each.name, ""))) for each in fields(law)]


def _rows(gait: Gait) -> list[dict[str, Any]]:
    rows = []
    for row in record_samples(gait.system, gait.state):
        event = f"SPEAR_{identifier(row.event).upper()}" if row.event else "SPEAR_NOTHING"
        numbers = {name: [number(each) for each in getattr(row, name)] for name in "qvu"}
        rows.append({"event": event, "t": number(row.t), **numbers})
    return rows


def number(value: float) -> str:
    """Returns a number as C reads it back exactly."""
    return repr(float(value))


def _ascii(unit: str) -> str:
    return re.sub(r"[^\x20-\x7e]", lambda found: {"·": ".", "²": "^2"}.get(found[0], "?"), unit)
