"""The surroundings: a colour, or a panorama."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import model
from .images import linear_pixels
from .materials import source
from .notes import Notes


class Worlds:
    """Translates worlds, and keeps the last panorama."""

    def __init__(self) -> None:
        self._key: tuple[Any, ...] = ()
        self._panorama: np.ndarray | None = None
        self._digest = ""

    def forget(self) -> None:
        """Reads the panorama again when it is next asked for."""
        self._key = ()

    def of(self, world: Any, notes: Notes) -> model.World:
        if world is None:
            return model.World()
        if world.node_tree is None:
            return model.World(_color(np.array(world.color)))
        output = world.node_tree.get_output_node("CYCLES")
        linked = source(output.inputs["Surface"]) if output is not None else None
        if linked is None:
            return model.World()
        if source(output.inputs["Volume"]):
            notes.tell(world.name, "volumes are not supported")
        node = linked[0]
        if node.bl_idname != "ShaderNodeBackground":
            notes.tell(world.name, f"the node {node.name} is not supported; the world is black")
            return model.World()
        strength = node.inputs["Strength"].default_value
        if source(node.inputs["Strength"]):
            notes.tell(world.name, "the strength must be a number")
        linked = source(node.inputs["Color"])
        if linked is None:
            return model.World(_color(np.array(node.inputs["Color"].default_value) * strength))
        color = linked[0]
        if color.bl_idname == "ShaderNodeRGB":
            return model.World(_color(np.array(linked[1].default_value) * strength))
        if color.bl_idname == "ShaderNodeTexEnvironment":
            return self._panoramic(world, color, strength, notes)
        notes.tell(
            world.name,
            f"the node {color.name} is not supported as its colour (an equirectangular image is); the world is black",
        )
        return model.World()

    def _panoramic(self, world: Any, node: Any, strength: float, notes: Notes) -> model.World:
        if node.projection != "EQUIRECTANGULAR":
            notes.tell(world.name, "mirror balls are not supported; the world is black")
            return model.World()
        image = node.image
        if image is None:
            return model.World()
        key = (image.name_full, image.filepath, image.colorspace_settings.name)
        if key != self._key:
            pixels = linear_pixels(image)
            if pixels is None:
                notes.tell(
                    image.name,
                    f"{image.filepath or 'its file'} cannot be read; put the file there, or choose another; the world is black",
                )
                return model.World()
            # Blender has +x in the middle, Lumivox -z, which is Blender's +y.
            self._panorama = np.ascontiguousarray(np.maximum(pixels, 0.0))
            self._digest, self._key = model.digest(self._panorama), key
        turn = self._turn(world, node, notes) - 90.0
        factor = _color(np.full(3, strength))
        return model.World(factor, self._panorama, turn, self._digest)

    def _turn(self, world: Any, node: Any, notes: Notes) -> float:
        """The turn of the world about z, counter-clockwise seen from above, degrees."""
        linked = source(node.inputs["Vector"])
        if linked is None:
            return 0.0
        mapping = linked[0]
        if mapping.bl_idname != "ShaderNodeMapping":
            return 0.0
        turns = np.degrees(np.array(mapping.inputs["Rotation"].default_value))
        if turns[0] or turns[1] or tuple(mapping.inputs["Scale"].default_value) != (1.0, 1.0, 1.0):
            notes.tell(world.name, f"of the node {mapping.name} only the rotation about z has an effect")
        # The node turns the direction that is looked up, so that the picture turns back.
        turn = -float(turns[2])
        return -turn if mapping.vector_type == "TEXTURE" else turn


def _color(values: np.ndarray) -> model.Color:
    red, green, blue = (max(float(value), 0.0) for value in values[:3])
    return red, green, blue
