"""The whole evaluated scene."""

from __future__ import annotations

from typing import Any

import numpy as np

from .. import model
from ..units import place
from . import lights, meshes
from .images import Images
from .materials import Surfaces
from .notes import Notes
from .world import Worlds

_WITH_TRIANGLES = ("MESH", "CURVE", "SURFACE", "META", "FONT")
_WITHOUT = ("VOLUME", "POINTCLOUD", "CURVES", "GREASEPENCIL")


class Reader:
    """Reads a depsgraph, again and again: what has not changed since is kept.

    Without :meth:`forget` in between, the meshes and images of the last reading are used again.
    """

    def __init__(self) -> None:
        self._images = Images()
        self._worlds = Worlds()
        self._meshes: dict[str, tuple[list[tuple[int, model.Mesh]], Notes]] = {}

    def forget_all(self) -> None:
        """Reads everything again: for another frame or another file."""
        self._meshes.clear()

    def take_updates(self, depsgraph: Any) -> None:
        """Forgets what Blender says has changed."""
        import bpy

        for update in depsgraph.updates:
            changed = update.id
            if isinstance(changed, bpy.types.Image):
                self._images.forget(changed)
                self._worlds.forget()
            elif update.is_updated_geometry:
                if _has_nodes(changed):
                    # They may make meshes with names of their own.
                    self.forget_all()
                self._forget_mesh(changed)

    def _forget_mesh(self, changed: Any) -> None:
        name = changed.name_full
        for key in [key for key in self._meshes if name in key.split("\n")[:2]]:
            del self._meshes[key]

    def read(self, depsgraph: Any) -> model.Scene:
        """The scene of an evaluated depsgraph."""
        notes = Notes()
        scene = depsgraph.scene_eval
        surfaces = Surfaces(self._images, notes)
        materials: list[model.Material] = []
        number_of_material: dict[Any, int] = {}
        translated: dict[str, model.Material] = {}
        found_meshes: list[model.Mesh] = []
        number_of_mesh: dict[int, int] = {}
        instances: list[model.Instance] = []
        lamps: list[dict[str, Any]] = []
        used: set[str] = set()

        def put(mesh: model.Mesh) -> int:
            if id(mesh) not in number_of_mesh:
                number_of_mesh[id(mesh)] = len(found_meshes)
                found_meshes.append(mesh)
            return number_of_mesh[id(mesh)]

        def surface(material: Any) -> model.Material:
            name = material.name_full if material is not None else ""
            if name not in translated:
                translated[name] = surfaces.of(material)
            return translated[name]

        for item in depsgraph.object_instances:
            if not item.show_self:
                continue
            thing = item.object
            matrix = np.array(item.matrix_world)
            key = key_of(item)
            if thing.type == "LIGHT":
                if thing.data.type != "AREA":
                    lamp = lights.lamp(thing.name, thing.data, matrix, notes)
                    if lamp is not None:
                        lamps.append(lamp)
                    continue
                shown = lights.area(thing.name, thing.data, matrix, notes)
                if shown is None or not _is_invertible(shown[2]):
                    continue
                mesh, material, shape = shown
                number_of_material[key] = len(materials)
                materials.append(material)
                instances.append(
                    model.Instance(
                        thing.name, put(mesh), number_of_material[key], shape, key, thing.pass_index
                    )
                )
                if thing.visible_camera is False:
                    notes.tell(thing.name, "area lights are seen by the camera, from their front")
                continue
            if thing.is_holdout or thing.is_shadow_catcher:
                notes.tell(thing.name, "holdouts and shadow catchers are shown like other objects")
            if thing.type in _WITHOUT:
                notes.tell(thing.name, f"objects of the type {thing.type} are not supported")
            if thing.type not in _WITH_TRIANGLES or not thing.visible_camera:
                if thing.type in _WITH_TRIANGLES:
                    notes.tell(thing.name, "what the camera does not see is left out altogether")
                continue
            slots = [slot.material for slot in thing.material_slots] or [None]
            looks = [surface(material) for material in slots]
            shape = tuple(map(tuple, place(matrix).tolist()))
            if not _is_invertible(shape):
                continue
            for slot, mesh in self._parts(thing, looks, notes, used):
                name = slots[slot].name_full if slots[slot] is not None else ""
                if name not in number_of_material:
                    number_of_material[name] = len(materials)
                    materials.append(looks[slot])
                instances.append(
                    model.Instance(
                        thing.name,
                        put(mesh),
                        number_of_material[name],
                        shape,
                        (*key, slot),
                        thing.pass_index,
                    )
                )
        for known in self._meshes.keys() - used:
            del self._meshes[known]
        return model.Scene(
            name=scene.name,
            meshes=tuple(found_meshes),
            materials=tuple(materials),
            instances=tuple(instances),
            lights=tuple(lamps),
            world=self._worlds.of(scene.world, notes),
            notes=notes.all(),
        )

    def _parts(
        self, thing: Any, looks: list[model.Material], notes: Notes, used: set[str]
    ) -> list[tuple[int, model.Mesh]]:
        """The triangles of an evaluated object, shared by objects with the same mesh."""
        data = thing.data
        # Objects without modifiers share the mesh of their data.
        owner = thing.name_full if thing.modifiers or thing.type != "MESH" else ""
        needs = [(look.uv_maps(), look.color_attribute) for look in looks]
        key = f"{data.name_full}\n{owner}\n{data.as_pointer()}\n{needs}"
        used.add(key)
        if key not in self._meshes:
            mesh, told = thing.to_mesh(), Notes()
            try:
                name = f"{data.name_full} of {owner}" if owner else data.name_full
                found = meshes.parts(name, mesh, looks, told) if mesh else []
            finally:
                thing.to_mesh_clear()
            self._meshes[key] = found, told
        found, told = self._meshes[key]
        notes.take(told)
        return found


def _has_nodes(changed: Any) -> bool:
    modifiers = getattr(changed, "modifiers", ())
    return any(modifier.type == "NODES" for modifier in modifiers)


def key_of(item: Any) -> tuple[Any, ...]:
    """What tells an instance of a depsgraph from others, in all frames."""
    if not item.is_instance:
        return (item.object.name_full,)
    return (item.object.name_full, item.parent.name_full, *item.persistent_id)


def _is_invertible(matrix: model.Matrix) -> bool:
    return abs(np.linalg.det(np.array(matrix)[:3, :3])) > 1e-12
