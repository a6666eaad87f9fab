"""Write docs/explanation/errata.md from `spear_pin.studies.audit.errata`: `python -m docs.make_errata`."""

from __future__ import annotations

import textwrap
from pathlib import Path

from spear_pin.studies.audit.errata import ERRATA

PAGE = Path(__file__).parent / "explanation" / "errata.md"
WIDTH = 120
HEAD = """\
# Corrections of the source

What was found by recalculating chapters 3 to 5 of the source and the tables they draw on. Only what bears on this
package is listed; everything not listed is used as printed. The numbers come from

```sh
python -m benchmarks.errata
```

and `spear report` computes those that show each correction anew.

Below, "here" is the package. Where the printed form has another meaning under another convention, that is said.
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
    return textwrap.fill(block, WIDTH, break_long_words=False, break_on_hyphens=False)


if __name__ == "__main__":
    PAGE.write_text(page(), encoding="utf-8")
    print(PAGE)
