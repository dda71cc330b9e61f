"""Scenes: from files, built in, from arrays, and edited."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from dataclasses import replace
from difflib import get_close_matches
from tempfile import TemporaryDirectory
from typing import Any, Literal, NamedTuple

import numpy as np

from . import _lumivox
from ._arrays import color, floats, numbers, vector, vertex_numbers
from ._records import IDENTITY, Camera, Instance, Light, Material, Record, Vector
from .errors import InputError

Path = str | os.PathLike[str]
#: The lower and the upper corner of a box, m.
Corners = tuple[Vector, Vector]
Progress = Callable[[str, float, int], object]


class Animation(NamedTuple):
    """An animation of a scene: its name, and its duration in seconds."""

    name: str
    duration_s: float


#: An animation's number or name, or ``"all"`` for all at once.
AnimationLike = int | str


class Scene:
    """Triangles, materials, lights, cameras and surroundings.

    The world is right-handed with y up, in metres. Light is in candela, lux and cd/m2. Edits check
    what they change; one that fails changes nothing. Renderers see the scene as it was when they
    were made, until :meth:`Renderer.update`.
    """

    def __init__(self, name: str = "scene") -> None:
        """An empty scene, for :meth:`add`."""
        self._scene = _lumivox.Scene(str(name))

    @classmethod
    def _of(cls, scene: _lumivox.Scene) -> Scene:
        made = cls.__new__(cls)
        made._scene = scene
        return made

    @classmethod
    def builtin(cls, name: str) -> Scene:
        """A built-in scene, such as ``"cornell"``; :data:`lumivox.BUILTIN` has the names."""
        return cls._of(_lumivox.Scene.builtin(name))

    @classmethod
    def load(
        cls,
        path: Path,
        *,
        unit_m: float = 1.0,
        up: Literal["y", "z"] = "y",
        crease_deg: float | None = None,
        scene: str | None = None,
        allow_outside: bool = False,
        ignore_required: bool = False,
        progress: Progress | None = None,
    ) -> Scene:
        """Reads a glTF, OBJ, PLY, STL or VXCT file, or makes ``"builtin:NAME"``.

        ``unit_m`` is the file's unit in metres, ``up`` its upward axis, ``crease_deg`` the angle
        above which edges without normals stay sharp (default: as the format has it), ``scene`` the
        name or number of one of several. ``allow_outside`` lets the file name others outside its
        folder; ``ignore_required`` shows a glTF file that needs unknown extensions as well as
        possible. :attr:`warnings` has what was ignored or replaced.
        """
        loaded = _lumivox.Scene.load(
            os.fspath(path),
            float(unit_m),
            up,
            crease_deg,
            None if scene is None else str(scene),
            allow_outside,
            ignore_required,
            progress,
        )
        return cls._of(loaded)

    @classmethod
    def from_arrays(
        cls,
        positions: Any,
        indices: Any,
        normals: Any = None,
        uvs: Any = None,
        *,
        material: Material | None = None,
        crease_deg: float = 30.0,
        name: str = "scene",
    ) -> Scene:
        """A scene of one mesh; the arguments are those of :meth:`add`."""
        scene = cls(name)
        scene.add(
            positions, indices, normals, uvs, material=material, crease_deg=crease_deg, name=name
        )
        return scene

    @classmethod
    def from_mesh(cls, mesh: Any, **options: Any) -> Scene:
        """A scene of an object of trimesh or PyVista; ``options`` are those of :meth:`add_mesh`."""
        scene = cls(str(options.get("name", "scene")))
        scene.add_mesh(mesh, **options)
        return scene

    def add(
        self,
        positions: Any,
        indices: Any,
        normals: Any = None,
        uvs: Any = None,
        *,
        material: Material | None = None,
        world_from_local: Any = IDENTITY,
        crease_deg: float = 30.0,
        name: str = "mesh",
    ) -> None:
        """Adds triangles with a material of their own, as one instance.

        ``positions`` is (N, 3) in metres; ``indices`` is (M, 3) or (3 M,) of whole numbers, each
        triangle counter-clockwise seen from its front; ``normals`` is (N, 3), ``uvs`` (N, 2).
        Without normals, edges below ``crease_deg`` become smooth. ``world_from_local`` is (4, 4).
        The default material is a diffuse grey of 0.8.
        """
        places = floats("positions", positions, (None, 3))
        triangles = vertex_numbers("indices", indices, len(places))
        if len(triangles) == 0:
            raise InputError("indices: has no triangle")
        directions = None if normals is None else floats("normals", normals, (len(places), 3))
        coordinates = None if uvs is None else floats("uvs", uvs, (len(places), 2))
        crease = float(floats("crease_deg", crease_deg, ()))
        if not 0.0 <= crease <= 180.0:
            raise InputError(f"crease_deg: is {crease}, but must be from 0 to 180")
        self._scene.add(
            str(name),
            places.tobytes(),
            triangles.tobytes(),
            None if directions is None else directions.tobytes(),
            None if coordinates is None else coordinates.tobytes(),
            crease,
            (material or Material(name=str(name)))._record(),
            floats("world_from_local", world_from_local, (4, 4)).tolist(),
        )

    def add_mesh(
        self,
        mesh: Any,
        *,
        material: Material | None = None,
        world_from_local: Any = IDENTITY,
        crease_deg: float = 30.0,
        name: str = "mesh",
    ) -> None:
        """Adds what has ``vertices`` and ``faces`` (trimesh), or ``points`` (PyVista).

        A scene of trimesh adds each of its meshes. Of PyVista's data sets it is the surface, in
        triangles. Colours are not read: give the material.
        """
        for positions, indices in _triangles(mesh):
            self.add(
                positions,
                indices,
                material=material,
                world_from_local=world_from_local,
                crease_deg=crease_deg,
                name=name,
            )

    def copy(self) -> Scene:
        """A copy, whose edits leave this one as it is; it shares memory until then."""
        return Scene._of(self._scene.copy())

    def __reduce__(self) -> Any:
        """Scenes travel to other processes and machines as GLB."""
        with TemporaryDirectory() as folder:
            file = os.path.join(folder, "scene.glb")
            self._scene.save_glb(file)
            with open(file, "rb") as opened:
                # Files store directions as rotations, which rounds them.
                return _of_glb, (opened.read(), self.lights, self.cameras)

    def save(self, path: Path) -> None:
        """Writes a ``.glb`` file (glTF 2.0), which loads as the same scene again."""
        path = os.fspath(path)
        if not path.lower().endswith(".glb"):
            raise InputError(f"path: is {path}, but must end with .glb")
        self._scene.save_glb(path)

    @property
    def name(self) -> str:
        """The built-in scene's name, or the file's without its extension."""
        return self._scene.name

    @property
    def triangles(self) -> int:
        """The number of triangles that are drawn."""
        return self._scene.triangles

    @property
    def origin(self) -> tuple[float, float, float]:
        """Where the scene's zero lies in the file's coordinates, m: zero, but for places on a map, which 32-bit floats cannot hold.

        All positions count from there.
        """
        x, y, z = self._scene.origin
        return x, y, z

    @property
    def warnings(self) -> list[str]:
        """Sentences on what was ignored or replaced in the file."""
        return self._scene.warnings

    @property
    def bounds(self) -> Corners | None:
        """The lower and the upper corner of the box around it, m; ``None`` without triangles."""
        corners = self._scene.bounds
        return None if corners is None else (vector("low", corners[0]), vector("high", corners[1]))

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """The cameras; may be set."""
        return tuple(map(Camera._of, self._scene.cameras))

    @cameras.setter
    def cameras(self, cameras: Iterable[Camera]) -> None:
        self._scene.set_cameras([camera._record() for camera in cameras])

    @property
    def animations(self) -> tuple[Animation, ...]:
        """The animations of the file that it was loaded from."""
        return tuple(Animation(*known) for known in self._scene.animations)

    def pose(self, time_s: float, animation: AnimationLike = 0) -> None:
        """Shows the scene ``time_s`` seconds into an animation: a number, a name, or ``"all"``.

        Nothing repeats: before its start and after its end it stands still. The file's instances,
        lights and cameras move; what was added, and other lights and cameras that replaced the
        file's, stay.
        """
        self._scene.pose(seconds("time_s", time_s), animation_number(self.animations, animation))

    def bounds_over(self, times_s: Any, animation: AnimationLike = 0) -> Corners:
        """The box around its poses at some times (N,), s: ``bounds`` for a :class:`Renderer`."""
        times, posed, corners = floats("times_s", times_s, (None,)), self.copy(), []
        if times.size == 0:
            raise InputError("times_s: has none")
        for time_s in times.tolist():
            posed.pose(time_s, animation)
            corners += list(posed.bounds or ())
        if not corners:
            raise InputError(f"the scene {self.name!r} has no triangles")
        return vector("low", np.min(corners, axis=0)), vector("high", np.max(corners, axis=0))

    @property
    def lights(self) -> tuple[Light, ...]:
        """The lamps and suns; may be set, as in ``scene.lights += (Light(intensity=100),)``."""
        return tuple(map(Light._of, self._scene.lights))

    @lights.setter
    def lights(self, lights: Iterable[Light]) -> None:
        self._scene.set_lights([light._record() for light in lights])

    @property
    def materials(self) -> tuple[Material, ...]:
        """The materials; :meth:`set_material` changes one."""
        return tuple(map(Material._of, self._scene.materials))

    def set_material(self, which: int | str, **changes: Any) -> None:
        """Changes fields of the material of a number or a name: ``roughness=0.2``."""
        index, material = _find("material", self.materials, which)
        self._scene.set_material(index, _changed("Material", material, changes)._record())

    @property
    def instances(self) -> tuple[Instance, ...]:
        """The instances; :meth:`set_instance` changes one."""
        return tuple(map(Instance._of, self._scene.instances))

    def set_instance(self, which: int | str, **changes: Any) -> None:
        """Changes fields of the instance of a number or a name: ``hidden=True``."""
        index, instance = _find("instance", self.instances, which)
        self._scene.set_instance(index, _changed("Instance", instance, changes)._record())

    @property
    def environment(self) -> tuple[float, ...]:
        """The radiance of the surroundings in cd/m2, RGB; with a map, the factor of its texels."""
        return tuple(self._scene.environment[0])

    def set_environment(
        self, radiance: Any = 1.0, *, map: Any = None, rotation_deg: float = 0.0
    ) -> None:
        """Sets the surroundings: ``radiance`` in cd/m2, RGB or grey.

        With a ``map``, a file (.hdr, .exr, .png, .jpg) or an array (H, W, 3), it is the factor of
        its texels: longitude by latitude, -z in the middle, turned counter-clockwise about y.
        """
        factor = color("radiance", radiance)
        turn = float(floats("rotation_deg", rotation_deg, ()))
        file, width, texels = None, 0, None
        if isinstance(map, (str, os.PathLike)):
            file = os.fspath(map)
        elif map is not None:
            pixels = floats("map", map, (None, None, 3))
            width, texels = pixels.shape[1], pixels.tobytes()
            if pixels.size == 0:
                raise InputError("map: has no texels")
        self._scene.set_environment(factor, turn, file, width, texels)

    def set_sky(
        self,
        towards_sun: Any = None,
        *,
        elevation_deg: float = 45.0,
        azimuth_deg: float = 0.0,
        turbidity: float = 2.0,
    ) -> None:
        """Sets the surroundings to a clear sky with its sun, in cd/m2 and lux.

        The sun is in the direction ``towards_sun``, or at an elevation and an azimuth (0 is
        towards -z, 90 towards +x). ``turbidity`` is the haze, from 1 (the clearest) to 10. The
        sun takes the place of all directional lights, which are suns, too.
        """
        if towards_sun is None:
            high = np.radians(float(floats("elevation_deg", elevation_deg, ())))
            around = np.radians(float(floats("azimuth_deg", azimuth_deg, ())))
            towards_sun = (
                np.cos(high) * np.sin(around),
                np.sin(high),
                -np.cos(high) * np.cos(around),
            )
        haze = float(floats("turbidity", turbidity, ()))
        self._scene.set_sky(vector("towards_sun", towards_sun), haze)

    def __repr__(self) -> str:
        return f"<lumivox.Scene {self.name!r}: {self.triangles} triangles>"


def seconds(name: str, value: Any) -> float:
    """``value`` as a time in seconds."""
    return float(floats(name, value, ()))


def animation_number(known: Sequence[Animation], which: AnimationLike) -> int | None:
    """The number of an animation; ``None`` is all of them."""
    if isinstance(which, str):
        names = [animation.name for animation in known]
        if which in names:
            return names.index(which)
        if which == "all" and known:
            return None
    elif isinstance(which, (int, np.integer)) and 0 <= which < len(known):
        return int(which)
    listed = ", ".join(f"{number} {item.name!r}" for number, item in enumerate(known)) or "none"
    raise InputError(f"the scene has no animation {which!r}; there are: {listed}")


def _of_glb(data: bytes, lights: Iterable[Light], cameras: Iterable[Camera]) -> Scene:
    with TemporaryDirectory() as folder:
        file = os.path.join(folder, "scene.glb")
        with open(file, "wb") as opened:
            opened.write(data)
        scene = Scene.load(file)
    scene.lights, scene.cameras = tuple(lights), tuple(cameras)
    return scene


def _triangles(mesh: Any) -> list[tuple[Any, Any]]:
    """The positions and the triangles of an object of trimesh or PyVista."""
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):
        return [(mesh.vertices, mesh.faces)]
    if hasattr(mesh, "geometry") and hasattr(mesh, "dump"):
        return [pair for part in mesh.dump() for pair in _triangles(part)]
    if hasattr(mesh, "points") and (hasattr(mesh, "faces") or hasattr(mesh, "extract_surface")):
        surface = mesh if hasattr(mesh, "faces") else mesh.extract_surface()
        flat = numbers("faces", surface.triangulate().faces, (None,))
        return [(surface.triangulate().points, flat.reshape(-1, 4)[:, 1:])]
    raise InputError(
        f"mesh: is a {type(mesh).__name__}, but must have vertices and faces (trimesh), or points "
        "(PyVista); arrays go to Scene.add"
    )


def _find(what: str, items: Sequence[Record], which: int | str) -> tuple[int, Record]:
    if isinstance(which, str):
        names = [getattr(item, "name") for item in items]
        if which in names:
            index = names.index(which)
            return index, items[index]
        like = get_close_matches(which, names, 1)
        remedy = f"; did you mean {like[0]!r}?" if like else f"; there are {names}"
        raise InputError(f"there is no {what} {which!r}{remedy}")
    if not 0 <= which < len(items):
        raise InputError(f"there is no {what} {which}; the scene has {len(items)}, from 0")
    return int(which), items[which]


def _changed(what: str, item: Record, changes: dict[str, Any]) -> Record:
    try:
        return replace(item, **changes)
    except TypeError:
        known = list(item._record())
        wrong = [name for name in changes if name not in known]
        if not wrong:
            raise
        like = get_close_matches(wrong[0], known, 1)
        remedy = f"; did you mean {like[0]!r}?" if like else f"; it has {', '.join(known)}"
        raise InputError(f"{what} has no {wrong[0]!r}{remedy}") from None
