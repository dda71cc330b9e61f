"""Small scenes and settings: a software GPU renders them in a second."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import lumivox
from lumivox import Material, Scene

#: Settings of small pictures.
SMALL: dict[str, Any] = {"resolution": 32, "frames": 2, "bounces": 1, "shadow_resolution": 128}

BLACK = Material(base_color=0.0)


def quad(
    scene: Scene, corner: Any, u: Any, v: Any, material: Material | None = None, name: str = "quad"
) -> None:
    """Adds a parallelogram whose front is towards u x v."""
    a, b, c = (np.array(vector, float) for vector in (corner, u, v))
    scene.add([a, a + b, a + b + c, a + c], [[0, 1, 2], [0, 2, 3]], material=material, name=name)


def floor(material: Material | None = None, edge_m: float = 4.0) -> Scene:
    """A floor at a height of 0, its middle at the origin."""
    scene = Scene("floor")
    half = edge_m / 2
    quad(scene, (-half, 0, half), (edge_m, 0, 0), (0, 0, -edge_m), material, "floor")
    return scene


def lambert(corners: Any, point: Any, normal: Any) -> float:
    """The irradiance of a polygon of radiance 1 (Lambert 1760; Arvo 1995, "Analytic methods for
    simulated light transport", section 2.2): half the sum over edges of the angle times the cosine
    between the edge's plane and the surface."""
    rays = [np.subtract(corner, point) for corner in corners]
    rays = [ray / np.linalg.norm(ray) for ray in rays]
    total = 0.0
    for a, b in zip(rays, rays[1:] + rays[:1]):
        across = np.cross(a, b)
        angle = np.arctan2(np.linalg.norm(across), a @ b)
        total += float(angle * (across / np.linalg.norm(across)) @ np.array(normal))
    return abs(total) / 2


@pytest.fixture(scope="session")
def cornell() -> Scene:
    return Scene.builtin("cornell")


@pytest.fixture(scope="session")
def renderer(cornell: Scene) -> lumivox.Renderer:
    layers = ("irradiance", "depth", "instance", "material", "normal")
    return lumivox.Renderer(cornell, size=(48, 32), layers=layers, **SMALL)
