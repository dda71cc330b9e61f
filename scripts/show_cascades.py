#!/usr/bin/env python3
"""Makes the figures of docs/cascades.md: pictures of the city, a strip of its fly-through, a chart of memory, and, on standard
output, what each cascade costs.

Usage: scripts/show_cascades.py [PROGRAM] [PART ...]   (default: target/debug/lumivox, and all parts: pictures, flight, memory, costs)

On two cores without a GPU all of it takes about half an hour.
"""

import math
import os
import re
import subprocess
import sys
import tempfile
from pathlib import Path

from contact_sheet import read_png, write_png

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
IMAGES = os.path.join(ROOT, "docs", "images", "cascades")
SUN = ["--shadow-resolution", "8192"]
MIB = 1024 * 1024
# The city's octree with its whole kilometre in one box, from `lumivox-lab volumes builtin:city`:
# edge of the voxels in m, and MiB.
OCTREE = [(1000 / 128, 28_272_180 / MIB), (1000 / 256, 112_373_280 / MIB)]


def lumivox(program, scene, output, *options):
    command = [program, "render", f"builtin:{scene}", "-o", output, "--volume", "cascades", *SUN, *options]
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def pictures(program):
    for scene, name, *options in [
        ("city", "street", "--camera", "street", "--frames", "16"),
        ("city-night", "street-night", "--camera", "street", "--frames", "96"),
        ("interior", "interior", "--frames", "16"),
        ("interior-night", "interior-night", "--frames", "96"),
        ("city", "borders", "--camera", "above", "--frames", "4", "--show-grid"),
    ]:
        lumivox(program, scene, f"{IMAGES}/{name}.png", *options, "--size", "384x216", "--bounces", "4")
    with tempfile.TemporaryDirectory() as folder:
        files = [f"{folder}/{level}.png" for level in (2, 4, 6)]
        for level, file in zip((2, 4, 6), files):
            options = ["--view", "voxels", "--level", str(level), "--size", "256x144", "--bounces", "2", "--frames", "4"]
            lumivox(program, "city", file, "--camera", "roof", *options)
        strip(files, f"{IMAGES}/voxels.png", 3)


def flight(program):
    with tempfile.TemporaryDirectory() as folder:
        files = []
        for second in range(0, 42, 5):
            files.append(f"{folder}/{second}.png")
            options = ["--camera", "flight", "--animation", "flight", "--time", str(second), "--size", "192x108"]
            lumivox(program, "city", files[-1], *options, "--frames", "8", "--bounces", "2")
        strip(files, f"{IMAGES}/flight.png", 3)


def strip(files, output, columns):
    gap = 4
    tiles = [read_png(Path(file)) for file in files]
    width, height = tiles[0][:2]
    blank = bytes([255]) * (3 * width)
    lines = []
    for first in range(0, len(tiles), columns):
        row = [tile[2] for tile in tiles[first : first + columns]]
        row += [[blank] * height] * (columns - len(row))
        lines += [bytes([255] * 3 * gap).join(bytes(tile[y]) for tile in row) for y in range(height)]
        lines += [bytes([255]) * len(lines[0])] * gap
    write_png(Path(output), columns * (width + gap) - gap, lines[:-gap])


def volume_mib(program, *options):
    """MiB of the volume, from the estimate of `lumivox info`."""
    command = [program, "info", "builtin:city", *options]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    return int(re.search(r"voxel volume +([\d ]+?)  ", text).group(1).replace(" ", "")) / MIB


def memory(program):
    """Bytes against the finest voxel, for a reach of a kilometre in every way: circles are measured, rings computed."""
    dense = [(1000 / n, volume_mib(program, "--resolution", str(n)), True) for n in (64, 128, 256)]
    # Dense volumes grow with the cube of the resolution.
    dense += [(1000 / 256 / 2**n, dense[-1][1] * 8**n, False) for n in (1, 2, 3, 4, 5)]
    octree = [(voxel, mib, True) for voxel, mib in OCTREE]
    # An octree grows with the square.
    octree += [(OCTREE[-1][0] / 2**n, OCTREE[-1][1] * 4**n, False) for n in (1, 2, 3, 4, 5)]
    cascades = []
    for count in range(2, 9):
        options = ["--volume", "cascades", "--cascades", str(count), "--cascade-voxel", str(16 / 2 ** (count - 1))]
        cascades.append((16 / 2 ** (count - 1), volume_mib(program, *options), True))
    series = [("dense", "#c44e52", dense), ("octree", "#4c72b0", octree), ("cascades", "#55a868", cascades)]
    with open(f"{IMAGES}/memory.svg", "w") as file:
        file.write(chart(series))
    for name, _, points in series:
        print(name, *(f"{voxel:.3g} m: {mib:,.0f} MiB;" for voxel, mib, _ in points))


def chart(series):
    width, height, left, right, top, bottom = 620, 420, 84, 20, 44, 60
    x_range, y_range = (0.1, 20.0), (2.0, 2e7)

    def place(value, low_high, start, end):
        low, high = (math.log(bound) for bound in low_high)
        return start + (math.log(value) - low) / (high - low) * (end - start)

    def x(voxel):
        # Finer voxels to the right.
        return place(voxel, x_range, width - right, left)

    def y(mib):
        return place(mib, y_range, height - bottom, top)

    font = 'font-family="sans-serif"'
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">']
    out.append(f'<rect width="{width}" height="{height}" fill="white"/>')
    out.append(f'<text x="{left}" y="26" {font} font-size="17" fill="#222">Memory of the volume for a city of a kilometre</text>')
    for voxel in (0.125, 0.25, 0.5, 1, 2, 4, 8, 16):
        out.append(f'<line x1="{x(voxel):.1f}" y1="{top}" x2="{x(voxel):.1f}" y2="{height - bottom}" stroke="#e8e8ec"/>')
        out.append(f'<text x="{x(voxel):.1f}" y="{height - bottom + 20}" {font} font-size="13" fill="#666" text-anchor="middle">{voxel}</text>')
    for power in range(1, 8):
        mib = 10**power
        label = f"{mib} MiB" if power < 4 else f"{mib // 1000:,} GB".replace(",", " ")
        out.append(f'<line x1="{left}" y1="{y(mib):.1f}" x2="{width - right}" y2="{y(mib):.1f}" stroke="#e8e8ec"/>')
        out.append(f'<text x="{left - 8}" y="{y(mib) + 4:.1f}" {font} font-size="13" fill="#666" text-anchor="end">{label}</text>')
    out.append(f'<text x="{(left + width - right) / 2}" y="{height - 14}" {font} font-size="14" fill="#222" text-anchor="middle">edge of the finest voxels, m</text>')
    for number, (name, color, points) in enumerate(series):
        points = sorted(points, reverse=True)
        line = " ".join(f"{x(voxel):.1f},{y(mib):.1f}" for voxel, mib, _ in points)
        out.append(f'<polyline points="{line}" fill="none" stroke="{color}" stroke-width="2"/>')
        for voxel, mib, is_measured in points:
            fill = color if is_measured else "white"
            out.append(f'<circle cx="{x(voxel):.1f}" cy="{y(mib):.1f}" r="4.5" fill="{fill}" stroke="{color}" stroke-width="2"/>')
        legend = top + 18 + 20 * number
        out.append(f'<circle cx="{left + 18}" cy="{legend - 4}" r="4.5" fill="{color}"/>')
        out.append(f'<text x="{left + 30}" y="{legend}" {font} font-size="14" fill="#222">{name}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"


def costs(program):
    """Times by stages with one to eight cascades, the least of two runs each."""
    print("| cascades | outermost voxels | reach | voxels | voxelization | direct light | a bounce | a frame | volume |")
    print("| --: | --: | --: | --: | --: | --: | --: | --: | --: |")
    stages = [["voxelize"], ["light"], ["face rays", "emitter rays", "bounce"], ["trace"]]
    with tempfile.TemporaryDirectory() as folder:
        for count in range(1, 9):
            options = ["--cascades", str(count), "--size", "160x90", "--frames", "2", "--bounces", "2", "-v"]
            runs = []
            for _ in range(2):
                text = lumivox(program, "city", f"{folder}/a.png", "--camera", "street", *options)
                stage = dict(re.findall(r"^  (\S[\w -]*?) +([\d.]+)$", text, re.MULTILINE))
                runs.append([sum(float(stage.get(name, 0)) for name in names) for names in stages])
            voxels = re.search(r"voxels +([\d ]+) with", text).group(1)
            mib = volume_mib(program, "--volume", "cascades", "--cascades", str(count))
            times = " | ".join(f"{min(times):.0f} ms" for times in zip(*runs))
            edge = 0.125 * 2 ** (count - 1)
            print(f"| {count} | {edge:g} m | {32 * edge:g} m | {voxels} | {times} | {mib:.0f} MiB |", flush=True)


def main():
    arguments = sys.argv[1:]
    program = arguments.pop(0) if arguments and os.path.exists(arguments[0]) else f"{ROOT}/target/debug/lumivox"
    os.makedirs(IMAGES, exist_ok=True)
    parts = {"pictures": pictures, "flight": flight, "memory": memory, "costs": costs}
    for part in arguments or parts:
        parts[part](program)


if __name__ == "__main__":
    main()
