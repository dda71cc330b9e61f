"""A scene between Blender and Lumivox: plain values, which know neither of the two.

Values of one kind have a ``key`` that tells them from others, and two scenes are compared value by
value. Arrays are compared by their digest.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from hashlib import blake2b
from typing import Any

import numpy as np

Matrix = tuple[tuple[float, ...], ...]
Color = tuple[float, float, float]


def digest(*parts: bytes | np.ndarray | str | None) -> str:
    """A text that differs if any of the parts does."""
    total = blake2b(digest_size=16)
    for part in parts:
        if isinstance(part, np.ndarray):
            part = np.ascontiguousarray(part).data
        elif isinstance(part, str):
            part = part.encode()
        total.update(b"-" if part is None else part)
        total.update(b"|")
    return total.hexdigest()


@dataclass(frozen=True)
class UvMap:
    """Texture coordinates: a layer of a mesh (empty: that of renders), moved by a 2 x 3 matrix."""

    layer: str = ""
    transform: tuple[float, ...] = (1.0, 0.0, 0.0, 0.0, 1.0, 0.0)


@dataclass(frozen=True, eq=False)
class Image:
    """A picture in the bytes of a PNG or JPEG file."""

    key: str
    data: bytes

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Image) and self.key == other.key

    def __hash__(self) -> int:
        return hash(self.key)

    @property
    def mime(self) -> str:
        return "image/jpeg" if self.data[:2] == b"\xff\xd8" else "image/png"


@dataclass(frozen=True)
class Texture:
    """An image on a surface; ``extension`` is Blender's: REPEAT, EXTEND, MIRROR or CLIP."""

    image: Image
    uv: UvMap = UvMap()
    extension: str = "REPEAT"
    is_smooth: bool = True


@dataclass(frozen=True)
class Material:
    """A surface, with the terms of glTF; ``emissive`` is in W/(m2 sr)."""

    name: str = "material"
    base_color: Color = (0.8, 0.8, 0.8)
    alpha: float = 1.0
    metallic: float = 0.0
    roughness: float = 1.0
    specular: float = 0.0
    specular_color: Color = (1.0, 1.0, 1.0)
    ior: float = 1.5
    emissive: Color = (0.0, 0.0, 0.0)
    transmission: float = 0.0
    coat: float = 0.0
    coat_roughness: float = 0.0
    sheen_color: Color = (0.0, 0.0, 0.0)
    sheen_roughness: float = 0.0
    normal_scale: float = 1.0
    is_blended: bool = False
    is_double_sided: bool = True
    #: The name of the colour attribute that multiplies the base colour.
    color_attribute: str | None = None
    #: By slot: base_color, metallic_roughness, emissive, normal, transmission, coat.
    textures: Mapping[str, Texture] = field(default_factory=dict)
    #: Blender's pass index.
    index: int = 0

    def uv_maps(self) -> list[UvMap]:
        """The sets of texture coordinates that its textures need."""
        return list(dict.fromkeys(texture.uv for texture in self.textures.values()))


@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of one material in their own space; ``uvs`` has an array for each of its sets."""

    key: str
    positions: np.ndarray
    indices: np.ndarray
    normals: np.ndarray
    uvs: tuple[np.ndarray, ...] = ()
    colors: np.ndarray | None = None
    digest: str = ""

    @staticmethod
    def of(
        key: str,
        positions: np.ndarray,
        indices: np.ndarray,
        normals: np.ndarray,
        uvs: tuple[np.ndarray, ...] = (),
        colors: np.ndarray | None = None,
    ) -> Mesh:
        known = digest(positions, indices, normals, *uvs, colors)
        return Mesh(key, positions, indices, normals, uvs, colors, known)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Mesh) and (self.key, self.digest) == (other.key, other.digest)


@dataclass(frozen=True)
class Instance:
    """A mesh in Lumivox's world with a material, by their numbers."""

    name: str
    mesh: int
    material: int
    matrix: Matrix
    #: Tells instances of one object apart, over frames.
    key: tuple[Any, ...] = ()
    #: Blender's pass index of the object.
    index: int = 0


@dataclass(frozen=True, eq=False)
class World:
    """The surroundings: radiance in W/(m2 sr), or the factor of a panorama's texels (H, W, 3)."""

    radiance: Color = (0.0, 0.0, 0.0)
    panorama: np.ndarray | None = None
    rotation_deg: float = 0.0
    key: str = ""

    def __eq__(self, other: object) -> bool:
        if not isinstance(other, World):
            return False
        return (self.radiance, self.rotation_deg, self.key) == (
            other.radiance,
            other.rotation_deg,
            other.key,
        )


@dataclass(frozen=True)
class Scene:
    """All that light depends on."""

    name: str = "scene"
    meshes: tuple[Mesh, ...] = ()
    materials: tuple[Material, ...] = ()
    instances: tuple[Instance, ...] = ()
    #: The fields of Lumivox's lights, in Lumivox's world and units.
    lights: tuple[Mapping[str, Any], ...] = ()
    world: World = field(default_factory=World)
    #: Sentences on what was left out or replaced, without repetition.
    notes: tuple[str, ...] = ()
