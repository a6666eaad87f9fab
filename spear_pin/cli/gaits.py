"""The gaits that commands show, by name, path or speed."""

from __future__ import annotations

import argparse
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING, NamedTuple

from spear_pin.cli.given import refuse
from spear_pin.cli.pairs import names
from spear_pin.cli.python_lines import Code, Program
from spear_pin.errors import BadValue, UnknownName

if TYPE_CHECKING:
    from spear_pin.gaits.gait import Gait

BOUND = "long_stride"  # the one that is shown unless another is asked for
WHAT = "hop|bound|GAIT"
VARY = "let these parameters change so that the measures of --keep do not, one for each"
SPEED_SUFFIX = r"_(\d+(?:\.\d+)?)$"  # of a gait's name: in m/s


def bounding_gait(name: str, speed: float | None) -> tuple[str, Gait]:
    """A bounding gait by its name or path; asked for a speed, the one of its family that is nearest to it.

    Gaits of a family have the same name but for the speed behind it: long_stride and long_stride_3.00.

    Args:
        name: of a shipped gait, or the path of a saved one.
        speed: in m/s; None for the gait of just this name.

    Returns:
        Its name or path, and the gait.

    Raises:
        BadValue: if it does not bound.
        UnknownName: if there is no such gait.
        BadFile: if the file is none of a gait.
    """
    from spear_pin.gaits import library
    from spear_pin.gaits.gait import Gait
    from spear_pin.studies.bound import mean_speed

    if name in library.names() and speed is not None:
        family = {other: re.search(SPEED_SUFFIX, other) for other in library.names() if _base(other) == _base(name)}
        speeds = {
            other: float(found[1]) if found else mean_speed(Gait.load(library.path(other)))
            for other, found in family.items()
        }
        name = min(speeds, key=lambda other: abs(speeds[other] - speed))
    gait = Gait.load(library.path(name) if name in library.names() else name)
    if gait.system.kind != "bounding":
        where = "; --space plays it" if gait.system.kind == "bounding_in_space" else ""
        raise BadValue("--gait", name, f"a bounding gait; this one is of the kind {gait.system.kind!r}{where}")
    return name, gait


def add_gait(parser: argparse.ArgumentParser) -> None:
    """Declare the gait, which `find_named_gait` finds."""
    parser.add_argument(
        "what",
        metavar=WHAT,
        help=f"a leg's hop in place, the bound {BOUND}, a gait by name such as trot, or the path of a saved one",
    )


def add_wanted(parser: argparse.ArgumentParser) -> None:
    """Declare --flight-time and --speed, of which one may be given; see `solved_for`."""
    wanted = parser.add_mutually_exclusive_group()
    wanted.add_argument(
        "--flight-time", type=float, metavar="S", help="solve a hop's stance torque for this flight time"
    )
    wanted.add_argument("--speed", type=float, metavar="M/S", help="solve other gaits' hip torque for this mean speed")


class Asked(NamedTuple):
    """What a gait is asked for.

    Attributes:
        solved: the parameter to solve for.
        measure: the measure that has a wanted value.
        value: this value; None if its option was not given.
        option: the option.
    """

    solved: str
    measure: str
    value: float | None
    option: str


def solved_for(arguments: argparse.Namespace, gait: Gait | None) -> Asked:
    """What a gait is asked for by the options of `add_wanted`: a hop for its flight time, others for their speed.

    Args:
        arguments: of the command.
        gait: the gait; None for the hop.

    Raises:
        BadValue: the option for other gaits was given.
    """
    from spear_pin.gaits.bounding import SPEED_BY

    if gait is None or "hopping" in gait.system.kind:
        refuse(arguments, "only with gaits that travel; for a hop give --flight-time", "speed")
        return Asked("stance_torque", "flight_time", arguments.flight_time, "--flight-time")
    refuse(arguments, "only with a hop; for gaits that travel give --speed", "flight_time")
    return Asked(SPEED_BY, "mean_speed", arguments.speed, "--speed")


def add_kept(parser: argparse.ArgumentParser) -> None:
    """Declare --vary and --keep: what is solved for, and the measures that stay as the gait has them."""
    for option, metavar, text in (("--vary", "NAME", VARY), ("--keep", "MEASURE", "keep these measures as they are")):
        text = f"{text}; separated by commas"
        parser.add_argument(option, type=names, action="extend", default=[], metavar=metavar, help=text)


@contextmanager
def offer_words(*words: str) -> Iterator[None]:
    """Offer words besides the names of gaits that are valid, where a gait is not known."""
    try:
        yield
    except UnknownName as error:
        raise UnknownName(error.kind, error.value, (*words, *error.valid), error.also) from None


def find_named_gait(what: str) -> Gait:
    """SPEAR-II's hop in place with a flight of 0.2 s ("hop"), the bound that is shown ("bound"), or a gait by name.

    Args:
        what: one of these words, a name, or a path.

    Raises:
        UnknownName: if there is no such gait.
        BadFile: if the file is none of a gait.
    """
    from spear_pin import Gait, find_gait, hopping, load

    if what == "hop":
        system = hopping(load("spear_ii", locked=["boom_x"]))
        return find_gait(system, vary=["stance_torque"], target={"flight_time": 0.2})
    with offer_words("hop", "bound"):
        return Gait.load(BOUND if what == "bound" else what)


def write_gait(program: Program, what: str) -> Code:
    """Write the Python of `find_named_gait`, and return what the gait is called."""
    from spear_pin import Gait, find_gait, hopping, load

    if what != "hop":
        return program.let("gait", program.call(Gait.load, BOUND if what == "bound" else what))
    robot = program.let("robot", program.call(load, "spear_ii", locked=["boom_x"]))
    hop = program.call(hopping, robot)
    return program.let("gait", program.call(find_gait, hop, vary=["stance_torque"], target={"flight_time": 0.2}))


def _base(name: str) -> str:
    return re.sub(SPEED_SUFFIX, "", name)
