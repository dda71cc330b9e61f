"""Rendering by cones: pictures from one camera or many, and irradiance at points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _lumivox
from ._arrays import size_of, view, whole
from ._records import Camera
from .errors import InputError
from .light import Irradiance, photometric, places
from .picture import Picture
from .scene import Progress, Scene

#: The layers beside the radiance. Those of the first line are in cd/m2, and ``irradiance`` is in
#: lux; they are (H, W, 3). Then 0 to 1: ``occlusion`` and ``shadow`` (H, W), ``albedo`` (H, W, 3).
#: ``normal`` (H, W, 3) is in the world, ``depth`` (H, W) in metres. All of these are float32, means
#: over the frames, 0 in the background. ``instance`` and ``material`` (H, W) int32 are the numbers
#: at the middle of the pixel, -1 in the background.
LAYERS: tuple[str, ...] = (
    *("direct", "indirect", "specular"),
    "irradiance",
    *("occlusion", "shadow", "albedo"),
    *("normal", "depth"),
    *("instance", "material"),
)

CameraLike = Camera | str | int


def settings() -> list[dict[str, str]]:
    """The table of settings: of each its name, group, unit, values, meaning and default."""
    keys = ("name", "group", "unit", "values", "summary", "default")
    return [dict(zip(keys, row)) for row in _lumivox.table()]


def _text(name: str, value: Any) -> str:
    """A value as it is written on the command line."""
    if isinstance(value, (bool, np.bool_)):
        return "on" if value else "off"
    if isinstance(value, (str, int, np.integer)):
        return str(value)
    if isinstance(value, (float, np.floating)):
        return repr(float(value))
    if isinstance(value, (Sequence, np.ndarray)):
        return ",".join(_text(name, item) for item in value)
    raise InputError(f"{name}: is a {type(value).__name__}, but must be a number, a word or a vector")


def _camera(camera: CameraLike | None) -> Any:
    if camera is None or isinstance(camera, str):
        return camera
    if isinstance(camera, Camera):
        return camera._record()
    if isinstance(camera, (int, np.integer)) and not isinstance(camera, bool):
        return str(camera)
    raise InputError(f"camera: is a {type(camera).__name__}, but must be a Camera, a name or a number")


def _scene(scene: Any) -> _lumivox.Scene:
    if not isinstance(scene, Scene):
        kind = type(scene).__name__
        raise InputError(f"scene: is a {kind}, but must be a lumivox.Scene (Scene.load reads a file)")
    return scene._scene


class Renderer:
    """A scene on the GPU, with its voxels and their light, for pictures from any number of cameras.

    ``camera`` is a :class:`Camera`, the name or number of one of the scene's, or a text as on the
    command line (``"framing"``, ``"inside"``, ``"PX,PY,PZ,TX,TY,TZ"``); by default the scene's
    first, else one that shows it well. ``size`` is (width, height). ``layers`` are names of
    :data:`LAYERS`. ``surroundings`` is ``"auto"`` (light is added if the scene has too little, as
    the program does), ``"studio"``, ``"sky"`` or ``"none"``. ``adapter`` is part of a GPU's name.
    ``progress`` is called with a stage, the steps done and their number.

    Further arguments are settings, with the names and values of the command line (``_`` for ``-``):
    ``frames=16``, ``resolution=128``, ``preset="high"``; :func:`settings` lists them.

    The result of a picture does not depend on those before it. Threads may share a renderer; they
    take turns.
    """

    def __init__(
        self,
        scene: Scene,
        camera: CameraLike | None = None,
        size: tuple[int, int] = (640, 360),
        *,
        layers: Iterable[str] = (),
        surroundings: str = "auto",
        adapter: str | None = None,
        progress: Progress | None = None,
        **settings: Any,
    ) -> None:
        names = [layers] if isinstance(layers, str) else list(layers)
        given = [(name, _text(name, value)) for name, value in settings.items()]
        self._size = size_of("size", size)
        self._adapter = adapter
        self._renderer = _lumivox.Renderer(
            _scene(scene),
            _camera(camera),
            self._size,
            given,
            list(dict.fromkeys(names)),
            surroundings,
            adapter,
            progress,
        )
        own = dict(self._renderer.settings)
        self._screen = (own["exposure"], own["tone_map"])

    def render(self, camera: CameraLike | None = None, progress: Progress | None = None) -> Picture:
        """A picture from a camera, by default from the last one."""
        width, height = self._size
        arrays: dict[str, npt.NDArray[Any]] = {}
        for name, data, channels, kind in self._renderer.render(_camera(camera), progress):
            arrays[name] = view(data, kind, height, width, channels)
        radiance, coverage = arrays.pop("radiance"), arrays.pop("coverage")
        exposure, tone_map = self._screen
        return Picture(
            radiance,
            coverage=coverage,
            layers=arrays,
            exposure=exposure,
            tone_map=tone_map,
            adapter=self._adapter,
        )

    def pictures(self, cameras: Iterable[CameraLike]) -> Iterator[Picture]:
        """The pictures from many cameras, one after the other: ``tqdm(renderer.pictures(...))``."""
        for camera in cameras:
            yield self.render(camera)

    def render_many(
        self, cameras: Iterable[CameraLike], progress: Progress | None = None
    ) -> dict[str, npt.NDArray[Any]]:
        """The pictures from N cameras as arrays: ``radiance`` (N, H, W, 3), ``coverage`` and the
        layers (N, H, W) or (N, H, W, 3). ``progress`` is called after each picture."""
        views = list(cameras)
        stacked: dict[str, npt.NDArray[Any]] = {}
        for number, picture in enumerate(self.pictures(views)):
            parts = {"radiance": picture.radiance, "coverage": picture.coverage, **picture.layers}
            for name, part in parts.items():
                if name not in stacked:
                    stacked[name] = np.empty((len(views), *part.shape), part.dtype)
                stacked[name][number] = part
            if progress is not None:
                progress("pictures", number + 1, len(views))
        if not stacked:
            raise InputError("cameras: has none")
        return stacked

    def irradiance(self, points: Any, normals: Any = (0.0, 1.0, 0.0), frames: int = 16) -> Irradiance:
        """The irradiance at points, as of a lux meter, by cones.

        ``points`` is (..., 3) in metres, on surfaces or in the air; ``normals`` has the same shape,
        or is one for all. More ``frames`` (1 to 65536) mean less noise. :class:`Irradiance` has the
        result in lux.
        """
        array, towards = places("points", points, "normals", normals)
        frames = whole("frames", frames, 1, 65536)
        data = self._renderer.irradiance(array.tobytes(), np.ascontiguousarray(towards).tobytes(), frames)
        gathered = np.frombuffer(data, np.float32).reshape(*array.shape[:-1], 7)
        direct, indirect = gathered[..., 0:3], gathered[..., 3:6]
        return Irradiance(direct, indirect, gathered[..., 6], photometric(direct + indirect), None)

    def faces(self) -> dict[str, npt.NDArray[Any]]:
        """The faces of the voxels with their light, N of them: what cones see.

        ``position`` (N, 3) is the mean of the surface in the world, m; ``vector_area`` (N, 3) the sum
        of area times normal, m2; ``axis`` (N,) the axis that it faces (+x, -x, +y, -y, +z, -z as 0 to
        5); ``cell`` (N, 3) the voxel's place in the grid, int32, which several faces may share.
        ``reflectance`` (N, 3) is 0 to 1; ``emission`` and ``radiance`` (N, 3) are in cd/m2. The
        radiance is what the last gather finds: it has one bounce less than the setting ``bounces``.
        """
        arrays: dict[str, npt.NDArray[Any]] = {}
        for name, data, channels, kind in self._renderer.faces():
            flat = np.frombuffer(data, np.dtype("<" + kind))
            arrays[name] = flat if channels == 1 else flat.reshape(-1, channels)
        return arrays

    def update(self, scene: Scene, progress: Progress | None = None) -> None:
        """Shows other lights, surroundings, materials or places of instances of the same scene,
        without compiling and uploading everything again. The grid stays as it is."""
        self._renderer.update(_scene(scene), progress)

    @property
    def camera(self) -> Camera:
        """The camera of the last picture, or of the next one."""
        return Camera._of(self._renderer.camera)

    @property
    def size(self) -> tuple[int, int]:
        """Width and height in pixels."""
        return self._size

    @property
    def settings(self) -> dict[str, str]:
        """All settings that have an effect, as texts of the command line."""
        return dict(self._renderer.settings)

    @property
    def notes(self) -> list[str]:
        """Sentences on what was chosen: camera and light."""
        return self._renderer.notes

    @property
    def voxels(self) -> int:
        """The number of occupied voxels."""
        return self._renderer.voxels

    @property
    def voxel_size_m(self) -> float:
        """The edge of a voxel, m."""
        return self._renderer.voxel_size_m

    @property
    def adapter(self) -> str:
        """The GPU and its driver."""
        return self._renderer.adapter

    def __repr__(self) -> str:
        width, height = self._size
        return f"<lumivox.Renderer: {width} x {height}, {self.voxels} voxels, {self.adapter}>"


def render(
    scene: Scene,
    camera: CameraLike | None = None,
    size: tuple[int, int] = (640, 360),
    *,
    layers: Iterable[str] = (),
    surroundings: str = "auto",
    adapter: str | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> Picture:
    """A picture of a scene; the arguments are those of :class:`Renderer`."""
    renderer = Renderer(
        scene,
        camera,
        size,
        layers=layers,
        surroundings=surroundings,
        adapter=adapter,
        progress=progress,
        **settings,
    )
    return renderer.render(progress=progress)


def render_many(
    scene: Scene,
    cameras: Iterable[CameraLike],
    size: tuple[int, int] = (256, 256),
    *,
    layers: Iterable[str] = (),
    surroundings: str = "auto",
    adapter: str | None = None,
    progress: Progress | None = None,
    **settings: Any,
) -> dict[str, Any]:
    """Pictures from N cameras as arrays (N, H, W, C), with one set of voxels for all; the
    arguments are those of :class:`Renderer`, the result that of :meth:`Renderer.render_many`."""
    views = list(cameras)
    if not views:
        raise InputError("cameras: has none")
    renderer = Renderer(
        scene,
        views[0],
        size,
        layers=layers,
        surroundings=surroundings,
        adapter=adapter,
        progress=progress,
        **settings,
    )
    return renderer.render_many(views, progress)
