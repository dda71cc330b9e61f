"""Passes as those of Cycles."""

from __future__ import annotations

import math
from typing import Any

import bpy
import numpy as np
import pytest

import scenes
from conftest import color, read, shown, small
from extension import backdrop, passes
from extension.units import LUMENS_PER_WATT

DATA = ("z", "normal", "object_index", "material_index", "vector", "diffuse_color")


@pytest.fixture
def both(box: Any, exr: Any) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """The channels of Lumivox and Cycles of a frame in which object and camera move."""
    layer = bpy.context.view_layer
    for name in DATA:
        setattr(layer, f"use_pass_{name}", True)
    thing, camera = bpy.data.objects["box"], box.camera
    thing.pass_index, bpy.data.materials["red"].pass_index = 7, 3
    for frame, x, turn, height in ((1, -0.2, 0.0, 2.4), (2, 0.1, 0.2, 2.5), (3, 0.3, 0.6, 2.7)):
        thing.location.x, thing.rotation_euler.z, camera.location.z = x, turn, height
        thing.keyframe_insert("location", frame=frame)
        thing.keyframe_insert("rotation_euler", frame=frame)
        camera.keyframe_insert("location", frame=frame)
    box.frame_set(2)
    return exr(), exr("CYCLES", samples=64)


def test_data_passes_are_those_of_cycles(both: Any) -> None:
    ours, cycles = both
    tolerances = {
        "Depth.Z": 0.01,
        "Normal.X": 0.02,
        "Normal.Y": 0.02,
        "Normal.Z": 0.02,
        "Object Index.X": 0.0,
        "Material Index.X": 0.0,
        "Vector.X": 0.02,
        "Vector.Y": 0.02,
        "Vector.Z": 0.02,
        "Vector.W": 0.02,
        "Diffuse Color.R": 0.02,
        "Diffuse Color.G": 0.02,
    }
    for name, tolerance in tolerances.items():
        a, b = ours[f"ViewLayer.{name}"], cycles[f"ViewLayer.{name}"]
        assert np.ptp(b) > 0.05, name
        # At edges Cycles takes the first sample of a pixel, which is not in its middle.
        agree = abs(a - b) <= tolerance + 1e-4 * abs(b)
        assert agree.mean() > 0.85, (name, agree.mean(), a[12], b[12])


def test_diffuse_light_adds_up(box: Any, exr: Any) -> None:
    layer = bpy.context.view_layer
    for name in ("diffuse_direct", "diffuse_indirect", "diffuse_color"):
        setattr(layer, f"use_pass_{name}", True)
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.0
    ours, cycles = exr(samples=16), exr("CYCLES", samples=256)
    albedo = color(ours, "Diffuse Color")
    direct, indirect = color(ours, "Diffuse Direct"), color(ours, "Diffuse Indirect")
    # Surfaces are diffuse and dark outside: all light is in these passes. Not at edges, where a
    # mean of products is not the product of means.
    agree = abs(color(ours) - (direct + indirect) * albedo) < 0.01 * color(ours).max()
    assert agree.mean() > 0.85
    for name in ("Diffuse Direct", "Diffuse Indirect"):
        means = color(ours, name).mean(), color(cycles, name).mean()
        assert means[1] > 0.01
        assert means[0] == pytest.approx(means[1], rel=0.06), name


def test_a_transparent_film_has_the_coverage_as_alpha(exr: Any) -> None:
    scenes.panorama()
    scene = small((32, 24))
    scene.render.film_transparent = True
    ours, cycles = exr(samples=8), exr("CYCLES", samples=64)
    alpha = ours["ViewLayer.Combined.A"]
    assert alpha.min() == 0.0 and alpha.max() == pytest.approx(1.0)
    assert abs(alpha - cycles["ViewLayer.Combined.A"]).mean() < 0.02
    # Colours are multiplied by alpha, so that nothing of the sky is left.
    assert abs(color(ours)[alpha == 0.0]).max() == 0.0
    np.testing.assert_allclose(color(ours).mean((0, 1)), color(cycles).mean((0, 1)), rtol=0.05)


def test_coarse_voxels_are_told(box: Any) -> None:
    _, view = read()
    picture = shown(layers=("depth",))
    share = passes.voxel_share(picture, view, 0.25)
    # The middle of what is seen is about 5 m away.
    height = 2.0 * 5.2 * math.tan(math.radians(view.vertical_fov_deg) / 2.0)
    assert share == pytest.approx(0.25 / height, rel=0.15)


def test_edges_on_a_transparent_film_keep_only_the_surface(box: Any) -> None:
    data, view = read()
    sky = np.array(data.world.radiance, np.float32) * LUMENS_PER_WATT
    surface, coverage = np.float32(500.0), np.full((view.height, view.width), 0.25, np.float32)
    picture = backdrop.Picture(0.25 * surface + 0.75 * np.tile(sky, (*coverage.shape, 1)), coverage)
    pixels = passes.combined(picture, view, data.world, is_transparent=True)
    np.testing.assert_allclose(pixels[..., :3], 0.25 * surface / LUMENS_PER_WATT, rtol=1e-5)
    np.testing.assert_array_equal(pixels[..., 3], coverage)
    solid = passes.combined(picture, view, data.world, is_transparent=False)
    assert (solid[..., 3] == 1.0).all() and (solid[..., :3] > pixels[..., :3]).all()
