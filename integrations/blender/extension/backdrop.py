"""The surroundings as the camera sees them: without surfaces, and to take them out of pictures."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np

from . import model
from .translate.camera import View
from .units import nits


@dataclass(frozen=True)
class Picture:
    """What Lumivox returns of a scene with surfaces."""

    radiance: np.ndarray
    coverage: np.ndarray
    layers: dict[str, np.ndarray] = field(default_factory=dict)


def picture(view: View, world: model.World, layers: Iterable[str]) -> Picture:
    """The picture of a scene without surfaces, with its layers."""
    width, height = view.canvas
    whole = replace(view, left=0, top=0, width=width, height=height)
    made: dict[str, np.ndarray] = {}
    for name in layers:
        if name == "instance":
            made[name] = np.full((height, width), -1, np.int32)
        else:
            channels = () if name == "depth" else (3,)
            made[name] = np.zeros((height, width, *channels), np.float32)
    return Picture(radiance(whole, world), np.zeros((height, width), np.float32), made)


def radiance(view: View, world: model.World) -> np.ndarray:
    """The radiance (H, W, 3) in cd/m2 behind all surfaces, at the middles of Blender's pixels."""
    factor = np.array([nits(channel) for channel in world.radiance], np.float32)
    if world.panorama is None:
        return np.tile(factor, (view.height, view.width, 1))
    height, width = world.panorama.shape[:2]
    rays = view.rays()
    # From -z in the middle to the right, less the turn of the panorama.
    around = np.arctan2(rays[..., 0], -rays[..., 2]) + np.radians(world.rotation_deg)
    column = (0.5 + around / (2.0 * np.pi)) * width - 0.5
    row = (0.5 - np.arcsin(np.clip(rays[..., 1], -1.0, 1.0)) / np.pi) * height - 0.5
    found = np.zeros((view.height, view.width, 3))
    for down in (0, 1):
        for right in (0, 1):
            y, x = np.floor(row).astype(int) + down, np.floor(column).astype(int) + right
            share = (1.0 - abs(row - y)) * (1.0 - abs(column - x))
            texels = world.panorama[np.clip(y, 0, height - 1), x % width]
            found += share[..., None] * texels
    return np.float32(found * factor)
