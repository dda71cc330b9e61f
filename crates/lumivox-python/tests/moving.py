"""A file with an animation."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np

#: A camera that sees the whole scene, as on the command line.
VIEW = "0,1,5,0,1,0,40"


def moving(folder: Path) -> Path:
    """A file: a plate that slides by 1 m in a second, a flag whose morph target rises by 0.4 m, a wall behind them, and a
    lamp that goes up; each is 1 m square but the wall."""
    data = bytearray()
    views: list[dict[str, int]] = []
    accessors: list[dict[str, Any]] = []

    def put(values: Any, kind: str, component: int = 5126) -> int:
        array = np.asarray(values, np.float32 if component == 5126 else np.uint16)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        rows = array.reshape(-1, array.shape[-1] if kind == "VEC3" else 1)
        ends = {"min": rows.min(0).tolist(), "max": rows.max(0).tolist()}
        accessors.append(
            {"bufferView": len(views) - 1, "componentType": component, "count": len(rows), "type": kind, **ends}
        )
        data.extend(array.tobytes() + bytes(-array.nbytes % 4))
        return len(accessors) - 1

    corners = np.array([(-0.5, 0, 0), (0.5, 0, 0), (0.5, 1, 0), (-0.5, 1, 0)])
    square = {"attributes": {"POSITION": put(corners, "VEC3")}, "indices": put([0, 1, 2, 0, 2, 3], "SCALAR", 5123)}
    wall = {**square, "attributes": {"POSITION": put(8 * corners - (0, 2, 0), "VEC3")}}
    flag = {**square, "targets": [{"POSITION": put([(0, 0.4, 0)] * 4, "VEC3")}]}
    second = put([0, 1], "SCALAR")
    ways = {
        0: ("translation", put([(0, 0, 0), (1, 0, 0)], "VEC3")),
        1: ("weights", put([0, 1], "SCALAR")),
        3: ("translation", put([(0, 1, 3), (0, 2, 3)], "VEC3")),
    }
    tracks = [{"input": second, "output": output} for _, output in ways.values()]
    channels = [
        {"sampler": number, "target": {"node": node, "path": path}}
        for number, (node, (path, _)) in enumerate(ways.items())
    ]
    lights = {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 500, "name": "lamp"}]}}
    document = {
        "asset": {"version": "2.0"},
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": lights,
        "scene": 0,
        "scenes": [{"nodes": [0, 1, 2, 3]}],
        "nodes": [
            {"name": "plate", "mesh": 0},
            {"name": "flag", "mesh": 1, "translation": [-1.2, 0, 0]},
            {"name": "wall", "mesh": 2, "translation": [0, 0, -2]},
            {"name": "lamp", "translation": [0, 1, 3], "extensions": {"KHR_lights_punctual": {"light": 0}}},
        ],
        "meshes": [{"primitives": [square]}, {"primitives": [flag], "weights": [0]}, {"primitives": [wall]}],
        "animations": [{"name": "walk", "samplers": tracks, "channels": channels}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(data), "uri": "data:;base64," + base64.b64encode(data).decode()}],
    }
    file = folder / "moving.gltf"
    file.write_text(json.dumps(document))
    return file
