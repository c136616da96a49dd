"""`python -m costeer`: the same as the command `costeer`."""

import sys

from costeer.cli import main

if __name__ == "__main__":
    sys.exit(main())
