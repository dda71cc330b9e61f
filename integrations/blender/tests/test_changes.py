"""Edits arrive with the least work, and the picture is that of a new session."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import bpy
import numpy as np
import pytest

import scenes
from conftest import SMALL, read
from extension import changes
from extension.changes import Change
from extension.session import Session
from extension.translate import Reader


def nothing() -> None:
    pass


def camera() -> None:
    bpy.context.scene.camera.location.x += 0.5


def lamp() -> None:
    bpy.data.objects["lamp"].data.energy *= 2.0


def moved_lamp() -> None:
    bpy.data.objects["lamp"].location.x -= 1.0


def world() -> None:
    bpy.context.scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 3.0


def place() -> None:
    bpy.data.objects["box"].location.x += 0.3


def surface() -> None:
    inputs = scenes._principled(bpy.data.materials["red"]).inputs
    inputs["Base Color"].default_value = (0.1, 0.6, 0.1, 1.0)
    inputs["Roughness"].default_value = 0.3


def glow() -> None:
    inputs = scenes._principled(bpy.data.materials["red"]).inputs
    inputs["Emission Strength"].default_value = 0.5


def coat() -> None:
    scenes._principled(bpy.data.materials["red"]).inputs["Coat Weight"].default_value = 1.0


def shape() -> None:
    bpy.data.objects["box"].data.vertices[7].co.z += 0.4


def modifier() -> None:
    bpy.data.objects["box"].modifiers.new("bevel", "BEVEL").width = 0.1


def added() -> None:
    scenes._box("another", (1.2, 0, 0.3), (0.5, 0.5, 0.5), bpy.data.materials["red"])


def deleted() -> None:
    bpy.data.objects.remove(bpy.data.objects["box"])


def hidden() -> None:
    bpy.data.objects["box"].hide_render = bpy.data.objects["box"].hide_viewport = True


def mirrored() -> None:
    bpy.data.objects["box"].scale.x = -1.0


EDITS = {
    nothing: Change.NOTHING,
    camera: Change.NOTHING,
    lamp: Change.PLACES,
    moved_lamp: Change.PLACES,
    world: Change.PLACES,
    place: Change.PLACES,
    surface: Change.MATERIALS,
    glow: Change.MATERIALS,
    coat: Change.SCENE,
    shape: Change.SCENE,
    modifier: Change.SCENE,
    added: Change.SCENE,
    deleted: Change.SCENE,
    hidden: Change.SCENE,
    mirrored: Change.SCENE,
}


@pytest.mark.parametrize("edit", EDITS, ids=lambda edit: edit.__name__)
def test_an_edit_costs_no_more_than_it_must(box: Any, edit: Callable[[], None]) -> None:
    before, _ = read()
    edit()
    bpy.context.view_layer.update()
    after, _ = read()
    assert changes.between(before, after) == EDITS[edit]
    assert changes.between(None, after) == Change.SCENE


def test_pictures_after_edits_are_those_of_a_new_session(box: Any) -> None:
    session, reader = Session(), Reader()
    data, view = read(reader)
    session.show(data, view, SMALL)
    pictures = [session.picture(view).radiance]
    renderer = session.renderer
    for edit in (camera, lamp, world, place, surface, glow):
        edit()
        depsgraph = bpy.context.evaluated_depsgraph_get()
        reader.take_updates(depsgraph)
        data, view = read(reader)
        assert session.show(data, view, SMALL) < Change.SCENE, edit.__name__
        assert session.renderer is renderer
        pictures.append(session.picture(view).radiance)
        assert not np.array_equal(pictures[-1], pictures[-2]), edit.__name__
    fresh = Session()
    fresh.show(read()[0], view, SMALL)
    np.testing.assert_array_equal(pictures[-1], fresh.picture(view).radiance)


def test_what_leaves_the_voxels_gets_larger_ones(box: Any) -> None:
    session = Session()
    data, view = read()
    session.show(data, view, SMALL)
    size = session.renderer.voxel_size_m
    bpy.data.objects["box"].location.x += 6.0
    bpy.context.view_layer.update()
    data, view = read()
    assert session.show(data, view, SMALL) == Change.SCENE
    assert session.renderer.voxel_size_m > 1.5 * size
    # Smaller ones again when it has come back.
    bpy.data.objects["box"].location.x -= 6.0
    bpy.data.objects["floor"].scale = (0.4, 0.4, 0.4)
    bpy.context.view_layer.update()
    data, view = read()
    assert session.show(data, view, SMALL) == Change.SCENE
    fresh = Session()
    fresh.show(data, view, SMALL)
    assert session.renderer.voxel_size_m == fresh.renderer.voxel_size_m


def test_cascades_do_not_depend_on_the_bounds(box: Any) -> None:
    settings = {"frames": 1, "bounces": 1, "volume": "cascades", "cascades": 2, "cascade_resolution": 32}
    session = Session()
    data, view = read()
    session.show(data, view, settings)
    renderer = session.renderer
    bpy.data.objects["box"].location.x += 6.0
    bpy.context.view_layer.update()
    data, view = read()
    assert session.show(data, view, settings) < Change.SCENE and session.renderer is renderer
    fresh = Session()
    fresh.show(data, view, settings)
    np.testing.assert_array_equal(session.picture(view).radiance, fresh.picture(view).radiance)
    # Without them there is one box again, around all that is there now.
    session.show(data, view, SMALL)
    assert session.renderer.settings["volume"] != "cascades"
    fresh = Session()
    fresh.show(data, view, SMALL)
    np.testing.assert_array_equal(session.picture(view).radiance, fresh.picture(view).radiance)


def test_other_settings_and_sizes_keep_the_scene(box: Any) -> None:
    session = Session()
    data, view = read()
    session.show(data, view, SMALL)
    scene, renderer = session.scene, session.renderer
    coarse = view.scaled(2)
    session.show(data, coarse, {**SMALL, "frames": 2})
    assert session.scene is scene and session.renderer is renderer
    assert session.picture(coarse).radiance.shape == (12, 16, 3)
    session.show(data, view, {**SMALL, "frames": 2})
    assert session.picture(view).radiance.shape == (24, 32, 3)
    session.show(data, view, SMALL)
    fresh = Session()
    fresh.show(data, view, SMALL)
    np.testing.assert_array_equal(session.picture(view).radiance, fresh.picture(view).radiance)


def test_a_change_that_is_stopped_half_way_is_not_forgotten(box: Any) -> None:
    session = Session()
    data, view = read()
    session.show(data, view, SMALL)
    before = session.picture(view).radiance
    place()
    bpy.context.view_layer.update()

    def stop(stage: str, done: float, total: int) -> None:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        session.show(read()[0], view, SMALL, progress=stop)
    session.show(data, view, SMALL)
    np.testing.assert_array_equal(session.picture(view).radiance, before)


def test_objects_share_meshes(box: Any) -> None:
    first = bpy.data.objects["box"]
    for number in range(4):
        copy = first.copy()
        copy.location.x = 0.2 * number
        bpy.context.scene.collection.objects.link(copy)
    bpy.context.view_layer.update()
    data, _ = read()
    assert len(data.instances) == 6 and len(data.meshes) == 2


def test_instances_of_collections_are_seen(box: Any) -> None:
    parts = bpy.data.collections.new("parts")
    parts.objects.link(bpy.data.objects["box"])
    bpy.context.scene.collection.objects.unlink(bpy.data.objects["box"])
    for x in (-1.0, 1.0):
        empty = scenes._link("instancer", None)
        empty.instance_type, empty.instance_collection = "COLLECTION", parts
        empty.location.x = x
    bpy.context.view_layer.update()
    data, _ = read()
    places = sorted(placed.matrix[0][3] for placed in data.instances if placed.name == "box")
    assert places == [-1.0, 1.0]
    assert len({placed.key for placed in data.instances}) == len(data.instances)


def test_instances_of_nodes_and_particles_are_seen(box: Any) -> None:
    thing = bpy.data.objects["box"]
    group = bpy.data.node_groups.new("scatter", "GeometryNodeTree")
    group.interface.new_socket("Geometry", in_out="OUTPUT", socket_type="NodeSocketGeometry")
    line, cone = group.nodes.new("GeometryNodeMeshLine"), group.nodes.new("GeometryNodeMeshCone")
    spread, end = group.nodes.new("GeometryNodeInstanceOnPoints"), group.nodes.new("NodeGroupOutput")
    line.inputs["Count"].default_value = 3
    group.links.new(line.outputs[0], spread.inputs["Points"])
    group.links.new(cone.outputs[0], spread.inputs["Instance"])
    group.links.new(spread.outputs[0], end.inputs[0])
    thing.modifiers.new("scatter", "NODES").node_group = group
    reader = Reader()
    bpy.context.view_layer.update()
    data, _ = read(reader)
    cones = [placed for placed in data.instances if placed.name != "floor"]
    assert len(cones) == 3 and len({placed.mesh for placed in cones}) == 1
    assert len({placed.key for placed in cones}) == 3

    floor = bpy.data.objects["floor"]
    particles = floor.modifiers.new("particles", "PARTICLE_SYSTEM").particle_system.settings
    particles.type, particles.count, particles.render_type = "HAIR", 5, "OBJECT"
    lone = scenes._box("seed", (0, 0, -9), (0.1, 0.1, 0.1), bpy.data.materials["red"])
    particles.instance_object = lone
    particles.use_advanced_hair = True
    bpy.context.view_layer.update()
    data, _ = read()
    seeds = [placed for placed in data.instances if placed.name == "seed"]
    assert len(seeds) == 6
