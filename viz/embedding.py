"""Parts of a page that holds several playbacks and drawings, and loads nothing else."""

from __future__ import annotations

import re
from collections.abc import Iterable

from markupsafe import Markup, escape

from spear_pin.errors import BadValue

VIEWER = re.compile(r"(?<=<script>).*?(?=</script>)", re.S)  # the first script of a page
ENLARGED = 1.3  # figures on a screen beside those on paper


def shared(pages: Iterable[str]) -> tuple[str, list[tuple[str, str]]]:
    """Returns the viewer that pages of `player` have in common, and the text before and after it in each page.

    Raises:
        BadValue: the pages do not have the same viewer.
    """
    parts = []
    for text in pages:
        found = VIEWER.search(text)
        if found is None:
            raise BadValue("pages", text[:80], "pages of a player, with its viewer")
        parts.append((text[: found.start()], found[0], text[found.end() :]))
    viewers = {viewer for _, viewer, _ in parts}
    if len(viewers) > 1:
        raise BadValue("pages", len(viewers), "pages with the same viewer")
    return "".join(viewers), [(before, after) for before, _, after in parts]


def drawing(svg: bytes, name: str, label: str) -> Markup:
    """Returns a figure of matplotlib as an element of a page; keeps only ids that it uses, and makes them unique.

    Args:
        svg: the file.
        name: name of the figure on the page.
        label: description of the figure, in words.
    """
    source = svg.decode()
    source = source[source.index("<svg") :]
    source = re.sub(r"<metadata>.*?</metadata>", "", source, flags=re.S)
    used = set(re.findall(r'(?:href="|url\()#([^")]+)', source))
    source = re.sub(r' id="([^"]*)"', lambda m: f' id="{name}-{m[1]}"' if m[1] in used else "", source)
    source = re.sub(r'(href="|url\()#', rf"\g<1>#{name}-", source)
    size = re.search(r'width="([\d.]+)pt" height="[\d.]+pt"', source)
    assert size is not None  # matplotlib's own
    source = source.replace(size[0], f'style="--width:{ENLARGED * float(size[1]):.0f}pt"', 1)
    return Markup(source.replace("<svg ", f'<svg role="img" aria-label="{escape(label)}" ', 1))
