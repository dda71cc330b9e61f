"""Panels in Blender's own places, with Blender's own words."""

from __future__ import annotations

from typing import Any

import bpy

from . import passes, status
from .engine import LumivoxEngine

ENGINE = LumivoxEngine.bl_idname
#: Panels that Blender keeps for EEVEE but which show what Lumivox reads as well.
_EEVEE = (
    "EEVEE_MATERIAL_PT_context_material",
    "EEVEE_MATERIAL_PT_surface",
    "EEVEE_WORLD_PT_surface",
    "DATA_PT_EEVEE_light",
    "DATA_PT_spot",
    "MATERIAL_PT_preview",
)
#: Panels whose settings have no effect.
_WITHOUT_EFFECT = ("VIEWLAYER_PT_filter", "VIEWLAYER_PT_layer_passes", "DATA_PT_light")


class _Panel:
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"
    COMPAT_ENGINES = {ENGINE}

    @classmethod
    def poll(cls, context: Any) -> bool:
        return context.engine in cls.COMPAT_ENGINES

    def _layout(self) -> Any:
        layout = self.layout
        layout.use_property_split = True
        layout.use_property_decorate = False
        return layout


class LUMIVOX_RENDER_PT_sampling(_Panel, bpy.types.Panel):
    bl_label = "Sampling"

    def draw(self, context: Any) -> None:
        own, layout = context.scene.lumivox, self._layout()
        layout.prop(own, "preset")
        column = layout.column(align=True, heading="Samples")
        column.prop(own, "preview_samples")
        column.prop(own, "samples")
        layout.prop(own, "bounces")
        layout.prop(own, "shadows")
        column = layout.column()
        column.active = own.shadows == "map"
        column.prop(own, "shadow_resolution")


class LUMIVOX_RENDER_PT_voxels(_Panel, bpy.types.Panel):
    bl_label = "Voxels"

    def draw(self, context: Any) -> None:
        own, layout = context.scene.lumivox, self._layout()
        if not own.use_cascades:
            column = layout.column(align=True)
            column.prop(own, "preview_resolution")
            column.prop(own, "resolution")
            layout.prop(own, "box")
            layout.operator("lumivox.add_box", icon="CUBE")
        known = status.of(context.scene.name)
        if known.voxels:
            layout.label(text=f"{known.voxels:,} voxels of {known.voxel_m:.3g} m")
        if known.coarse:
            box = layout.box()
            for number, line in enumerate(_lines(known.coarse, 48)):
                box.label(text=line, icon="INFO" if number == 0 else "BLANK1")


class LUMIVOX_RENDER_PT_cascades(_Panel, bpy.types.Panel):
    bl_label = "Cascades"
    bl_parent_id = "LUMIVOX_RENDER_PT_voxels"
    bl_options = {"DEFAULT_CLOSED"}

    def draw_header(self, context: Any) -> None:
        self.layout.prop(context.scene.lumivox, "use_cascades", text="")

    def draw(self, context: Any) -> None:
        own, layout = context.scene.lumivox, self._layout()
        layout.active = own.use_cascades
        layout.prop(own, "cascades")
        layout.prop(own, "cascade_resolution")
        layout.prop(own, "cascade_voxel")
        edge = own.cascade_resolution * own.cascade_voxel * 2 ** (own.cascades - 1)
        layout.label(text=f"The outermost box has an edge of {edge:.4g} m")


class LUMIVOX_RENDER_PT_film(_Panel, bpy.types.Panel):
    bl_label = "Film"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        self._layout().prop(context.scene.render, "film_transparent", text="Transparent")


class LUMIVOX_RENDER_PT_report(_Panel, bpy.types.Panel):
    bl_label = "Last Picture"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        known, column = status.of(context.scene.name), self.layout.column()
        if known.adapter:
            column.label(text=known.adapter)
        for note in known.notes:
            for number, line in enumerate(_lines(note, 56)):
                column.label(text=line, icon="ERROR" if number == 0 else "BLANK1")


class LUMIVOX_RENDER_PT_files(_Panel, bpy.types.Panel):
    bl_label = "Bake and Export"
    bl_options = {"DEFAULT_CLOSED"}

    def draw(self, context: Any) -> None:
        column = self.layout.column()
        column.operator("lumivox.bake_volume", icon="LIGHTPROBE_VOLUME")
        column.operator("lumivox.save_glb", icon="EXPORT")


class LUMIVOX_VIEWLAYER_PT_passes(_Panel, bpy.types.Panel):
    bl_label = "Passes"
    bl_context = "view_layer"

    def draw(self, context: Any) -> None:
        layout = self._layout()
        column = layout.column(align=True)
        for known in passes.PASSES:
            column.prop(context.view_layer, known.wish, text=known.name)


CLASSES = (
    LUMIVOX_RENDER_PT_sampling,
    LUMIVOX_RENDER_PT_voxels,
    LUMIVOX_RENDER_PT_cascades,
    LUMIVOX_RENDER_PT_film,
    LUMIVOX_RENDER_PT_report,
    LUMIVOX_RENDER_PT_files,
    LUMIVOX_VIEWLAYER_PT_passes,
)


def _lines(text: str, width: int) -> list[str]:
    lines = [""]
    for word in text.split():
        if lines[-1] and len(lines[-1]) + len(word) >= width:
            lines.append("")
        lines[-1] += (" " if lines[-1] else "") + word
    return lines


def _shared() -> list[Any]:
    """Blender's own panels that make sense here."""
    return [
        panel
        for panel in bpy.types.Panel.__subclasses__()
        if panel.__name__ not in _WITHOUT_EFFECT
        and (
            "BLENDER_RENDER" in getattr(panel, "COMPAT_ENGINES", ())
            or panel.__name__ in _EEVEE
        )
    ]


def register() -> None:
    for known in CLASSES:
        bpy.utils.register_class(known)
    for panel in _shared():
        # A set of its own: panels may share theirs.
        panel.COMPAT_ENGINES = {*panel.COMPAT_ENGINES, ENGINE}


def unregister() -> None:
    for panel in _shared():
        panel.COMPAT_ENGINES = {*panel.COMPAT_ENGINES} - {ENGINE}
    for known in reversed(CLASSES):
        bpy.utils.unregister_class(known)
