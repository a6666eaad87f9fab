"""Docstrings are plain text with sections: in them bars and asterisks mean themselves, and so do colons."""

import re
from typing import Any

from sphinx.application import Sphinx
from sphinx.ext.napoleon import Config, GoogleDocstring

ARRAY = re.compile(r"~?numpy\.ndarray\[tuple\[~?typing\.Any, \.\.\.\], ~?numpy\.dtype\[~?numpy\.(\w+?)_?\]\]")
SECTIONS = Config(napoleon_use_ivar=True, napoleon_use_rtype=False, napoleon_attr_annotations=False)


def literal(line: str) -> str:
    """A line with what reStructuredText would take for markup escaped, except in backquotes."""
    parts = line.split("`")
    return "`".join(re.sub(r"(?<!\\)([|*])", r"\\\1", part) if i % 2 == 0 else part for i, part in enumerate(parts))


def read_plainly(app: Sphinx, what: str, name: str, obj: Any, options: Any, lines: list[str]) -> None:
    """Change a docstring to reStructuredText."""
    # in those of properties and data it would take what precedes a colon for a type
    kind = "object" if what in ("attribute", "data", "property") else what
    lines[:] = GoogleDocstring([literal(line) for line in lines], SECTIONS, app, kind, name, obj, options).lines()


def shorten(
    app: Sphinx, what: str, name: str, obj: Any, options: Any, signature: str | None, returns: str | None
) -> tuple[str | None, str | None]:
    """Write arrays as the source does, and defaults that are made anew each time so that they can be read."""

    def short(text: str | None) -> str | None:
        return text and ARRAY.sub(r"NDArray[\1]", text).replace("<factory>", "...")

    return short(signature), short(returns)


def setup(app: Sphinx) -> dict[str, Any]:
    """Listen to docstrings and signatures."""
    app.connect("autodoc-process-docstring", read_plainly)
    app.connect("autodoc-process-signature", shorten)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
