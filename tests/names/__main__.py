"""`python -m tests.names`, with names of subjects, or without for all of them."""

import sys

from tests.names.comparison import main

if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
