"""The path tracer against Mitsuba 3 (Jakob et al. 2022), on diffuse scenes that both are given."""

from __future__ import annotations

from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest

import lumivox
from lumivox import Camera, Light, Material, Scene

mitsuba: Any = import_module("mitsuba")

Array = npt.NDArray[Any]
SIZE = (32, 24)


class Both:
    """One scene for both programs."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.ours = Scene("both")
        self.theirs: dict[str, Any] = {
            "type": "scene",
            "integrator": {"type": "path", "max_depth": -1, "rr_depth": 16},
        }

    def add(self, corners: Array, quads: Any, color: Any, radiance: float = 0.0) -> None:
        """Quadrilaterals whose fronts are seen; both programs shade them flat."""
        faces = [face for a, b, c, d in quads for face in ((a, b, c), (a, c, d))]
        material = Material(base_color=color, emissive=radiance)
        self.ours.add(corners, faces, material=material)
        file = self.folder / f"mesh{len(self.theirs)}.ply"
        header = (
            f"ply\nformat ascii 1.0\nelement vertex {len(corners)}\nproperty float x\nproperty float y\n"
            f"property float z\nelement face {len(faces)}\nproperty list uchar int vertex_index\nend_header\n"
        )
        lines = [" ".join(map(str, corner)) for corner in corners]
        lines += [f"3 {a} {b} {c}" for a, b, c in faces]
        file.write_text(header + "\n".join(lines) + "\n")
        bsdf = {"type": "diffuse", "reflectance": {"type": "rgb", "value": list(np.broadcast_to(color, 3))}}
        shape: dict[str, Any] = {"type": "ply", "filename": str(file), "face_normals": True, "bsdf": bsdf}
        if radiance:
            shape["emitter"] = {"type": "area", "radiance": {"type": "rgb", "value": [radiance] * 3}}
        self.theirs[f"shape{len(self.theirs)}"] = shape

    def box(self, low: Any, high: Any, color: Any, is_room: bool = False) -> None:
        """A box that is seen from outside, or a room."""
        corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
        corners = np.array(low) + corners * (np.array(high) - np.array(low))
        quads = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
        self.add(corners, [quad[::-1] for quad in quads] if is_room else quads, color)

    def ground(self, color: Any) -> None:
        corners = np.array([(-20, 0, 20), (20, 0, 20), (20, 0, -20), (-20, 0, -20)], float)
        self.add(corners, [(0, 1, 2, 3)], color)

    def sky(self, radiance: Any) -> None:
        self.ours.set_environment(radiance)
        self.theirs["sky"] = {"type": "constant", "radiance": {"type": "rgb", "value": list(radiance)}}


def under_a_sky(both: Both) -> None:
    both.ground(0.4)
    both.box((-1, 0, -1), (0, 1.5, 0), (0.7, 0.2, 0.1))
    both.box((0.3, 0, -0.5), (1.2, 0.6, 0.6), (0.2, 0.6, 0.3))
    both.sky((1.0, 1.5, 2.5))


def under_a_sun(both: Both) -> None:
    both.ground(0.5)
    both.box((-0.8, 0, -0.8), (0.2, 1.2, 0.2), 0.8)
    both.sky((0.3, 0.4, 0.6))
    sun = (-0.5, -1.0, -0.4)
    both.ours.lights = [Light("directional", 5.0, direction=sun)]
    irradiance = {"type": "rgb", "value": [5.0] * 3}
    both.theirs["sun"] = {"type": "directional", "direction": list(sun), "irradiance": irradiance}


def in_a_room(both: Both) -> None:
    both.box((-3, 0, -3), (3, 3, 5), (0.7, 0.6, 0.5), is_room=True)
    both.box((-1, 0, -1), (0.2, 1, 0.4), (0.2, 0.3, 0.7))
    # A panel below the ceiling, facing down.
    panel = np.array([(-1, 2.9, -1), (1, 2.9, -1), (1, 2.9, 1), (-1, 2.9, 1)])
    both.add(panel, [(0, 1, 2, 3)], 0.0, 8.0)


@pytest.mark.parametrize("make", [under_a_sky, under_a_sun, in_a_room], ids=lambda make: make.__name__)
def test_means_match_mitsuba_within_one_percent(make: Callable[[Both], None], tmp_path: Path) -> None:
    both = Both(tmp_path)
    make(both)
    eye, target, fov = (1.5, 2.2, 4.0), (0.0, 0.5, 0.0), 45.0
    camera = Camera.look_at(eye, target, vertical_fov_deg=fov)
    samples = 1024
    ours = lumivox.reference(both.ours, camera, SIZE, samples=samples, surroundings="none")
    mitsuba.set_variant("scalar_rgb")
    both.theirs["sensor"] = {
        "type": "perspective",
        "fov": fov,
        "fov_axis": "y",
        "to_world": mitsuba.ScalarTransform4f().look_at(origin=eye, target=target, up=(0, 1, 0)),
        "film": {"type": "hdrfilm", "width": SIZE[0], "height": SIZE[1], "rfilter": {"type": "box"}},
        "sampler": {"type": "independent", "sample_count": samples},
    }
    theirs = np.array(mitsuba.render(mitsuba.load_dict(both.theirs)))[..., :3]
    mean = theirs.mean((0, 1))
    error = ours.radiance.mean((0, 1)) / mean - 1
    print(f"{make.__name__}: means {ours.radiance.mean((0, 1))}, {mean}: {100 * error} %")
    assert (abs(error) < 0.01).all()
    # Locally, too: means over 8 x 8 pixels differ only by noise.
    blocks = [picture.reshape(3, 8, 4, 8, 3).mean((1, 3)) for picture in (ours.radiance, theirs)]
    np.testing.assert_allclose(blocks[0], blocks[1], rtol=0.04)
