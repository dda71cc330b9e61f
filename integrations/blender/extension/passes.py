"""The passes of Blender from the layers of Lumivox."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from . import backdrop, model
from .translate.camera import View
from .units import LUMENS_PER_WATT, from_lumivox

#: Blender's depth where nothing is.
FAR_AWAY = 1e10


@dataclass(frozen=True)
class Pass:
    """A pass: Blender's name, channels, and the attribute of a view layer that asks for it."""

    name: str
    channels: str
    kind: str
    wish: str
    #: The layers of Lumivox that it needs.
    layers: tuple[str, ...]
    #: Whether it shows the middle of a pixel, so that edges are not smoothed.
    is_of_middle: bool = False


PASSES = (
    Pass("Depth", "Z", "VALUE", "use_pass_z", ("depth",), True),
    Pass("Normal", "XYZ", "VECTOR", "use_pass_normal", ("normal",)),
    Pass("Diffuse Direct", "RGB", "COLOR", "use_pass_diffuse_direct", ("direct", "albedo")),
    Pass("Diffuse Indirect", "RGB", "COLOR", "use_pass_diffuse_indirect", ("irradiance",)),
    Pass("Diffuse Color", "RGB", "COLOR", "use_pass_diffuse_color", ("albedo",)),
    Pass("Object Index", "X", "VALUE", "use_pass_object_index", ("instance",), True),
    Pass("Material Index", "X", "VALUE", "use_pass_material_index", ("instance",), True),
    Pass("Vector", "XYZW", "VECTOR", "use_pass_vector", ("instance", "depth"), True),
)

Matrices = Mapping[tuple[Any, ...], Any]


@dataclass(frozen=True)
class Moment:
    """A view, and the matrices of instances by their keys, at a time."""

    view: View
    matrices: Matrices


def wanted(view_layer: Any) -> list[Pass]:
    """The passes beside Combined that a view layer asks for."""
    return [known for known in PASSES if getattr(view_layer, known.wish)]


def layers(asked: list[Pass]) -> set[str]:
    """The layers that passes need, and the notes on voxels."""
    return {layer for known in asked for layer in known.layers} | {"depth"}


def combined(picture: Any, view: View, world: model.World, is_transparent: bool) -> np.ndarray:
    """Radiance in Blender's units with alpha, (H, W, 4) from the top."""
    pixels = np.ones((view.height, view.width, 4), np.float32)
    light = view.cut(picture.radiance)
    if is_transparent:
        coverage = view.cut(picture.coverage)[..., None]
        # Colours are multiplied by alpha: only what surfaces send stays.
        light = light - (1.0 - coverage) * backdrop.radiance(view, world)
        light = np.where(coverage > 0.0, np.maximum(light, 0.0), 0.0)
        pixels[..., 3:] = coverage
    pixels[..., :3] = light / LUMENS_PER_WATT
    return pixels


def make(
    known: Pass,
    picture: Any,
    view: View,
    scene: model.Scene,
    before: Moment | None = None,
    after: Moment | None = None,
) -> np.ndarray:
    """A pass (H, W, channels) from the top. ``before`` and ``after`` are the neighbouring frames,
    for the vector pass."""
    layers = {name: view.cut(picture.layers[name]) for name in known.layers}
    coverage = view.cut(picture.coverage)[..., None]
    if known.name == "Depth":
        return _depth(layers["depth"], view)
    if known.name == "Normal":
        return from_lumivox(layers["normal"])
    if known.name == "Diffuse Color":
        return layers["albedo"]
    if known.name == "Diffuse Direct":
        albedo = layers["albedo"]
        with np.errstate(divide="ignore", invalid="ignore"):
            light = np.where(albedo > 1e-4, layers["direct"] / albedo, 0.0)
        return np.float32(light * coverage / LUMENS_PER_WATT)
    if known.name == "Diffuse Indirect":
        return np.float32(layers["irradiance"] / (np.pi * LUMENS_PER_WATT))
    numbers = layers["instance"]
    if known.name == "Vector":
        return _motion(layers["depth"], numbers, view, scene, before, after)
    if known.name == "Object Index":
        indices = [instance.index for instance in scene.instances]
    else:
        indices = [scene.materials[instance.material].index for instance in scene.instances]
    # The last one is that of the background, whose number is -1.
    return np.array([*indices, 0], np.float32)[numbers][..., None]


def _depth(distance: np.ndarray, view: View) -> np.ndarray:
    """The depth along the camera's axis, as of Blender's."""
    along = view.rays() @ np.array(view.forward)
    depth = np.where(distance > 0.0, distance * along - view.back_m, FAR_AWAY)
    return depth.astype(np.float32)[..., None]


def _motion(
    distance: np.ndarray,
    numbers: np.ndarray,
    view: View,
    scene: model.Scene,
    before: Moment | None,
    after: Moment | None,
) -> np.ndarray:
    """The way from here to the previous frame and from the next frame to here, in pixels to the
    right and up, as in Cycles. Objects count as rigid; the background does not move."""
    points = np.array(view.position) + view.rays() * distance[..., None]
    here = view.project(points)
    vectors = np.zeros((*distance.shape, 4), np.float32)
    identity = np.eye(4)
    for moment, channel, sign in ((before, 0, 1.0), (after, 2, -1.0)):
        if moment is None:
            continue
        moves = np.tile(identity, (len(scene.instances) + 1, 1, 1))
        for number, instance in enumerate(scene.instances):
            now, then = np.array(instance.matrix), moment.matrices.get(instance.key)
            if then is not None:
                moves[number] = np.array(then) @ np.linalg.inv(now)
        move = moves[numbers]
        there = np.einsum("...ij,...j->...i", move[..., :3, :3], points) + move[..., :3, 3]
        way = sign * (moment.view.project(there) - here)
        is_seen = (numbers >= 0) & np.isfinite(way).all(axis=2)
        vectors[..., channel : channel + 2] = np.where(is_seen[..., None], way, 0.0)
    return vectors


def voxel_share(picture: Any, view: View, voxel_m: float) -> float:
    """The edge of a voxel in the median of what is seen, as a share of the picture's height."""
    distance = view.cut(picture.layers["depth"])
    coverage = view.cut(picture.coverage)
    # The first frame has more samples of the coverage than of the distance.
    seen = (coverage > 0.5) & (distance > 0.0)
    if not seen.any():
        return 0.0
    middle = float(np.median(distance[seen] / coverage[seen]))
    height_m = 2.0 * middle * np.tan(np.radians(view.vertical_fov_deg) / 2.0)
    return voxel_m / (height_m * view.height / view.canvas[1])
