"""Units and axes: the only place where those of Blender and Lumivox meet.

Blender's world has z up, and its light is radiometric: radiance in W/(m2 sr). Lumivox's world has
y up, and its light is photometric: radiance in cd/m2. One factor, that of light with a wavelength
of 555 nm, connects them, as in Blender's own export to glTF. It cancels out in pictures, which are
divided by it, so that they have the values of Cycles.
"""

from __future__ import annotations

import math

import numpy as np

#: Lumens in a watt.
LUMENS_PER_WATT = 683.0

#: Rotates Blender's axes to Lumivox's: (x, y, z) becomes (x, z, -y).
LUMIVOX_FROM_BLENDER = np.array(((1.0, 0.0, 0.0), (0.0, 0.0, 1.0), (0.0, -1.0, 0.0)))


def place(matrix: object) -> np.ndarray:
    """A matrix that leads to Blender's world, as one that leads to Lumivox's, (4, 4)."""
    turned = np.array(matrix, np.float64)
    turned[:3] = LUMIVOX_FROM_BLENDER @ turned[:3]
    return turned


def direction(vector: object) -> np.ndarray:
    """A direction or position in Blender's world, in Lumivox's."""
    return LUMIVOX_FROM_BLENDER @ np.array(vector, np.float64)


def from_lumivox(vectors: np.ndarray) -> np.ndarray:
    """Directions (..., 3) in Lumivox's world, in Blender's."""
    return vectors @ LUMIVOX_FROM_BLENDER.astype(vectors.dtype)


def candela(watts: float) -> float:
    """The intensity of a point or spot light of a power: radiant flux over the whole sphere."""
    return LUMENS_PER_WATT * watts / (4.0 * math.pi)


def lux(irradiance: float) -> float:
    """The illuminance of a sun, of W/m2 on a surface that faces it."""
    return LUMENS_PER_WATT * irradiance


def area_radiance(watts: float, area_m2: float) -> float:
    """The radiance in W/(m2 sr) of one side of an area that sends a power."""
    return watts / (math.pi * area_m2)


def nits(radiance: float) -> float:
    """W/(m2 sr) in cd/m2."""
    return LUMENS_PER_WATT * radiance
