"""Cameras: any perspective as Lumivox's, whose axis is in the middle of its picture.

A shifted lens sees a part of a larger, unshifted picture. The larger picture is rendered, and the
part cut out of it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from ..units import direction

#: An orthographic camera is shown as one at this multiple of its picture's size.
FAR = 500.0


@dataclass(frozen=True)
class View:
    """What is rendered: Lumivox's camera, the size of its picture, and the part of it that is
    Blender's picture, in pixels: ``left`` and ``top``, ``width`` and ``height``."""

    position: tuple[float, ...]
    forward: tuple[float, ...]
    up: tuple[float, ...]
    vertical_fov_deg: float
    near_m: float
    canvas: tuple[int, int]
    left: int
    top: int
    width: int
    height: int
    #: The distance by which an orthographic camera was moved back.
    back_m: float = 0.0

    def camera(self, lumivox: Any) -> Any:
        return lumivox.Camera(
            self.position, self.forward, self.up, self.vertical_fov_deg, self.near_m
        )

    def _axes(self) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        forward, up = np.array(self.forward), np.array(self.up)
        right = np.cross(forward, up)
        right /= np.linalg.norm(right)
        return right, np.cross(right, forward), forward

    def _pixel(self) -> float:
        """The edge of a pixel at a distance of 1 along the axis."""
        return 2.0 * math.tan(math.radians(self.vertical_fov_deg) / 2.0) / self.canvas[1]

    def rays(self) -> np.ndarray:
        """Unit vectors (H, W, 3) through the middles of Blender's pixels, in Lumivox's world."""
        right, up, forward = self._axes()
        columns = (self.left + np.arange(self.width) + 0.5 - self.canvas[0] / 2.0) * self._pixel()
        rows = (self.canvas[1] / 2.0 - self.top - np.arange(self.height) - 0.5) * self._pixel()
        rays = forward + columns[None, :, None] * right + rows[:, None, None] * up
        return rays / np.linalg.norm(rays, axis=2, keepdims=True)

    def project(self, points: np.ndarray) -> np.ndarray:
        """Where points (..., 3) of Lumivox's world are in Blender's picture, in pixels from the
        left and the bottom; NaN behind the camera."""
        right, up, forward = self._axes()
        towards = points - np.array(self.position)
        depth = towards @ forward
        with np.errstate(divide="ignore", invalid="ignore"):
            scale = np.where(depth > 0.0, 1.0 / (depth * self._pixel()), np.nan)
        x = (towards @ right) * scale + self.canvas[0] / 2.0 - self.left
        y = (towards @ up) * scale - self.canvas[1] / 2.0 + self.top + self.height
        return np.stack((x, y), axis=-1)

    def cut(self, pixels: np.ndarray) -> np.ndarray:
        """Blender's part of an array (H, W, ...)."""
        return pixels[self.top : self.top + self.height, self.left : self.left + self.width]

    def scaled(self, divisor: int) -> View:
        """A coarser picture of the same view."""
        if divisor == 1:
            return self
        coarse = [max(1, -(-length // divisor)) for length in (self.width, self.height)]
        kept = [max(1, round(length / divisor)) for length in self.canvas]
        canvas = (max(kept[0], coarse[0]), max(kept[1], coarse[1]))
        left = min(round(self.left / divisor), canvas[0] - coarse[0])
        top = min(round(self.top / divisor), canvas[1] - coarse[1])
        return replace(
            self, canvas=canvas, left=left, top=top, width=coarse[0], height=coarse[1]
        )


def view(
    world_from_camera: Any,
    clip_from_camera: Any,
    size: tuple[int, int],
    near_m: float = 0.01,
    part: tuple[int, int, int, int] | None = None,
) -> View:
    """The view of Blender's matrices, of a picture of ``size``, or of ``part`` of it: left, top,
    width and height in pixels.

    ``clip_from_camera`` is an OpenGL projection. The shift of the lens is rounded to half a pixel.
    """
    left, top, part_width, part_height = part or (0, 0, *size)
    place, projection = np.array(world_from_camera), np.array(clip_from_camera)
    right, up, backward = (place[:3, column] for column in range(3))
    up, backward = up / np.linalg.norm(up), backward / np.linalg.norm(backward)
    position = place[:3, 3]
    width, height = size
    back_m = 0.0
    if projection[3, 3] == 0.0:
        # Half the height of the picture at a distance of 1.
        half = 1.0 / projection[1, 1]
        center = (-projection[0, 2], -projection[1, 2])
    else:
        half_height = 1.0 / projection[1, 1]
        back_m = FAR * half_height
        half = 1.0 / FAR
        center = (projection[0, 3], projection[1, 3])
        position = position + backward * back_m
        near_m = 1e-3 * back_m
    # The lens's axis, in pixels from the left and the top.
    axis = ((1.0 + center[0]) * width / 2.0 - left, (1.0 - center[1]) * height / 2.0 - top)
    lengths = (part_width, part_height)
    canvas, corner = zip(*(_around(at, length) for at, length in zip(axis, lengths)))
    half *= canvas[1] / height
    return View(
        position=tuple(direction(position).tolist()),
        forward=tuple(direction(-backward).tolist()),
        up=tuple(direction(up).tolist()),
        vertical_fov_deg=math.degrees(2.0 * math.atan(half)),
        near_m=max(near_m, 1e-4),
        canvas=canvas,
        left=corner[0],
        top=corner[1],
        width=part_width,
        height=part_height,
        back_m=back_m,
    )


def _around(axis: float, length: int) -> tuple[int, int]:
    """The length of the shortest line of pixels with its middle at ``axis`` that contains
    ``length`` pixels from 0, and where these begin on it. ``axis`` is rounded to half a pixel."""
    twice = round(2.0 * axis)
    return max(twice, 2 * length - twice), max(0, length - twice)


def of_object(
    camera: Any,
    depsgraph: Any,
    size: tuple[int, int],
    part: tuple[int, int, int, int] | None = None,
) -> View:
    """The view of an evaluated camera, in square pixels."""
    projection = camera.calc_matrix_camera(depsgraph, x=size[0], y=size[1])
    return view(camera.matrix_world, projection, size, camera.data.clip_start, part)


def of_region(region_3d: Any, size: tuple[int, int], near_m: float) -> View:
    """The view of a viewport."""
    return view(region_3d.view_matrix.inverted(), region_3d.window_matrix, size, near_m)
