"""Exceptions: each has the message of Lumivox and the ``code`` that the program would exit with.

``KeyboardInterrupt`` stops work that runs, between two frames or samples.
"""

from __future__ import annotations


class Error(Exception):
    """The GPU failed, or Lumivox has a defect; the base of the others."""

    code: int = 1


class InputError(Error, ValueError):
    """Bad input: the message names the argument, or the file and the place in it, and the remedy."""

    code: int = 3


class GpuError(Error, RuntimeError):
    """There is no suitable GPU (the message says what to install), or more was asked for than it can hold."""

    code: int = 4


class OutputError(Error, OSError):
    """A file cannot be written."""

    code: int = 5
