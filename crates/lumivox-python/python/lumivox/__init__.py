"""Lumivox: global illumination by voxel cone tracing, as arrays.

>>> import lumivox
>>> scene = lumivox.Scene.builtin("cornell")
>>> picture = lumivox.render(scene, size=(320, 180), frames=16)
>>> picture.radiance.shape, picture.radiance.dtype
((180, 320, 3), dtype('float32'))
>>> picture.to_png("cornell.png")  # doctest: +SKIP

Pictures are in cd/m2 and irradiance is in lux; lengths are in metres, with y up. The GPU is opened
at the first use and shared; without one, an exception says what to install. Work releases
Python's global lock, and Ctrl-C stops it. The same input gives the same bits on the same GPU and
driver.
"""

from __future__ import annotations

from importlib.metadata import PackageNotFoundError
from importlib.metadata import version as _version

from . import _lumivox
from ._records import Camera, Instance, Light, Material
from .errors import Error, GpuError, InputError, OutputError
from .light import (
    Irradiance,
    Luminance,
    Workplane,
    irradiance,
    luminance,
    workplane,
    workplane_points,
)
from .picture import Picture
from .reference import Figures, Reference, compare, merge, reference, reference_part
from .render import LAYERS, Renderer, render, render_many, settings
from .scene import Animation, Scene

#: The names of the built-in scenes.
BUILTIN: tuple[str, ...] = tuple(_lumivox.builtin_names())


def adapters() -> list[str]:
    """The GPUs of this machine, the fastest first; part of a name is an ``adapter``."""
    return _lumivox.adapters()


try:
    __version__ = _version("lumivox")
except PackageNotFoundError:  # The package lies in its source folder.
    __version__ = "0"

__all__ = [
    "BUILTIN",
    "LAYERS",
    "Animation",
    "Camera",
    "Error",
    "Figures",
    "GpuError",
    "InputError",
    "Instance",
    "Irradiance",
    "Light",
    "Luminance",
    "Material",
    "OutputError",
    "Picture",
    "Reference",
    "Renderer",
    "Scene",
    "Workplane",
    "adapters",
    "compare",
    "irradiance",
    "luminance",
    "merge",
    "reference",
    "reference_part",
    "render",
    "render_many",
    "settings",
    "workplane",
    "workplane_points",
]
