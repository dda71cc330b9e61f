"""Five scenes, made in code, that measure Lumivox for Blender and test it."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from typing import Any

import bpy
import numpy as np

Color = Sequence[float]
WHITE = (0.73, 0.73, 0.73)


def cornell() -> None:
    """A Cornell box of 2 m with an area light below its ceiling."""
    _begin(world=(0.0, 0.0, 0.0))
    white = material("white", WHITE)
    _quad("floor", (-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), white)
    _quad("ceiling", (-1, -1, 2), (-1, 1, 2), (1, 1, 2), (1, -1, 2), white)
    _quad("back", (-1, 1, 0), (1, 1, 0), (1, 1, 2), (-1, 1, 2), white)
    left, right = material("red", (0.61, 0.05, 0.04)), material("green", (0.11, 0.41, 0.1))
    _quad("left", (-1, -1, 0), (-1, 1, 0), (-1, 1, 2), (-1, -1, 2), left)
    _quad("right", (1, -1, 0), (1, -1, 2), (1, 1, 2), (1, 1, 0), right)
    _box("short", (0.35, -0.3, 0.3), (0.6, 0.6, 0.6), white, turn_deg=-17)
    _box("tall", (-0.33, 0.35, 0.6), (0.6, 0.6, 1.2), white, turn_deg=20)
    lamp = _light("area", "AREA", (0, 0, 1.99), energy=12.0, color=(1.0, 0.86, 0.7))
    lamp.data.shape, lamp.data.size, lamp.data.size_y = "RECTANGLE", 0.5, 0.4
    # As Lumivox shows it.
    lamp.visible_camera = True
    _camera((0, -4.4, 1.0), (0, 0, 1.0), lens=38)


def room() -> None:
    """A room with a window, through which sun and sky shine."""
    _begin(world=(0.35, 0.55, 0.9), strength=2.0)
    white, wood = material("plaster", (0.78, 0.76, 0.72)), material("wood", (0.4, 0.22, 0.1))
    _box("floor", (0, 0, -0.1), (5, 4, 0.2), wood)
    _box("ceiling", (0, 0, 2.7), (5, 4, 0.2), white)
    _box("left", (-2.4, 0, 1.3), (0.2, 4, 2.6), white)
    _box("right", (2.4, 0, 1.3), (0.2, 4, 2.6), white)
    _box("front", (0, -1.9, 1.3), (5, 0.2, 2.6), white)
    # The wall with the window.
    _box("sill", (0, 1.9, 0.45), (5, 0.2, 0.9), white)
    _box("lintel", (0, 1.9, 2.4), (5, 0.2, 0.4), white)
    _box("pier left", (-1.6, 1.9, 1.55), (1.6, 0.2, 1.3), white)
    _box("pier right", (1.6, 1.9, 1.55), (1.6, 0.2, 1.3), white)
    _box("table", (0.4, 0.2, 0.72), (1.4, 0.8, 0.05), material("table", (0.6, 0.45, 0.3)))
    for x in (-0.2, 1.0):
        for y in (-0.12, 0.52):
            _box("leg", (x, y, 0.35), (0.06, 0.06, 0.7), wood)
    _ball("ball", (-1.2, 0.6, 0.3), 0.3, material("blue", (0.1, 0.2, 0.6)))
    sun = _light("sun", "SUN", (0, 5, 5), energy=12.0, color=(1.0, 0.9, 0.75))
    sun.data.angle = math.radians(0.53)
    _aim(sun, (0.35, -0.8, -0.62))
    camera = _camera((-1.6, -1.6, 1.4), (0.6, 1.0, 1.0), lens=20)
    # Whole pixels of pictures that are a multiple of 16 wide.
    camera.data.shift_y = 0.0625


def lamps() -> None:
    """A point light and two spots over a floor with things."""
    _begin(world=(0.01, 0.01, 0.015))
    _quad("floor", (-4, -4, 0), (4, -4, 0), (4, 4, 0), (-4, 4, 0), material("floor", (0.5, 0.5, 0.5)))
    _quad("wall", (-4, 2, 0), (4, 2, 0), (4, 2, 4), (-4, 2, 4), material("wall", (0.6, 0.55, 0.5)))
    gloss = material("gloss", (0.5, 0.1, 0.05), roughness=0.35, level=0.5)
    _ball("ball", (-0.8, 0.2, 0.5), 0.5, gloss)
    _box("box", (0.9, 0.3, 0.4), (0.8, 0.8, 0.8), material("box", (0.2, 0.5, 0.3)), turn_deg=25)
    point = _light("point", "POINT", (0.2, -0.6, 1.6), energy=60.0, color=(1.0, 0.8, 0.6))
    point.data.shadow_soft_size = 0.05
    for x, color in ((-2.2, (0.5, 0.6, 1.0)), (2.4, (1.0, 0.5, 0.9))):
        spot = _light("spot", "SPOT", (x, -1.0, 2.8), energy=400.0, color=color)
        spot.data.spot_size, spot.data.spot_blend = math.radians(50), 0.3
        spot.data.shadow_soft_size = 0.02
        _aim(spot, (-0.4 * x, 0.8, -2.6))
    _camera((0, -5.5, 2.2), (0, 0, 0.8), lens=35)


def materials() -> None:
    """Textures, metals, clear coat and a normal map under a large area light."""
    _begin(world=(0.4, 0.45, 0.5), strength=0.6)
    checker = image("checker", _checker())
    floor = material("floor", WHITE, roughness=0.6, level=0.5)
    _texture(floor, "Base Color", checker, scale=4.0)
    _quad("floor", (-3, -3, 0), (3, -3, 0), (3, 3, 0), (-3, 3, 0), floor)
    _quad("wall", (-3, 2.4, 0), (3, 2.4, 0), (3, 2.4, 3), (-3, 2.4, 3), material("wall", WHITE))
    gold = material("gold", (1.0, 0.72, 0.3), metallic=1.0, roughness=0.3)
    steel = material("steel", (0.6, 0.6, 0.62), metallic=1.0, roughness=0.15)
    coated = material("coated", (0.5, 0.02, 0.02), roughness=0.6, level=0.5)
    _principled(coated).inputs["Coat Weight"].default_value = 1.0
    _principled(coated).inputs["Coat Roughness"].default_value = 0.1
    bumps = material("bumps", (0.3, 0.5, 0.7), roughness=0.7, level=0.5)
    _normal_map(bumps, image("bumps", _bumps(), is_data=True))
    for x, look in ((-1.8, gold), (-0.6, steel), (0.6, coated), (1.8, bumps)):
        _ball(look.name, (x, 0.3, 0.55), 0.55, look)
    glow = material("glow", (0.0, 0.0, 0.0))
    _principled(glow).inputs["Emission Color"].default_value = (1.0, 0.5, 0.2, 1.0)
    _principled(glow).inputs["Emission Strength"].default_value = 6.0
    _box("glow", (0, -0.9, 0.1), (0.8, 0.2, 0.2), glow)
    lamp = _light("area", "AREA", (1.5, -2.5, 4.0), energy=250.0)
    lamp.data.shape, lamp.data.size = "DISK", 1.2
    _aim(lamp, (-1.2, 2.6, -3.5))
    _camera((0, -5.2, 1.9), (0, 0, 0.6), lens=40)


def panorama() -> None:
    """Things on a ground under a panorama with a sunset."""
    _begin(world=(0.0, 0.0, 0.0))
    _surround(image("sunset", _sunset(), is_float=True), turn_deg=40.0)
    _quad("ground", (-5, -5, 0), (5, -5, 0), (5, 5, 0), (-5, 5, 0), material("ground", (0.4, 0.38, 0.35)))
    _ball("chrome", (-1.3, 0, 0.6), 0.6, material("chrome", (0.9, 0.9, 0.9), metallic=1.0, roughness=0.1))
    _ball("clay", (0.1, 0.4, 0.6), 0.6, material("clay", (0.6, 0.3, 0.2)))
    _box("block", (1.4, 0.1, 0.5), (0.8, 0.8, 1.0), material("block", WHITE), turn_deg=30)
    _camera((0.4, -4.6, 1.5), (0, 0, 0.7), lens=35)


SCENES: dict[str, Callable[[], None]] = {
    "cornell": cornell,
    "room": room,
    "lamps": lamps,
    "materials": materials,
    "panorama": panorama,
}


# --- parts ---


def material(
    name: str, color: Color, roughness: float = 1.0, metallic: float = 0.0, level: float = 0.0
) -> Any:
    """A Principled BSDF; by default it is purely diffuse. ``level`` is that of its gloss."""
    made = bpy.data.materials.new(name)
    inputs = _principled(made).inputs
    inputs["Base Color"].default_value = (*color, 1.0)
    inputs["Roughness"].default_value = roughness
    inputs["Metallic"].default_value = metallic
    inputs["Specular IOR Level"].default_value = level
    return made


def image(name: str, pixels: np.ndarray, is_data: bool = False, is_float: bool = False) -> Any:
    """An image of pixels (H, W, 3) from the bottom."""
    height, width = pixels.shape[:2]
    made = bpy.data.images.new(name, width, height, float_buffer=is_float, is_data=is_data)
    whole = np.ones((height, width, 4), np.float32)
    whole[..., :3] = pixels
    made.pixels.foreach_set(whole.ravel())
    made.update()
    made.pack()
    return made


def _begin(world: Color, strength: float = 1.0) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.world = bpy.data.worlds.new("world")
    background = scene.world.node_tree.nodes["Background"]
    background.inputs["Color"].default_value = (*world, 1.0)
    background.inputs["Strength"].default_value = strength
    scene.render.resolution_percentage = 100


def _link(name: str, data: Any) -> Any:
    made = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(made)
    return made


def _mesh(name: str, corners: Any, faces: Any, look: Any, uvs: Any = None) -> Any:
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    mesh.materials.append(look)
    layer = mesh.uv_layers.new(name="UVMap")
    if uvs is not None:
        layer.data.foreach_set("uv", np.array(uvs, np.float32).ravel())
    return _link(name, mesh)


def _quad(name: str, a: Any, b: Any, c: Any, d: Any, look: Any) -> Any:
    return _mesh(name, [a, b, c, d], [(0, 1, 2, 3)], look, [(0, 0), (1, 0), (1, 1), (0, 1)])


def _box(name: str, center: Any, size: Any, look: Any, turn_deg: float = 0.0) -> Any:
    corners = [
        tuple(0.5 * side * sign for side, sign in zip(size, signs))
        for signs in ((x, y, z) for z in (-1, 1) for y in (-1, 1) for x in (-1, 1))
    ]
    faces = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    made = _mesh(name, corners, faces, look)
    made.location = center
    made.rotation_euler.z = math.radians(turn_deg)
    return made


def _ball(name: str, center: Any, radius: float, look: Any) -> Any:
    rows, columns = 24, 48
    corners, uvs, faces = [], [], []
    for row in range(rows + 1):
        for column in range(columns + 1):
            high, around = math.pi * (row / rows - 0.5), 2.0 * math.pi * column / columns
            flat = math.cos(high)
            corners.append((flat * math.cos(around), flat * math.sin(around), math.sin(high)))
            uvs.append((column / columns, row / rows))
    for row in range(rows):
        for column in range(columns):
            a = row * (columns + 1) + column
            faces.append((a, a + 1, a + columns + 2, a + columns + 1))
    made = _mesh(name, corners, faces, look, [uvs[corner] for face in faces for corner in face])
    made.data.shade_smooth()
    # The corners are on the unit sphere, where positions are normals.
    made.data.normals_split_custom_set_from_vertices(corners)
    made.location, made.scale = center, (radius,) * 3
    return made


def _light(name: str, kind: str, place: Any, energy: float, color: Color = (1, 1, 1)) -> Any:
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = energy, color
    made = _link(name, data)
    made.location = place
    return made


def _aim(thing: Any, along: Any) -> None:
    from mathutils import Vector

    thing.rotation_euler = Vector(along).to_track_quat("-Z", "Y").to_euler()


def _camera(place: Any, target: Any, lens: float) -> Any:
    made = _link("camera", bpy.data.cameras.new("camera"))
    made.location, made.data.lens = place, lens
    _aim(made, [b - a for a, b in zip(place, target)])
    bpy.context.scene.camera = made
    return made


def _principled(look: Any) -> Any:
    return look.node_tree.nodes["Principled BSDF"]


def _image_node(tree: Any, source: Any, scale: float) -> Any:
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image = source
    if scale != 1.0:
        mapping = tree.nodes.new("ShaderNodeMapping")
        mapping.inputs["Scale"].default_value = (scale, scale, scale)
        coordinates = tree.nodes.new("ShaderNodeTexCoord")
        tree.links.new(coordinates.outputs["UV"], mapping.inputs["Vector"])
        tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    return node


def _texture(look: Any, name: str, source: Any, scale: float = 1.0) -> None:
    tree = look.node_tree
    node = _image_node(tree, source, scale)
    tree.links.new(node.outputs["Color"], _principled(look).inputs[name])


def _normal_map(look: Any, source: Any) -> None:
    tree = look.node_tree
    node, normals = _image_node(tree, source, 1.0), tree.nodes.new("ShaderNodeNormalMap")
    tree.links.new(node.outputs["Color"], normals.inputs["Color"])
    tree.links.new(normals.outputs["Normal"], _principled(look).inputs["Normal"])


def _surround(source: Any, turn_deg: float) -> None:
    tree = bpy.context.scene.world.node_tree
    node, mapping = tree.nodes.new("ShaderNodeTexEnvironment"), tree.nodes.new("ShaderNodeMapping")
    coordinates = tree.nodes.new("ShaderNodeTexCoord")
    node.image = source
    mapping.inputs["Rotation"].default_value[2] = math.radians(turn_deg)
    tree.links.new(coordinates.outputs["Generated"], mapping.inputs["Vector"])
    tree.links.new(mapping.outputs["Vector"], node.inputs["Vector"])
    tree.links.new(node.outputs["Color"], tree.nodes["Background"].inputs["Color"])


def _checker() -> np.ndarray:
    y, x = np.mgrid[0:128, 0:128]
    odd = ((x // 64 + y // 64) % 2)[..., None]
    return np.where(odd, (0.8, 0.78, 0.7), (0.25, 0.3, 0.45)).astype(np.float32)


def _bumps() -> np.ndarray:
    y, x = np.mgrid[0:256, 0:512] / 256.0
    slope_x = 0.5 * np.cos(2.0 * np.pi * 8.0 * x)
    slope_y = 0.5 * np.cos(2.0 * np.pi * 8.0 * y)
    normals = np.stack((-slope_x, -slope_y, np.ones_like(x)), axis=-1)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return (0.5 * normals + 0.5).astype(np.float32)


def _sunset() -> np.ndarray:
    y, x = np.mgrid[0:128, 0:256]
    high, around = (y + 0.5) / 128.0 - 0.5, (x + 0.5) / 256.0
    sky = np.stack((0.5 - 0.4 * high, 0.45 - 0.1 * high, 0.5 + 0.5 * high), axis=-1)
    sky = np.where(high[..., None] > 0.0, sky, (0.12, 0.1, 0.08))
    glow = np.exp(-((around - 0.3) ** 2 / 0.002 + (high - 0.12) ** 2 / 0.002))
    return (sky + glow[..., None] * np.array((12.0, 7.0, 3.0))).astype(np.float32)
