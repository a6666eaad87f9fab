"""Paths of springs as tables of a file, JSON or TOML."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, fields
from typing import Any

from spear_pin.errors import BadValue, UnknownName
from spear_pin.model.cable import Anchor, Between, Over
from spear_pin.model.linkage import Linkage
from spear_pin.model.path import Joints, Path, Sum
from spear_pin.model.spring import Spring

KEYS = ("path", "from", "to", "over", "linkage", "sum")  # of a spring's table that describe its path
PULLEY, LINKAGE = ("body", "at", "radius", "side"), ("joint", "crank", "rod", "offset", "zero", "side")


def spring_data(spring: Spring) -> dict[str, Any]:
    """Returns a spring as a table."""
    nested = "path", "clutch"
    numbers = {field.name: getattr(spring, field.name) for field in fields(spring) if field.name not in nested}
    clutch = {} if spring.clutch is None else {"clutch": asdict(spring.clutch)}
    return numbers | clutch | ({} if spring.path is None else path_data(spring.path))


def path_data(path: Path) -> dict[str, Any]:
    """Returns the keys of a spring's table that describe a path.

    Raises:
        BadValue: the path is of a kind of its own.
    """
    if isinstance(path, Joints):
        return {"path": {joint: path.side * weight for joint, weight in path.weights}}
    if isinstance(path, Between):
        return {"from": _anchored(path.start), "to": _anchored(path.end)}
    if isinstance(path, Over):
        pulley = {**_anchored(path.centre), "radius": path.radius, "side": path.side}
        return {"from": _anchored(path.start), "over": pulley, "to": _anchored(path.end)}
    if isinstance(path, Linkage):
        turned = {"side": path.turned * path.side, "zero": path.turned * path.zero}
        return {"linkage": {name: getattr(path, name) for name in LINKAGE} | turned}
    if isinstance(path, Sum):
        return {"sum": [{"weight": weight, **path_data(part)} for weight, part in path.parts]}
    raise BadValue("path", path, "one of the package's, to be kept in a file")


def path_of(table: Mapping[str, Any]) -> tuple[Path | None, dict[str, Any]]:
    """Returns the path of a spring's table, None if it has none, and the other keys.

    Raises:
        BadValue: a key or a value of the path is not valid.
        UnknownName: a key is unknown.
    """
    own = {key: table[key] for key in KEYS if key in table}
    others = {key: value for key, value in table.items() if key not in KEYS}
    if not own:
        return None, others
    given = frozenset(own)
    if given == {"path"}:
        return Joints(_table("path", own["path"])), others
    if given == {"linkage"}:
        return Linkage(**keys_of("linkage", own["linkage"], LINKAGE[:3], LINKAGE[3:])), others
    if given == {"sum"}:
        return Sum(_parts(own["sum"])), others
    if given not in ({"from", "to"}, {"from", "over", "to"}):
        expected = "path, or linkage, or sum, or from and to, with over for a pulley between them"
        raise BadValue("path of a spring", ", ".join(own), expected)
    start, end = (_anchor(name, own[name]) for name in ("from", "to"))
    if "over" not in own:
        return Between(start, end), others
    pulley = keys_of("over", own["over"], PULLEY[:3], PULLEY[3:])
    centre = Anchor(pulley["body"], pulley["at"])
    return Over(start, centre, end, pulley["radius"], pulley.get("side", 1.0)), others


def _parts(given: Any) -> list[tuple[Any, Path]]:
    if not isinstance(given, Sequence) or not all(isinstance(each, Mapping) for each in given):
        raise BadValue("sum", given, "a list of tables, each with weight and a path")
    found = []
    for each in given:
        path, others = path_of(each)
        keys_of("a part of sum", others, ("weight",), ())
        if path is None:
            raise BadValue("sum", each, "a path in each part")
        found.append((others["weight"], path))
    return found


def _anchored(anchor: Anchor) -> dict[str, Any]:
    x, y, z = anchor.at
    return {"body": anchor.body, "at": [anchor.side * x, y, z]}


def _anchor(name: str, given: Any) -> Anchor:
    return Anchor(**keys_of(name, given, ("body", "at"), ()))


def keys_of(name: str, given: Any, wanted: Sequence[str], optional: Sequence[str]) -> Mapping[str, Any]:
    """Returns a table that has all wanted keys, and of others only optional ones.

    Raises:
        UnknownName: a key is unknown.
        BadValue: it is no table, or a key is missing.
    """
    table = _table(name, given)
    for key in table:
        if key not in (*wanted, *optional):
            raise UnknownName(f"key of {name}", key, (*wanted, *optional))
    if missing := [key for key in wanted if key not in table]:
        raise BadValue(name, dict(table), f"a table with {missing[0]}")
    return table


def _table(name: str, given: Any) -> Mapping[str, Any]:
    if not isinstance(given, Mapping):
        raise BadValue(name, given, "a table")
    return given
