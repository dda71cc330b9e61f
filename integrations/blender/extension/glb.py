"""Writes meshes, materials and instances as binary glTF 2.0, which Lumivox reads.

Lights, surroundings and cameras are set in Lumivox itself.
"""

from __future__ import annotations

import json
import struct
from typing import Any

import numpy as np

from . import model
from .units import nits

_FLOAT, _UINT = 5126, 5125
_ARRAYS, _INDICES = 34962, 34963
_LINEAR, _NEAREST, _LINEAR_MIPS = 9729, 9728, 9987
_WRAPS = {"REPEAT": 10497, "EXTEND": 33071, "CLIP": 33071, "MIRROR": 33648}
#: The most bytes of a file: lengths in GLB have 32 bits.
_MOST = (1 << 32) - 1


class TooLarge(ValueError):
    """The scene does not fit into a GLB file."""


class _Writer:
    def __init__(self) -> None:
        self.document: dict[str, Any] = {
            "asset": {"version": "2.0", "generator": "Lumivox for Blender"},
            "scene": 0,
        }
        self.parts: list[bytes] = []
        self.length = 0
        self.extensions: set[str] = set()
        self.images: dict[str, int] = {}
        self.textures: dict[tuple[Any, ...], int] = {}
        self.accessors: dict[int, int] = {}

    def push(self, kind: str, value: Any) -> int:
        known = self.document.setdefault(kind, [])
        known.append(value)
        return len(known) - 1

    def view(self, data: bytes, target: int | None = None) -> int:
        view: dict[str, Any] = {"buffer": 0, "byteOffset": self.length, "byteLength": len(data)}
        if target is not None:
            view["target"] = target
        padding = -len(data) % 4
        self.parts += [data, bytes(padding)]
        self.length += len(data) + padding
        if self.length > _MOST - (64 << 20):
            raise TooLarge(
                "the scene has more than 4 GB of meshes and images: hide some of it, or use instances of one mesh"
            )
        return self.push("bufferViews", view)

    def accessor(self, array: np.ndarray) -> int:
        """The accessor of an array, which several meshes may share."""
        if id(array) in self.accessors:
            return self.accessors[id(array)]
        is_index = array.dtype == np.uint32
        accessor = {
            "bufferView": self.view(
                np.ascontiguousarray(array).tobytes(), _INDICES if is_index else _ARRAYS
            ),
            "componentType": _UINT if is_index else _FLOAT,
            "count": array.size if is_index else len(array),
            "type": "SCALAR" if is_index else f"VEC{array.shape[1]}",
        }
        if not is_index and array.shape[1] == 3:
            accessor["min"] = array.min(axis=0).tolist()
            accessor["max"] = array.max(axis=0).tolist()
        number = self.push("accessors", accessor)
        self.accessors[id(array)] = number
        return number

    def texture(self, texture: model.Texture, uv_maps: list[model.UvMap]) -> dict[str, Any]:
        image = texture.image
        if image.key not in self.images:
            entry = {"bufferView": self.view(image.data), "mimeType": image.mime}
            self.images[image.key] = self.push("images", entry)
        key = (image.key, texture.extension, texture.is_smooth)
        if key not in self.textures:
            wrap = _WRAPS.get(texture.extension, _WRAPS["REPEAT"])
            sampler = {
                "wrapS": wrap,
                "wrapT": wrap,
                "magFilter": _LINEAR if texture.is_smooth else _NEAREST,
                "minFilter": _LINEAR_MIPS if texture.is_smooth else _NEAREST,
            }
            entry = {"source": self.images[image.key], "sampler": self.push("samplers", sampler)}
            self.textures[key] = self.push("textures", entry)
        return {"index": self.textures[key], "texCoord": uv_maps.index(texture.uv)}

    def material(self, material: model.Material) -> int:
        uv_maps = material.uv_maps()
        textures = {
            slot: self.texture(texture, uv_maps) for slot, texture in material.textures.items()
        }
        surface: dict[str, Any] = {
            "baseColorFactor": [*material.base_color, material.alpha],
            "metallicFactor": material.metallic,
            "roughnessFactor": material.roughness,
        }
        json_material: dict[str, Any] = {
            "name": material.name,
            "pbrMetallicRoughness": surface,
            "doubleSided": material.is_double_sided,
        }
        if material.is_blended:
            json_material["alphaMode"] = "BLEND"
        if "base_color" in textures:
            surface["baseColorTexture"] = textures["base_color"]
        if "metallic_roughness" in textures:
            surface["metallicRoughnessTexture"] = textures["metallic_roughness"]
        if "normal" in textures:
            scale = material.normal_scale
            json_material["normalTexture"] = {**textures["normal"], "scale": scale}
        if "emissive" in textures:
            json_material["emissiveTexture"] = textures["emissive"]
        extensions: dict[str, Any] = {
            "KHR_materials_specular": {
                "specularFactor": material.specular,
                "specularColorFactor": list(material.specular_color),
            },
            "KHR_materials_ior": {"ior": material.ior},
        }
        emitted = [nits(channel) for channel in material.emissive]
        if strongest := max(emitted):
            # A factor of at most 1, and a strength for the rest.
            json_material["emissiveFactor"] = [channel / strongest for channel in emitted]
            extensions["KHR_materials_emissive_strength"] = {"emissiveStrength": strongest}
        if material.coat:
            extensions["KHR_materials_clearcoat"] = {
                "clearcoatFactor": material.coat,
                "clearcoatRoughnessFactor": material.coat_roughness,
            }
        if any(material.sheen_color):
            extensions["KHR_materials_sheen"] = {
                "sheenColorFactor": list(material.sheen_color),
                "sheenRoughnessFactor": material.sheen_roughness,
            }
        if material.transmission:
            transmission: dict[str, Any] = {"transmissionFactor": material.transmission}
            if "transmission" in textures:
                transmission["transmissionTexture"] = textures["transmission"]
            extensions["KHR_materials_transmission"] = transmission
        self.extensions |= extensions.keys()
        json_material["extensions"] = extensions
        return self.push("materials", json_material)

    def finish(self) -> bytes:
        if self.extensions:
            self.document["extensionsUsed"] = sorted(self.extensions)
        if self.length:
            self.document["buffers"] = [{"byteLength": self.length}]
        text = json.dumps(self.document, separators=(",", ":"), allow_nan=False).encode()
        text += b" " * (-len(text) % 4)
        whole = 12 + 8 + len(text) + 8 + self.length
        return b"".join(
            (
                struct.pack("<4sII", b"glTF", 2, whole),
                struct.pack("<I4s", len(text), b"JSON"),
                text,
                struct.pack("<I4s", self.length, b"BIN\0"),
                *self.parts,
            )
        )


def write(scene: model.Scene) -> bytes:
    """The bytes of a GLB file in which instances and materials have their numbers of ``scene``."""
    writer = _Writer()
    for material in scene.materials:
        writer.material(material)
    meshes: dict[tuple[int, int], int] = {}
    nodes = []
    for instance in scene.instances:
        pair = (instance.mesh, instance.material)
        if pair not in meshes:
            mesh = scene.meshes[instance.mesh]
            attributes = {
                "POSITION": writer.accessor(mesh.positions),
                "NORMAL": writer.accessor(mesh.normals),
            }
            for number, uvs in enumerate(mesh.uvs):
                attributes[f"TEXCOORD_{number}"] = writer.accessor(uvs)
            if mesh.colors is not None:
                attributes["COLOR_0"] = writer.accessor(mesh.colors)
            primitive = {
                "attributes": attributes,
                "indices": writer.accessor(mesh.indices),
                "material": instance.material,
            }
            meshes[pair] = writer.push("meshes", {"name": mesh.key, "primitives": [primitive]})
        columns = np.array(instance.matrix).T.flatten().tolist()
        node = {"name": instance.name, "mesh": meshes[pair], "matrix": columns}
        nodes.append(writer.push("nodes", node))
    writer.push("scenes", {"name": scene.name, "nodes": nodes} if nodes else {"name": scene.name})
    return writer.finish()
