#!/usr/bin/env python3
"""Measures Lumivox for Blender against Cycles, and writes docs/generated/blender.md with pictures.

Usage: measure.py [SCENE ...]   (default: all; others keep their last rows)

It runs in Blender's Python module, with the extension of Python where ./test puts it:
target/tools/blender/bin/python integrations/blender/measure.py. The numbers of each scene are kept
in target/blender.json, so that scenes can be measured one by one.
"""

from __future__ import annotations

import datetime
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT / "crates/lumivox-python/python")]

import bpy  # noqa: E402
import extension  # noqa: E402
import lumivox  # noqa: E402
import numpy as np  # noqa: E402
import scenes  # noqa: E402
from extension.operators import run_program  # noqa: E402
from extension.translate.images import encode_srgb  # noqa: E402
from extension.units import LUMENS_PER_WATT  # noqa: E402

SIZE = (160, 120)
FRAMES = 32
VOXELS = 128
SAMPLES = 512
BOUNCES = 32
#: Values are limited to this multiple of the mean.
MOST = 8.0
#: Pictures for the comparison with the command line.
SMALL, FEW = (96, 72), 4
PAGE = ROOT / "docs/generated/blender.md"
IMAGES = ROOT / "docs/generated/images/blender"
LUMINANCE = np.array((0.2126, 0.7152, 0.0722), np.float32)


def render(engine: str, folder: Path, seed: int = 0, samples: int = SAMPLES // 2) -> tuple[np.ndarray, float]:
    """A picture (H, W, 3) in Blender's units, and the seconds of all cores that it took."""
    scene = bpy.context.scene
    scene.render.engine = engine
    scene.cycles.seed, scene.cycles.samples = seed, samples
    scene.render.filepath = str(folder / "picture.exr")
    begun = time.process_time()
    bpy.ops.render.render(write_still=True)
    took = time.process_time() - begun
    return read(folder / "picture.exr"), took


def read(file: Path) -> np.ndarray:
    """The pixels of an EXR file (H, W, 3) from the top."""
    loaded = bpy.data.images.load(str(file))
    loaded.colorspace_settings.name = "Non-Color"
    width, height = loaded.size
    pixels = np.empty(width * height * 4, np.float32)
    loaded.pixels.foreach_get(pixels)
    bpy.data.images.remove(loaded)
    return np.ascontiguousarray(pixels.reshape(height, width, 4)[::-1, :, :3])


def set_up(size: tuple[int, int], frames: int) -> None:
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    # The whole of the light: by default Cycles ends it after four diffuse bounces, and clamps it.
    for kind in ("max_bounces", "diffuse_bounces", "glossy_bounces"):
        setattr(scene.cycles, kind, BOUNCES)
    scene.cycles.sample_clamp_direct = scene.cycles.sample_clamp_indirect = 0.0
    scene.cycles.blur_glossy = 0.0
    # Lumivox's pixels are square, too.
    scene.cycles.pixel_filter_type = "BOX"
    scene.lumivox.samples, scene.lumivox.resolution = frames, VOXELS


def measure(name: str, folder: Path) -> dict[str, Any]:
    """The numbers of a scene; writes its pictures."""
    scenes.SCENES[name]()
    set_up(SIZE, FRAMES)
    ours, our_s = render("LUMIVOX", folder)
    halves, times = zip(*(render("CYCLES", folder, seed) for seed in (1, 2)))
    truth = (halves[0] + halves[1]) / 2.0
    # The variance of the mean of both halves.
    variance = (((halves[0] - halves[1]) @ LUMINANCE) * LUMENS_PER_WATT / 2.0) ** 2
    # Lamps that are seen would outweigh all that they light.
    most = MOST * truth.mean()
    variance[truth.max(axis=2) > most] = 0.0
    limited = [np.minimum(known, most) * LUMENS_PER_WATT for known in (ours, truth)]
    figures = lumivox.compare(*limited, variance)
    side_by_side(name, ours, truth)
    set_up(SMALL, FEW)
    inside, _ = render("LUMIVOX", folder)
    glb, exr = folder / "scene.glb", folder / "outside.exr"
    bpy.ops.lumivox.save_glb(filepath=str(glb))
    options = (f"--size={SMALL[0]}x{SMALL[1]}", f"--frames={FEW}", f"--resolution={VOXELS}")
    run_program("render", str(glb), "-o", str(exr), *options)
    # The file's camera is that of the whole canvas.
    is_shifted = bpy.context.scene.camera.data.shift_y != 0.0
    steps = None if is_shifted else steps_between(inside * LUMENS_PER_WATT, read(exr))
    return {
        "about": (scenes.SCENES[name].__doc__ or "").strip(),
        "bias": figures.bias_percent,
        "rmse": figures.rmse_percent,
        "noise": figures.noise_percent,
        "flip": figures.flip,
        "lumivox_s": our_s,
        "cycles_s": sum(times),
        "steps": steps,
        "adapter": lumivox.adapters()[0],
    }


def steps_between(a: np.ndarray, b: np.ndarray) -> int:
    """The largest difference of two pictures on a screen, in 255ths."""
    exposure = float(-np.log2(max(np.median(b[b > 0.0]), 1e-6)) - 1.0)
    screens = [lumivox.Picture(np.float32(known), exposure=exposure).screen().astype(int) for known in (a, b)]
    return int(abs(screens[0] - screens[1]).max())


def side_by_side(name: str, ours: np.ndarray, truth: np.ndarray) -> None:
    """Lumivox, Cycles, and their difference around grey, as one picture."""
    bright = 0.4 / max(float(np.percentile(truth, 75)), 1e-6)
    strip = [encode_srgb(known * bright) for known in (ours, truth)]
    strip.append(0.5 + (ours - truth) * bright)
    whole = np.clip(np.concatenate(strip, axis=1), 0.0, 1.0)[::-1]
    height, width = whole.shape[:2]
    image = bpy.data.images.new(name, width, height)
    pixels = np.ones((height, width, 4), np.float32)
    pixels[..., :3] = whole
    image.pixels.foreach_set(pixels.ravel())
    image.file_format, image.filepath_raw = "WEBP", str(IMAGES / f"{name}.webp")
    image.save(quality=90)


def page(rows: dict[str, dict[str, Any]]) -> str:
    commit = subprocess.run(
        ["git", "rev-parse", "--short=8", "HEAD"], cwd=ROOT, capture_output=True, text=True, check=True
    ).stdout.strip()
    adapter = next(iter(rows.values()))["adapter"]
    lines = [
        "# Lumivox for Blender beside Cycles",
        "",
        f"Made of commit {commit} on {datetime.date.today()} by `integrations/blender/measure.py`, with Blender {bpy.app.version_string} on {adapter}.",
        "",
        f"Each [scene](../../integrations/blender/scenes.py) is rendered by Lumivox ({FRAMES} frames, {VOXELS} voxels, preset `balanced`) and by Cycles on the CPU ({SAMPLES} samples, {BOUNCES} bounces, no clamping, no denoiser, box filter), with {SIZE[0]}x{SIZE[1]} pixels. *Bias* and *RMSE* are in percent of Cycles's mean, its noise taken out, with values of at most {MOST:g} times the mean (lamps in the picture would outweigh all else); *seconds* are those of all cores together, preparation included. *Command line* is the largest difference, in 255ths of the screen's range, between the picture of the extension and that of `lumivox render` for the exported scene ({SMALL[0]}x{SMALL[1]} pixels, {FEW} frames).",
        "",
        "| scene | bias | RMSE | noise of Cycles | FLIP | Lumivox | Cycles | command line |",
        "| --- | --: | --: | --: | --: | --: | --: | --: |",
    ]
    for name, row in rows.items():
        steps = "shifted lens" if row["steps"] is None else row["steps"]
        lines.append(
            f"| {name} | {row['bias']:+.1f} % | {row['rmse']:.1f} % | {row['noise']:.1f} % | {row['flip']:.3f} | {row['lumivox_s']:.0f} s | {row['cycles_s']:.0f} s | {steps} |"
        )
    lines += ["", "Pictures: Lumivox, Cycles, and their difference around grey.", ""]
    for name, row in rows.items():
        lines += [f"**{name}**: {row['about']}", "", f"![{name} by Lumivox and by Cycles, and their difference](images/blender/{name}.webp)", ""]
    return "\n".join(lines)


def main(names: list[str]) -> None:
    unknown = [name for name in names if name not in scenes.SCENES]
    if unknown:
        sys.exit(f"error: there is no scene {unknown[0]}; there are {', '.join(scenes.SCENES)}")
    IMAGES.mkdir(parents=True, exist_ok=True)
    kept = ROOT / "target/blender.json"
    kept.parent.mkdir(exist_ok=True)
    rows = json.loads(kept.read_text()) if kept.exists() else {}
    extension.register()
    for name in names or scenes.SCENES:
        with tempfile.TemporaryDirectory() as folder:
            rows[name] = measure(name, Path(folder))
        kept.write_text(json.dumps(rows, indent=1) + "\n")
        print(name, rows[name], flush=True)
    rows = {name: rows[name] for name in scenes.SCENES if name in rows}
    PAGE.write_text(page(rows), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
