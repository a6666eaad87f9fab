"""Lists the data that are read in URDF, SRDF and MJCF files, from `grammars.toml`."""

import tomllib
from importlib.resources import files
from typing import Any

from spear_pin.model.unread import Grammar

SETS = ("nested", "kinds", "single", "idle", "still")


def _grammar(read: dict[str, str], usual: dict[str, list[str]], **given: Any) -> Grammar:
    return Grammar(read=read, usual=usual, **{name: frozenset(given.get(name, "").split()) for name in SETS})


_TABLES = tomllib.loads(files("spear_pin.model").joinpath("grammars.toml").read_text("utf-8"))
for _part in ("compiler", "option"):  # a URDF's are MuJoCo's, of which it takes what changes nothing
    _TABLES["urdf"]["read"][f"robot/mujoco/{_part}"] = _TABLES["mjcf"]["still"]
URDF, SRDF, MJCF = (_grammar(**_TABLES[name]) for name in ("urdf", "srdf", "mjcf"))
