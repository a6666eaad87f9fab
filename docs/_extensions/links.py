"""Links that lead to files of the repository lead to the pages made from them."""

import re
from typing import Any

from sphinx.application import Sphinx


def redirected(text: str) -> str:
    """The text of a page with links to examples, modules and the README changed for the site's."""
    text = re.sub(r"\]\(((?:\.\./)*)\.\./examples/(\w+)\.py\)", r"](\1gallery/\2.md)", text)
    module = r"\]\(((?:\.\./)*)\.\./(spear_pin/[\w/]+)\.py\)"
    text = re.sub(module, lambda link: f"]({link[1]}api/{link[2].replace('/', '.')}.rst)", text)
    return re.sub(r"\]\(((?:\.\./)*)\.\./README\.md\)", r"](\1index.md)", text)


def redirect(app: Sphinx, page: str, source: list[str]) -> None:
    """Change a page as it is read."""
    source[0] = redirected(source[0])


def setup(app: Sphinx) -> dict[str, Any]:
    """Listen to pages being read."""
    app.connect("source-read", redirect)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
