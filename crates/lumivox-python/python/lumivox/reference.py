"""The truth: path-traced pictures, and the errors of others against them."""

from __future__ import annotations

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import _lumivox
from ._arrays import Floats, floats, numbers, size_of, view, whole
from ._records import Camera
from .errors import InputError
from .picture import Picture
from .render import CameraLike, _camera, _scene
from .scene import Progress, Scene


class Reference(Picture):
    """A path-traced picture. Its layers are means over all samples: ``direct``, ``one_bounce`` and
    ``irradiance`` (lux, without light straight from lamps), ``occlusion``, ``albedo``, ``normal``,
    ``depth``, and ``radiance_variance`` and so on: that of each pixel's mean, averaged over the
    channels, whose root is the standard error."""

    def __init__(self, reference: _lumivox.Reference, adapter: str | None = None) -> None:
        width, height = reference.size
        arrays = {
            name: view(data, "f4", height, width, channels)
            for name, data, channels in reference.arrays()
        }
        radiance, coverage = arrays.pop("radiance"), arrays.pop("coverage")
        super().__init__(radiance, coverage=coverage, layers=arrays, adapter=adapter)
        self._reference = reference

    @classmethod
    def load(cls, path: str | os.PathLike[str]) -> Reference:
        """Reads an OpenEXR file of ``lumivox reference`` or :meth:`save`."""
        return cls(_lumivox.Reference.load(os.fspath(path)))

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes all layers into one OpenEXR file."""
        self._reference.save(os.fspath(path))

    @property
    def samples(self) -> int:
        """Samples of each pixel."""
        return self._reference.samples

    @property
    def standard_error(self) -> Floats:
        """The standard error of the radiance, (H, W), cd/m2; infinite below 17 samples."""
        return np.sqrt(np.asarray(self.layers["radiance_variance"], np.float32))


def reference(
    scene: Scene,
    camera: CameraLike | None = None,
    size: tuple[int, int] = (640, 360),
    *,
    samples: int = 256,
    seed: int = 0,
    bounces: int | None = None,
    surroundings: str = "auto",
    adapter: str | None = None,
    progress: Progress | None = None,
) -> Reference:
    """A path-traced picture, without bias; noise falls with the root of ``samples``.

    Scene, camera, size, surroundings, adapter and progress are as for :class:`Renderer`. The same
    ``seed`` gives the same bits on the same GPU and driver. ``bounces`` limits indirect light.
    """
    return Reference(
        _trace(scene, camera, size, (0, samples), False, seed, bounces, surroundings, adapter, progress),
        adapter,
    )


def reference_part(
    scene: Scene,
    camera: CameraLike | None = None,
    size: tuple[int, int] = (640, 360),
    *,
    batches: tuple[int, int],
    seed: int = 0,
    bounces: int | None = None,
    surroundings: str = "auto",
    adapter: str | None = None,
    progress: Progress | None = None,
) -> bytes:
    """Some batches of 16 samples of a reference, from the first number to before the second.

    The bytes are those of a file of ``lumivox reference --part``. :func:`merge` adds parts up, to
    the bits of one :func:`reference` with 16 samples for each batch, in any order.
    """
    try:
        first, end = batches
    except (TypeError, ValueError):
        raise InputError(f"batches: is {batches!r}, but must be two numbers") from None
    first, end = whole("batches", first, 0), whole("batches", end, 1)
    if not first < end <= 1 << 20:
        raise InputError(f"batches: is {batches}, but must rise, up to {1 << 20}")
    samples = (first, 16 * (end - first))
    traced = _trace(
        scene, camera, size, samples, True, seed, bounces, surroundings, adapter, progress
    )
    return traced.part() or b""


def merge(
    parts: Iterable[bytes], *, allow_mixed: bool = False, adapter: str | None = None
) -> Reference:
    """The sum of parts, each the bytes of :func:`reference_part` or of its file. An iterator is read
    one part after the other, so that only one is in memory.

    A part that is given twice counts once. Parts of different programs, GPUs and drivers are
    refused unless ``allow_mixed``: their sum does not have the bits of one machine.
    """
    return Reference(_lumivox.Reference.merge(parts, bool(allow_mixed)), adapter)


def _trace(
    scene: Scene,
    camera: CameraLike | None,
    size: tuple[int, int],
    samples: tuple[int, int],
    is_part: bool,
    seed: int,
    bounces: int | None,
    surroundings: str,
    adapter: str | None,
    progress: Progress | None,
) -> _lumivox.Reference:
    """Traces from a batch on a number of samples."""
    first_batch, count = samples
    return _lumivox.Reference.trace(
        _scene(scene),
        _camera(camera),
        size_of("size", size),
        whole("samples", count, 1),
        whole("seed", seed, 0),
        first_batch,
        is_part,
        None if bounces is None else whole("bounces", bounces, 0),
        surroundings,
        adapter,
        progress,
    )


@dataclass(frozen=True)
class Figures:
    """The errors of a picture, as ``lumivox compare`` tells them; percent of the reference's mean.

    ``bias_percent`` is negative where it is too dark. ``rmse_percent`` is without the reference's
    noise, if that is known; ``p95_percent`` is not exceeded by 95 % of the pixels' errors relative
    to themselves; ``flip`` is what a viewer sees (Andersson et al. 2020), 0 to 1.
    """

    bias_percent: float
    rmse_percent: float
    rmse_with_noise_percent: float
    p95_percent: float
    flip: float | None
    noise_percent: float | None


def compare(picture: Picture | Any, truth: Picture | Any, variance: Any = None) -> Figures:
    """The errors of a picture against the truth, each a picture or an array (H, W, 3) in cd/m2.

    ``variance`` (H, W) is that of the truth's pixels; a :class:`Reference` brings its own.
    """
    if variance is None and isinstance(truth, Reference):
        variance = truth.layers["radiance_variance"]
    ours = picture.radiance if isinstance(picture, Picture) else picture
    theirs = truth.radiance if isinstance(truth, Picture) else truth
    expected = floats("truth", theirs, (None, None, 3))
    height, width = expected.shape[:2]
    got = floats("picture", ours, (height, width, 3))
    known = None
    if variance is not None:
        # With fewer than two batches it is infinite, that is, unknown.
        known = np.ascontiguousarray(numbers("variance", variance, (height, width)), np.float32)
    figures = _lumivox.figures(
        (width, height),
        expected.tobytes(),
        None if known is None else known.tobytes(),
        got.tobytes(),
    )
    return Figures(*figures)
