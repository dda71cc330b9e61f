"""Operators: the box of voxels, baking, and export."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import bpy
import numpy as np

from .engine import explain, picture_size
from .properties import box_of, settings_of
from .session import load
from .translate import Reader
from .translate.camera import of_object
from .units import LUMIVOX_FROM_BLENDER


def scene_of(context: Any) -> tuple[Any, tuple[str, ...]]:
    """The scene of a context as Lumivox's, with its camera, and the notes on it."""
    import lumivox

    depsgraph = context.evaluated_depsgraph_get()
    data = Reader().read(depsgraph)
    if not data.instances:
        raise ValueError("the scene has no visible surfaces")
    scene = load(data)
    if context.scene.camera is not None:
        camera = context.scene.camera.evaluated_get(depsgraph)
        view = of_object(camera, depsgraph, picture_size(context.scene.render))
        scene.cameras = (view.camera(lumivox),)
    return scene, data.notes


class LUMIVOX_OT_add_box(bpy.types.Operator):
    """Add a cube around the scene, in which light is computed: move and scale it to what is seen"""

    bl_idname = "lumivox.add_box"
    bl_label = "Add Voxel Box"
    bl_options = {"REGISTER", "UNDO"}

    def execute(self, context: Any) -> set[str]:
        shown = [
            np.array(item.bound_box) @ np.array(item.matrix_world)[:3, :3].T
            + np.array(item.matrix_world)[:3, 3]
            for item in context.visible_objects
            if item.type in ("MESH", "CURVE", "SURFACE", "META", "FONT")
        ]
        corners = np.concatenate(shown) if shown else np.array(((-1.0,) * 3, (1.0,) * 3))
        low, high = corners.min(axis=0), corners.max(axis=0)
        box = bpy.data.objects.new("Voxel Box", None)
        box.empty_display_type = "CUBE"
        box.location = (low + high) / 2.0
        box.scale = np.maximum((high - low) / 2.0, 1e-3)
        context.collection.objects.link(box)
        context.scene.lumivox.box = box
        return {"FINISHED"}


class _Export:
    filepath: bpy.props.StringProperty(subtype="FILE_PATH")

    def invoke(self, context: Any, event: Any) -> set[str]:
        if not self.filepath:
            stem = Path(bpy.data.filepath).stem or "scene"
            self.filepath = bpy.path.abspath("//") + stem + self.filename_ext
        context.window_manager.fileselect_add(self)
        return {"RUNNING_MODAL"}

    def _target(self) -> str:
        path = bpy.path.abspath(self.filepath)
        if not path:
            raise ValueError("filepath: is empty, but must be the file to write")
        return bpy.path.ensure_ext(path, self.filename_ext)

    def execute(self, context: Any) -> set[str]:
        try:
            self._write(context)
        except Exception as error:
            self.report({"ERROR"}, explain(error))
            return {"CANCELLED"}
        return {"FINISHED"}


class LUMIVOX_OT_save_glb(_Export, bpy.types.Operator):
    """Write the scene as Lumivox renders it, for its program, window and web page"""

    bl_idname = "lumivox.save_glb"
    bl_label = "Export for Lumivox (.glb)"

    filename_ext = ".glb"
    filter_glob: bpy.props.StringProperty(default="*.glb", options={"HIDDEN"})

    def _write(self, context: Any) -> None:
        scene, notes = scene_of(context)
        scene.save(self._target())
        for note in notes:
            self.report({"WARNING"}, note)


class LUMIVOX_OT_bake_volume(_Export, bpy.types.Operator):
    """Write the indirect light at a grid of probes, an irradiance volume for Bevy"""

    bl_idname = "lumivox.bake_volume"
    bl_label = "Bake Irradiance Volume (.ktx2)"

    filename_ext = ".ktx2"
    filter_glob: bpy.props.StringProperty(default="*.ktx2", options={"HIDDEN"})
    spacing: bpy.props.FloatProperty(
        name="Spacing",
        description="Distance between probes: at most half the width of the smallest room. 0 is a 24th of the box's longest edge",
        subtype="DISTANCE",
        min=0.0,
        max=1e6,
        default=0.0,
    )
    frames: bpy.props.IntProperty(
        name="Frames", description="Frames of the cones' mean", min=1, max=65536, default=256
    )

    def _write(self, context: Any) -> None:
        scene, notes = scene_of(context)
        target = self._target()
        settings = settings_of(context.scene, False)
        options = [f"--frames={self.frames}", f"--preset={settings['preset']}", "--json"]
        options += [f"--bounces={settings['bounces']}"]
        options += [f"--resolution={settings.get('resolution', 128)}"]
        if self.spacing > 0.0:
            options.append(f"--spacing={self.spacing}")
        box = box_of(context.scene, context.evaluated_depsgraph_get())
        if box is not None:
            options.append("--box=" + ",".join(f"{number:.6g}" for corner in box for number in corner))
        with TemporaryDirectory(prefix="lumivox") as folder:
            file = os.path.join(folder, "scene.glb")
            scene.save(file)
            told = json.loads(run_program("bake", file, "-o", target, *options))
        for note in notes:
            self.report({"WARNING"}, note)
        self.report({"INFO"}, f"{target}: {_place(told)}")


def run_program(*arguments: str) -> str:
    """The output of the program ``lumivox``, which comes with the Python package.

    In a process of its own, so that its errors can be read and Blender goes on if it fails.
    """
    import lumivox

    packages = str(Path(lumivox.__file__).parent.parent)
    path = os.pathsep.join(filter(None, (packages, os.environ.get("PYTHONPATH"))))
    done = subprocess.run(
        [sys.executable, "-m", "lumivox", *arguments],
        env={**os.environ, "PYTHONPATH": path},
        capture_output=True,
        text=True,
    )
    if done.returncode:
        raise RuntimeError(done.stderr.strip() or f"lumivox ended with status {done.returncode}")
    return done.stdout


def _place(told: dict[str, Any]) -> str:
    """Where the volume is, in Blender's world."""
    numbers = told.get("translation") or told.get("center_m")
    if numbers is None:
        return "written"
    x, y, z = np.array(numbers) @ LUMIVOX_FROM_BLENDER
    return f"centre at {x:.3f}, {y:.3f}, {z:.3f} in Blender"


CLASSES = (LUMIVOX_OT_add_box, LUMIVOX_OT_save_glb, LUMIVOX_OT_bake_volume)


def register() -> None:
    for known in CLASSES:
        bpy.utils.register_class(known)


def unregister() -> None:
    for known in reversed(CLASSES):
        bpy.utils.unregister_class(known)
