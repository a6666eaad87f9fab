"""Motors of joints on the command line: `--motor JOINT=MOTOR`."""

from __future__ import annotations

import argparse
from collections.abc import Iterable
from typing import TYPE_CHECKING

from spear_pin.cli.pairs import once, words

if TYPE_CHECKING:
    from spear_pin.model.motor import Motor


def add_motors(parser: argparse.ArgumentParser) -> None:
    """Declare the option."""
    parser.add_argument(
        "--motor",
        type=words,
        action="extend",
        default=[],
        metavar="JOINT=MOTOR",
        help="of the catalogue, for its heat",
    )


def motors(pairs: Iterable[tuple[str, str]]) -> dict[str, Motor]:
    """Motors of the catalogue, by joint.

    Raises:
        UnknownName: there is no motor of a name.
        BadValue: a joint is given two.
    """
    from spear_pin.model.catalogue import motor

    return {joint: motor(name) for joint, name in once(pairs, "--motor").items()}
