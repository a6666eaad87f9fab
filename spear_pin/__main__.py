"""`python -m spear_pin`: the same as the command `spear`."""

from spear_pin.cli import main

if __name__ == "__main__":  # worker processes import this module too
    raise SystemExit(main())
