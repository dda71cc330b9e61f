"""What differs between two scenes, and the cheapest work that shows it."""

from __future__ import annotations

from enum import IntEnum

from . import model


class Change(IntEnum):
    """The work that a change requires, the cheapest first."""

    NOTHING = 0
    #: Lights, surroundings and the places of instances.
    PLACES = 1
    #: Numbers of materials as well.
    MATERIALS = 2
    #: Other triangles, textures, or another list of instances: the scene is built again.
    SCENE = 3


#: The fields of a material that Lumivox changes without reading the scene again.
EDITABLE = ("name", "base_color", "metallic", "roughness", "specular", "emissive")


def between(old: model.Scene | None, new: model.Scene) -> Change:
    """The change from one scene to another."""
    if old is None or not _has_same_parts(old, new):
        return Change.SCENE
    change = Change.NOTHING
    moved = any(a.matrix != b.matrix for a, b in zip(old.instances, new.instances))
    if moved or old.lights != new.lights or old.world != new.world:
        change = Change.PLACES
    for before, after in zip(old.materials, new.materials):
        if before != after:
            if not is_editable(before, after):
                return Change.SCENE
            change = Change.MATERIALS
    for before, after in zip(old.instances, new.instances):
        if before.material != after.material:
            change = Change.MATERIALS
    return change


def is_editable(before: model.Material, after: model.Material) -> bool:
    """Whether two materials differ only in what Lumivox changes in place."""
    kept = {name: getattr(after, name) for name in EDITABLE}
    return _without_index(after) == _without_index(before, **kept)


def _without_index(material: model.Material, **changes: object) -> dict[str, object]:
    # A pass index shows only in the passes that Blender gets, which read the new scene.
    return {**vars(material), **changes, "index": 0}


def _has_same_parts(old: model.Scene, new: model.Scene) -> bool:
    if len(old.instances) != len(new.instances) or len(old.materials) != len(new.materials):
        return False
    if old.meshes != new.meshes:
        return False
    for before, after in zip(old.instances, new.instances):
        if (before.key, before.mesh) != (after.key, after.mesh):
            return False
        # Lumivox refuses to mirror what was not, since that turns surfaces inside out.
        if _is_mirrored(before.matrix) != _is_mirrored(after.matrix):
            return False
    return True


def _is_mirrored(matrix: model.Matrix) -> bool:
    (a, b, c, _), (d, e, f, _), (g, h, i, _) = matrix[:3]
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g) < 0.0
