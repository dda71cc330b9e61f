"""Surfaces: the nodes of Blender's materials in the terms of glTF."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .. import model
from .images import Images
from .notes import Notes

#: Blender shows what has no material as diffuse grey.
NONE = model.Material("no material")
#: Nodes that a surface may end in.
KNOWN = "Principled, Diffuse, Glossy, Glass, Emission, and a mix of one with Transparent"
#: The inputs of the Principled BSDF that have no effect here, with the values that mean none.
_WITHOUT_EFFECT = {
    "Diffuse Roughness": 0.0,
    "Subsurface Weight": 0.0,
    "Anisotropic": 0.0,
    "Thin Film Thickness": 0.0,
}
_CHANNELS = {"Red": 0, "Green": 1, "Blue": 2, "Alpha": 3}


@dataclass
class _Color:
    """A colour as a product of a constant, an image and a colour attribute."""

    factor: np.ndarray
    node: Any = None
    attribute: str | None = None


class Surfaces:
    """Translates materials; ``images`` keeps their images."""

    def __init__(self, images: Images, notes: Notes) -> None:
        self._images, self._notes = images, notes

    def of(self, material: Any) -> model.Material:
        """The surface of an evaluated material, or of none."""
        if material is None:
            return NONE
        known = {
            "name": material.name,
            "is_double_sided": not material.use_backface_culling,
            "index": material.pass_index,
        }
        tree = material.node_tree
        output = tree.get_output_node("CYCLES") if tree is not None else None
        if output is None:
            color = tuple(material.diffuse_color)[:3] if tree is None else (0.0, 0.0, 0.0)
            return model.Material(**known, base_color=color)
        if source(output.inputs["Displacement"]):
            self._notes.tell(material.name, "displacement by nodes is not supported")
        if source(output.inputs["Volume"]):
            self._notes.tell(material.name, "volumes are not supported")
        shader = source(output.inputs["Surface"])
        if shader is None:
            return model.Material(**known, base_color=(0.0, 0.0, 0.0))
        return self._surface(_Surface(material.name, self._images, self._notes), shader[0], known)

    def _surface(self, surface: _Surface, node: Any, known: dict[str, Any]) -> model.Material:
        kind = node.bl_idname
        if kind == "ShaderNodeMixShader":
            return self._mix(surface, node, known)
        translate = {
            "ShaderNodeBsdfPrincipled": surface.principled,
            "ShaderNodeBsdfDiffuse": surface.diffuse,
            "ShaderNodeBsdfAnisotropic": surface.glossy,
            "ShaderNodeBsdfGlossy": surface.glossy,
            "ShaderNodeBsdfGlass": surface.glass,
            "ShaderNodeEmission": surface.emission,
        }.get(kind)
        if translate is None:
            surface.tell(f"the node {node.name} is not supported as a surface ({KNOWN} are)")
            return model.Material(**known)
        translate(node)
        return model.Material(**known, **surface.fields, textures=surface.textures)

    def _mix(self, surface: _Surface, node: Any, known: dict[str, Any]) -> model.Material:
        shaders = [source(node.inputs[number]) for number in (1, 2)]
        clear = [
            linked is not None and linked[0].bl_idname == "ShaderNodeBsdfTransparent"
            for linked in shaders
        ]
        other = shaders[0] if clear[1] else shaders[1]
        if sum(clear) != 1 or other is None:
            surface.tell(f"the node {node.name} is not supported as a surface ({KNOWN} are)")
            return model.Material(**known)
        solid = self._surface(surface, other[0], known)
        factor = source(node.inputs[0])
        if factor is not None:
            surface.tell(
                "a mix with Transparent by an image or other nodes is not supported; link its Alpha to a Principled BSDF"
            )
            return solid
        share = float(node.inputs[0].default_value)
        covered = share if clear[0] else 1.0 - share
        return model.Material(**{**vars(solid), "alpha": covered, "is_blended": covered < 1.0})


class _Surface:
    """The fields of one material while they are found."""

    def __init__(self, name: str, images: Images, notes: Notes) -> None:
        self._name, self._images, self._notes = name, images, notes
        self.fields: dict[str, Any] = {}
        self.textures: dict[str, model.Texture] = {}

    def tell(self, sentence: str) -> None:
        self._notes.tell(self._name, sentence)

    def principled(self, node: Any) -> None:
        inputs = node.inputs
        for name, nothing in _WITHOUT_EFFECT.items():
            if source(inputs[name]) or inputs[name].default_value != nothing:
                self.tell(f'the input "{name}" has no effect')
        level = self._number(inputs["Specular IOR Level"])
        tint = self._constant(inputs["Specular Tint"])
        sheen = self._number(inputs["Sheen Weight"])
        self._base_color(inputs["Base Color"])
        self._rough_and_metal(inputs["Roughness"], inputs["Metallic"])
        self._alpha(inputs["Alpha"])
        self._normal(inputs["Normal"])
        self._emission(inputs["Emission Color"], inputs["Emission Strength"])
        # At a level of 0.5 only the index of refraction decides; glTF's factor is at most 1, so
        # that more goes to the colour.
        scale = 2.0 * max(level, 0.0)
        self.fields |= {
            "specular": min(scale, 1.0),
            "specular_color": _color(tint * max(scale, 1.0)),
            "ior": max(self._number(inputs["IOR"]), 1.0),
            "transmission": _share(self._number(inputs["Transmission Weight"])),
            "coat": _share(self._number(inputs["Coat Weight"])),
            "coat_roughness": _share(self._number(inputs["Coat Roughness"])),
            "sheen_color": _color(np.clip(sheen * self._constant(inputs["Sheen Tint"]), 0.0, 1.0)),
            "sheen_roughness": _share(self._number(inputs["Sheen Roughness"])) if sheen else 0.0,
        }

    def diffuse(self, node: Any) -> None:
        if source(node.inputs["Roughness"]) or node.inputs["Roughness"].default_value:
            self.tell("the roughness of the Diffuse BSDF has no effect")
        self._base_color(node.inputs["Color"])
        self._normal(node.inputs["Normal"])

    def glossy(self, node: Any) -> None:
        self._base_color(node.inputs["Color"])
        self._rough_and_metal(node.inputs["Roughness"], None)
        self._normal(node.inputs["Normal"])
        self.fields["metallic"] = 1.0

    def glass(self, node: Any) -> None:
        self._base_color(node.inputs["Color"])
        self._rough_and_metal(node.inputs["Roughness"], None)
        self._normal(node.inputs["Normal"])
        ior = max(self._number(node.inputs["IOR"]), 1.0)
        self.fields |= {"transmission": 1.0, "specular": 1.0, "ior": ior}

    def emission(self, node: Any) -> None:
        self.fields["base_color"] = (0.0, 0.0, 0.0)
        self._emission(node.inputs["Color"], node.inputs["Strength"])

    # --- inputs ---

    def _base_color(self, socket: Any) -> None:
        color = self._product(socket)
        self.fields["base_color"] = _color(np.clip(color.factor, 0.0, 1.0))
        self.fields["color_attribute"] = color.attribute
        self._image("base_color", color.node, self._images.color)

    def _emission(self, color_socket: Any, strength_socket: Any) -> None:
        strength = self._number(strength_socket)
        if strength == 0.0:
            return
        color = self._product(color_socket)
        if color.attribute is not None:
            self.tell("a colour attribute has no effect on emission")
        self.fields["emissive"] = _color(np.maximum(color.factor * strength, 0.0))
        self._image("emissive", color.node, self._images.color)

    def _rough_and_metal(self, rough_socket: Any, metal_socket: Any | None) -> None:
        found = {}
        for field, socket in (("roughness", rough_socket), ("metallic", metal_socket)):
            if socket is None:
                continue
            node, channel = self._channel(socket)
            self.fields[field] = 1.0 if node else _share(self._number(socket))
            if node:
                found[field] = (node, channel)
        if not found:
            return
        uvs = {self._uv(node) for node, _ in found.values()}
        if len(uvs) > 1:
            self.tell("images of roughness and metallic need the same texture coordinates; metallic's has no effect")
            found.pop("metallic")
            self.fields["metallic"] = 0.0
        sources = [
            (found[field][0].image, found[field][1]) if field in found else None
            for field in ("roughness", "metallic")
        ]
        node = next(iter(found.values()))[0]
        image = self._images.packed(sources[0], sources[1], self._notes)
        self._put("metallic_roughness", node, image)
        if image is None:
            self.fields |= {field: _share(_default(socket)) for field, socket in (
                ("roughness", rough_socket), ("metallic", metal_socket)) if field in found}

    def _alpha(self, socket: Any) -> None:
        linked = source(socket)
        if linked is None:
            alpha = _share(_default(socket))
            self.fields |= {"alpha": alpha, "is_blended": alpha < 1.0}
            return
        node, output = linked
        base = self.textures.get("base_color")
        if node.bl_idname == "ShaderNodeTexImage" and output.name == "Alpha" and base is not None:
            if node.image is not None and self._images.color(node.image, self._notes) == base.image:
                self.fields["is_blended"] = True
                return
        self.tell("the alpha of an image other than the base colour's has no effect")

    def _normal(self, socket: Any) -> None:
        linked = source(socket)
        if linked is None:
            return
        node, _ = linked
        color = source(node.inputs["Color"]) if node.bl_idname == "ShaderNodeNormalMap" else None
        if color is None or color[0].bl_idname != "ShaderNodeTexImage" or node.space != "TANGENT":
            self.tell(f"the node {node.name} has no effect on normals (an image with Normal Map in tangent space has)")
            return
        self.fields["normal_scale"] = self._number(node.inputs["Strength"])
        self._image("normal", color[0], self._images.data)

    # --- values ---

    def _number(self, socket: Any) -> float:
        linked = source(socket)
        if linked is not None:
            if linked[0].bl_idname == "ShaderNodeValue":
                return float(linked[1].default_value)
            self._unsupported(socket, linked[0])
        return _default(socket)

    def _constant(self, socket: Any) -> np.ndarray:
        linked = source(socket)
        if linked is not None:
            if linked[0].bl_idname == "ShaderNodeRGB":
                return np.array(linked[1].default_value)[:3]
            self._unsupported(socket, linked[0])
        return np.array(socket.default_value)[:3]

    def _product(self, socket: Any) -> _Color:
        linked = source(socket)
        if linked is None:
            return _Color(np.array(socket.default_value)[:3])
        node, output = linked
        kind = node.bl_idname
        if kind == "ShaderNodeRGB":
            return _Color(np.array(output.default_value)[:3])
        if kind == "ShaderNodeTexImage" and output.name == "Color":
            return _Color(np.ones(3), node=node)
        if kind == "ShaderNodeVertexColor":
            return _Color(np.ones(3), attribute=node.layer_name)
        if kind == "ShaderNodeAttribute" and node.attribute_type == "GEOMETRY":
            return _Color(np.ones(3), attribute=node.attribute_name)
        factors = _multiplied(node)
        if factors is not None:
            a, b = (self._product(factor) for factor in factors)
            if (a.node is None or b.node is None) and None in (a.attribute, b.attribute):
                attribute = b.attribute if a.attribute is None else a.attribute
                return _Color(a.factor * b.factor, a.node or b.node, attribute)
        self._unsupported(socket, node)
        return _Color(np.array(socket.default_value)[:3])

    def _channel(self, socket: Any) -> tuple[Any, int]:
        """The image of a number, and its channel; ``None`` if there is none."""
        linked = source(socket)
        if linked is None:
            return None, 0
        node, output = linked
        channel = 0
        if node.bl_idname == "ShaderNodeSeparateColor" and node.mode == "RGB":
            channel = _CHANNELS[output.name]
            linked = source(node.inputs[0])
            node = linked[0] if linked else node
        elif output.name == "Alpha":
            channel = 3
        if node.bl_idname != "ShaderNodeTexImage" or node.image is None:
            if node.bl_idname != "ShaderNodeValue":
                self._unsupported(socket, node)
            return None, 0
        return node, channel

    def _unsupported(self, socket: Any, node: Any) -> None:
        self.tell(f'the node {node.name} at "{socket.name}" is not supported; the value of the input is used')

    # --- textures ---

    def _image(self, slot: str, node: Any, read: Any) -> None:
        if node is None:
            return
        if node.image is None:
            self.tell(f"the node {node.name} has no image")
            return
        image = read(node.image, self._notes)
        if image is None and slot == "base_color":
            # As Blender shows missing images.
            self.fields["base_color"] = (1.0, 0.0, 1.0)
        self._put(slot, node, image)

    def _put(self, slot: str, node: Any, image: model.Image | None) -> None:
        if image is None:
            return
        uv = self._uv(node)
        used = {texture.uv for texture in self.textures.values()}
        if uv not in used and len(used) == 2:
            self.tell(f"a third set of texture coordinates is not supported; the node {node.name} has no effect")
            return
        if node.projection != "FLAT":
            self.tell(f"the projection of the node {node.name} is not supported; it is flat")
        if node.extension == "CLIP":
            self.tell(f"the extension Clip of the node {node.name} is not supported; it is Extend")
        smooth = node.interpolation != "Closest"
        self.textures[slot] = model.Texture(image, uv, node.extension, smooth)

    def _uv(self, node: Any) -> model.UvMap:
        """The texture coordinates of an image."""
        linked = source(node.inputs["Vector"])
        transform = np.eye(3)
        while linked is not None and linked[0].bl_idname == "ShaderNodeMapping":
            mapping = linked[0]
            transform = transform @ self._mapping(mapping)
            linked = source(mapping.inputs["Vector"])
        layer = ""
        if linked is not None:
            kind, output = linked[0].bl_idname, linked[1].name
            if kind == "ShaderNodeUVMap":
                layer = linked[0].uv_map
            elif kind != "ShaderNodeTexCoord" or output != "UV":
                self.tell(f"{node.name} is shown with UV coordinates; others are not supported")
        return model.UvMap(layer, tuple(transform[:2].flatten().tolist()))

    def _mapping(self, node: Any) -> np.ndarray:
        inputs = node.inputs
        sizes = np.array(inputs["Scale"].default_value)
        turns = np.array(inputs["Rotation"].default_value)
        place = np.zeros(3)
        if node.vector_type in ("POINT", "TEXTURE"):
            place = np.array(inputs["Location"].default_value)
        is_linked = any(source(inputs[name]) for name in ("Scale", "Rotation"))
        if is_linked or turns[0] or turns[1] or node.vector_type == "NORMAL":
            self.tell(f"the node {node.name} has only its constant scale, location and rotation about z")
        cosine, sine = np.cos(turns[2]), np.sin(turns[2])
        rotation = np.array(((cosine, -sine, 0.0), (sine, cosine, 0.0), (0.0, 0.0, 1.0)))
        scale = np.diag((sizes[0], sizes[1], 1.0))
        move = np.eye(3)
        move[:2, 2] = place[:2]
        whole = move @ rotation @ scale
        if node.vector_type == "TEXTURE":
            return np.linalg.inv(whole) if abs(np.linalg.det(whole)) > 1e-12 else np.eye(3)
        return whole


def source(socket: Any) -> tuple[Any, Any] | None:
    """The node and the output that a socket is linked to, through reroutes and muted nodes;
    ``None`` behind a muted link."""
    seen = 0
    while socket.is_linked and seen < 64:
        link = socket.links[0]
        if link.is_muted or not link.is_valid:
            return None
        node, output = link.from_node, link.from_socket
        if node.bl_idname == "NodeReroute":
            socket = node.inputs[0]
        elif node.mute:
            passed = [inner.from_socket for inner in node.internal_links if output == inner.to_socket]
            if not passed:
                return None
            socket = passed[0]
        else:
            return node, output
        seen += 1
    return None


def _multiplied(node: Any) -> tuple[Any, Any] | None:
    """The two colours that a node multiplies."""
    if node.bl_idname != "ShaderNodeMix" or node.data_type != "RGBA":
        return None
    factor = node.inputs["Factor"]
    if node.blend_type != "MULTIPLY" or source(factor) or factor.default_value != 1.0:
        return None
    first, second = (socket for socket in node.inputs if socket.type == "RGBA")
    return first, second


def _default(socket: Any) -> float:
    return float(socket.default_value)


def _share(value: float) -> float:
    return min(max(value, 0.0), 1.0)


def _color(values: np.ndarray) -> model.Color:
    red, green, blue = (float(value) for value in values)
    return red, green, blue
