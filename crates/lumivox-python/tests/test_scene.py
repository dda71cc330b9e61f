"""Scenes from arrays and files, and their edits."""

from __future__ import annotations

import os
from dataclasses import fields
from importlib import import_module
from pathlib import Path
from types import SimpleNamespace
from typing import Any, get_args, get_type_hints

import numpy as np
import pytest
import trimesh

import lumivox
from lumivox import Camera, InputError, Light, Material, OutputError, Scene

from conftest import SMALL, floor, quad

POSITIONS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], np.float32)
TRIANGLE = np.array([[0, 1, 2]])


def test_builtin_scenes_are_named() -> None:
    assert "cornell" in lumivox.BUILTIN
    with pytest.raises(InputError, match='no built-in scene is called "cornel"; there are: .*cornell'):
        Scene.builtin("cornel")
    assert Scene.load("builtin:cornell").triangles == Scene.builtin("cornell").triangles


def test_arrays_of_any_kind_become_triangles() -> None:
    every_second = np.repeat(POSITIONS, 2, axis=0)[::2]
    backwards = np.ascontiguousarray(POSITIONS[::-1])[::-1]
    by_columns = np.asfortranarray(POSITIONS)
    assert not any(array.flags.c_contiguous for array in (every_second, backwards, by_columns))
    others = (POSITIONS.astype(np.float64), POSITIONS.astype(">f4"), POSITIONS.astype(np.float16), POSITIONS.tolist())
    for positions in (POSITIONS, every_second, backwards, by_columns, *others):
        for indices in (TRIANGLE, TRIANGLE.ravel(), TRIANGLE.astype(np.uint8), TRIANGLE.tolist(), TRIANGLE.T.ravel()):
            scene = Scene.from_arrays(positions, indices)
            assert (scene.triangles, scene.bounds) == (1, ((0, 0, 0), (1, 1, 0)))
    still = POSITIONS.copy()
    still.flags.writeable = False
    assert Scene.from_arrays(still, TRIANGLE).bounds == ((0, 0, 0), (1, 1, 0))


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"positions": POSITIONS[:, :2]}, r"positions: has the shape \(3, 2\), but must have \(N, 3\)"),
        ({"positions": POSITIONS * np.nan}, r"positions\[0, 0\]: is nan, but must be finite"),
        ({"positions": POSITIONS.astype(float) * 1e300}, r"positions\[1, 0\]: is 1e\+300"),
        ({"positions": [["a"]]}, "positions: has the dtype <U1"),
        ({"positions": POSITIONS.astype(complex)}, "positions: has the dtype complex128"),
        ({"positions": [[0, 0], [1]]}, "positions: is no array"),
        # A copy would take terabytes.
        ({"positions": np.broadcast_to(np.float32(0), (1 << 40, 3))}, "positions: has 3298534883328 numbers, but"),
        ({"indices": np.broadcast_to(np.uint8(0), (1 << 40, 3))}, "indices: has 3298534883328 numbers, but"),
        ({"indices": [[0, 1, 3]]}, r"indices\[0, 2\]: is 3, but there are only 3 positions"),
        ({"indices": [[0, 1, -1]]}, r"indices\[0, 2\]: is -1"),
        ({"indices": [[0.0, 1.0, 2.0]]}, "indices: has the dtype float64, but must have whole"),
        ({"indices": [0, 1]}, "indices: has 2 numbers"),
        ({"indices": np.zeros((0, 3), int)}, "indices: has no triangle"),
        ({"indices": [[0, 1, 1]]}, "no triangles to show"),
        ({"normals": POSITIONS[:2]}, r"normals: has the shape \(2, 3\), but must have \(3, 3\)"),
        ({"uvs": POSITIONS}, r"uvs: has the shape \(3, 3\), but must have \(3, 2\)"),
        ({"crease_deg": 181}, "crease_deg: is 181.0"),
    ],
)
def test_bad_arrays_are_named(arguments: dict[str, Any], message: str) -> None:
    good: dict[str, Any] = {"positions": POSITIONS, "indices": TRIANGLE}
    with pytest.raises(InputError, match=message) as raised:
        Scene.from_arrays(**{**good, **arguments})
    assert raised.value.code == 3
    assert isinstance(raised.value, ValueError)


def test_trimesh_and_pyvista_like_meshes_are_read() -> None:
    box = trimesh.creation.box((1, 2, 3))
    scene = Scene.from_mesh(box, name="box")
    assert scene.triangles == 12
    assert scene.bounds == ((-0.5, -1, -1.5), (0.5, 1, 1.5))
    several = trimesh.Scene([box, box.copy().apply_translation((5, 0, 0))])
    assert Scene.from_mesh(several).triangles == 24
    # The format of pyvista.PolyData: each face begins with the number of its corners.
    surface = SimpleNamespace(points=POSITIONS, faces=np.array([3, 0, 1, 2]))
    surface.triangulate = lambda: surface
    assert Scene.from_mesh(surface).triangles == 1
    with pytest.raises(InputError, match="mesh: is a int, but must have vertices and faces"):
        Scene.from_mesh(3)


def test_edits_are_kept_and_saved(tmp_path: Path) -> None:
    scene = floor(Material(base_color=(0.5, 0.25, 0.125), name="wood"))
    scene.cameras = [Camera.look_at((0, 1, 3), (0, 0, 0), 60, name="eye")]
    scene.lights = [Light(intensity=100, position=(0, 2, 0), name="lamp")]
    scene.lights += (Light("spot", 5, inner_angle_deg=10, outer_angle_deg=20),)
    scene.lights += (Light("directional", 1000, direction=(0, -2, 0), angular_radius_deg=0.25),)
    scene.set_material("wood", roughness=0.5, emissive=3.0)
    scene.set_instance(0, world_from_local=np.diag([2, 2, 2, 1]), name="big floor")
    scene.set_environment((1, 2, 3))
    scene.save(tmp_path / "scene.glb")
    for read in (scene, scene.copy(), Scene.load(tmp_path / "scene.glb")):
        assert read.bounds == ((-4, 0, -4), (4, 0, 4))
        assert read.instances[0].name == "big floor"
        (material,) = read.materials
        assert (material.name, material.roughness, material.emissive) == ("wood", 0.5, (3, 3, 3))
        assert material.base_color == (0.5, 0.25, 0.125)
        assert [light.kind for light in read.lights] == ["point", "spot", "directional"]
        assert [light.intensity for light in read.lights] == [100, 5, 1000]
        assert read.lights[1].outer_angle_deg == pytest.approx(20)
        assert read.lights[2].direction == (0, -1, 0)
        assert read.cameras[0].vertical_fov_deg == pytest.approx(60)
        assert read.environment == (1, 2, 3)


def test_lights_have_all_fields_of_the_table() -> None:
    scene = floor()
    kinds = get_args(get_type_hints(Light)["kind"])
    with pytest.raises(InputError, match="must be " + " or ".join([", ".join(kinds[:-1]), kinds[-1]])):
        scene.lights = [Light("?")]  # type: ignore[arg-type]
    scene.lights = [Light(kind, attenuation=(1, 0.5, 0.25)) for kind in kinds]
    assert list(scene.lights) == [Light(kind, attenuation=(1, 0.5, 0.25)) for kind in kinds]
    keys = {key for light in scene._scene.lights for key in light}
    assert keys == {field.name for field in fields(Light)}


def test_editing_a_copy_does_not_change_the_original() -> None:
    scene = floor()
    copy = scene.copy()
    copy.set_material(0, base_color=0.5)
    assert copy.materials[0].base_color == (0.5, 0.5, 0.5)
    assert scene.materials[0].base_color == pytest.approx((0.8, 0.8, 0.8))


def test_textures_outlive_edits(tmp_path: Path) -> None:
    scene = Scene.builtin("spheres")
    scene.save(tmp_path / "before.glb")
    scene.set_material("checkered floor", roughness=0.75, double_sided=True)
    scene.save(tmp_path / "after.glb")
    before, after = ((tmp_path / name).read_bytes() for name in ("before.glb", "after.glb"))
    assert before.count(b"IHDR") == after.count(b"IHDR") >= 1
    assert before != after


def refused(edit: str, message: str) -> None:
    scene = floor()
    before = (scene.cameras, scene.lights, scene.materials, scene.instances, scene.environment)
    with pytest.raises(InputError, match=message):
        exec(edit, {"scene": scene, "Camera": Camera, "Light": Light, "np": np})
    after = (scene.cameras, scene.lights, scene.materials, scene.instances, scene.environment)
    assert before == after


@pytest.mark.parametrize(
    ("edit", "message"),
    [
        ("scene.lights = [Light('lamp')]", 'its kind is "lamp", but must be point, spot'),
        ("scene.lights = [Light(intensity=-1)]", 'floor: light "light".* -1'),
        ("scene.lights = [Light(position=(0, np.inf, 0))]", r"position\[1\]: is inf"),
        ("scene.lights = [Light(direction=(0, 0, 0), kind='spot')]", "direction"),
        ("scene.cameras = [Camera(vertical_fov_deg=180)]", "vertical_fov_deg: is 180"),
        ("scene.lights = [Light(intensity=float('nan'))]", "intensity: is nan, but must be finite"),
        ("scene.cameras = [Camera(up=(0, 0, 1))]", "forward, up"),
        ("scene.cameras = [Camera(near_m=0)]", "near"),
        ("scene.set_material(1, roughness=0)", "there is no material 1; the scene has 1"),
        ("scene.set_material('flor', roughness=0)", "there is no material 'flor'; did you mean 'floor'"),
        ("scene.set_material(0, rougness=0)", "Material has no 'rougness'; did you mean 'roughness'"),
        ("scene.set_material(0, roughness=2)", "roughness is 2, but must be from 0 to 1"),
        ("scene.set_instance(0, world_from_local=np.zeros((4, 4)))", "finite and invertible"),
        ("scene.set_instance(0, world_from_local=np.diag([-1, 1, 1, 1]))", "mirrors it"),
        ("scene.set_instance(0, material=4)", "there is no material 4"),
        ("scene.set_environment(-1)", "environment"),
        ("scene.set_environment(map=np.zeros((2, 4)))", r"map: has the shape \(2, 4\)"),
        ("scene.set_sky(turbidity=11)", "turbidity must be from 1 to 10"),
    ],
)
def test_bad_edits_change_nothing(edit: str, message: str) -> None:
    refused(edit, message)


def test_file_errors_name_the_file(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no/such.glb"):
        Scene.load("no/such.glb")
    with pytest.raises(OutputError, match="missing") as raised:
        floor().save(tmp_path / "missing" / "a.glb")
    assert raised.value.code == 5
    with pytest.raises(InputError, match="must end with .glb"):
        floor().save(tmp_path / "a.obj")


def test_an_empty_scene_is_refused() -> None:
    with pytest.raises(InputError, match='the scene "scene" has no triangles; add some'):
        lumivox.render(Scene(), size=(8, 8), **SMALL)


def test_parts_have_materials_of_their_own() -> None:
    scene = floor(Material(name="floor"))
    quad(scene, (0, 1, 0), (1, 0, 0), (0, 0, -1), Material(base_color=(1, 0, 0), name="sign"))  # sign
    assert [instance.material for instance in scene.instances] == [0, 1]
    assert scene.materials[1].base_color == (1, 0, 0)


# test_trimesh_and_pyvista_like_meshes_are_read tests the interface of meshes without PyVista.
@pytest.mark.skipif(not os.environ.get("LUMIVOX_RELEASE"), reason="for a release: installs VTK")
@pytest.mark.filterwarnings("ignore:The default value of `algorithm`")
def test_real_pyvista_meshes_load() -> None:
    pyvista: Any = import_module("pyvista")
    for mesh, triangles in ((pyvista.Cube(), 12), (pyvista.Plane(i_resolution=3, j_resolution=2), 12)):
        scene = Scene.from_mesh(mesh)
        assert scene.triangles == triangles
        low, high = scene.bounds or ((), ())
        np.testing.assert_allclose([*low, *high], np.array(mesh.bounds).reshape(3, 2).T.ravel(), atol=1e-6)
    # A grid of cells is shown by its surface: 6 faces of 2 x 2 quadrilaterals.
    assert Scene.from_mesh(pyvista.ImageData(dimensions=(3, 3, 3))).triangles == 48
