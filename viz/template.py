"""Contents of pages that hold everything themselves: files of this package, meshcat's viewer, data."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Any


def filled(template: str, parts: Mapping[str, str]) -> str:
    """A template of this package, by its path below `viz`, with its {{parts}}."""
    return re.sub(r"\{\{(\w+)\}\}", lambda match: parts[match[1]], asset(template))


def asset(name: str) -> str:
    """Text of a file of this package, by its path below `viz`."""
    return files("spear_pin.viz").joinpath(name).read_text(encoding="utf-8")


def viewer_parts(data: Mapping[str, Any], script: str) -> dict[str, str]:
    """The parts "controls" and "viewer" of a page: buttons and time bar; meshcat's viewer with data and a script."""
    parts = {
        "licences": _comment(licences()),
        "library": library(),
        "data": script_json(data),
        "script": asset("viewer.js") + asset(script),
    }
    return {"controls": asset("controls.html"), "viewer": filled("viewer.html", parts)}


def library() -> str:
    """The script of meshcat's viewer."""
    return (_folder() / "dist" / "main.min.js").read_text(encoding="utf-8")


def licences() -> str:
    """Those of all that is in it."""
    papers = "LICENSE", "dist/main.min.js.LICENSE.txt", "dist/main.min.js.THIRD_PARTY_LICENSES.json"
    paths = (_folder() / paper for paper in papers)
    return "\n\n".join(path.read_text(encoding="utf-8") for path in paths if path.is_file())


def _folder() -> Path:
    # importing meshcat takes a second and warns; only its files are needed
    spec = find_spec("meshcat")
    if spec is None or not spec.submodule_search_locations:
        raise ImportError("playback needs the package meshcat")
    return Path(spec.submodule_search_locations[0]) / "viewer"


def script_json(data: Mapping[str, Any]) -> str:
    """Data as JSON that may stand in a script: a title may hold the end of one, or of a comment."""
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")


def css(color: tuple[float, float, float]) -> str:
    """A colour, each part from 0 to 1, as CSS has it."""
    return "#" + "".join(f"{round(255 * value):02x}" for value in color)


def _comment(text: str) -> str:
    return text.replace("--", "- -").replace("<", "&lt;").replace(">", "&gt;")
