"""Draws the picture of a viewport with Blender's GPU module; needs a window."""

from __future__ import annotations

from typing import Any

import gpu
import numpy as np
from gpu_extras.presets import draw_texture_2d

from .viewport import Shown


class Texture:
    """A picture on Blender's GPU."""

    def __init__(self, shown: Shown) -> None:
        self.shown = shown
        height, width = shown.pixels.shape[:2]
        pixels = np.ascontiguousarray(shown.pixels[::-1]).ravel()
        buffer = gpu.types.Buffer("FLOAT", len(pixels), pixels)
        self.texture = gpu.types.GPUTexture((width, height), format="RGBA16F", data=buffer)


def picture(engine: Any, scene: Any, region: Any, shown: Shown, known: Texture | None) -> Texture:
    """Draws a picture over a region, in the scene's view transform; the texture for the next."""
    texture = known if known is not None and known.shown is shown else Texture(shown)
    gpu.state.blend_set("ALPHA_PREMULT")
    engine.bind_display_space_shader(scene)
    draw_texture_2d(texture.texture, (0, 0), region.width, region.height)
    engine.unbind_display_space_shader()
    gpu.state.blend_set("NONE")
    return texture
