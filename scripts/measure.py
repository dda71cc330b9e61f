#!/usr/bin/env python3
"""Prints the table of stage times and memory in docs/speed.md, from the program's own --json output.

Usage: scripts/measure.py [PROGRAM]   (default: target/release/lumivox; build it first, on an idle machine)
"""

import json
import os
import subprocess
import sys
import tempfile

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SCENES = ["cornell", "atrium"]
RESOLUTIONS = [64, 128, 256]
# Stages of the program, in the order of the table, with what happens in them.
ONCE = ["voxelize", "volume", "shadow maps", "light", "bounce", "filter"]
FRAME = ["G-buffer", "direct light", "trace", "picture"]


def render(program, scene, resolution, preset):
    with tempfile.TemporaryDirectory() as folder:
        command = [
            program, "render", f"builtin:{scene}", "-o", os.path.join(folder, "x.png"),
            "--resolution", str(resolution), "--preset", preset, "--frames", "16", "--json",
        ]
        result = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(result.stdout)


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else os.path.join(ROOT, "target/release/lumivox")
    reports = {}
    for scene in SCENES:
        for resolution in RESOLUTIONS:
            for preset in ["fast", "balanced", "high"]:
                print(f"{scene} {resolution} {preset}", file=sys.stderr)
                reports[scene, resolution, preset] = render(program, scene, resolution, preset)

    columns = [(scene, resolution) for scene in SCENES for resolution in RESOLUTIONS]

    def row(name, cell):
        print(f"| {name} | " + " | ".join(cell(*column) for column in columns) + " |")

    def stage(name, preset):
        def cell(scene, resolution):
            stages = {s["stage"]: s["ms"] for s in reports[scene, resolution, preset]["stages"]}
            return f"{stages.get(name, 0.0):.0f}"
        return cell

    def frame(preset):
        def cell(scene, resolution):
            stages = {s["stage"]: s["ms"] for s in reports[scene, resolution, preset]["stages"]}
            return f"**{sum(stages.get(name, 0.0) for name in FRAME):.0f}**"
        return cell

    def of_report(key):
        return lambda scene, resolution: key(reports[scene, resolution, "balanced"])

    first = reports[columns[0] + ("balanced",)]
    print(f"GPU: {first['adapter']['name'] if 'adapter' in first else '?'}; 640x360, 8 bounces\n")
    row("", lambda scene, resolution: f"{scene} {resolution}")
    row("---", lambda *_: "---:")
    row("voxels", of_report(lambda report: f"{report['voxels']:,}"))
    row("memory, MiB", of_report(lambda report: f"{report['memory_bytes'] / 2**20:.0f}"))
    for name in ONCE:
        row(f"{name}, ms once", stage(name, "balanced"))
    for name in FRAME:
        if name == "trace":
            for preset in ["fast", "balanced", "high"]:
                row(f"trace, {preset}, ms a frame", stage(name, preset))
        else:
            row(f"{name}, ms a frame", stage(name, "balanced"))
    for preset in ["fast", "balanced", "high"]:
        row(f"**whole frame, {preset}, ms**", frame(preset))


if __name__ == "__main__":
    main()
