"""Illuminance of cones and of the path tracer against closed forms, after the analytical part of
CIE 171:2006, "Test cases to assess the accuracy of lighting computer programs".

``python tests/test_closed_forms.py`` prints the table of docs/measure.md.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import lumivox
from lumivox import Light, Material, Scene

from conftest import BLACK, floor, lambert, quad

Array = npt.NDArray[Any]
#: Corner, u and v of a parallelogram by its name.
Walls = dict[str, tuple[Any, Any, Any]]


@dataclass
class Case:
    """Points with their illuminance in closed form, lux; with ``weights``, their weighted mean."""

    name: str
    scene: Scene
    points: Array
    normals: Any
    lux: Array
    #: The greatest allowed error of cones, relative to the greatest illuminance.
    cones: float
    weights: Array | None = None


def square(height: float, edge: float) -> Array:
    """The corners of a level square around the origin, turning so that it faces down."""
    half = edge / 2
    return np.array([(-half, height, -half), (half, height, -half), (half, height, half), (-half, height, half)])


def spread(count: int = 7, reach: float = 1.5) -> Array:
    """Points of a floor, along a line from its middle."""
    x = np.linspace(0.0, reach, count)
    return np.stack([x, np.zeros(count), 0.4 * x], 1)


def point_source() -> Case:
    scene = floor(BLACK)
    scene.lights = [Light(intensity=300, position=(0, 1.5, 0))]
    points = spread()
    away = np.linalg.norm(points - (0, 1.5, 0), axis=1)
    return Case("a point source above a plane", scene, points, (0, 1, 0), 300 * 1.5 / away**3, 1e-4)


def area_source() -> Case:
    scene = floor(BLACK)
    corners = square(1.5, 1.0)
    glow = Material(base_color=0.0, emissive=1000.0)
    quad(scene, corners[0], corners[1] - corners[0], corners[3] - corners[0], glow, "panel")
    points = spread()
    lux = np.array([1000 * lambert(corners, point, (0, 1, 0)) for point in points])
    return Case("a luminous square above a plane", scene, points, (0, 1, 0), lux, 0.03)


def reflecting_square() -> Case:
    """A square of albedo 0.5 below a sun that lights it evenly, and the points of a wall beside it."""
    scene = Scene("reflection")
    quad(scene, (-0.5, 0, 0.5), (1, 0, 0), (0, 0, -1), Material(base_color=0.5), "square")
    # The grid of the cones ends where the scene ends.
    quad(scene, (-1.0, -0.2, 1.0), (0, 0, -2), (0, 2.4, 0), BLACK, "wall")
    scene.lights = [Light("directional", 10_000, direction=(0, -1, 0))]
    heights = np.linspace(0.2, 2.0, 7)
    points = np.stack([np.full(7, -1.0), heights, np.zeros(7)], 1)
    corners = square(0.0, 1.0)
    lux = np.array([0.5 * 10_000 / np.pi * lambert(corners, point, (1, 0, 0)) for point in points])
    return Case("light reflected by a diffuse square", scene, points, (1, 0, 0), lux, 0.15)


def closed_room() -> Case:
    """A closed cube of one albedo: what its walls absorb is what its lamp sends, so the mean over all
    walls is the flux over the area and the absorbed share."""
    scene, albedo, edge, candela = Scene("room"), 0.5, 2.0, 100.0
    grey = Material(base_color=albedo)
    points, normals = [], []
    # Gauss's rule is exact for smooth light; the middles of as many cells are 0.2 % too bright.
    nodes, weights = np.polynomial.legendre.leggauss(12)
    each = nodes * edge / 2
    for axis in range(3):
        for side in (-1.0, 1.0):
            normal = np.zeros(3)
            normal[axis] = -side
            u = np.eye(3)[(axis + 1) % 3]
            v = np.cross(normal, u)
            quad(scene, -normal * edge / 2 - (u + v) * edge / 2, u * edge, v * edge, grey, f"wall{axis}{side}")
            grid = -normal * edge / 2 + each[:, None, None] * u + each[None, :, None] * v
            points.append(grid.reshape(-1, 3))
            normals.append(np.broadcast_to(normal, (144, 3)))
    scene.lights = [Light(intensity=candela, position=(0, 0, 0))]
    lux = 4 * np.pi * candela / (6 * edge**2) / (1 - albedo)
    return Case(
        "the mean over a closed room of albedo 0.5",
        scene,
        np.concatenate(points),
        np.concatenate(normals),
        np.array([lux]),
        0.1,
        weights=np.tile(np.outer(weights, weights).ravel() / 24, 6),
    )


def _room(scene: Scene, walls: Walls) -> None:
    black = Material(base_color=0.0, double_sided=True)
    for name, (corner, u, v) in walls.items():
        quad(scene, corner, u, v, black, name)


def roof_opening() -> Case:
    """A black room of 4 m by 4 m, 2 m high, with a hole of 1 m by 1 m in the middle of its roof."""
    scene = floor(BLACK)
    _room(
        scene,
        {
            "west": ((-2, 0, 2), (0, 0, -4), (0, 2, 0)),
            "east": ((2, 0, -2), (0, 0, 4), (0, 2, 0)),
            "north": ((-2, 0, -2), (4, 0, 0), (0, 2, 0)),
            "south": ((2, 0, 2), (-4, 0, 0), (0, 2, 0)),
            "roof north": ((-2, 2, -2), (4, 0, 0), (0, 0, 1.5)),
            "roof south": ((-2, 2, 0.5), (4, 0, 0), (0, 0, 1.5)),
            "roof west": ((-2, 2, -0.5), (1.5, 0, 0), (0, 0, 1)),
            "roof east": ((0.5, 2, -0.5), (1.5, 0, 0), (0, 0, 1)),
        },
    )
    scene.set_environment(5000)
    points, corners = spread(), square(2.0, 1.0)
    lux = np.array([5000 * lambert(corners, point, (0, 1, 0)) for point in points])
    return Case("a uniform sky through an opening of a roof", scene, points, (0, 1, 0), lux, 0.15)


def facade_opening() -> Case:
    """A black room with a window of 1 m by 1 m in a wall at z = -1.5, whose sill is 0.5 m above the floor."""
    scene = floor(BLACK, 3.0)
    _room(
        scene,
        {
            "west": ((-1.5, 0, 1.5), (0, 0, -3), (0, 2.5, 0)),
            "east": ((1.5, 0, -1.5), (0, 0, 3), (0, 2.5, 0)),
            "south": ((1.5, 0, 1.5), (-3, 0, 0), (0, 2.5, 0)),
            "roof": ((-1.5, 2.5, -1.5), (3, 0, 0), (0, 0, 3)),
            "below": ((-1.5, 0, -1.5), (3, 0, 0), (0, 0.5, 0)),
            "above": ((-1.5, 1.5, -1.5), (3, 0, 0), (0, 1, 0)),
            "left": ((-1.5, 0.5, -1.5), (1, 0, 0), (0, 1, 0)),
            "right": ((0.5, 0.5, -1.5), (1, 0, 0), (0, 1, 0)),
        },
    )
    scene.set_environment(5000)
    z = np.linspace(-1.0, 0.8, 6)
    points = np.stack([np.full(6, 0.2), np.zeros(6), z], 1)
    window = np.array([(-0.5, 0.5, -1.5), (0.5, 0.5, -1.5), (0.5, 1.5, -1.5), (-0.5, 1.5, -1.5)])
    lux = np.array([5000 * lambert(window, point, (0, 1, 0)) for point in points])
    return Case("a uniform sky through an opening of a facade", scene, points, (0, 1, 0), lux, 0.15)


def overcast_sky() -> Case:
    """The CIE overcast sky (Moon and Spencer 1942), L = Lz (1 + 2 sin e) / 3 at an elevation e, on level
    and upright surfaces: 7/9 pi Lz and (pi/6 + 4/9) Lz, above a black ground."""
    scene = floor(BLACK, 40.0)
    rows = np.sin(np.pi / 2 - (np.arange(256) + 0.5) / 256 * np.pi)
    sky = np.where(rows > 0, 3000 * (1 + 2 * rows) / 3, 0.0)
    texels = np.broadcast_to(sky[:, None, None], (256, 512, 3)).astype(np.float32)
    scene.set_environment(map=texels)
    # The upright surfaces are high enough that cones hit no ground.
    points = np.array([(0, 0, 0), (0, 4, 0), (0, 4, 0), (0, 4, 0)])
    normals = np.array([(0, 1, 0), (1, 0, 0), (0, 0, -1), (0.6, 0, 0.8)])
    lux = 3000 * np.array([7 / 9 * np.pi, *[np.pi / 6 + 4 / 9] * 3])
    return Case("the CIE overcast sky, level and upright", scene, points, normals, lux, 0.05)


CASES: list[Callable[[], Case]] = [
    point_source,
    area_source,
    reflecting_square,
    closed_room,
    roof_opening,
    facade_opening,
    overcast_sky,
]


def errors(case: Case, frames: int, samples: int) -> tuple[Array, Array, Array]:
    """The errors of cones and paths, and the standard errors of paths, relative to the greatest lux."""
    greatest = case.lux.max()
    cones = lumivox.irradiance(case.scene, case.points, case.normals, frames=frames, resolution=128)
    paths = lumivox.irradiance(case.scene, case.points, case.normals, method="paths", samples=samples)
    assert paths.standard_error is not None
    found, traced, sigma = cones.lux, paths.lux, paths.standard_error
    if case.weights is not None:
        found, traced = ((light * case.weights).sum(keepdims=True) for light in (found, traced))
        sigma = np.sqrt(((sigma * case.weights) ** 2).sum(keepdims=True))
    return (found - case.lux) / greatest, (traced - case.lux) / greatest, sigma / greatest


@pytest.mark.parametrize("make", CASES, ids=lambda make: make.__name__)
def test_irradiance_matches_the_closed_form(make: Callable[[], Case]) -> None:
    case = make()
    cones, paths, sigma = errors(case, frames=64, samples=1024)
    print(f"{case.name}: cones {cones}, paths {paths} +- {sigma}")
    # Four standard errors, and 1e-4 for the rounding of f32 and the texels of a sky.
    assert (abs(paths) <= 4 * sigma + 1e-4).all()
    assert (abs(cones) <= case.cones).all()


def _percent(error: Array) -> str:
    return f"{100 * float(error[np.abs(error).argmax()]):+.2f}"


if __name__ == "__main__":
    print("| case | lux | cones, % | path tracer, % | its standard error, % |")
    print("| --- | ---: | ---: | ---: | ---: |")
    for make in CASES:
        case = make()
        cones, paths, sigma = errors(case, frames=256, samples=1 << 14)
        low, high = case.lux.min(), case.lux.max()
        lux = f"{high:.4g}" if low == high else f"{low:.4g} to {high:.4g}"
        print(f"| {case.name} | {lux} | {_percent(cones)} | {_percent(paths)} | {100 * sigma.max():.2f} |")
