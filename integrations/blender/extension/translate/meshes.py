"""Triangles of evaluated meshes."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import model
from .notes import Notes


def _read(collection: Any, attribute: str, kind: type, width: int = 1) -> np.ndarray:
    values = np.empty(len(collection) * width, kind)
    collection.foreach_get(attribute, values)
    return values.reshape(-1, width) if width > 1 else values


def parts(
    key: str, mesh: Any, materials: list[model.Material], notes: Notes
) -> list[tuple[int, model.Mesh]]:
    """The meshes of an evaluated mesh, one for each material slot that has triangles, with the
    slot's number. ``materials`` are those of the slots; what lies beyond has the last one."""
    mesh.calc_loop_triangles()
    triangles = mesh.loop_triangles
    if len(triangles) == 0:
        return []
    corners = _read(triangles, "loops", np.int32, 3)
    slots = np.minimum(_read(triangles, "material_index", np.int32), len(materials) - 1)
    places = _read(mesh.vertices, "co", np.float32, 3)
    vertex_of_corner = _read(mesh.loops, "vertex_index", np.int32)
    normals = _read(mesh.corner_normals, "vector", np.float32, 3)
    found = []
    for slot in np.unique(slots):
        material = materials[slot]
        chosen = corners if len(materials) == 1 else corners[slots == slot]
        if len(chosen) * 3 < len(vertex_of_corner) // 2:
            used, indices = np.unique(chosen, return_inverse=True)
        else:
            used, indices = np.arange(len(vertex_of_corner)), chosen
        uvs = tuple(_uvs(mesh, uv, used, material, notes) for uv in material.uv_maps())
        colors = None
        if material.color_attribute is not None:
            colors = _colors(mesh, material, used, vertex_of_corner, notes)
        found.append(
            (
                int(slot),
                model.Mesh.of(
                    f"{key}/{slot}",
                    places[vertex_of_corner[used]],
                    np.ascontiguousarray(indices, np.uint32).ravel(),
                    normals[used],
                    uvs,
                    colors,
                ),
            )
        )
    return found


def _uvs(
    mesh: Any, uv: model.UvMap, used: np.ndarray, material: model.Material, notes: Notes
) -> np.ndarray:
    """Texture coordinates of corners, as in glTF: v counts from the top."""
    if uv.layer:
        layer = mesh.uv_layers.get(uv.layer)
    else:
        layer = next((layer for layer in mesh.uv_layers if layer.active_render), None)
    if layer is None:
        wanted = f'the UV map "{uv.layer}"' if uv.layer else "a UV map"
        notes.tell(mesh.name, f'it lacks {wanted}, which its material "{material.name}" needs')
        return np.zeros((len(used), 2), np.float32)
    flat = _read(layer.uv, "vector", np.float32, 2)[used]
    a, b, x, c, d, y = uv.transform
    moved = flat @ np.array(((a, c), (b, d)), np.float32) + np.array((x, y), np.float32)
    moved[:, 1] = 1.0 - moved[:, 1]
    return moved.astype(np.float32)


def _colors(
    mesh: Any,
    material: model.Material,
    used: np.ndarray,
    vertex_of_corner: np.ndarray,
    notes: Notes,
) -> np.ndarray | None:
    name = material.color_attribute
    if name:
        attribute = mesh.color_attributes.get(name)
    else:
        attribute = mesh.color_attributes.active_color
    if attribute is None or attribute.domain not in ("POINT", "CORNER"):
        notes.tell(mesh.name, f'it lacks the colour attribute of its material "{material.name}"')
        return None
    colors = _read(attribute.data, "color", np.float32, 4)
    colors = colors[used if attribute.domain == "CORNER" else vertex_of_corner[used]]
    colors[:, 3] = 1.0
    return np.clip(colors, 0.0, 1.0)
