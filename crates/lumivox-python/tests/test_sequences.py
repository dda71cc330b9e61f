"""Animations, sequences of pictures, and the motion in them."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import lumivox
from lumivox import Animation, Camera, InputError, Light, Renderer, Scene

from conftest import SMALL, floor, quad
from moving import VIEW, moving

SIZE = (64, 48)
#: `VIEW` as a camera.
EYE = Camera.look_at((0, 1, 5), (0, 1, 0), 40)
#: Pixels a metre at a distance of 5 m.
SCALE = SIZE[1] / (2 * 5 * np.tan(np.radians(20)))
TIMES = [0, 1 / 3, 2 / 3]


def program(*arguments: str) -> None:
    subprocess.run([sys.executable, "-m", "lumivox", *arguments], check=True, capture_output=True)


def test_posing_moves_instances_and_lights(tmp_path: Path) -> None:
    scene = Scene.load(moving(tmp_path))
    assert scene.animations == (Animation("walk", 1.0),)
    scene.pose(0.5)
    assert scene.instances[0].world_from_local[0][3] == pytest.approx(0.5)
    assert scene.lights[0].position == pytest.approx((0, 1.5, 3))
    scene.pose(9, "walk")
    assert scene.instances[0].world_from_local[0][3] == pytest.approx(1)
    low, high = scene.bounds_over([0, 1], "all")
    assert (low[1], high[1]) == pytest.approx((-2, 6)) and scene.lights[0].position[1] == pytest.approx(2)
    # Neither added lights nor lights that replace the file's move.
    scene.lights += (Light(intensity=1, position=(5, 5, 5), name="mine"),)
    scene.pose(0)
    assert [light.position for light in scene.lights] == [(0, 1, 3), (5, 5, 5)]
    scene.lights = scene.lights[1:]
    scene.cameras = [EYE]
    scene.pose(1)
    assert scene.lights[0].position == (5, 5, 5) and scene.cameras == (EYE,)
    for animation in ("run", 1, -1):
        with pytest.raises(InputError, match="no animation .*; there are: 0 'walk'"):
            scene.pose(0, animation)
    with pytest.raises(InputError, match="time_s: is nan"):
        scene.pose(float("nan"))
    with pytest.raises(InputError, match="there are: none"):
        floor().pose(0)


def test_a_sequence_matches_the_command_line(tmp_path: Path) -> None:
    file = moving(tmp_path)
    views = lumivox.render_many(Scene.load(file), VIEW, SIZE, times_s=TIMES, **SMALL)
    assert views["radiance"].shape == (3, 48, 64, 3)
    values = [f"--{name.replace('_', '-')}={value}" for name, value in SMALL.items()]
    values += ["--size=64x48", f"--camera={VIEW}", f"--output={tmp_path / 's_#.exr'}"]
    program("render", str(file), "--time=0..1", "--fps=3", *values)
    for number, radiance in enumerate(views["radiance"]):
        written = (tmp_path / f"s_{number}.exr").read_bytes()
        assert written == lumivox.Picture(radiance, coverage=views["coverage"][number]).to_exr(), number
    assert (views["radiance"][0] != views["radiance"][2]).any()


def test_one_moment_matches_the_command_line(tmp_path: Path) -> None:
    file = moving(tmp_path)
    scene = Scene.load(file)
    small = lumivox.render(scene, VIEW, (32, 24), time_s=0.5, **SMALL)
    values = [f"--{name.replace('_', '-')}={value}" for name, value in SMALL.items()]
    view = ["--size=32x24", f"--camera={VIEW}", "--time=0.5"]
    program("render", str(file), *values, *view, "-o", str(tmp_path / "a.exr"))
    assert (tmp_path / "a.exr").read_bytes() == small.to_exr()
    # The path tracer shows the posed scene.
    program("reference", str(file), "--samples=16", *view, "-o", str(tmp_path / "b.exr"))
    scene.pose(0.5)
    truth = lumivox.reference(scene, VIEW, (32, 24), samples=16)
    assert (truth.radiance == lumivox.Reference.load(tmp_path / "b.exr").radiance).all()


def test_the_camera_of_a_file_moves(tmp_path: Path) -> None:
    file = moving(tmp_path)
    document = json.loads(file.read_text())
    document["cameras"] = [{"type": "perspective", "perspective": {"yfov": 0.7, "znear": 0.01}}]
    # The camera rises with the lamp.
    document["nodes"][3]["camera"] = 0
    file.write_text(json.dumps(document))
    renderer = Renderer(Scene.load(file), size=(8, 8), **SMALL)
    heights = [renderer.camera.position[1] for _ in renderer.pictures(None, [0, 0.5, 1])]
    assert heights == pytest.approx([1, 1.5, 2])


def test_the_motion_layer_shows_object_motion(tmp_path: Path) -> None:
    scene = Scene.load(moving(tmp_path))
    options = {**SMALL, "layers": ["motion", "instance"]}
    views = lumivox.render_many(scene, EYE, SIZE, times_s=[0, 0.5], **options)
    assert views["motion"].shape == (2, 48, 64, 2) and (views["motion"][0] == 0).all()
    motion, instance = views["motion"][1], views["instance"][1]
    for number, way in ((0, (0.5 * SCALE, 0)), (1, (0, -0.2 * SCALE)), (2, (0, 0))):
        seen = motion[instance == number]
        assert len(seen) > 50
        # Rays are rounded to f32.
        np.testing.assert_allclose(seen, np.broadcast_to(way, seen.shape), atol=1e-3)


def test_the_motion_layer_shows_camera_motion() -> None:
    """The pixels of one picture, with their depth, are found in the other."""
    scene = floor(edge_m=10)
    quad(scene, (-0.5, 0, 0), (1, 0, 0), (0, 1, 0), name="wall")
    cameras = [Camera.look_at((0.3 * x, 1.0 + 0.1 * x, 4.0), (0, 0.5, 0), 40 + 5 * x) for x in range(2)]
    seen = Renderer(scene, cameras[0], SIZE, layers=["motion", "depth"], **{**SMALL, "frames": 1})
    first, second = seen.pictures(cameras)
    assert (first.layers["motion"] == 0).all()

    def frame(camera: Camera) -> tuple[npt.NDArray[Any], float]:
        back = -np.array(camera.forward)
        right = np.cross(camera.up, back)
        right /= np.linalg.norm(right)
        return np.array([right, np.cross(back, right), back]), np.tan(np.radians(camera.vertical_fov_deg / 2))

    (axes, half), (former_axes, former_half) = frame(cameras[1]), frame(cameras[0])
    x, y = np.meshgrid(np.arange(64) + 0.5, np.arange(48) + 0.5)
    local = np.stack([(2 * x - 64) / 48 * half, -(2 * y - 48) / 48 * half, -np.ones_like(x)], -1)
    rays = local @ axes / np.linalg.norm(local, axis=-1, keepdims=True)
    depth = second.layers["depth"][..., None]
    # Coverage counts all samples, data layers only the first.
    is_surface = depth > 0
    # The background is infinitely far away.
    ways = np.where(is_surface, np.array(cameras[1].position) + depth * rays - cameras[0].position, rays)
    place = ways @ former_axes.T
    former = np.stack([place[..., 0], -place[..., 1]], -1) / -place[..., 2:] / former_half * 48 + (64, 48)
    expected = np.stack([x, y], -1) - former / 2
    motion = second.layers["motion"]
    assert np.abs(motion).max() > 2 and (~is_surface).sum() > 50
    # One frame samples the middles of pixels. Depth is rounded, and at an edge the two methods may
    # see different surfaces.
    close = np.abs(motion - expected).max(-1) < 0.02
    assert close.mean() > 0.99


def test_points_formerly_behind_the_camera_have_nan_motion() -> None:
    cameras = [Camera.look_at((0, 1, 0), (0, 1, z)) for z in (1, -1)]
    views = lumivox.render_many(floor(), cameras, (8, 8), layers=["motion"], **SMALL)
    assert np.isnan(views["motion"][1]).all()


def test_realtime_pictures_do_not_depend_on_earlier_ones(cornell: Scene) -> None:
    cameras = [Camera.look_at((x, 1.0, 3.5), (0, 1, 0)) for x in (-0.4, 0.4)]
    settings: dict[str, Any] = {"preset": "realtime", "resolution": 32, "frames": 2, "shadow_resolution": 128}
    renderer = Renderer(cornell, cameras[0], (24, 16), **settings)
    after = [renderer.render(camera).radiance for camera in cameras][1]
    assert (after == lumivox.render(cornell, cameras[1], (24, 16), **settings).radiance).all()


def test_bad_sequence_arguments_raise_input_errors(cornell: Scene) -> None:
    renderer = Renderer(cornell, size=(8, 8), **SMALL)
    for call, message in (
        (lambda: renderer.render_many([EYE, EYE], [0]), "times_s: has 1 times, but there are 2 cameras"),
        (lambda: renderer.render_many(EYE, [[0]]), r"times_s: has the shape \(1, 1\)"),
        (lambda: renderer.render_many([]), "cameras: has none"),
        (lambda: renderer.render_many(EYE, [0.5]), "no animation 0; there are: none"),
        (lambda: Renderer(cornell, bounds=[(0, 0, 0), (1, -1, 1)]), "bounds: the first corner"),
        (lambda: Renderer(cornell, bounds=[0, 1]), r"bounds: has the shape \(2,\)"),
    ):
        with pytest.raises(InputError, match=message):
            call()
