"""Self-contained pages: Jinja templates of this package, its scripts and styles, meshcat's viewer."""

from __future__ import annotations

import json
from collections.abc import Callable, Mapping
from functools import cache
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from markupsafe import Markup

if TYPE_CHECKING:
    from jinja2 import Environment

# content security policy: a page asks for nothing, and runs the scripts and styles that stand in it
POLICY = "default-src 'none'; script-src 'unsafe-inline' 'unsafe-eval'; style-src 'unsafe-inline'; img-src data: blob:"


@cache
def environment(**filters: Callable[..., Any]) -> Environment:
    """Returns the environment of this package's templates, by their paths below `viz`; values are escaped.

    Args:
        filters: filters that they may use, besides those of all pages.
    """
    # most of what imports this module makes no page
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("spear_pin.viz", ""),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.globals |= {"asset": asset, "library": library, "licence": licence, "licences": licences}
    made.globals |= {"policy": Markup(POLICY)}
    made.filters |= {"script_json": script_json, **filters}
    return made


def asset(name: str) -> Markup:
    """Returns a style or script of this package, by its path below `viz`; it is not a template: it has braces."""
    return Markup(files("spear_pin.viz").joinpath(name).read_text(encoding="utf-8"))


def library() -> Markup:
    """Returns the script of meshcat's viewer."""
    return Markup((_folder() / "dist" / "main.min.js").read_text(encoding="utf-8"))


def licences() -> Markup:
    """Returns the licences of all that is in that script, in a form for a comment of HTML."""
    papers = "LICENSE", "dist/main.min.js.LICENSE.txt", "dist/main.min.js.THIRD_PARTY_LICENSES.json"
    paths = (_folder() / paper for paper in papers)
    return _comment("\n\n".join(path.read_text(encoding="utf-8") for path in paths if path.is_file()))


def licence(name: str) -> Markup:
    """Returns the licence of a foreign script, by the licence's path below `viz`, in a form for a comment of HTML."""
    return _comment(str(asset(name)))


def _comment(text: str) -> Markup:
    return Markup(text.replace("--", "- -").replace("<", "&lt;").replace(">", "&gt;"))


def _folder() -> Path:
    # importing meshcat takes a second and warns; only its files are needed
    spec = find_spec("meshcat")
    if spec is None or not spec.submodule_search_locations:
        raise ImportError("playback needs the package meshcat")
    return Path(spec.submodule_search_locations[0]) / "viewer"


def script_json(data: Mapping[str, Any]) -> Markup:
    """Returns data as JSON that is safe in a script: a title may hold the end of a script, or of a comment.

    Jinja's `tojson` would escape every quote, ampersand and `>` of the scripts that a report holds as data, too.
    """
    return Markup(json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c"))


def css(color: tuple[float, float, float]) -> str:
    """Returns a colour, each part from 0 to 1, in CSS notation."""
    return "#" + "".join(f"{round(255 * value):02x}" for value in color)
