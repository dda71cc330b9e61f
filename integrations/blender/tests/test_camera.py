"""Cameras: where points are in the picture, and what the picture is cut out of."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

import scenes
from conftest import color, read, small
from extension.translate.camera import of_object
from extension.units import direction

POINTS = ((0.3, 0.2, 0.4), (-0.5, 0.4, 1.0), (0.1, -0.6, 0.2))


def _plain(data: Any) -> None:
    pass


def _shifted(data: Any) -> None:
    data.shift_x, data.shift_y = 0.25, -0.125


def _tall(data: Any) -> None:
    data.sensor_fit, data.sensor_height = "VERTICAL", 20.0


def _orthographic(data: Any) -> None:
    data.type, data.ortho_scale = "ORTHO", 3.0


@pytest.mark.parametrize("change", (_plain, _shifted, _tall, _orthographic))
@pytest.mark.parametrize("size", ((64, 32), (32, 64)))
def test_points_are_where_blender_sees_them(change: Any, size: tuple[int, int]) -> None:
    scenes._begin(world=(0, 0, 0))
    camera = scenes._camera((1.0, -4.0, 2.0), (0, 0, 0.4), lens=40)
    change(camera.data)
    scene = small(size)
    bpy.context.view_layer.update()
    _, view = read()
    for point in POINTS:
        share = world_to_camera_view(scene, camera, Vector(point))
        expected = np.array((share.x * size[0], share.y * size[1]))
        found = view.project(direction(point))
        # Parallel rays are shown as from far away.
        error = 0.25 if camera.data.type == "ORTHO" else 1e-3
        assert abs(found - expected).max() < error, (point, found, expected)
        if not (0 < found[0] < size[0] and 0 < found[1] < size[1]):
            continue
        row, column = size[1] - 1 - int(found[1]), int(found[0])
        along = direction(point) - np.array(view.position)
        along /= np.linalg.norm(along)
        assert view.rays()[row, column] @ along > 1.0 - 3.0 / size[0] ** 2
    assert view.canvas[0] >= size[0] and view.canvas[1] >= size[1]
    assert (view.canvas == size) == (change is not _shifted)


def test_a_part_of_the_picture_is_cut_out_of_the_same_view(box: Any) -> None:
    depsgraph = bpy.context.evaluated_depsgraph_get()
    camera = box.camera.evaluated_get(depsgraph)
    whole = of_object(camera, depsgraph, (64, 48))
    part = of_object(camera, depsgraph, (64, 48), part=(40, 8, 20, 30))
    assert (part.width, part.height) == (20, 30)
    np.testing.assert_allclose(part.rays(), whole.rays()[8:38, 40:60], atol=1e-6)


def test_a_shifted_lens_shows_what_cycles_shows(box: Any, exr: Any) -> None:
    box.camera.data.shift_x, box.camera.data.shift_y = 0.25, 0.125
    ours, cycles = color(exr(samples=8)), color(exr("CYCLES", samples=64))
    # Blocks of pixels, without the noise.
    blocks = [picture.reshape(6, 4, 8, 4, 3).mean(axis=(1, 3)) for picture in (ours, cycles)]
    np.testing.assert_allclose(blocks[0], blocks[1], atol=0.04 * cycles.max())


def test_an_orthographic_camera_shows_what_cycles_shows(box: Any, exr: Any) -> None:
    box.camera.data.type, box.camera.data.ortho_scale = "ORTHO", 4.0
    bpy.context.view_layer.use_pass_z = True
    ours, cycles = exr(samples=8), exr("CYCLES", samples=64)
    blocks = [color(known).reshape(6, 4, 8, 4, 3).mean(axis=(1, 3)) for known in (ours, cycles)]
    np.testing.assert_allclose(blocks[0], blocks[1], atol=0.04 * color(cycles).max())
    depths = ours["ViewLayer.Depth.Z"], cycles["ViewLayer.Depth.Z"]
    assert np.mean(abs(depths[0] - depths[1]) < 0.02) > 0.9


def test_coarser_pictures_show_the_same(box: Any) -> None:
    box.camera.data.shift_x = 0.2
    bpy.context.view_layer.update()
    _, view = read()
    coarse = view.scaled(4)
    assert (coarse.width, coarse.height) == (8, 6)
    middle = [vectors.mean(axis=(0, 1)) for vectors in (view.rays(), coarse.rays())]
    np.testing.assert_allclose(middle[0], middle[1], atol=0.02)
    assert view.scaled(1) is view
