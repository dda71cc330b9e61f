"""Checked conversion between arrays and the bytes of the extension."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from .errors import InputError

Floats = npt.NDArray[np.float32]
Integers = npt.NDArray[np.int32]


def _words(shape: Sequence[int | None]) -> str:
    return "(" + ", ".join("N" if length is None else str(length) for length in shape) + ")"


#: The most numbers in an array: 2 GiB as 32-bit numbers, more than a GPU's buffer holds.
MOST = 1 << 29


def numbers(name: str, value: Any, *shapes: Sequence[int | None]) -> npt.NDArray[Any]:
    """``value`` as an array of real numbers of one of the shapes; ``None`` stands for any length."""
    try:
        array = np.asarray(value)
    except (TypeError, ValueError) as error:
        raise InputError(f"{name}: is no array: {error}") from None
    if array.dtype.kind not in "fiu" or array.dtype.itemsize > 16:
        raise InputError(f"{name}: has the dtype {array.dtype}, but must have real numbers")
    if array.size > MOST:
        raise InputError(f"{name}: has {array.size} numbers, but must have at most {MOST}")
    for shape in shapes:
        fits = len(shape) == array.ndim
        if fits and all(want in (None, got) for want, got in zip(shape, array.shape)):
            return array
    wanted = " or ".join(_words(shape) for shape in shapes)
    raise InputError(f"{name}: has the shape {array.shape}, but must have {wanted}")


def floats(name: str, value: Any, *shapes: Sequence[int | None]) -> Floats:
    """``value`` as a contiguous array of finite 32-bit floats of one of the shapes."""
    array = numbers(name, value, *shapes)
    with np.errstate(over="ignore", invalid="ignore"):
        # `ascontiguousarray` turns a scalar into an array of one number.
        single = np.ascontiguousarray(array, dtype=np.float32).reshape(array.shape)
    finite = np.isfinite(single)
    if not finite.all():
        index = tuple(int(i) for i in np.argwhere(~finite)[0])
        place = f"[{', '.join(map(str, index))}]" if index else ""
        raise InputError(f"{name}{place}: is {array[index]}, but must be finite in 32 bits")
    return single


def vertex_numbers(name: str, value: Any, count: int) -> npt.NDArray[np.uint32]:
    """``value`` as triples of numbers of ``count`` vertices."""
    array = numbers(name, value, (None, 3), (None,))
    if array.dtype.kind == "f":
        raise InputError(f"{name}: has the dtype {array.dtype}, but must have whole numbers")
    if array.size % 3:
        raise InputError(f"{name}: has {array.size} numbers, but must have three for each triangle")
    flat = array.reshape(-1, 3)
    outside = (flat < 0) | (flat >= count)
    if outside.any():
        row, column = (int(i) for i in np.argwhere(outside)[0])
        raise InputError(
            f"{name}[{row}, {column}]: is {flat[row, column]}, but there are only {count} positions"
        )
    return np.ascontiguousarray(flat, dtype=np.uint32)


def vector(name: str, value: Any) -> tuple[float, float, float]:
    """``value`` as three finite floats."""
    x, y, z = floats(name, value, (3,)).tolist()
    return (x, y, z)


def color(name: str, value: Any) -> tuple[float, float, float]:
    """``value`` as a colour: three numbers, or one for grey."""
    array = floats(name, value, (3,), ())
    x, y, z = np.broadcast_to(array, 3).tolist()
    return (x, y, z)


def whole(name: str, value: Any, least: int, most: int = (1 << 32) - 1) -> int:
    """``value`` as a whole number of a range."""
    is_whole = isinstance(value, (int, np.integer)) and not isinstance(value, (bool, np.bool_))
    if not is_whole or not least <= value <= most:
        raise InputError(f"{name}: is {value}, but must be a whole number from {least} to {most}")
    return int(value)


def size_of(name: str, value: Any) -> tuple[int, int]:
    """``value`` as a width and a height in pixels."""
    array = numbers(name, value, (2,))
    if array.dtype.kind == "f" or array.min() < 1 or array.max() > 32768:
        raise InputError(f"{name}: is {value}, but must be two whole numbers from 1 to 32768")
    width, height = array.tolist()
    return (width, height)


def view(data: bytearray, kind: str, height: int, width: int, channels: int) -> npt.NDArray[Any]:
    """The array that has ``data`` as its memory."""
    shape = (height, width) if channels == 1 else (height, width, channels)
    return np.frombuffer(data, dtype=np.dtype("<" + kind)).reshape(shape)
