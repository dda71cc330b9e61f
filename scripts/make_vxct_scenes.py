#!/usr/bin/env python3
"""Writes the models of the scenes in scenes/ (models/*.obj) and scenes/many.scene.

Every model stands within [-1, 1] and is one mesh with normals, wound counter-clockwise seen from outside.
The other scenes are written by hand. Run it in the root of the repository; it takes no arguments.
"""

import colorsys
import math
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent


def normalized(v):
    length = math.sqrt(sum(x * x for x in v)) or 1.0
    return [x / length for x in v]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def write_obj(name, what, vertices, faces):
    """`vertices` are pairs of position and normal, `faces` lists of their numbers from 0."""
    # Adding zero makes a negative zero a zero.
    number = lambda x: f"{round(x, 4) + 0.0:.4f}".rstrip("0").rstrip(".")
    lines = [f"# {what}; written by scripts/make_vxct_scenes.py", f"o {name}"]
    lines += ["v " + " ".join(map(number, position)) for position, _ in vertices]
    lines += ["vn " + " ".join(map(number, normalized(normal))) for _, normal in vertices]
    lines += ["f " + " ".join(f"{i + 1}//{i + 1}" for i in face) for face in faces]
    (ROOT / "models" / f"{name}.obj").write_text("\n".join(lines) + "\n")


def lattice(columns, rows, closed):
    """Quads between neighbours of a lattice whose columns close to a ring, and its rows, too, if asked."""
    place = lambda column, row: (row % rows) * columns + column % columns
    last = rows if closed else rows - 1
    return [
        [place(c, r), place(c + 1, r), place(c + 1, r + 1), place(c, r + 1)]
        for r in range(last)
        for c in range(columns)
    ]


def turned(profile, columns):
    """A surface of revolution about y. `profile` holds points (radius, height) from bottom to top."""
    vertices = []
    for i, (radius, height) in enumerate(profile):
        below, above = profile[max(i - 1, 0)], profile[min(i + 1, len(profile) - 1)]
        along = (above[0] - below[0], above[1] - below[1])
        for column in range(columns):
            angle = -math.tau * column / columns
            cos, sin = math.cos(angle), math.sin(angle)
            normal = [along[1] * cos, -along[0], along[1] * sin]
            vertices.append(([radius * cos, height, radius * sin], normal))
    return vertices, lattice(columns, len(profile), False)


def sphere():
    rows, columns = 17, 32
    angles = [math.pi * (row / (rows - 1) - 0.5) for row in range(rows)]
    # Poles of a small radius, so that no quad becomes a line.
    profile = [(max(math.cos(a), 0.004), math.sin(a)) for a in angles]
    vertices, faces = turned(profile, columns)
    vertices = [(position, position) for position, _ in vertices]
    return vertices, faces


def vase():
    """A foot, a belly, a neck and a lip, and the same way back inside; the foot is closed."""
    outside = [(0.01, -1.0), (0.36, -1.0), (0.38, -0.95), (0.3, -0.86), (0.34, -0.72), (0.5, -0.45),
               (0.6, -0.15), (0.58, 0.15), (0.44, 0.42), (0.28, 0.62), (0.24, 0.78), (0.3, 0.92), (0.375, 0.985), (0.375, 1.0)]
    inside = [(0.355, 1.0), (0.34, 0.985), (0.26, 0.88), (0.2, 0.74), (0.24, 0.6), (0.4, 0.4), (0.53, 0.13), (0.55, -0.15),
              (0.45, -0.43), (0.01, -0.7)]
    return turned(outside + inside, 28)


def knot():
    """The torus knot that goes twice around and three times through."""
    along, around, tube = 84, 10, 0.17

    def curve(t):
        radius = 0.55 + 0.25 * math.cos(3 * t)
        return [radius * math.cos(2 * t), radius * math.sin(2 * t), 0.36 * math.sin(3 * t)]

    vertices = []
    for i in range(along):
        t = math.tau * i / along
        center = curve(t)
        tangent = normalized([b - a for a, b in zip(curve(t - 1e-3), curve(t + 1e-3))])
        # Away from the ring's middle line: a frame that closes without a twist.
        out = [math.cos(2 * t), math.sin(2 * t), 0.0]
        side = normalized(cross(tangent, out))
        up = cross(side, tangent)
        for j in range(around):
            angle = math.tau * j / around
            normal = [math.cos(angle) * u + math.sin(angle) * s for u, s in zip(up, side)]
            vertices.append(([c + tube * n for c, n in zip(center, normal)], normal))
    return vertices, lattice(around, along, True)


def quad():
    corners = [[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]]
    return [(corner, [0, 0, 1]) for corner in corners], [[0, 1, 2, 3]]


def many():
    """A winding stair of cubes in all hues around a column of glowing balls."""
    lines = [
        "scene {",
        "  name = many",
        "",
        "  model { name = Floor path = models/quad.obj position { x = 0 y = -0.92f z = 0 }",
        "    rotation { x = -90 y = 0 z = 0 } scale = 0.98f",
        "    material { specular_str = 0.1f color { r = 0.75f g = 0.75f b = 0.75f } } }",
        "  model { name = BackWall path = models/quad.obj position { x = 0 y = 0 z = -0.97f } scale = 0.98f",
        "    material { specular_str = 0.1f color { r = 0.6f g = 0.65f b = 0.75f } } }",
        "",
    ]
    steps = 60
    for i in range(steps):
        share = i / (steps - 1)
        turn = 2.5 * share
        angle = math.tau * turn
        radius = 0.62 - 0.14 * share
        x, z = radius * math.cos(angle), radius * math.sin(angle)
        y = -0.86 + 1.6 * share
        r, g, b = (0.15 + 0.75 * c for c in colorsys.hsv_to_rgb(share * 0.83, 0.85, 1.0))
        lines += [
            f"  model {{ name = Step{i + 1} primitive = cube",
            f"    position {{ x = {x:.3f}f, y = {y:.3f}f, z = {z:.3f}f }}",
            f"    rotation {{ x = 0 y = {-math.degrees(angle) % 360:.1f}f z = 0 }}",
            "    scale_x = 0.16f scale_y = 0.025f scale_z = 0.07f",
            f"    material {{ shininess = 40 specular_str = 0.3f color {{ r = {r:.2f}f g = {g:.2f}f b = {b:.2f}f }} }} }}",
        ]
    lines.append("")
    for i in range(7):
        y = -0.78 + 0.26 * i
        warm = 2.6 - 0.2 * i
        lines += [
            f"  model {{ name = Ball{i + 1} path = models/sphere.obj shader = EMIT",
            f"    position {{ x = 0 y = {y:.2f}f z = 0 }} scale = 0.085f",
            f"    material {{ color {{ r = {warm:.2f}f g = {warm * 0.85:.2f}f b = {warm * 0.6:.2f}f }} }} }}",
        ]
    lines += [
        "",
        "  light { position { x = -0.5f y = 1.2f z = 1.6f } color { r = 0.5f g = 0.55f b = 0.7f } }",
        "}",
    ]
    (ROOT / "scenes" / "many.scene").write_text("\n".join(lines) + "\n")


def main():
    for name, what, make in [
        ("quad", "A square that faces +z", quad),
        ("sphere", "A ball", sphere),
        ("vase", "A vase", vase),
        ("knot", "A torus knot", knot),
    ]:
        vertices, faces = make()
        write_obj(name, what, vertices, faces)
    many()


if __name__ == "__main__":
    main()
