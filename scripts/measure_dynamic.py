#!/usr/bin/env python3
"""Prints what it saves to keep what is static while other things move, from `lumivox-lab dynamic`.

Usage: scripts/measure_dynamic.py [PROGRAM]   (default: target/release/lumivox-lab; build it first, on an idle machine)

The scene is a field of 576 spheres over a floor, 276 482 triangles, of which 1, 10 and 50 % move; and the atrium,
whose triangles are few and large.
"""

import base64
import json
import math
import os
import struct
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SHARES = [0.01, 0.1, 0.5]
VOLUMES = ["dense", "octree"]
RESOLUTION = 128
SEGMENTS = 16


def sphere():
    """Positions, which are the normals too, and indices, of a unit sphere."""
    positions, indices = [], []
    for row in range(SEGMENTS + 1):
        for column in range(SEGMENTS + 1):
            theta, phi = math.pi * row / SEGMENTS, 2 * math.pi * column / SEGMENTS
            positions.append((
                math.sin(theta) * math.cos(phi), math.cos(theta), math.sin(theta) * math.sin(phi)))
    for row in range(SEGMENTS):
        for column in range(SEGMENTS):
            a = row * (SEGMENTS + 1) + column
            b = a + SEGMENTS + 1
            indices += ([a, a + 1, b] if row > 0 else [])
            indices += ([a + 1, b + 1, b] if row + 1 < SEGMENTS else [])
    return positions, indices


def field():
    """The field of spheres as a glTF file."""
    meshes = [
        sphere(),
        ([(x, 0, z) for x, z in [(-1, -1), (-1, 1), (1, 1), (1, -1)]], [0, 1, 2, 0, 2, 3]),
    ]
    gltf = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": []}], "nodes": [],
        "meshes": [], "accessors": [], "bufferViews": [],
        "materials": [{"pbrMetallicRoughness": {
            "baseColorFactor": [0.7, 0.6, 0.5, 1], "metallicFactor": 0}}],
        "extensionsUsed": ["KHR_lights_punctual"],
        "extensions": {"KHR_lights_punctual": {"lights": [{"type": "point", "intensity": 500}]}},
    }
    data = b""

    def accessor(values, component, kind):
        nonlocal data
        gltf["bufferViews"].append(
            {"buffer": 0, "byteOffset": len(data), "byteLength": len(values)})
        data += values
        size = {"SCALAR": 4, "VEC3": 12}[kind]
        gltf["accessors"].append({
            "bufferView": len(gltf["bufferViews"]) - 1, "componentType": component,
            "count": len(values) // size, "type": kind})
        return len(gltf["accessors"]) - 1

    for positions, indices in meshes:
        place = accessor(b"".join(struct.pack("<3f", *p) for p in positions), 5126, "VEC3")
        corners = list(zip(*positions))
        gltf["accessors"][place]["min"] = [min(values) for values in corners]
        gltf["accessors"][place]["max"] = [max(values) for values in corners]
        order = accessor(struct.pack(f"<{len(indices)}I", *indices), 5125, "SCALAR")
        gltf["meshes"].append(
            {"primitives": [{"attributes": {"POSITION": place}, "indices": order, "material": 0}]})

    def node(**parts):
        gltf["nodes"].append(parts)
        gltf["scenes"][0]["nodes"].append(len(gltf["nodes"]) - 1)

    for i in range(12 * 4 * 12):
        x, y, z = i % 12, i // 12 % 4, i // 48
        node(mesh=0, translation=[x - 5.5, y + 0.5, z - 5.5], scale=[0.3, 0.3, 0.3])
    node(mesh=1, scale=[6.5, 1, 6.5])
    node(translation=[0, 6, 0], extensions={"KHR_lights_punctual": {"light": 0}})
    uri = "data:application/octet-stream;base64," + base64.b64encode(data).decode()
    gltf["buffers"] = [{"byteLength": len(data), "uri": uri}]
    return json.dumps(gltf)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "target/release/lumivox-lab")
    rows = []
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "field.gltf")
        with open(path, "w") as file:
            file.write(field())
        for name, scene in [("field", path), ("atrium", "builtin:atrium")]:
            for volume, share in [(volume, share) for volume in VOLUMES for share in SHARES]:
                print(f"{name} {volume} {share}", file=sys.stderr)
                command = [program, "dynamic", scene, "--resolution", str(RESOLUTION),
                           "--volume", volume, "--share", str(share), "--json"]
                result = subprocess.run(command, check=True, capture_output=True, text=True)
                rows.append((f"{name}, {volume}", share, json.loads(result.stdout)))

    def pair(whole, kept):
        return f"{whole:.1f} | {kept:.1f} | {whole / max(kept, 1e-9):.1f}"

    print(f"GPU: {rows[0][2]['adapter']['name']}; {RESOLUTION} voxels, six lobes; ms a move\n")
    print("| scene, volume | share that moves | voxelize: all | kept | gain "
          "| with the volume: all | kept | gain | filter: all | kept | gain | cells written |")
    print("| --- | ---: " + "| ---: | ---: | ---: " * 3 + "| ---: |")
    for name, share, report in rows:
        assert report["has_same_bits"]
        stages = {stage["stage"]: stage for stage in report["stages"]}
        voxelize = pair(stages["voxelize"]["whole_ms"], stages["voxelize"]["kept_ms"])
        whole = pair(report["whole_voxelize_ms"], report["kept_voxelize_ms"])
        filters = pair(stages["filter"]["whole_ms"], stages["filter"]["kept_ms"])
        print(f"| {name} | {share:.0%} | {voxelize} | {whole} | {filters} "
              f"| {report['changed_share']:.0%} |")


if __name__ == "__main__":
    main()
