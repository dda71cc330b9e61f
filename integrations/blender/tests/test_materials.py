"""Surfaces: what nodes mean, and what is told about those that mean nothing here."""

from __future__ import annotations

from typing import Any

import bpy
import numpy as np
import pytest

import lumivox
import scenes
from conftest import color, read, shown, small
from extension import glb, model
from extension.session import load
from extension.translate.images import Images, encode_srgb
from extension.translate.materials import Surfaces
from extension.translate.notes import Notes
from extension.translate.scene import Reader


@pytest.fixture
def look() -> Any:
    scenes._begin(world=(0, 0, 0))
    return scenes.material("look", (0.2, 0.4, 0.6))


def translated(look: Any) -> tuple[model.Material, tuple[str, ...]]:
    notes = Notes()
    return Surfaces(Images(), notes).of(look), notes.all()


def _node(look: Any, kind: str, output: str | int, name: str) -> Any:
    tree = look.node_tree
    node = tree.nodes.new(kind)
    tree.links.new(node.outputs[output], scenes._principled(look).inputs[name])
    return node


def test_the_numbers_of_the_principled_bsdf(look: Any) -> None:
    inputs = scenes._principled(look).inputs
    for name, value in {
        "Metallic": 0.25,
        "Roughness": 0.5,
        "IOR": 1.4,
        "Specular IOR Level": 0.75,
        "Alpha": 0.5,
        "Transmission Weight": 0.3,
        "Coat Weight": 0.7,
        "Coat Roughness": 0.2,
        "Sheen Weight": 0.5,
        "Sheen Roughness": 0.4,
        "Emission Strength": 3.0,
    }.items():
        inputs[name].default_value = value
    inputs["Emission Color"].default_value = (1.0, 0.5, 0.0, 1.0)
    found, told = translated(look)
    assert told == ()
    assert found == model.Material(
        name="look",
        base_color=pytest.approx((0.2, 0.4, 0.6)),
        metallic=0.25,
        roughness=0.5,
        ior=pytest.approx(1.4),
        specular=1.0,
        specular_color=pytest.approx((1.5, 1.5, 1.5)),
        alpha=0.5,
        is_blended=True,
        transmission=pytest.approx(0.3),
        coat=pytest.approx(0.7),
        coat_roughness=pytest.approx(0.2),
        sheen_color=(0.5, 0.5, 0.5),
        sheen_roughness=pytest.approx(0.4),
        emissive=(3.0, 1.5, 0.0),
    )
    # All of it arrives in Lumivox.
    mesh = model.Mesh.of(
        "triangle", np.eye(3, dtype=np.float32), np.arange(3, dtype=np.uint32), np.eye(3, dtype=np.float32)
    )
    placed = model.Instance("triangle", 0, 0, tuple(map(tuple, np.eye(4).tolist())))
    arrived = load(model.Scene(meshes=(mesh,), materials=(found,), instances=(placed,))).materials[0]
    assert arrived.metallic == 0.25 and arrived.roughness == 0.5 and arrived.specular == 1.0
    assert arrived.emissive == pytest.approx((3.0 * 683.0, 1.5 * 683.0, 0.0))
    text = glb.write(model.Scene(meshes=(mesh,), materials=(found,), instances=(placed,)))
    for extension in ("clearcoat", "sheen", "transmission", "ior", "specular", "emissive_strength"):
        assert f"KHR_materials_{extension}".encode() in text


def test_other_shaders(look: Any) -> None:
    tree = look.node_tree
    output = tree.nodes["Material Output"]

    def ends_in(kind: str, **values: Any) -> model.Material:
        node = tree.nodes.new(kind)
        for name, value in values.items():
            node.inputs[name].default_value = value
        tree.links.new(node.outputs[0], output.inputs["Surface"])
        found, told = translated(look)
        assert told == ()
        return found

    diffuse = ends_in("ShaderNodeBsdfDiffuse", Color=(0.1, 0.2, 0.3, 1.0))
    assert diffuse.base_color == pytest.approx((0.1, 0.2, 0.3))
    assert (diffuse.specular, diffuse.roughness) == (0.0, 1.0)
    glossy = ends_in("ShaderNodeBsdfAnisotropic", Roughness=0.25)
    assert (glossy.metallic, glossy.roughness) == (1.0, 0.25)
    assert ends_in("ShaderNodeBsdfGlass").transmission == 1.0
    glow = ends_in("ShaderNodeEmission", Strength=2.0, Color=(1.0, 0.5, 0.0, 1.0))
    assert glow.emissive == (2.0, 1.0, 0.0) and glow.base_color == (0.0, 0.0, 0.0)
    mix = tree.nodes.new("ShaderNodeMixShader")
    tree.links.new(tree.nodes.new("ShaderNodeBsdfTransparent").outputs[0], mix.inputs[1])
    tree.links.new(scenes._principled(look).outputs[0], mix.inputs[2])
    mix.inputs[0].default_value = 0.25
    tree.links.new(mix.outputs[0], output.inputs["Surface"])
    mixed, told = translated(look)
    assert told == () and mixed.alpha == 0.25 and mixed.is_blended
    tree.links.clear()
    assert translated(look)[0].base_color == (0.0, 0.0, 0.0)


def test_what_is_not_supported_is_told_once(look: Any) -> None:
    scenes._principled(look).inputs["Subsurface Weight"].default_value = 0.5
    _node(look, "ShaderNodeTexNoise", "Color", "Base Color")
    for x in (0, 3):
        scenes._box("box", (x, 0, 0), (1, 1, 1), look)
    data, _ = _read()
    assert len(data.notes) == 2
    assert any("look" in note and "Noise Texture" in note for note in data.notes)
    assert any("Subsurface Weight" in note for note in data.notes)
    assert data.materials[0].base_color == pytest.approx((0.2, 0.4, 0.6))


def _read() -> tuple[model.Scene, None]:
    return Reader().read(bpy.context.evaluated_depsgraph_get()), None


def test_images_keep_their_colours(look: Any) -> None:
    linear = np.full((4, 4, 3), (0.1, 0.5, 0.9), np.float32)
    stored = scenes.image("bytes", encode_srgb(linear))
    floats = scenes.image("floats", linear, is_float=True)
    images, notes = Images(), Notes()
    for image in (stored, floats):
        found = images.color(image, notes)
        assert found.mime == "image/png" and notes.all() == ()
        back = bpy.data.images.new("back", 1, 1)
        back.pack(data=found.data, data_len=len(found.data))
        back.source = "FILE"
        assert tuple(back.size) == (4, 4)
        np.testing.assert_allclose(back.pixels[:3], encode_srgb(linear[0, 0]), atol=1 / 255)


def test_textures_are_mapped_as_in_cycles(exr: Any) -> None:
    """A picture on a plane, moved and turned by a Mapping node, as in Cycles."""
    scenes._begin(world=(1.0, 1.0, 1.0))
    pixels = np.zeros((16, 16, 3), np.float32)
    pixels[:8, :8], pixels[8:, :8], pixels[:8, 8:] = (1, 0, 0), (0, 1, 0), (0, 0, 1)
    glow = scenes.material("glow", (0, 0, 0))
    scenes._texture(glow, "Emission Color", scenes.image("corners", pixels), scale=2.0)
    scenes._principled(glow).inputs["Emission Strength"].default_value = 1.0
    mapping = glow.node_tree.nodes["Mapping"]
    mapping.inputs["Location"].default_value = (0.25, 0.125, 0.0)
    mapping.inputs["Rotation"].default_value = (0.0, 0.0, 0.5)
    scenes._quad("plane", (-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), glow)
    scenes._camera((0, -3, 0), (0, 0, 0), lens=50)
    small((32, 32))
    ours, cycles = color(exr(samples=16)), color(exr("CYCLES", samples=32))
    blocks = [picture.reshape(8, 4, 8, 4, 3).mean(axis=(1, 3)) for picture in (ours, cycles)]
    assert np.ptp(blocks[1]) > 0.5
    np.testing.assert_allclose(blocks[0], blocks[1], atol=0.1)


def test_missing_images_are_magenta_and_told(box: Any) -> None:
    missing = bpy.data.images.new("lost", 4, 4)
    missing.source, missing.filepath = "FILE", "//nowhere/lost.png"
    look = bpy.data.materials["red"]
    scenes._texture(look, "Base Color", missing)
    data, _ = read()
    assert any("lost.png" in note and "cannot be read" in note for note in data.notes)
    assert next(known for known in data.materials if known.name == "red").base_color == (1.0, 0.0, 1.0)
    red, green, _ = shown().radiance.mean(axis=(0, 1))
    assert red > 1.02 * green


def test_roughness_and_metallic_of_two_images_become_one(look: Any) -> None:
    rough, metal = np.zeros((4, 4, 3), np.float32), np.zeros((8, 8, 3), np.float32)
    rough[...], metal[...] = 0.2, 0.8
    for name, pixels in (("Roughness", rough), ("Metallic", metal)):
        node = _node(look, "ShaderNodeTexImage", "Color", name)
        node.image = scenes.image(name, pixels, is_data=True)
    found, told = translated(look)
    assert told == () and (found.roughness, found.metallic) == (1.0, 1.0)
    packed = bpy.data.images.new("packed", 1, 1, is_data=True)
    data = found.textures["metallic_roughness"].image.data
    packed.pack(data=data, data_len=len(data))
    packed.source = "FILE"
    assert tuple(packed.size) == (8, 8)
    np.testing.assert_allclose(packed.pixels[1:3], (0.2, 0.8), atol=1 / 255)


def unpacked(image: model.Image) -> np.ndarray:
    """The first pixel of an image."""
    loaded = bpy.data.images.new("unpacked", 1, 1, is_data=True)
    loaded.pack(data=image.data, data_len=len(image.data))
    loaded.source = "FILE"
    return np.array(loaded.pixels[:4])


@pytest.mark.parametrize("name, channel, expected", (("Roughness", "Green", (0.5, 1.0)), ("Metallic", "Blue", (1.0, 0.75))))
def test_the_channel_without_an_image_is_one(look: Any, name: str, channel: str, expected: Any) -> None:
    node = _node(look, "ShaderNodeSeparateColor", channel, name)
    texture = look.node_tree.nodes.new("ShaderNodeTexImage")
    texture.image = scenes.image("parts", np.full((4, 4, 3), (0.25, 0.5, 0.75), np.float32), is_data=True)
    look.node_tree.links.new(texture.outputs["Color"], node.inputs[0])
    found, told = translated(look)
    assert told == ()
    np.testing.assert_allclose(
        unpacked(found.textures["metallic_roughness"].image)[1:3], expected, atol=1 / 255
    )


def test_one_image_is_read_apart_for_roughness_and_metallic(look: Any) -> None:
    image = scenes.image("grey", np.full((4, 4, 3), 0.5, np.float32), is_data=True)
    images, notes = Images(), Notes()
    rough = images.packed((image, 0), None, notes)
    metal = images.packed(None, (image, 0), notes)
    np.testing.assert_allclose(unpacked(rough)[1:3], (0.5, 1.0), atol=1 / 255)
    np.testing.assert_allclose(unpacked(metal)[1:3], (1.0, 0.5), atol=1 / 255)


def test_numbers_in_srgb_are_decoded(look: Any) -> None:
    """Roughness, metallic and normals of images whose colour space is that of colours."""
    image = scenes.image("encoded", encode_srgb(np.full((4, 4, 3), (0.1, 0.3, 0.6), np.float32)))
    images, notes = Images(), Notes()
    np.testing.assert_allclose(unpacked(images.data(image, notes))[:3], (0.1, 0.3, 0.6), atol=1 / 255)
    both = images.packed((image, 0), (image, 0), notes)
    np.testing.assert_allclose(unpacked(both)[1:3], (0.1, 0.1), atol=1 / 255)


def test_muted_nodes_are_passed(look: Any) -> None:
    node = _node(look, "ShaderNodeRGB", 0, "Base Color")
    node.outputs[0].default_value = (0.9, 0.1, 0.1, 1.0)
    node.mute = True
    assert translated(look)[0].base_color == pytest.approx((0.2, 0.4, 0.6))
    tree = look.node_tree
    mix = _node(look, "ShaderNodeMix", 2, "Base Color")
    mix.data_type, mix.blend_type = "RGBA", "MULTIPLY"
    result = next(socket for socket in mix.outputs if socket.type == "RGBA")
    first, second = (socket for socket in mix.inputs if socket.type == "RGBA")
    tree.links.new(result, scenes._principled(look).inputs["Base Color"])
    mix.inputs["Factor"].default_value, second.default_value = 1.0, (0.5, 0.5, 0.5, 1.0)
    node.mute = False
    tree.links.new(node.outputs[0], first)
    assert translated(look)[0].base_color == pytest.approx((0.45, 0.05, 0.05))
    mix.mute = True
    assert translated(look)[0].base_color == pytest.approx((0.9, 0.1, 0.1))


def test_notes_on_meshes_stay_after_edits(look: Any) -> None:
    scenes._texture(look, "Base Color", scenes.image("dots", np.ones((4, 4, 3), np.float32)))
    look.node_tree.nodes["Image Texture"].extension = "CLIP"
    plane = scenes._quad("plane", (-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), look)
    while plane.data.uv_layers:
        plane.data.uv_layers.remove(plane.data.uv_layers[0])
    bpy.context.view_layer.update()
    reader, depsgraph = Reader(), bpy.context.evaluated_depsgraph_get()
    first = reader.read(depsgraph).notes
    assert any("Clip" in note for note in first) and any("lacks" in note for note in first)
    assert reader.read(depsgraph).notes == first


def test_color_attributes_multiply(exr: Any) -> None:
    scenes._begin(world=(1.0, 1.0, 1.0))
    look = scenes.material("painted", (1, 1, 1))
    plane = scenes._quad("plane", (-1, 0, -1), (1, 0, -1), (1, 0, 1), (-1, 0, 1), look)
    attribute = plane.data.color_attributes.new("paint", "FLOAT_COLOR", "POINT")
    for number, paint in enumerate(((1, 0, 0), (0, 1, 0), (0, 0, 1), (0.5, 0.5, 0.5))):
        attribute.data[number].color = (*paint, 1.0)
    _node(look, "ShaderNodeVertexColor", "Color", "Base Color").layer_name = "paint"
    scenes._camera((0, -3, 0), (0, 0, 0), lens=50)
    small((16, 16))
    ours, cycles = color(exr(samples=16)), color(exr("CYCLES", samples=128))
    np.testing.assert_allclose(ours[2::4, 2::4], cycles[2::4, 2::4], atol=0.05)


def test_scenes_over_4_gb_are_refused(box: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(glb, "_MOST", (64 << 20) + 100)
    with pytest.raises(glb.TooLarge, match="instances of one mesh"):
        glb.write(read()[0])


def test_lumivox_reads_what_is_written(box: Any) -> None:
    data, _ = read()
    scene = load(data)
    assert [placed.name for placed in scene.instances] == ["floor", "box"]
    assert scene.triangles == 14 and scene.warnings == []
    assert isinstance(scene, lumivox.Scene)
