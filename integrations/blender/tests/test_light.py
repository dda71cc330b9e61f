"""Units: each kind of light gives what Cycles measures."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest

import scenes
from conftest import color, small


def _floor() -> None:
    scenes._begin(world=(0.0, 0.0, 0.0))
    scenes._quad("floor", (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), scenes.material("grey", (0.5,) * 3))
    scenes._camera((0, -2.2, 1.6), (0, 0, 0), lens=45)


def _lamp(kind: str, energy: float, place: Any = (0.3, 0.2, 1.5)) -> Any:
    lamp = scenes._light("lamp", kind, place, energy, (1.0, 0.7, 0.4))
    scenes._aim(lamp, (-0.1, 0.1, -1.0))
    # Outside of the picture of the floor, and not seen from behind.
    lamp.visible_camera = False
    return lamp


def point() -> None:
    _lamp("POINT", 40.0).data.shadow_soft_size = 0.1


def unscaled_point() -> None:
    lamp = _lamp("POINT", 500.0)
    lamp.data.shadow_soft_size, lamp.data.normalize = 0.1, False


def spot() -> None:
    lamp = _lamp("SPOT", 200.0)
    lamp.data.spot_size, lamp.data.spot_blend = math.radians(60), 0.4


def sun() -> None:
    lamp = _lamp("SUN", 3.0)
    lamp.data.angle, lamp.data.exposure = math.radians(5), 1.0


def square() -> None:
    _lamp("AREA", 30.0).data.size = 0.5


def ellipse() -> None:
    lamp = _lamp("AREA", 30.0)
    lamp.data.shape, lamp.data.size, lamp.data.size_y = "ELLIPSE", 0.8, 0.3
    lamp.scale = (1.5, 1.5, 1.0)


def unscaled_area() -> None:
    lamp = _lamp("AREA", 20.0)
    lamp.data.normalize, lamp.data.size = False, 0.5


def warm_point() -> None:
    lamp = _lamp("POINT", 40.0)
    lamp.data.use_temperature, lamp.data.temperature = True, 3000.0


def world() -> None:
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.2, 0.5, 0.8, 1)
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 1.5


def emission() -> None:
    glow = scenes.material("glow", (0.0, 0.0, 0.0))
    scenes._principled(glow).inputs["Emission Color"].default_value = (1.0, 0.6, 0.3, 1.0)
    scenes._principled(glow).inputs["Emission Strength"].default_value = 20.0
    scenes._box("glow", (0, 0, 1.2), (0.4, 0.4, 0.1), glow)


LIGHTS = (point, unscaled_point, spot, sun, square, ellipse, unscaled_area, warm_point, world, emission)


@pytest.mark.parametrize("make", LIGHTS, ids=lambda make: make.__name__)
def test_lights_have_blenders_units(make: Callable[[], None], exr: Any) -> None:
    _floor()
    make()
    small((24, 16))
    ours, cycles = color(exr(samples=16)), color(exr("CYCLES", samples=256))
    means = ours.mean(axis=(0, 1)), cycles.mean(axis=(0, 1))
    assert means[1].max() > 0.02
    np.testing.assert_allclose(means[0], means[1], rtol=0.02, err_msg=make.__name__)
    # The light is at the same places, too.
    blur = [picture[..., 1].reshape(4, 4, 6, 4).mean(axis=(1, 3)) for picture in (ours, cycles)]
    assert abs(blur[0] - blur[1]).max() < 0.1 * blur[1].max()


def test_a_panorama_is_turned_as_in_cycles(exr: Any) -> None:
    scenes.panorama()
    small((32, 24))
    # So that the sun is in the picture.
    mapping = bpy.context.scene.world.node_tree.nodes["Mapping"]
    mapping.inputs["Rotation"].default_value[2] = math.radians(-10)
    ours, cycles = color(exr(samples=4)), color(exr("CYCLES", samples=64))
    # The upper rows show only the sky.
    assert np.ptp(cycles[:6, :, 0]) > 1.0
    np.testing.assert_allclose(ours[:6], cycles[:6], rtol=0.05)
    np.testing.assert_allclose(ours.mean(axis=(0, 1)), cycles.mean(axis=(0, 1)), rtol=0.03)


@pytest.mark.parametrize("kind", ("SUN", "POINT"))
def test_soft_shadows_are_as_wide_as_in_cycles(kind: str, exr: Any) -> None:
    _floor()
    # It covers the left half of the floor, above the camera.
    scenes._camera((0, -2.4, 0.9), (0, 0, 0), lens=45)
    black = scenes.material("black", (0.0, 0.0, 0.0))
    scenes._quad("cover", (-3, -3, 1.3), (0, -3, 1.3), (0, 3, 1.3), (-3, 3, 1.3), black)
    lamp = _lamp(kind, 3.0 if kind == "SUN" else 300.0, (0.0, 0.0, 2.6))
    if kind == "SUN":
        lamp.rotation_euler = (0.0, 0.0, 0.0)
        lamp.data.angle = math.radians(30)
    else:
        lamp.data.shadow_soft_size = 0.3
    scene = small((24, 16))
    scene.lumivox.resolution, scene.lumivox.shadows = 64, "cone"
    rows = [color(exr(samples=64)), color(exr("CYCLES", samples=512))]
    profiles = [picture[6:12, :, 1].mean(axis=0) / picture[:, :, 1].max() for picture in rows]
    wide = [np.count_nonzero((profile > 0.1) & (profile < 0.6)) for profile in profiles]
    assert wide[1] >= 3
    np.testing.assert_allclose(profiles[0], profiles[1], atol=0.12)
