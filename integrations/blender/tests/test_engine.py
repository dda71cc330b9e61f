"""Renders as Blender starts them: animations, layers, faults, and export."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest

import lumivox
import scenes
from conftest import HERE, SMALL, color, environment, read, small
from extension import engine, passes, status
from extension.engine import KEPT, Cancelled
from extension.operators import run_program
from extension.properties import box_of
from extension.session import Session
from extension.units import LUMENS_PER_WATT


def memory_mib() -> float:
    pages = int(Path("/proc/self/statm").read_text().split()[1])
    return pages * 4096 / 2**20


def test_an_animation_keeps_its_scene_and_its_memory(box: Any, tmp_path: Path) -> None:
    thing = bpy.data.objects["box"]
    for frame, x in ((1, -0.8), (40, 0.8)):
        thing.location.x = x
        thing.keyframe_insert("location", frame=frame)
    changes, used = [], []

    def note(*_: Any) -> None:
        changes.append(KEPT.session.last_change)
        used.append(memory_mib())

    bpy.app.handlers.render_post.append(note)
    box.frame_start, box.frame_end = 1, 40
    box.render.filepath = str(tmp_path / "frame_")
    try:
        bpy.ops.render.render(animation=True)
    finally:
        bpy.app.handlers.render_post.remove(note)
    assert len(list(tmp_path.glob("frame_*.png"))) == 40
    assert len(changes) == 40
    # Only the first frame builds the scene.
    assert all(change < 3 for change in changes[1:])
    assert used[-1] - used[10] < 8.0, used
    assert KEPT.session is None


def test_view_layers_show_what_they_contain(box: Any, exr: Any) -> None:
    hidden = bpy.data.collections.new("hidden")
    box.collection.children.link(hidden)
    hidden.objects.link(bpy.data.objects["box"])
    box.collection.objects.unlink(bpy.data.objects["box"])
    other = box.view_layers.new("other")
    other.layer_collection.children["hidden"].exclude = True
    for layer in box.view_layers:
        layer.use_pass_object_index = True
    bpy.data.objects["box"].pass_index = 5
    found = exr()
    assert found["ViewLayer.Object Index.X"].max() == 5.0
    assert found["other.Object Index.X"].max() == 0.0
    assert not np.array_equal(color(found), color(found, layer="other"))


def test_another_scene_is_rendered_as_itself(box: Any, tmp_path: Path) -> None:
    other = bpy.data.scenes.new("other")
    assert other.lumivox.resolution == 128 and box.lumivox.resolution == 16
    other.render.engine, other.camera = "LUMIVOX", box.camera
    other.render.resolution_x, other.render.resolution_y = 16, 12
    other.lumivox.samples, other.lumivox.resolution = 1, 32
    other.collection.objects.link(bpy.data.objects["box"])
    taken = []

    def note(*_: Any) -> None:
        taken.append((len(KEPT.session.data.instances), KEPT.session.renderer.size))

    bpy.app.handlers.render_post.append(note)
    try:
        bpy.ops.render.render()
        bpy.ops.render.render(scene="other")
    finally:
        bpy.app.handlers.render_post.remove(note)
    assert taken == [(2, (32, 24)), (1, (16, 12))]


def test_a_scene_without_surfaces_shows_its_world(exr: Any) -> None:
    scenes._begin(world=(0.1, 0.2, 0.3))
    scenes._camera((0, -3, 0), (0, 0, 0), lens=50)
    small((8, 8))
    np.testing.assert_allclose(color(exr())[4, 4], (0.1, 0.2, 0.3), rtol=1e-3)


def test_a_scene_without_a_camera_is_an_error(box: Any) -> None:
    bpy.data.objects.remove(box.camera)
    with pytest.raises(RuntimeError, match="camera"):
        bpy.ops.render.render()


def test_a_region_of_the_picture(box: Any, exr: Any) -> None:
    whole = color(exr())
    box.render.use_border = box.render.use_crop_to_border = True
    box.render.border_min_x, box.render.border_max_x = 0.25, 0.75
    box.render.border_min_y, box.render.border_max_y = 0.5, 1.0
    part = color(exr())
    assert part.shape == (12, 16, 3)
    # Cones differ with the place in the picture.
    np.testing.assert_allclose(part, whole[:12, 8:24], atol=0.15 * whole.max())
    assert abs(part.mean() / whole[:12, 8:24].mean() - 1.0) < 0.02


def test_sizes_are_those_of_blender(box: Any, exr: Any) -> None:
    box.render.resolution_x, box.render.resolution_y = 100, 170
    box.render.resolution_percentage = 29
    box.render.use_border = box.render.use_crop_to_border = True
    depsgraph = bpy.context.evaluated_depsgraph_get()
    for edge in (0.7, 5 / 29, 0.9):
        box.render.border_min_x, box.render.border_max_x = 0.0, edge
        box.render.border_min_y, box.render.border_max_y = 1.0 - edge, 1.0
        view = engine.camera_view(box.camera, depsgraph)
        assert (view.height, view.width) == color(exr("CYCLES", samples=1)).shape[:2], edge


def test_pixels_that_are_not_square_are_an_error(box: Any) -> None:
    box.render.pixel_aspect_x = 2.0
    with pytest.raises(RuntimeError, match="square"):
        bpy.ops.render.render()


def test_the_frames_around_one_leave_its_time(box: Any) -> None:
    other = scenes._camera((3, -5, 2.5), (0, 0, 0.4), lens=40)
    other.location.x = 4.0
    taken: list[tuple[int, float]] = []

    def frame_set(frame: int, subframe: float) -> None:
        taken.append((frame, subframe))
        box.frame_set(frame, subframe=subframe)

    shown = SimpleNamespace(frame_set=frame_set, camera_override=other)
    shown._camera_view = lambda known: engine.LumivoxEngine._camera_view(shown, known)
    box.frame_set(7, subframe=0.25)
    asked = [known for known in passes.PASSES if known.name == "Vector"]
    depsgraph = bpy.context.evaluated_depsgraph_get()
    before, _ = engine.LumivoxEngine._neighbours(shown, depsgraph, asked)
    assert taken == [(6, 0.25), (8, 0.25), (7, 0.25)]
    assert before.view.position[0] == pytest.approx(4.0)
    box.render.pixel_aspect_x = 2.0
    with pytest.raises(ValueError, match="square"):
        engine.LumivoxEngine._neighbours(shown, depsgraph, asked)
    assert (box.frame_current, box.frame_subframe) == (7, 0.25)


def test_a_stopped_render_leaves_a_usable_session(box: Any) -> None:
    data, view = read()
    for stage in ("voxelize", "render"):
        session = Session()

        def stop(name: str, done: float, total: int) -> None:
            if name == stage:
                raise Cancelled

        with pytest.raises(Cancelled):
            session.show(data, view, SMALL, progress=stop)
            session.picture(view, stop)
        session.show(data, view, SMALL)
        assert session.picture(view).radiance.mean() > 0.0


def test_a_scene_that_changes_while_it_is_rendered(box: Any) -> None:
    """What was read is a copy: deleting objects meanwhile changes nothing."""
    data, view = read()

    def delete(stage: str, done: float, total: int) -> None:
        for thing in list(bpy.data.objects):
            if thing.name in ("box", "lamp"):
                bpy.data.objects.remove(thing)

    first, second = Session(), Session()
    first.show(data, view, SMALL)
    expected = first.picture(view).radiance
    second.show(data, view, SMALL, progress=delete)
    np.testing.assert_array_equal(second.picture(view, delete).radiance, expected)
    assert len(read()[0].instances) == 1


def test_undo_brings_back_what_was_read(box: Any) -> None:
    bpy.ops.ed.undo_push(message="before")
    before = read()[0]
    bpy.data.objects["box"].location.x += 1.0
    scenes._box("another", (1.2, 0, 0.3), (0.5, 0.5, 0.5), bpy.data.materials["red"])
    bpy.ops.ed.undo_push(message="after")
    bpy.context.view_layer.update()
    assert read()[0] != before
    bpy.ops.ed.undo()
    bpy.context.view_layer.update()
    assert read()[0] == before


def test_without_a_driver_it_says_what_to_install() -> None:
    program = (
        "import bpy, extension; extension.register()\n"
        "bpy.context.scene.render.engine = 'LUMIVOX'\n"
        "try: bpy.ops.render.render()\n"
        "except RuntimeError as error: print('said', error)"
    )
    nothing = environment(VK_DRIVER_FILES="/nowhere.json", VK_ICD_FILENAMES="/nowhere.json", DISPLAY="")
    done = subprocess.run(
        [sys.executable, "-c", program], env=nothing, capture_output=True, text=True, cwd=HERE
    )
    assert "said" in done.stdout and "mesa-vulkan-drivers" in done.stdout, done.stdout + done.stderr


def test_the_command_line_shows_the_exported_scene_alike(tmp_path: Path, exr: Any) -> None:
    scenes.materials()
    small((48, 36))
    ours = color(exr(samples=4)) * LUMENS_PER_WATT
    file, picture = tmp_path / "scene.glb", tmp_path / "picture.exr"
    assert bpy.ops.lumivox.save_glb(filepath=str(file)) == {"FINISHED"}
    options = ("--size=48x36", "--frames=4", "--resolution=16", "--bounces=2")
    run_program("render", str(file), "-o", str(picture), *options)
    loaded = bpy.data.images.load(str(picture))
    loaded.colorspace_settings.name = "Non-Color"
    theirs = np.array(loaded.pixels[:]).reshape(36, 48, 4)[::-1, :, :3]
    screens = [
        lumivox.Picture(np.float32(known), exposure=-9.0).screen().astype(int) for known in (ours, theirs)
    ]
    assert np.ptp(screens[0]) > 100
    assert abs(screens[0] - screens[1]).max() <= 1


def test_blenders_own_export_has_the_same_light(tmp_path: Path) -> None:
    """Lamps of a file that Blender exports as glTF are as bright as in the extension."""
    scenes.lamps()
    bpy.data.objects.remove(bpy.data.objects["spot"])
    bpy.data.objects.remove(bpy.data.objects["spot.001"])
    file = tmp_path / "blender.glb"
    bpy.ops.export_scene.gltf(filepath=str(file), export_lights=True, export_cameras=True)
    loaded = lumivox.Scene.load(file)
    own = read()[0].lights
    assert [light.kind for light in loaded.lights] == ["point"]
    assert loaded.lights[0].intensity == pytest.approx(own[0]["intensity"], rel=1e-3)
    np.testing.assert_allclose(loaded.lights[0].position, own[0]["position"], atol=1e-5)


def test_an_irradiance_volume_is_baked(box: Any, tmp_path: Path) -> None:
    file = tmp_path / "light.ktx2"
    assert bpy.ops.lumivox.bake_volume(filepath=str(file), spacing=1.0, frames=4) == {"FINISHED"}
    assert file.read_bytes().startswith(b"\xabKTX 20\xbb")
    with pytest.raises(RuntimeError, match="nowhere"):
        bpy.ops.lumivox.bake_volume(filepath="/nowhere/light.ktx2", spacing=1.0, frames=4)


def test_the_box_of_voxels_follows_its_object(box: Any) -> None:
    assert bpy.ops.lumivox.add_box() == {"FINISHED"}
    depsgraph = bpy.context.evaluated_depsgraph_get()
    low, high = box_of(box, depsgraph)
    np.testing.assert_allclose((low, high), ((-2, 0, -2), (2, 1, 2)), atol=1e-3)
    box.lumivox.box.scale = (0.5, 0.5, 0.5)
    bpy.context.view_layer.update()
    data, view = read()
    session = Session()
    session.show(data, view, SMALL, box=box_of(box, bpy.context.evaluated_depsgraph_get()))
    assert session.renderer.voxel_size_m == pytest.approx(1.0 / 16.0, rel=0.3)
    session.show(data, view, SMALL)
    assert session.renderer.voxel_size_m > 0.2
    # The setting keeps an object that was deleted.
    bpy.ops.object.select_all(action="DESELECT")
    box.lumivox.box.select_set(True)
    bpy.ops.object.delete()
    assert box.lumivox.box is not None
    assert box_of(box, bpy.context.evaluated_depsgraph_get()) is None


def test_notes_are_told_once(box: Any) -> None:
    status.forget()
    known = status.Status(voxels=1, voxel_m=0.5, voxel_share=0.2, notes=("lamp: is odd",))
    told = status.set_of("scene", known)
    assert told[0] == "lamp: is odd" and "0.5 m" in told[1]
    assert status.set_of("scene", known) == []
    assert engine.explain(ValueError("the reason")) == "Lumivox: the reason"
