"""Images of Blender as files in memory, and as arrays."""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import Any

import numpy as np

from .. import model
from .notes import Notes

_SIGNATURES = (b"\x89PNG\r\n\x1a\n", b"\xff\xd8\xff")


class Images:
    """Reads images, and keeps what it has read until they change."""

    def __init__(self) -> None:
        self._known: dict[tuple[Any, ...], model.Image | None] = {}

    def forget(self, image: Any) -> None:
        """Reads an image again when it is next asked for."""
        name = image.name_full
        self._known = {key: kept for key, kept in self._known.items() if name not in key}

    def color(self, image: Any, notes: Notes) -> model.Image | None:
        """An image of colours, encoded as sRGB."""
        return self._of(image, "color", notes)

    def data(self, image: Any, notes: Notes) -> model.Image | None:
        """An image of numbers."""
        return self._of(image, "data", notes)

    def packed(
        self, rough: tuple[Any, int] | None, metal: tuple[Any, int] | None, notes: Notes
    ) -> model.Image | None:
        """Roughness in green and metallic in blue, each from a channel of an image; 1 without."""
        if rough and metal and rough[0] == metal[0] and (rough[1], metal[1]) == (1, 2):
            return self.data(rough[0], notes)
        sources = [source for source in (rough, metal) if source is not None]
        wanted = [1] * (rough is not None) + [2] * (metal is not None)
        names = (image.name_full for image, _ in sources)
        channels = (channel for _, channel in sources)
        key = ("packed", *names, *channels, *wanted)
        if key not in self._known:
            grids = []
            for image, channel in sources:
                pixels = numbers_of(image)
                if pixels is None:
                    return self._missing(key, image, notes)
                grids.append(_levels(pixels)[..., channel])
            height = max(len(grid) for grid in grids)
            width = max(grid.shape[1] for grid in grids)
            whole = np.full((height, width, 3), 255, np.uint8)
            for channel, grid in zip(wanted, grids):
                rows = np.arange(height) * len(grid) // height
                columns = np.arange(width) * grid.shape[1] // width
                whole[..., channel] = grid[rows][:, columns]
            self._known[key] = _encoded(whole)
        return self._known[key]

    def _of(self, image: Any, use: str, notes: Notes) -> model.Image | None:
        key = (image.name_full, use)
        if key not in self._known:
            stored = _file(image, is_color=use == "color")
            if stored is None:
                pixels = pixels_of(image) if use == "color" else numbers_of(image)
                if pixels is None:
                    return self._missing(key, image, notes)
                if use == "color" and not _is_encoded(image):
                    pixels = np.concatenate((encode_srgb(pixels[..., :3]), pixels[..., 3:]), axis=2)
                stored = _png(_levels(pixels))
            self._known[key] = model.Image(model.digest(stored), stored)
        return self._known[key]

    def _missing(self, key: tuple[Any, ...], image: Any, notes: Notes) -> None:
        place = image.filepath or "its file"
        if image.source in ("TILED", "MOVIE", "SEQUENCE"):
            notes.tell(image.name, f"images of the kind {image.source} are not supported")
        else:
            notes.tell(
                image.name,
                f"{place} cannot be read; put the file there, or choose another with File > External Data",
            )
        # Not stored: the file may come back.
        return None


def _is_encoded(image: Any) -> bool:
    """Whether the pixels are encoded as sRGB; Blender has decoded those of floats."""
    return not image.is_float and image.colorspace_settings.name in ("sRGB", "Filmic sRGB")


def _file(image: Any, is_color: bool) -> bytes | None:
    """The bytes of the image's own file, if glTF may contain them as they are."""
    if image.source != "FILE" or image.is_dirty or image.is_float:
        return None
    if is_color != _is_encoded(image):
        return None
    if image.packed_file is not None:
        stored = bytes(image.packed_file.data)
    else:
        import bpy

        path = Path(bpy.path.abspath(image.filepath, library=image.library))
        try:
            stored = path.read_bytes()
        except OSError:
            return None
    return stored if stored.startswith(_SIGNATURES) else None


def pixels_of(image: Any) -> np.ndarray | None:
    """The pixels (H, W, 4) from the top, as Blender stores them; ``None`` if there are none."""
    if image.source in ("TILED", "MOVIE", "SEQUENCE"):
        return None
    width, height = image.size
    if width * height == 0 or len(image.pixels) != width * height * image.channels:
        return None
    flat = np.empty(len(image.pixels), np.float32)
    image.pixels.foreach_get(flat)
    pixels = flat.reshape(height, width, image.channels)[::-1]
    if image.channels < 3:
        pixels = np.repeat(pixels[..., :1], 3, axis=2)
    if pixels.shape[2] == 3:
        pixels = np.concatenate((pixels, np.ones((height, width, 1), np.float32)), axis=2)
    return pixels


def linear_pixels(image: Any) -> np.ndarray | None:
    """The pixels (H, W, 3) in linear light."""
    pixels = numbers_of(image)
    return None if pixels is None else pixels[..., :3]


def numbers_of(image: Any) -> np.ndarray | None:
    """The pixels (H, W, 4) as nodes see them: decoded, if their colour space is sRGB."""
    pixels = pixels_of(image)
    if pixels is None or not _is_encoded(image):
        return pixels
    return np.concatenate((decode_srgb(pixels[..., :3]), pixels[..., 3:]), axis=2)


def decode_srgb(encoded: np.ndarray) -> np.ndarray:
    low, high = encoded / 12.92, ((np.maximum(encoded, 0.0) + 0.055) / 1.055) ** 2.4
    return np.where(encoded <= 0.04045, low, high).astype(np.float32)


def encode_srgb(linear: np.ndarray) -> np.ndarray:
    low, high = linear * 12.92, 1.055 * np.maximum(linear, 0.0) ** (1.0 / 2.4) - 0.055
    return np.where(linear <= 0.0031308, low, high).astype(np.float32)


def _levels(pixels: np.ndarray) -> np.ndarray:
    return np.rint(np.clip(pixels, 0.0, 1.0) * 255.0).astype(np.uint8)


def _encoded(levels: np.ndarray) -> model.Image:
    stored = _png(levels)
    return model.Image(model.digest(stored), stored)


def _png(levels: np.ndarray) -> bytes:
    """A PNG file of (H, W, 3) or (H, W, 4) bytes. Blender brings no library for it to Python."""
    height, width, channels = levels.shape

    def chunk(name: bytes, data: bytes) -> bytes:
        check = zlib.crc32(name + data)
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", check)

    rows = np.zeros((height, 1 + width * channels), np.uint8)
    rows[:, 1:] = levels.reshape(height, -1)
    header = struct.pack(">IIBBBBB", width, height, 8, 2 if channels == 3 else 6, 0, 0, 0)
    packed = zlib.compress(rows.tobytes(), 1)
    return _SIGNATURES[0] + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b"")
