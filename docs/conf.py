"""Sphinx: the pages of this folder, the API from its docstrings, the gallery from `examples/`."""

import os
import sys
import tomllib
from pathlib import Path

sys.path[:0] = [str(Path(__file__).parent / "_extensions"), str(Path(__file__).parents[1])]

import kept  # noqa: E402

import spear_pin  # noqa: E402

project = "spear-pin"
author = "The spear-pin developers"
version = release = spear_pin.__version__

extensions = [
    "myst_nb",  # all that myst_parser reads, and notebooks, which it runs
    "sphinx.ext.autodoc",
    "sphinx.ext.autosummary",
    "sphinx_design",
    "sphinx_reredirects",
    "architecture",
    "docstrings",
    "gallery",
    "links",
    "mathml",
    "modules",
    "motors",
    "reference",
]
exclude_patterns = ["_extensions", "_templates", "images"]

moved = tomllib.loads((Path(__file__).parent / "moved.toml").read_text(encoding="utf-8"))
redirects = {old: os.path.relpath(f"{new}.html", os.path.dirname(old)) for old, new in moved.items()}

myst_enable_extensions = ["colon_fence", "dollarmath"]
myst_heading_anchors = 3

nb_execution_mode = "cache"  # of the same cells and the same sources
nb_execution_cache_path = str(Path(__file__).parents[1] / "build" / "notebooks" / kept.everything()[:16])
nb_execution_raise_on_error = True
nb_execution_timeout = 120  # s
# kernels import what is documented, too
os.environ["PYTHONPATH"] = os.pathsep.join([str(Path(__file__).parents[1]), os.environ.get("PYTHONPATH", "")])

templates_path = ["_templates"]
autodoc_typehints_format = "short"
autodoc_type_aliases = {name: name for name in ("Array", "ArrayLike", "Change", "GuardValue", "Held", "Latch", "Law")}
autodoc_preserve_defaults = True
autodoc_use_type_comments = False  # there are none, and it takes seconds to look for them
maximum_signature_line_length = 120
autodoc_member_order = "bysource"
# a name in backquotes is a link where it can be one, and code where not
default_role = "py:obj"

nitpicky = True
# only references that name something of this package in full can be checked without the network
nitpick_ignore_regex = [
    ("py:.*", r"(?!spear_pin\.).*|spear_pin\.\w+"),
    ("py:class", r"spear_pin\..*\.([A-Z]|_\w+)|spear_pin\.studies\.(comparison|payoff|workers)\..*"),
]

html_theme = "furo"
html_title = "spear-pin"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_copy_source = False
html_show_copyright = False
html_math_renderer = "mathml"
html_theme_options = {"navigation_with_keys": True}
