"""Write docs/explanation/errata.md from `spear_pin.studies.audit.errata`: `python -m docs.make_errata`."""

from __future__ import annotations

import re
import textwrap
from pathlib import Path

from spear_pin.studies.audit.errata import ERRATA

PAGE = Path(__file__).parent / "explanation" / "errata.md"
WIDTH = 120
HEAD = """\
# Corrections of the thesis

This page lists the errors that we found when we computed chapters 3 to 5 of the [thesis](source.md) again.
To print the inertias, gravity torques, poles and averages of this page, run

```sh
python -m benchmarks.errata
```

`spear report` writes a page that links each correction to the computed statements that show it. Only corrections that
matter for this package are listed; everything else is used as printed. "Here" means this package.
"""


def page() -> str:
    """The text of docs/explanation/errata.md."""
    blocks = [HEAD.rstrip("\n")]
    for group, errata in ERRATA.items():
        blocks.append(f"## {group}")
        for erratum in errata:
            blocks += map(_wrapped, f"**{erratum.title}.** {erratum.text}".split("\n\n"))
    return "\n\n".join(blocks) + "\n"


def _wrapped(block: str) -> str:
    if block.startswith("|"):
        return block
    kept = re.sub(r" (?=([-+=]|\d+\.) )", "\0", block)  # no line begins as a list or a heading does
    return textwrap.fill(kept, WIDTH, break_long_words=False, break_on_hyphens=False).replace("\0", " ")


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(PAGE)
