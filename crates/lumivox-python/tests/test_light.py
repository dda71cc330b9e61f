"""Irradiance against closed forms, and the path tracer."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lumivox
from lumivox import InputError, Light, Material, Renderer, Scene

from conftest import BLACK, SMALL, floor, lambert, quad


def test_a_lamp_follows_the_inverse_square_law() -> None:
    scene = floor(BLACK)
    height, candela = 1.5, 300.0
    scene.lights = [Light(intensity=candela, position=(0, height, 0))]
    x = np.linspace(-1.5, 1.5, 7)
    points = np.stack([x, np.zeros(7), 0.2 * np.ones(7)], 1)
    lux = lumivox.irradiance(scene, points, **SMALL).lux
    squared = x**2 + 0.2**2 + height**2
    # The inverse square times the cosine: I h / d^3, to the rounding of f32.
    np.testing.assert_allclose(lux, candela * height / squared**1.5, rtol=1e-5)
    below = lumivox.irradiance(scene, points, (0, -1, 0), **SMALL).lux
    assert (below == 0).all()


def test_a_uniform_sky_gives_pi_times_its_radiance() -> None:
    scene = floor(BLACK)
    scene.set_environment(1000)
    up = lumivox.irradiance(scene, [[0, 0, 0], [0.3, 0.2, -0.7]], **SMALL).lux
    # The cones' weights sum up to pi, to the rounding of f32.
    np.testing.assert_allclose(up, np.pi * 1000, rtol=1e-4)
    # A point in the air with a horizontal normal sees half of the sky, and the black floor. Cones
    # are 60 degrees wide and voxels are coarse, so the tolerance is a tenth.
    side = lumivox.irradiance(scene, (0, 0.05, 0), (1, 0, 0), **{**SMALL, "frames": 64}).lux
    assert side == pytest.approx(np.pi * 500, rel=0.1)


def test_a_luminous_polygon_matches_lamberts_formula() -> None:
    scene = floor(BLACK)
    corners = np.array([(-0.5, 1, -0.5), (0.5, 1, -0.5), (0.5, 1, 0.5), (-0.5, 1, 0.5)])
    glow = Material(base_color=0.0, emissive=1000.0)
    quad(scene, corners[0], corners[1] - corners[0], corners[3] - corners[0], glow, "panel")
    points = np.array([(0, 0, 0), (0.4, 0, 0.3), (1.2, 0, 0), (1.5, 0, -1.5)])
    lux = lumivox.irradiance(scene, points, **{**SMALL, "frames": 256}).lux
    expected = [1000 * lambert(corners, point, (0, 1, 0)) for point in points]
    # Points are drawn on the panel, 6 a frame: the standard error of 1536 is at most 1 % there.
    np.testing.assert_allclose(lux, expected, rtol=0.03)


def test_irradiance_accepts_arrays_of_any_shape(renderer: Renderer) -> None:
    grid = np.random.default_rng(1).uniform(0.2, 0.8, (2, 3, 3))
    light = renderer.irradiance(grid, frames=2)
    assert (light.lux.shape, light.direct.shape, light.openness.shape) == ((2, 3), (2, 3, 3), (2, 3))
    one = renderer.irradiance(grid[1, 2], frames=2)
    assert one.lux.shape == () and one.lux == light.lux[1, 2]
    np.testing.assert_allclose(light.rgb, light.direct + light.indirect)
    assert renderer.irradiance(np.zeros((0, 3))).lux.shape == (0,)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (([[0, 0]],), r"points: has the shape \(1, 2\)"),
        (([[0, 0, np.nan]],), r"points\[0, 2\]: is nan"),
        (([[0, 0, 0]], (0, 0, 0)), "normals: number 0 has no direction"),
        (([[0, 0, 0]], np.zeros((2, 3))), r"normals: has the shape \(2, 3\)"),
        (([[0, 0, 0]], (0, 1, 0), 0), "frames: is 0"),
        (([[0, 0, 0]], (0, 1, 0), 1.5), "frames: is 1.5"),
    ],
)
def test_bad_points_are_named(renderer: Renderer, arguments: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        renderer.irradiance(*arguments)


def test_path_traced_irradiance_reports_its_standard_error(cornell: Scene) -> None:
    points = [[0.1, 0.2, 0.1], [-0.2, 0.3, 0.3]]
    light = lumivox.irradiance(cornell, points, method="paths", samples=512)
    again = lumivox.irradiance(cornell, points, method="paths", samples=512)
    other = lumivox.irradiance(cornell, points, method="paths", samples=512, seed=1)
    assert (light.lux == again.lux).all() and (light.lux != other.lux).all()
    assert light.standard_error is not None and other.standard_error is not None
    sigma = np.hypot(light.standard_error, other.standard_error)
    # Two means of independent samples differ by less than four of their standard errors.
    assert (abs(light.lux - other.lux) < 4 * sigma).all()
    assert (0 < sigma).all() and (sigma < 0.1 * light.lux).all()
    np.testing.assert_allclose(light.rgb @ lumivox.light.LUMINANCE, light.lux, rtol=1e-5)
    assert (np.asarray(light) == light.lux).all()
    cones = lumivox.irradiance(cornell, points, resolution=64, frames=64)
    assert cones.standard_error is None
    # The error of cones at 64 voxels along the box.
    np.testing.assert_allclose(cones.lux, light.lux, rtol=0.1)
    dark = lumivox.irradiance(cornell, points, method="paths", samples=32, bounces=0)
    assert (dark.rgb == dark.direct).all(), "nothing but lamps without a bounce"
    assert lumivox.irradiance(cornell, np.zeros((0, 3)), method="paths").lux.shape == (0,)
    for options, message in (
        ({"method": "rays"}, "method: is 'rays'"),
        ({"method": "paths", "samples": 0}, "samples: is 0"),
        ({"method": "paths", "resolution": 64}, "resolution: is a setting of cones"),
    ):
        with pytest.raises(InputError, match=message):
            lumivox.irradiance(cornell, points, **options)
    many = np.broadcast_to(np.float32(0), ((1 << 20) + 1, 3))
    with pytest.raises(InputError, match="points: has 1048577 places, but must have at most 1048576"):
        lumivox.irradiance(cornell, many, method="paths")


def test_luminance_along_rays() -> None:
    scene = floor(Material(base_color=0.5))
    scene.set_environment(1000)
    origins = np.broadcast_to(np.array([0.0, 1.0, 0.0]), (2, 2, 3))
    directions = [[(0, 1, 0), (0.2, 0.5, 0.1)], [(0, -1, 0), (0.3, -1, 0.1)]]
    light = lumivox.luminance(scene, origins, directions, samples=256)
    assert light.luminance.shape == (2, 2) and light.radiance.shape == (2, 2, 3)
    # The sky itself, and half its radiance from a floor that nothing shades.
    np.testing.assert_allclose(light.luminance[0], 1000, rtol=1e-4)
    assert (abs(light.luminance[1] - 500) < 4 * light.standard_error[1] + 0.05).all()
    with pytest.raises(InputError, match="directions: number 0 has no direction"):
        lumivox.luminance(scene, (0, 1, 0), (0, 0, 0))


def test_a_workplane_is_written_as_png(tmp_path: Path) -> None:
    scene = floor(BLACK)
    scene.lights = [Light(intensity=100, position=(0.5, 1, 0.5))]
    plane = lumivox.workplane(
        scene, (-1, 0, -1), (2, 0, 0), (0, 0, 2), (4, 8), method="paths", samples=17
    )
    assert plane.irradiance.standard_error is not None
    plane.to_png(tmp_path / "plane.png", "a floor")
    data = plane.png("a floor")
    assert (tmp_path / "plane.png").read_bytes() == data and data.startswith(b"\x89PNG")
    assert plane.png("a floor", scale=(0, 1)) != data
    with pytest.raises(InputError, match="scale: is"):
        plane.png(scale=(5, 1))
    with pytest.raises(lumivox.OutputError, match="cannot write the picture"):
        plane.to_png(tmp_path / "none" / "plane.png")


def test_a_workplane_samples_cell_centres_and_reports_uniformity() -> None:
    scene = floor(BLACK)
    scene.lights = [Light(intensity=100, position=(0, 1, 0))]
    plane = lumivox.workplane(scene, (-1, 0, -1), (2, 0, 0), (0, 0, 2), (2, 4), **SMALL)
    assert plane.lux.shape == (2, 4)
    np.testing.assert_allclose(plane.points[0, :, 0], [-0.75, -0.25, 0.25, 0.75])
    np.testing.assert_allclose(plane.points[:, 0, 2], [-0.5, 0.5])
    squared = (plane.points**2).sum(-1) + 1
    expected = 100 / squared**1.5
    np.testing.assert_allclose(plane.lux, expected, rtol=1e-5)
    assert plane.mean == pytest.approx(expected.mean(), rel=1e-5)
    assert plane.uniformity == pytest.approx(expected.min() / expected.mean(), rel=1e-5)
    for shape, message in (((0, 2), "shape: is"), ("ab", "shape: is")):
        with pytest.raises(InputError, match=message):
            lumivox.workplane(scene, (0, 0, 0), (1, 0, 0), (0, 0, 1), shape)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="along, across"):
        lumivox.workplane(scene, (0, 0, 0), (1, 0, 0), (2, 0, 0))


def test_the_reference_reports_its_standard_error(cornell: Scene, tmp_path: Path) -> None:
    truth = lumivox.reference(cornell, size=(24, 16), samples=32)
    again = lumivox.reference(cornell, size=(24, 16), samples=32)
    other = lumivox.reference(cornell, size=(24, 16), samples=32, seed=1)
    assert (truth.radiance == again.radiance).all()
    assert (truth.radiance != other.radiance).any()
    assert truth.samples == 32 and truth.layers["irradiance"].shape == (16, 24, 3)
    # Two means differ by their noise: the mean square of the difference is the sum of the
    # variances.
    difference = ((truth.radiance - other.radiance) ** 2).mean()
    variance = (truth.standard_error**2 + other.standard_error**2).mean()
    assert 0.3 < difference / variance < 3
    truth.save(tmp_path / "truth.exr")
    written = tmp_path / "written.exr"
    options = ["--size=24x16", "--samples=32", "-o", str(written)]
    run = [sys.executable, "-m", "lumivox", "reference", "builtin:cornell", *options]
    subprocess.run(run, check=True, capture_output=True)
    assert written.read_bytes() == (tmp_path / "truth.exr").read_bytes(), "that of the program"
    loaded = lumivox.Reference.load(tmp_path / "truth.exr")
    assert all((loaded.layers[name] == layer).all() for name, layer in truth.layers.items())
    with pytest.raises(InputError, match="samples: is 0"):
        lumivox.reference(cornell, samples=0)


def test_compare_measures_known_errors(cornell: Scene, tmp_path: Path) -> None:
    truth = lumivox.reference(cornell, size=(48, 32), samples=64)
    same = lumivox.compare(truth, truth)
    assert (same.bias_percent, same.rmse_percent, same.flip) == (0, 0, 0)
    brighter = lumivox.compare(truth.radiance * 1.5, truth)
    assert brighter.bias_percent == pytest.approx(50, rel=1e-4)
    picture = lumivox.render(cornell, size=(48, 32), resolution=64, frames=4)
    figures = lumivox.compare(picture, truth)
    # Cones in coarse voxels, against 64 samples.
    assert abs(figures.bias_percent) < 10 and 0 < figures.rmse_percent < 50
    # The program reports the same errors for the same files.
    truth.save(tmp_path / "truth.exr")
    picture.to_exr(tmp_path / "picture.exr")
    files = [str(tmp_path / name) for name in ("truth.exr", "picture.exr")]
    run = [sys.executable, "-m", "lumivox", "compare", "--images", *files, "--json"]
    told = json.loads(subprocess.run(run, check=True, capture_output=True).stdout)["final"]
    # Files of pictures have no variance, so the noise is unknown.
    for name, value in vars(lumivox.compare(picture, truth.radiance)).items():
        assert told[name] == value, name
    with pytest.raises(InputError, match=r"picture: has the shape \(4, 4, 3\), but must have \(32, 48, 3\)"):
        lumivox.compare(np.zeros((4, 4, 3)), truth)


def test_parts_add_up_to_one_reference(cornell: Scene, tmp_path: Path) -> None:
    size = (16, 12)
    whole = lumivox.reference(cornell, size=size, samples=48)
    parts = [lumivox.reference_part(cornell, size=size, batches=at) for at in ((1, 3), (0, 1))]
    merged = lumivox.merge([*parts, parts[0]])
    assert merged.samples == 48
    assert (merged.radiance == whole.radiance).all()
    for name, layer in whole.layers.items():
        assert (merged.layers[name] == layer).all(), name
    # The program reads the same bytes.
    files = [tmp_path / "a", tmp_path / "b"]
    for file, part in zip(files, parts):
        file.write_bytes(part)
    run = [sys.executable, "-m", "lumivox", "merge", *map(str, files), "-o", str(tmp_path / "c.exr")]
    subprocess.run(run, check=True, capture_output=True)
    whole.save(tmp_path / "whole.exr")
    assert (tmp_path / "c.exr").read_bytes() == (tmp_path / "whole.exr").read_bytes()
    for wrong, message in (
        ([parts[0]], "the batches 0..1 are missing"),
        ([b"no part"], r"parts\[0\]: it is not a part"),
        ([], "parts: has none"),
    ):
        with pytest.raises(InputError, match=message):
            lumivox.merge(wrong)
    with pytest.raises(InputError, match="batches: is"):
        lumivox.reference_part(cornell, size=size, batches=(2, 2))
