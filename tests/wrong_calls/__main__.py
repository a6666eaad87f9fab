"""`python -m tests.wrong_calls`, with words that kinds and names of some calls contain, or without for all."""

import sys

from tests.wrong_calls.run import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
