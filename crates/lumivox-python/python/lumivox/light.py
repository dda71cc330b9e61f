"""Light as numbers: illuminance at points and on workplanes, and luminance along rays."""

from __future__ import annotations

import os
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _lumivox
from ._arrays import Floats, floats, vector, whole
from ._records import Camera
from .errors import InputError
from .picture import write

if TYPE_CHECKING:
    from .render import Renderer
    from .scene import Progress, Scene

#: The weights of linear RGB in luminance and illuminance (ITU-R BT.709-6, section 3.2).
LUMINANCE = (0.2126, 0.7152, 0.0722)

#: Maximum number of places that the path tracer measures at once, and of cells of a workplane.
MOST_PLACES = 1 << 20

#: Methods of measuring: cones, in milliseconds, or paths, without bias and with a standard error.
METHODS = ("cones", "paths")


def photometric(rgb: Floats) -> Floats:
    """The illuminance or luminance (...) of linear RGB (..., 3)."""
    return np.asarray(rgb @ np.array(LUMINANCE, np.float32), np.float32)


def places(name: str, points: Any, towards_name: str, towards: Any) -> tuple[Floats, Floats]:
    """Points (..., 3) and as many directions; one direction stands for all."""
    array = floats(name, points, *[(None,) * n + (3,) for n in range(1, 5)], (3,))
    directions = np.broadcast_to(floats(towards_name, towards, array.shape, (3,)), array.shape)
    lengths = np.linalg.norm(directions.reshape(-1, 3), axis=1)
    if (lengths == 0.0).any():
        raise InputError(f"{towards_name}: number {int(np.argmin(lengths))} has no direction")
    return array, directions


class Irradiance:
    """Irradiance at points, in lux.

    ``lux`` (...) is the illuminance, and ``standard_error`` (...) its standard error, or ``None``
    where it was found by cones. ``direct`` (straight from lamps and suns) and ``indirect`` (from
    surfaces and surroundings) are (..., 3), by the channels of linear RGB; ``openness`` (...) is the
    share of the hemisphere that is open, weighted by the cosine. All are float32. As an array
    (``np.asarray``) it is its ``lux``.
    """

    def __init__(
        self,
        direct: Floats,
        indirect: Floats,
        openness: Floats,
        lux: Floats,
        standard_error: Floats | None,
    ) -> None:
        self.direct = direct
        self.indirect = indirect
        self.openness = openness
        self.lux = lux
        self.standard_error = standard_error

    @property
    def rgb(self) -> Floats:
        """Direct and indirect together, (..., 3)."""
        return self.direct + self.indirect

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.array(self.lux, dtype) if copy else np.asarray(self.lux, dtype)

    def __repr__(self) -> str:
        return f"<lumivox.Irradiance at {self.lux.size} points, mean {self.lux.mean():.4g} lux>"


class Luminance:
    """What arrives along rays: ``radiance`` (..., 3) in cd/m2 by the channels of linear RGB,
    ``luminance`` (...), and the ``standard_error`` (...) of the luminance. All are float32. As an
    array (``np.asarray``) it is its ``luminance``."""

    def __init__(self, radiance: Floats, luminance: Floats, standard_error: Floats) -> None:
        self.radiance = radiance
        self.luminance = luminance
        self.standard_error = standard_error

    def __array__(self, dtype: Any = None, copy: bool | None = None) -> Any:
        return np.array(self.luminance, dtype) if copy else np.asarray(self.luminance, dtype)

    def __repr__(self) -> str:
        mean = self.luminance.mean()
        return f"<lumivox.Luminance along {self.luminance.size} rays, mean {mean:.4g} cd/m2>"


def _digits(value: float) -> str:
    """Four digits, or the whole number."""
    return f"{value:.0f}" if value >= 1000 else f"{value:.4g}"


class Workplane:
    """A flat grid of points in the middles of equal cells, and the illuminance there.

    ``points`` is (rows, columns, 3), ``lux`` (rows, columns) float32. ``mean``, ``minimum`` and
    ``maximum`` are in lux; ``uniformity`` is the least illuminance over the mean (EN 12464-1:2021),
    0 to 1, and 0 in darkness. In a notebook it shows itself in false colours.
    """

    def __init__(self, points: Floats, irradiance: Irradiance) -> None:
        self.points = points
        self.irradiance = irradiance
        self.lux = irradiance.lux
        figures = _lumivox.summary(np.ascontiguousarray(self.lux).tobytes())
        self.mean, self.minimum, self.maximum, self.uniformity = figures

    def _figures(self) -> str:
        return (
            f"mean {_digits(self.mean)} lux, least {_digits(self.minimum)}, greatest "
            f"{_digits(self.maximum)}, uniformity {self.uniformity:.3f}"
        )

    def png(self, title: str = "workplane", scale: tuple[float, float] | None = None) -> bytes:
        """A picture in false colours, PNG; ``scale`` is the lux at the ends of the colours, by
        default 0 and the greatest. The first row is at the top."""
        ends = None
        if scale is not None:
            low, high = floats("scale", scale, (2,)).tolist()
            if not 0.0 <= low < high:
                raise InputError(f"scale: is {scale}, but must rise from at least 0")
            ends = (low, high)
        rows, columns = self.lux.shape
        texts = (title, self._figures(), "lux")
        values = np.ascontiguousarray(self.lux).tobytes()
        return _lumivox.false_color(values, (columns, rows), texts, ends)

    def to_png(
        self,
        path: str | os.PathLike[str],
        title: str = "workplane",
        scale: tuple[float, float] | None = None,
    ) -> None:
        """Writes :meth:`png`."""
        write(path, self.png(title, scale))

    def _repr_png_(self) -> bytes:
        return self.png()

    def __repr__(self) -> str:
        rows, columns = self.lux.shape
        return f"<lumivox.Workplane {rows} x {columns}: {self._figures()}>"


def workplane_points(origin: Any, along: Any, across: Any, shape: tuple[int, int]) -> Floats:
    """The middles of ``shape`` (rows, columns) equal cells of a parallelogram, (rows, columns, 3).

    ``origin`` is a corner, m; ``along`` the edge that the columns divide, ``across`` that of the
    rows, both as vectors in metres.
    """
    try:
        rows, columns = (int(length) for length in shape)
    except (TypeError, ValueError):
        rows = columns = 0
    if rows < 1 or columns < 1 or rows * columns > MOST_PLACES:
        raise InputError(
            f"shape: is {shape}, but must be two whole numbers of at least 1, with a product of at "
            f"most {MOST_PLACES}"
        )
    corner = vector("origin", origin)
    edges = vector("along", along), vector("across", across)
    if not np.linalg.norm(np.cross(*edges)) > 0.0:
        raise InputError("along, across: must be two edges of an area")
    data = _lumivox.workplane_points(corner, *edges, (rows, columns))
    return np.frombuffer(data, np.float32).reshape(rows, columns, 3)


def _trace(
    scene: Scene,
    name: str,
    array: Floats,
    directions: Floats,
    is_along_rays: bool,
    samples: int,
    seed: int,
    bounces: int | None,
    surroundings: str,
    adapter: str | None,
    progress: Progress | None,
) -> Floats:
    """The path tracer's readings, (..., 9)."""
    from .render import _scene

    if array.size > 3 * MOST_PLACES:
        raise InputError(f"{name}: has {array.size // 3} places, but must have at most {MOST_PLACES} for paths")
    data = _lumivox.measure(
        _scene(scene),
        array.tobytes(),
        np.ascontiguousarray(directions).tobytes(),
        is_along_rays,
        whole("samples", samples, 1, 1 << 24),
        whole("seed", seed, 0, (1 << 32) - 1),
        None if bounces is None else whole("bounces", bounces, 0, (1 << 32) - 1),
        surroundings,
        adapter,
        progress,
    )
    return np.frombuffer(data, np.float32).reshape(*array.shape[:-1], 9)


def irradiance(
    scene: Scene,
    points: Any,
    normals: Any = (0.0, 1.0, 0.0),
    *,
    method: str = "cones",
    frames: int = 16,
    samples: int = 1024,
    seed: int = 0,
    bounces: int | None = None,
    surroundings: str = "none",
    adapter: str | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Irradiance:
    """The illuminance at points, as of a lux meter; ``.lux`` has the shape of ``points`` less its
    last axis.

    ``points`` is (..., 3) in metres, on surfaces or in the air; ``normals`` has the same shape, or is
    one for all. By the method ``"cones"`` it is gathered in voxels, over ``frames`` frames (1 to
    65536), with the ``settings`` of a :class:`Renderer` (which does the same for a scene that is on
    the GPU already). By ``"paths"`` it is path-traced without bias, with ``samples`` (1 to 16777216)
    for each point and a standard error; the ``seed`` chooses the noise. ``bounces`` limits indirect
    light. No light is added to the scene unless ``surroundings`` asks for it.
    """
    array, towards = places("points", points, "normals", normals)
    if method == "cones":
        if bounces is not None:
            settings["bounces"] = bounces
        renderer = _renderer(scene, surroundings, adapter, progress, settings)
        return renderer.irradiance(array, towards, frames)
    if method != "paths":
        raise InputError(f"method: is {method!r}, but must be one of {', '.join(METHODS)}")
    if settings:
        raise InputError(f"{next(iter(settings))}: is a setting of cones, which has no effect on paths")
    if array.size == 0:
        light: Floats = np.zeros((*array.shape[:-1], 9), np.float32)
    else:
        options = (samples, seed, bounces, surroundings, adapter, progress)
        light = _trace(scene, "points", array, towards, False, *options)
    direct = light[..., 3:6]
    return Irradiance(direct, light[..., 0:3] - direct, light[..., 8], light[..., 6], light[..., 7])


def luminance(
    scene: Scene,
    origins: Any,
    directions: Any,
    *,
    samples: int = 1024,
    seed: int = 0,
    bounces: int | None = None,
    surroundings: str = "none",
    adapter: str | None = None,
    progress: Progress | None = None,
) -> Luminance:
    """What arrives at ``origins`` (..., 3) from ``directions`` (as many, or one for all),
    path-traced with ``samples`` for each, as of a luminance meter. A ray that starts on a surface may
    meet it: start in the air. Lamps and suns without a surface are not seen."""
    array, towards = places("origins", origins, "directions", directions)
    if array.size == 0:
        nothing: Floats = np.zeros(array.shape[:-1], np.float32)
        return Luminance(np.zeros(array.shape, np.float32), nothing, nothing)
    options = (samples, seed, bounces, surroundings, adapter, progress)
    light = _trace(scene, "origins", array, towards, True, *options)
    return Luminance(light[..., 0:3], light[..., 6], light[..., 7])


def _renderer(
    scene: Scene,
    surroundings: str,
    adapter: str | None,
    progress: Progress | None,
    settings: dict[str, Any],
) -> Renderer:
    """A renderer whose pictures do not matter."""
    from .render import Renderer

    camera = Camera.look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0)) if surroundings == "none" else None
    return Renderer(
        scene,
        camera,
        (16, 16),
        surroundings=surroundings,
        adapter=adapter,
        progress=progress,
        **settings,
    )


def workplane(
    renderer: Renderer | Scene,
    origin: Any,
    along: Any,
    across: Any,
    shape: tuple[int, int] = (10, 10),
    *,
    normal: Any = (0.0, 1.0, 0.0),
    frames: int = 16,
    **options: Any,
) -> Workplane:
    """The illuminance on a grid of a workplane, for example 0.85 m above a floor.

    The grid is that of :func:`workplane_points`. Of a scene, ``options`` are those of
    :func:`irradiance`, ``method`` among them; of a renderer, whose voxels are used, there are none.
    """
    from .render import Renderer

    points = workplane_points(origin, along, across, shape)
    if not isinstance(renderer, Renderer):
        return Workplane(points, irradiance(renderer, points, normal, frames=frames, **options))
    if options:
        raise InputError(f"{next(iter(options))}: has no effect on a renderer that exists")
    return Workplane(points, renderer.irradiance(points, normal, frames))
