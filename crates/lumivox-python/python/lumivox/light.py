"""Light as numbers: irradiance at points, and on the grid of a workplane."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from ._arrays import Floats, vector
from .errors import InputError

if TYPE_CHECKING:
    from .render import Renderer
    from .scene import Scene

#: The weights of linear RGB in luminance and illuminance (ITU-R BT.709-6, section 3.2).
LUMINANCE = (0.2126, 0.7152, 0.0722)


class Irradiance:
    """Irradiance at points, in lux.

    ``direct`` (straight from lamps and suns) and ``indirect`` (from surfaces and surroundings) are
    (..., 3), by the channels of linear RGB; ``openness`` (...) is the share of the hemisphere that
    is open, weighted by the cosine. All are float32.
    """

    def __init__(self, gathered: Floats) -> None:
        self.direct: Floats = gathered[..., 0:3]
        self.indirect: Floats = gathered[..., 3:6]
        self.openness: Floats = gathered[..., 6]

    @property
    def rgb(self) -> Floats:
        """Both together, (..., 3)."""
        return self.direct + self.indirect

    @property
    def lux(self) -> Floats:
        """The illuminance (...)."""
        weights = np.array(LUMINANCE, np.float32)
        return np.asarray(self.rgb @ weights, np.float32)

    def __repr__(self) -> str:
        return f"<lumivox.Irradiance at {self.openness.size} points, mean {self.lux.mean():.4g} lux>"


class Workplane:
    """A flat grid of points in the middles of equal cells, and the illuminance there.

    ``points`` is (rows, columns, 3), ``lux`` (rows, columns) float32.
    """

    def __init__(self, points: Floats, irradiance: Irradiance) -> None:
        self.points = points
        self.irradiance = irradiance
        self.lux = irradiance.lux

    @property
    def mean(self) -> float:
        """The mean illuminance, lux."""
        return float(self.lux.mean(dtype=np.float64))

    @property
    def minimum(self) -> float:
        """The least illuminance, lux."""
        return float(self.lux.min())

    @property
    def maximum(self) -> float:
        """The highest illuminance, lux."""
        return float(self.lux.max())

    @property
    def uniformity(self) -> float:
        """The least illuminance over the mean (EN 12464-1:2021, section 3.11), 0 to 1; 0 in darkness."""
        return self.minimum / self.mean if self.mean > 0.0 else 0.0

    def __repr__(self) -> str:
        rows, columns = self.lux.shape
        return (
            f"<lumivox.Workplane {rows} x {columns}: mean {self.mean:.4g} lux, minimum "
            f"{self.minimum:.4g} lux, uniformity {self.uniformity:.3f}>"
        )


def workplane_points(origin: Any, along: Any, across: Any, shape: tuple[int, int]) -> Floats:
    """The middles of ``shape`` (rows, columns) equal cells of a parallelogram, (rows, columns, 3).

    ``origin`` is a corner, m; ``along`` the edge that the columns divide, ``across`` that of the
    rows, both as vectors in metres.
    """
    try:
        rows, columns = (int(length) for length in shape)
    except (TypeError, ValueError):
        rows = columns = 0
    if rows < 1 or columns < 1:
        raise InputError(f"shape: is {shape}, but must be two whole numbers of at least 1")
    corner = np.array(vector("origin", origin))
    edges = np.array(vector("along", along)), np.array(vector("across", across))
    if not np.linalg.norm(np.cross(*edges)) > 0.0:
        raise InputError("along, across: must be two edges of an area")
    u = ((np.arange(columns) + 0.5) / columns)[None, :, None]
    v = ((np.arange(rows) + 0.5) / rows)[:, None, None]
    return np.asarray(corner + u * edges[0] + v * edges[1], np.float32)


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
    :func:`irradiance`; of a renderer, whose voxels are used, there are none.
    """
    from .render import Renderer
    from ._records import Camera

    points = workplane_points(origin, along, across, shape)
    if not isinstance(renderer, Renderer):
        options = {"surroundings": "none", **options}
        camera = None
        if options["surroundings"] == "none":
            camera = Camera.look_at((0.0, 0.0, 1.0), (0.0, 0.0, 0.0))
        renderer = Renderer(renderer, camera, (16, 16), **options)
    elif options:
        raise InputError(f"{next(iter(options))}: has no effect on a renderer that exists")
    return Workplane(points, renderer.irradiance(points, normal, frames))
