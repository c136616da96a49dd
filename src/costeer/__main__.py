"""`costeer` and `python -m costeer`: the command line, which Ctrl-C ends in one line.

Nothing is imported before Ctrl-C is looked after: importing takes a moment.
"""

import sys


def run() -> int:
    """Run the command line; return its exit code."""
    try:
        from costeer.cli import main

        return main()
    except KeyboardInterrupt:
        print("costeer: stopped", file=sys.stderr)
        return 130


if __name__ == "__main__":
    sys.exit(run())
