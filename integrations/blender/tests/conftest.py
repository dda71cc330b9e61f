"""Blender without a window, with the extension of this folder."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import bpy
import numpy as np
import pytest

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[2]
sys.path[:0] = [str(HERE.parent), str(ROOT / "crates/lumivox-python/python")]

import extension  # noqa: E402
import scenes  # noqa: E402
from extension.engine import KEPT, picture_size  # noqa: E402
from extension.session import Session  # noqa: E402
from extension.translate import Reader  # noqa: E402
from extension.translate.camera import View, of_object  # noqa: E402

#: Settings of small pictures.
SMALL = {"frames": 4, "resolution": 16, "bounces": 2}


@pytest.fixture(scope="session", autouse=True)
def registered() -> Iterator[None]:
    extension.register()
    yield
    KEPT.drop()
    extension.unregister()


@pytest.fixture
def box() -> Any:
    """A box on a floor under a point light, in pictures of 32 x 24 pixels."""
    scenes._begin(world=(0.1, 0.1, 0.1))
    scenes._quad("floor", (-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0), scenes.material("floor", scenes.WHITE))
    scenes._box("box", (0, 0, 0.5), (1, 1, 1), scenes.material("red", (0.6, 0.1, 0.1)))
    scenes._light("lamp", "POINT", (1.0, -1.5, 2.5), energy=200.0)
    scenes._camera((0, -5, 2.5), (0, 0, 0.4), lens=40)
    return small()


def small(size: tuple[int, int] = (32, 24), samples: int = 4) -> Any:
    """The scene, with settings for quick pictures by Lumivox."""
    scene = bpy.context.scene
    scene.render.engine = "LUMIVOX"
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.lumivox.samples, scene.lumivox.resolution, scene.lumivox.bounces = samples, 16, 2
    scene.cycles.use_denoising = scene.cycles.use_adaptive_sampling = False
    scene.cycles.pixel_filter_type = "BOX"
    return scene


def read(reader: Reader | None = None) -> tuple[Any, View]:
    """The present scene in plain values, and the view of its camera."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    scene = bpy.context.scene
    camera = scene.camera.evaluated_get(depsgraph)
    view = of_object(camera, depsgraph, picture_size(scene.render))
    return (reader or Reader()).read(depsgraph), view


def shown(settings: Any = None, layers: Any = ()) -> Any:
    """A picture of the present scene by a new session."""
    data, view = read()
    session = Session()
    session.show(data, view, settings or SMALL, layers)
    return session.picture(view)


@pytest.fixture
def exr(tmp_path: Path) -> Callable[..., dict[str, np.ndarray]]:
    """Renders with an engine as F12 does, and returns the channels of the file by their names."""

    def render(engine: str = "LUMIVOX", samples: int | None = None) -> dict[str, np.ndarray]:
        import OpenEXR

        scene = bpy.context.scene
        scene.render.engine = engine
        if samples is not None:
            scene.cycles.samples = scene.lumivox.samples = samples
        scene.render.image_settings.media_type = "MULTI_LAYER_IMAGE"
        scene.render.image_settings.file_format = "OPEN_EXR_MULTILAYER"
        scene.render.image_settings.color_depth = "32"
        scene.render.filepath = str(tmp_path / f"{engine}.exr")
        bpy.ops.render.render(write_still=True)
        found: dict[str, np.ndarray] = {}
        with OpenEXR.File(scene.render.filepath, separate_channels=True) as file:
            for part in file.parts:
                for name, channel in part.channels.items():
                    found[name] = np.array(channel.pixels, np.float64)
        return found

    return render


def color(channels: dict[str, np.ndarray], name: str = "Combined", layer: str = "ViewLayer") -> np.ndarray:
    return np.stack([channels[f"{layer}.{name}.{channel}"] for channel in "RGB"], axis=-1)


def environment(**changes: str) -> dict[str, str]:
    """The environment of a process that finds Lumivox."""
    path = os.pathsep.join([str(HERE.parent), str(ROOT / "crates/lumivox-python/python")])
    return {**os.environ, "PYTHONPATH": path, **changes}
