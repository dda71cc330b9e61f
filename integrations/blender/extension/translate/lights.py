"""Lights in Blender's units: point, spot and sun as Lumivox's, areas as surfaces that emit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from .. import model
from ..units import area_radiance, candela, direction, lux, place
from .materials import source
from .notes import Notes

#: The share of a spot's blended rim, in cosines of the angle, over which Lumivox's fall-off has the
#: flux of Blender's: the mean of a smooth step is a half, that of a square over c is 1 - 2 c / 3.
SAME_FLUX = 0.75
#: The corners of a round area's outline.
CORNERS = 32
#: An area light is drawn so far in front of its place that the surface on which it lies does not
#: cover it, relative to its size.
_LIFT = 1e-3


def color(light: Any, notes: Notes) -> np.ndarray:
    """The colour of a light with its strength in watts, or W/m2 of a sun."""
    tinted = np.array(light.color)
    if light.use_temperature:
        tinted = tinted * np.array(light.temperature_color)
    tinted = tinted * (light.energy * 2.0**light.exposure)
    if light.use_nodes and light.node_tree is not None:
        tinted = tinted * _nodes(light, notes)
    return np.maximum(tinted, 0.0)


def _nodes(light: Any, notes: Notes) -> np.ndarray:
    output = light.node_tree.get_output_node("CYCLES")
    linked = source(output.inputs["Surface"]) if output is not None else None
    if linked is None:
        return np.zeros(3)
    node = linked[0]
    if node.bl_idname == "ShaderNodeEmission":
        sockets = (node.inputs["Color"], node.inputs["Strength"])
        if not any(source(socket) for socket in sockets):
            return np.array(sockets[0].default_value)[:3] * sockets[1].default_value
    notes.tell(light.name, "of its nodes only a constant Emission is supported; the light is white")
    return np.ones(3)


def lamp(name: str, light: Any, matrix: np.ndarray, notes: Notes) -> dict[str, Any] | None:
    """A point, spot or sun light as the fields of Lumivox's; ``None`` if it is dark."""
    strength = color(light, notes)
    brightest = float(strength.max())
    if brightest <= 0.0:
        return None
    if not light.use_shadow:
        notes.tell(name, "all lights cast shadows")
    fields: dict[str, Any] = {"name": name, "color": tuple((strength / brightest).tolist())}
    along = -matrix[:3, 2] / np.linalg.norm(matrix[:3, 2])
    if light.type == "SUN":
        return fields | {
            "kind": "directional",
            "intensity": lux(brightest),
            "direction": tuple(direction(along).tolist()),
            "angular_radius_deg": math.degrees(light.angle / 2.0),
        }
    radius = light.shadow_soft_size
    if not light.normalize and radius > 0.0:
        # The strength is that of a square metre of the sphere.
        brightest *= 4.0 * math.pi * radius**2
    fields |= {
        "intensity": candela(brightest),
        "position": tuple(direction(matrix[:3, 3]).tolist()),
        "radius_m": radius,
    }
    if light.type == "POINT":
        return fields | {"kind": "point"}
    outer = light.spot_size / 2.0
    if outer > math.pi / 2.0:
        notes.tell(name, "spots are at most 180 degrees wide")
        outer = math.pi / 2.0
    rim = SAME_FLUX * light.spot_blend * (1.0 - math.cos(outer))
    inner = math.acos(min(math.cos(outer) + rim, 1.0))
    return fields | {
        "kind": "spot",
        "direction": tuple(direction(along).tolist()),
        "outer_angle_deg": math.degrees(outer),
        "inner_angle_deg": min(math.degrees(inner), math.degrees(outer) * (1.0 - 1e-6)),
    }


def area(
    name: str, light: Any, matrix: np.ndarray, notes: Notes
) -> tuple[model.Mesh, model.Material, model.Matrix] | None:
    """An area light as a surface that emits to its front; ``None`` if it is dark."""
    strength = color(light, notes)
    width = light.size
    height = light.size_y if light.shape in ("RECTANGLE", "ELLIPSE") else width
    is_round = light.shape in ("DISK", "ELLIPSE")
    scale = np.linalg.norm(matrix[:3, :2], axis=0)
    area_m2 = width * height * scale[0] * scale[1] * (math.pi / 4.0 if is_round else 1.0)
    if strength.max() <= 0.0 or area_m2 <= 0.0:
        return None
    if light.spread < math.pi - 1e-3:
        notes.tell(name, "the spread of area lights has no effect")
    radiance = strength * area_radiance(1.0, area_m2 if light.normalize else 1.0)
    shape = matrix.copy()
    # At the light's own size, so that a change of it only moves the surface.
    shape[:3, 0] *= width
    shape[:3, 1] *= height
    depth = np.linalg.norm(shape[:3, 2])
    ahead = -shape[:3, 2] / depth if depth else np.zeros(3)
    shape[:3, 2] = -ahead
    shape[:3, 3] += ahead * _LIFT * min(width * scale[0], height * scale[1])
    material = model.Material(
        name=name,
        base_color=(0.0, 0.0, 0.0),
        emissive=tuple(float(channel) for channel in radiance),
        is_double_sided=False,
    )
    mesh = _DISK if is_round else _SQUARE
    return mesh, material, tuple(map(tuple, place(shape).tolist()))


def _flat(key: str, outline: np.ndarray) -> model.Mesh:
    """A convex outline (N, 2) in the plane z = 0, in which the light shines along -z."""
    count = len(outline)
    positions = np.zeros((count, 3), np.float32)
    positions[:, :2] = outline
    fan = [(0, corner + 1, corner) for corner in range(1, count - 1)]
    normals = np.tile(np.array((0.0, 0.0, -1.0), np.float32), (count, 1))
    return model.Mesh.of(key, positions, np.array(fan, np.uint32).ravel(), normals)


def _disk() -> np.ndarray:
    angles = np.arange(CORNERS) * (2.0 * np.pi / CORNERS)
    # A polygon of the circle's area.
    radius = 0.5 * np.sqrt(2.0 * np.pi / (CORNERS * np.sin(2.0 * np.pi / CORNERS)))
    return radius * np.stack((np.cos(angles), np.sin(angles)), axis=1)


_SQUARE = _flat("area square", np.array(((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))))
_DISK = _flat("area disk", _disk())
