"""Cameras, lights, materials and instances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeVar

import numpy as np
import numpy.typing as npt

from ._arrays import color, floats, vector
from .errors import InputError

Vector = tuple[float, float, float]
Record = TypeVar("Record", bound="_Record")


class _Vectors:
    """A field that takes three numbers in any array, and has a tuple of them."""

    def __init__(self, x: float, y: float, z: float) -> None:
        self._default: Vector = (x, y, z)

    def __set_name__(self, owner: type, name: str) -> None:
        self._name = name

    def __get__(self, record: Any, owner: type) -> Vector:
        # dataclass reads the class's field without a record: the default.
        kept: Vector = self._default if record is None else record.__dict__[self._name]
        return kept

    def __set__(self, record: Any, value: npt.ArrayLike) -> None:
        record.__dict__[self._name] = vector(self._name, value)


class _Colors(_Vectors):
    """A field that takes a colour, RGB or one number for grey, and has RGB."""

    def __set__(self, record: Any, value: npt.ArrayLike) -> None:
        record.__dict__[self._name] = color(self._name, value)


def _number(name: str, value: Any) -> float:
    return float(floats(name, value, ()))


@dataclass(frozen=True)
class _Record:
    def _put(self, name: str, value: Any) -> None:
        object.__setattr__(self, name, value)

    def _numbers(self, *names: str) -> None:
        for name in names:
            self._put(name, _number(name, getattr(self, name)))

    def _record(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    @classmethod
    def _of(cls: type[Record], record: Mapping[str, Any]) -> Record:
        return cls(**record)


@dataclass(frozen=True)
class Camera(_Record):
    """A perspective camera in the world: right-handed, y up, metres.

    ``forward`` and ``up`` may have any length; ``up`` need not be at right angles to ``forward``.
    ``vertical_fov_deg`` is the angle between the bottom and the top of the picture, above 0 and
    below 180. Things nearer than ``near_m`` (above 0) are not seen.
    """

    position: _Vectors = _Vectors(0.0, 0.0, 0.0)
    forward: _Vectors = _Vectors(0.0, 0.0, -1.0)
    up: _Vectors = _Vectors(0.0, 1.0, 0.0)
    vertical_fov_deg: float = 45.0
    near_m: float = 0.01
    name: str = "camera"

    def __post_init__(self) -> None:
        self._numbers("vertical_fov_deg", "near_m")
        if not 0.0 < self.vertical_fov_deg < 180.0:
            raise InputError(
                f"vertical_fov_deg: is {self.vertical_fov_deg}, but must be above 0 and below 180"
            )
        along = np.cross(self.forward, self.up)
        if not np.linalg.norm(along) > 0.0:
            raise InputError("forward, up: must have a direction, and not the same one")

    @classmethod
    def look_at(
        cls,
        position: Any,
        target: Any,
        vertical_fov_deg: float = 45.0,
        up: Any = (0.0, 1.0, 0.0),
        near_m: float = 0.01,
        name: str = "camera",
    ) -> Camera:
        """A camera at ``position`` with ``target`` in the middle of the picture, both in metres.

        If it looks along ``up``, -z is at the top of the picture.
        """
        eye, at = np.array(vector("position", position)), np.array(vector("target", target))
        forward = at - eye
        length = np.linalg.norm(forward)
        if not length > 0.0:
            raise InputError("position, target: must be different points")
        forward = forward / length
        top = vector("up", up)
        if np.linalg.norm(np.cross(forward, top)) < 1e-3 * np.linalg.norm(top):
            top = (0.0, 0.0, -1.0)
        return cls(vector("position", eye), vector("target", forward), top, vertical_fov_deg, near_m, name)


@dataclass(frozen=True)
class Light(_Record):
    """A lamp or a sun.

    ``intensity`` is in candela, for a directional light in lux on a surface that faces it. The
    light travels along ``direction`` (not of points). ``radius_m`` (not of directional lights) and
    ``angular_radius_deg`` (only of directional lights; the sun has 0.266) make shadows soft. A spot
    falls from ``inner_angle_deg`` to ``outer_angle_deg``, both from its axis, at most 90.
    ``range_m`` is the distance beyond which a lamp may be cut off; ``None``, the physical choice,
    is unlimited. ``attenuation`` (constant, linear, quadratic) is the fall-off in the look vxct.
    """

    kind: Literal["point", "spot", "directional"] = "point"
    intensity: float = 1.0
    position: _Vectors = _Vectors(0.0, 0.0, 0.0)
    direction: _Vectors = _Vectors(0.0, -1.0, 0.0)
    color: _Colors = _Colors(1.0, 1.0, 1.0)
    radius_m: float = 0.0
    angular_radius_deg: float = 0.0
    inner_angle_deg: float = 0.0
    outer_angle_deg: float = 45.0
    range_m: float | None = None
    name: str = "light"
    attenuation: Vector | None = None

    def __post_init__(self) -> None:
        numbers = (field.name for field in fields(self) if str(field.type).startswith("float"))
        self._numbers(*(name for name in numbers if getattr(self, name) is not None))
        if self.attenuation is not None:
            self._put("attenuation", vector("attenuation", self.attenuation))


@dataclass(frozen=True)
class Material(_Record):
    """The numbers of a surface (glTF 2.0, metallic-roughness).

    ``base_color`` is linear RGB from 0 to 1, or one number for grey: the diffuse albedo of a
    dielectric, the reflectance of a metal. ``specular`` from 0 (pure Lambert) to 1 is the strength
    of a dielectric's gloss. ``emissive`` is the emitted radiance in cd/m2, RGB or grey. Textures of
    a loaded material multiply these numbers, and stay.
    """

    base_color: _Colors = _Colors(0.8, 0.8, 0.8)
    metallic: float = 0.0
    roughness: float = 1.0
    specular: float = 0.0
    emissive: _Colors = _Colors(0.0, 0.0, 0.0)
    double_sided: bool = False
    name: str = "material"

    def __post_init__(self) -> None:
        self._numbers("metallic", "roughness", "specular")
        self._put("double_sided", bool(self.double_sided))


Rows = tuple[
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
    tuple[float, float, float, float],
]
IDENTITY: Rows = (
    (1.0, 0.0, 0.0, 0.0),
    (0.0, 1.0, 0.0, 0.0),
    (0.0, 0.0, 1.0, 0.0),
    (0.0, 0.0, 0.0, 1.0),
)


@dataclass(frozen=True)
class Instance(_Record):
    """A mesh in the world, with a material.

    ``mesh`` cannot be changed. ``material`` is the number of one of the scene's. ``world_from_local``
    has four rows, the last of them 0, 0, 0, 1. What is ``hidden`` is treated as absent; what is not
    ``voxelized`` is seen, but gives others no indirect light.
    """

    mesh: int = 0
    material: int = 0
    world_from_local: Rows = IDENTITY
    hidden: bool = False
    voxelized: bool = True
    name: str = "instance"

    def __post_init__(self) -> None:
        rows = floats("world_from_local", self.world_from_local, (4, 4)).tolist()
        self._put("world_from_local", tuple(map(tuple, rows)))
