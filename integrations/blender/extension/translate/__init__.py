"""Reads Blender's evaluated scene into the values of :mod:`model`; changes nothing in Blender."""

from .scene import Reader

__all__ = ["Reader"]
