"""The settings of a Blender scene, and those of Lumivox that they mean."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

from .units import place

BALANCED = "balanced"


def _voxels(default: int, about: str) -> Any:
    return bpy.props.IntProperty(
        name="Resolution" if about == "renders" else "Viewport Resolution",
        description=f"Voxels along the longest axis in {about}, rounded to a multiple of 8. More resolve finer detail; memory and time grow with the square",
        min=16,
        max=1024,
        step=8,
        default=default,
    )


class LumivoxSettings(bpy.types.PropertyGroup):
    """Settings of a scene: ``scene.lumivox``."""

    preset: bpy.props.EnumProperty(
        name="Quality",
        description="Cones for each pixel",
        items=(
            ("fast", "Fast", "9 cones, from one pixel of four"),
            (BALANCED, "Balanced", "9 cones from every pixel"),
            ("high", "High", "12 cones from every pixel, with finer samples: fewest leaks"),
        ),
        default=BALANCED,
    )
    samples: bpy.props.IntProperty(
        name="Render",
        description="Frames that a picture is the mean of. More have less noise",
        min=1,
        max=65536,
        default=64,
    )
    preview_samples: bpy.props.IntProperty(
        name="Viewport",
        description="Frames that the picture of a viewport is the mean of while nothing moves",
        min=1,
        max=65536,
        default=32,
    )
    bounces: bpy.props.IntProperty(
        name="Bounces",
        description="Bounces of indirect light. 0 is only direct light",
        min=0,
        max=64,
        default=16,
    )
    resolution: _voxels(128, "renders")
    preview_resolution: _voxels(64, "viewports")
    box: bpy.props.PointerProperty(
        name="Box",
        description="An object whose bounding box has the voxels; without one they are around the whole scene. Light is only computed in there",
        type=bpy.types.Object,
    )
    use_cascades: bpy.props.BoolProperty(
        name="Cascades",
        description="Boxes around the camera, each with voxels twice as large as those in the one within it: for landscapes and cities",
        default=False,
    )
    cascades: bpy.props.IntProperty(
        name="Boxes", description="Number of boxes", min=1, max=16, default=8
    )
    cascade_resolution: bpy.props.IntProperty(
        name="Resolution",
        description="Voxels along the edge of each box, rounded to a multiple of 8",
        min=32,
        max=256,
        step=8,
        default=64,
    )
    cascade_voxel: bpy.props.FloatProperty(
        name="Finest Voxel",
        description="Edge of the voxels around the camera",
        subtype="DISTANCE",
        min=0.001,
        max=1000.0,
        default=0.125,
    )
    shadows: bpy.props.EnumProperty(
        name="Shadows",
        description="Shadows of points, spots and suns. Those of areas, glowing surfaces and the world are always soft",
        items=(
            ("map", "Sharp", "Exact to a texel of their maps; sizes of lights have no effect"),
            ("cone", "Soft", "As wide as sizes of lights make them, but as coarse as the voxels"),
        ),
        default="map",
    )
    shadow_resolution: bpy.props.IntProperty(
        name="Shadow Maps",
        description="Texels along an edge of a lamp's shadow map. More make sharper shadows",
        min=16,
        max=16384,
        default=1024,
    )


def settings_of(scene: Any, is_preview: bool) -> dict[str, Any]:
    """The settings of Lumivox for a scene's pictures."""
    own = scene.lumivox
    chosen: dict[str, Any] = {
        "preset": own.preset,
        "frames": own.preview_samples if is_preview else own.samples,
        "bounces": own.bounces,
        "shadows": own.shadows,
        "shadow_resolution": own.shadow_resolution,
    }
    if own.use_cascades:
        return chosen | {
            "volume": "cascades",
            "cascades": own.cascades,
            "cascade_resolution": _of_eight(own.cascade_resolution, 32),
            "cascade_voxel": own.cascade_voxel,
        }
    resolution = own.preview_resolution if is_preview else own.resolution
    return chosen | {"resolution": _of_eight(resolution, 16)}


def box_of(scene: Any, depsgraph: Any) -> Any:
    """The lower and the upper corner of the box of voxels in Lumivox's world, or ``None``."""
    chosen = scene.lumivox.box
    # The setting keeps a deleted object alive.
    is_there = chosen is not None and chosen.name in scene.objects
    if not is_there or scene.lumivox.use_cascades:
        return None
    evaluated = chosen.evaluated_get(depsgraph)
    if evaluated.type == "EMPTY":
        size = evaluated.empty_display_size
        corners = size * (np.indices((2, 2, 2)).reshape(3, 8).T * 2.0 - 1.0)
    else:
        corners = np.array(evaluated.bound_box)
    matrix = place(evaluated.matrix_world)
    moved = corners @ matrix[:3, :3].T + matrix[:3, 3]
    low, high = moved.min(axis=0), moved.max(axis=0)
    if not (high > low).all():
        return None
    return tuple(low.tolist()), tuple(high.tolist())


def _of_eight(number: int, least: int) -> int:
    return max(least, (number + 4) // 8 * 8)


def register() -> None:
    bpy.utils.register_class(LumivoxSettings)
    bpy.types.Scene.lumivox = bpy.props.PointerProperty(type=LumivoxSettings)


def unregister() -> None:
    del bpy.types.Scene.lumivox
    bpy.utils.unregister_class(LumivoxSettings)
