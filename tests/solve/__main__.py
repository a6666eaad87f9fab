"""`python -m tests.solve [NAME ...]` searches the kept gaits again and writes them; `--check` only compares."""

import argparse
import sys

from tests.solve import gaits  # noqa: F401  registers the recipes
from tests.solve.kept import RECIPES, differences, keep


def main() -> int:
    """Runs the command."""
    parser = argparse.ArgumentParser(prog="python -m tests.solve", description=__doc__)
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"of {', '.join(RECIPES)}; all by default")
    parser.add_argument("--check", action="store_true", help="search, compare with what is kept, and write nothing")
    parser.add_argument("--stay", action="store_true", help="keep the gaits as they are, write what stands beside them")
    asked = parser.parse_args()
    if unknown := [name for name in asked.names if name not in RECIPES]:
        parser.error(f"{unknown[0]}: none of {', '.join(RECIPES)}")
    wrong = 0
    for name in asked.names or RECIPES:
        said = differences(RECIPES[name]) if asked.check else [str(keep(RECIPES[name], not asked.stay))]
        wrong += bool(asked.check and said)
        print(f"{name}: {'; '.join(said) or 'the same'}", flush=True)
    return wrong > 0


if __name__ == "__main__":
    sys.exit(main())
