"""Checks the memory that a robot of many joints needs against the free memory."""

from __future__ import annotations

import math
import os
import re
from pathlib import Path

from spear_pin.errors import BadFile

SHARE = 0.1  # share of the free memory for one copy of Pinocchio's data; a simulation holds several
CUBIC, SQUARE = 33, 600  # bytes per nv³ and nv²: second derivatives of the kinematics alone are 6 nv³ doubles
MEMINFO = Path("/proc/meminfo")


def check_memory(path: str | Path, joints: int, nv: int) -> None:
    """Refuses a robot before Pinocchio's data for it takes all memory.

    Args:
        path: path of its URDF.
        joints: number of its joints.
        nv: number of its degrees of freedom.

    Raises:
        BadFile: one copy would take more than a tenth of the memory that is free.
    """
    need, free = CUBIC * nv**3 + SQUARE * nv**2, free_memory()
    if need > SHARE * free:
        raise BadFile(
            path,
            f"has {joints} joints with {nv} degrees of freedom, for which Pinocchio takes {_read(need)} of memory: more"
            f" than {SHARE:.0%} of the {_read(free)} that are free",
        )


def free_memory() -> float:
    """Returns the number of bytes available without swapping; infinite if the system does not report it."""
    try:
        found = re.search(r"^MemAvailable:\s+(\d+) kB$", MEMINFO.read_text(encoding="ascii"), re.MULTILINE)
    except OSError:
        found = None
    if found:
        return 1024.0 * int(found[1])
    try:
        return float(os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES"))
    except (AttributeError, OSError, ValueError):  # on Windows, and on systems that do not report it
        return math.inf


def _read(size: float) -> str:
    return f"{size / 1e9:.1f} GB" if size >= 1e9 else f"{size / 1e6:.1f} MB"
