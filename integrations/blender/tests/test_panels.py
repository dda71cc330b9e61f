"""Panels and settings, without a window: a layout that checks what it is given."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np

import scenes
from conftest import color, read
from extension import panels, status
from extension.properties import settings_of


class Layout:
    """Records what a panel shows, and refuses what does not exist."""

    def __init__(self, shown: list[str]) -> None:
        self.shown = shown

    def prop(self, data: Any, name: str, text: str | None = None) -> None:
        assert name in data.bl_rna.properties, name
        self.shown.append(name)

    def operator(self, name: str, icon: str = "NONE") -> None:
        group, _, own = name.partition(".")
        getattr(getattr(bpy.ops, group), own).get_rna_type()
        self._icon(icon)
        self.shown.append(name)

    def label(self, text: str, icon: str = "NONE") -> None:
        self._icon(icon)
        self.shown.append(text)

    def _icon(self, icon: str) -> None:
        known = bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items
        assert icon in known, icon

    def column(self, align: bool = False, heading: str = "") -> Layout:
        return self

    def box(self) -> Layout:
        return self


def draw(known: Any) -> list[str]:
    shown: list[str] = []
    panel = type("Panel", (), {"layout": Layout(shown), "_layout": panels._Panel._layout})()
    known.draw(panel, bpy.context)
    if hasattr(known, "draw_header"):
        known.draw_header(panel, bpy.context)
    return shown


def test_panels_show_what_exists(box: Any) -> None:
    status.set_of(box.name, status.Status("a GPU", 1234, 0.5, 0.2, ("lamp: is odd",)))
    shown = [text for known in panels.CLASSES for text in draw(known)]
    own = {"rna_type", "name"}
    settings = {name for name in box.lumivox.bl_rna.properties.keys() if name not in own}
    assert settings <= set(shown)
    assert {"film_transparent", "use_pass_z", "use_pass_vector"} <= set(shown)
    assert "1,234 voxels of 0.5 m" in shown and "lamp: is odd" in shown and "a GPU" in shown
    assert any(text.startswith("Voxels of 0.5 m are 20%") for text in shown)
    status.forget()


def test_blenders_own_panels_are_shared() -> None:
    for name in ("RENDER_PT_format", "DATA_PT_lens", "DATA_PT_EEVEE_light", "EEVEE_MATERIAL_PT_surface"):
        assert panels.ENGINE in getattr(bpy.types, name).COMPAT_ENGINES, name
    assert panels.ENGINE not in bpy.types.DATA_PT_light.COMPAT_ENGINES


def test_settings_are_lumivoxs(box: Any, exr: Any) -> None:
    box.lumivox.resolution, box.lumivox.preview_resolution = 67, 20
    assert settings_of(box, False)["resolution"] == 64 and settings_of(box, True)["resolution"] == 24
    whole = color(exr())
    box.lumivox.use_cascades, box.lumivox.cascades = True, 2
    box.lumivox.cascade_resolution, box.lumivox.cascade_voxel = 32, 0.25
    settings = settings_of(box, False)
    assert settings["volume"] == "cascades" and "resolution" not in settings
    np.testing.assert_allclose(color(exr()).mean(), whole.mean(), rtol=0.05)


def test_objects_of_all_kinds_have_triangles(box: Any) -> None:
    text = scenes._link("text", bpy.data.curves.new("text", "FONT"))
    text.data.body, text.data.extrude = "Lumivox", 0.1
    curve = bpy.data.curves.new("curve", "CURVE")
    curve.dimensions, curve.bevel_depth = "3D", 0.1
    curve.splines.new("POLY").points.add(2)
    for number, point in enumerate(curve.splines[0].points):
        point.co = (number, number % 2, 0.0, 1.0)
    scenes._link("curve", curve)
    meta = bpy.data.metaballs.new("meta")
    meta.elements.new()
    scenes._link("meta", meta)
    bpy.context.view_layer.update()
    data, _ = read()
    assert {placed.name for placed in data.instances} == {"floor", "box", "text", "curve", "meta"}
    assert all(len(mesh.indices) > 0 and np.isfinite(mesh.normals).all() for mesh in data.meshes)
