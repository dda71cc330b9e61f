"""The program ``lumivox``, also as ``python -m lumivox``."""

from __future__ import annotations

import signal
import sys

from ._lumivox import main as _main


def main() -> int:
    """Runs the command line of the process; returns the exit code."""
    # The program handles Ctrl-C itself; Python's handler would raise KeyboardInterrupt.
    signal.signal(signal.SIGINT, signal.SIG_DFL)
    return _main(["lumivox", *sys.argv[1:]])


if __name__ == "__main__":
    sys.exit(main())
