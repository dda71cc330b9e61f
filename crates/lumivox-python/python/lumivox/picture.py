"""Pictures: radiance and layers as arrays, on screens and in files."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _lumivox
from ._arrays import Floats, floats
from .errors import InputError, OutputError


class Picture:
    """A picture as arrays, row by row from the top.

    ``radiance`` is (H, W, 3) float32 in cd/m2, linear RGB with the primaries of sRGB. ``coverage``
    is (H, W) float32: the share of the pixel that shows a surface. ``layers`` has the layers that
    were asked for; those of data, such as depth, have one sample a frame, of one frame the pixel's
    middle. In a notebook the picture shows itself.
    """

    def __init__(
        self,
        radiance: Any,
        *,
        coverage: Any = None,
        layers: dict[str, npt.NDArray[Any]] | None = None,
        exposure: str | float = "auto",
        tone_map: str = "neutral",
        adapter: str | None = None,
    ) -> None:
        self.radiance: Floats = floats("radiance", radiance, (None, None, 3))
        height, width = self.radiance.shape[:2]
        if self.radiance.size == 0:
            raise InputError("radiance: has no pixels")
        if coverage is None:
            coverage = np.ones((height, width), np.float32)
        self.coverage: Floats = floats("coverage", coverage, (height, width))
        self.layers: dict[str, npt.NDArray[Any]] = layers or {}
        self.exposure = exposure
        self.tone_map = tone_map
        self._adapter = adapter

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        height, width = self.radiance.shape[:2]
        return width, height

    def _develop(self) -> tuple[bytearray, bytes]:
        radiance = np.ascontiguousarray(self.radiance).tobytes()
        coverage = np.ascontiguousarray(self.coverage).tobytes()
        exposure, tone_map = str(self.exposure), str(self.tone_map)
        return _lumivox.develop(
            self.size, radiance, coverage, exposure, tone_map, self._adapter
        )

    def screen(self) -> npt.NDArray[np.uint8]:
        """The pixels for a screen, (H, W, 3) uint8: exposed by ``exposure`` stops (or ``"auto"``),
        with the curve ``tone_map``, sRGB-encoded."""
        width, height = self.size
        pixels = np.frombuffer(self._develop()[0], np.uint8)
        return np.ascontiguousarray(pixels.reshape(height, width, 4)[..., :3])

    def to_png(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """The bytes of a PNG file of :meth:`screen`, also written to ``path`` if there is one."""
        png = self._develop()[1]
        if path is not None:
            write(path, png)
        return png

    def to_exr(self, path: str | os.PathLike[str] | None = None) -> bytes:
        """The bytes of an OpenEXR file of the radiance, also written to ``path``."""
        exr = _lumivox.encode_exr(self.size, np.ascontiguousarray(self.radiance).tobytes())
        if path is not None:
            write(path, exr)
        return exr

    def _repr_png_(self) -> bytes:
        return self.to_png()

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> npt.NDArray[Any]:
        return np.array(self.radiance, dtype=dtype, copy=True if copy else None)

    def __repr__(self) -> str:
        width, height = self.size
        layers = f", layers {', '.join(self.layers)}" if self.layers else ""
        return f"<{type(self).__module__.split('.')[0]}.{type(self).__name__}: {width} x {height}{layers}>"


def write(path: str | os.PathLike[str], content: bytes) -> None:
    """Writes a file of a picture."""
    try:
        with open(path, "wb") as file:
            file.write(content)
    except OSError as error:
        raise OutputError(f"{os.fspath(path)}: cannot write the picture: {error.strerror}") from error
