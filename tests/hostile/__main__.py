"""`python -m tests.hostile`, with words that kinds and names of some files contain, or without for all."""

import sys

from tests.hostile.run import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
