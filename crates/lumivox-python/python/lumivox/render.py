"""Rendering by cones: pictures from one camera or many, and irradiance at points."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from . import _lumivox
from ._arrays import floats, size_of, vector, view, whole
from ._records import Camera
from .errors import InputError
from .light import Irradiance, photometric, places
from .picture import Picture
from .scene import AnimationLike, Corners, Progress, Scene, animation_number, seconds

#: The layers beside the radiance. ``direct``, ``indirect`` and ``specular`` are in cd/m2,
#: ``irradiance`` is in lux; they are (H, W, 3). ``occlusion`` and ``shadow`` (H, W) and ``albedo``
#: (H, W, 3) are from 0 to 1. ``normal`` (H, W, 3) is in the world, ``depth`` (H, W) in metres. All
#: of these are float32, means over the frames, 0 in the background. ``instance`` and ``material``
#: (H, W) int32 are the numbers at the middle of the pixel, -1 in the background. ``motion``
#: (H, W, 2) float32 is the movement of the point seen there since the previous picture, in pixels
#: to the right and down: 0 in the first picture, NaN where it was behind the camera.
LAYERS: tuple[str, ...] = (
    *("direct", "indirect", "specular"),
    "irradiance",
    *("occlusion", "shadow", "albedo"),
    *("normal", "depth"),
    *("instance", "material", "motion"),
)

CameraLike = Camera | str | int
#: Cameras, or one for all pictures.
Cameras = CameraLike | None | Iterable[CameraLike]
#: The cameras of N pictures, and their times, s.
Views = Sequence[CameraLike | None]
Times = Sequence[float | None]
Moment = tuple[CameraLike | None, float | None]


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


def moments(cameras: Cameras, times_s: Any) -> tuple[Views, Times]:
    """N cameras, and as many times or ``None``."""
    is_one = cameras is None or isinstance(cameras, (Camera, str, int))
    views: list[CameraLike | None] = [cameras] if is_one else list(cameras)  # type: ignore
    for view in views:
        _camera(view)
    times: list[float | None] = [None] * len(views)
    if times_s is not None:
        times = floats("times_s", times_s, (None,)).tolist()
        if is_one:
            views *= len(times)
    if len(views) != len(times):
        raise InputError(f"times_s: has {len(times)} times, but there are {len(views)} cameras")
    if not views:
        raise InputError("cameras: has none")
    return views, times


def _corners(bounds: Any) -> Corners:
    corners = floats("bounds", bounds, (2, 3))
    if not (corners[0] <= corners[1]).all():
        raise InputError("bounds: the first corner must be the lower one")
    return vector("bounds", corners[0]), vector("bounds", corners[1])


class Renderer:
    """A scene on the GPU, with its voxels and their light, for pictures from any number of cameras.

    ``camera`` is a :class:`Camera`, the name or number of one of the scene's, or a text as on the
    command line (``"framing"``, ``"inside"``, ``"PX,PY,PZ,TX,TY,TZ"``); by default the scene's
    first, else one that shows it well. ``size`` is (width, height). ``layers`` are names of
    :data:`LAYERS`. ``surroundings`` is ``"auto"`` (light is added if the scene has too little, as
    the program does), ``"studio"``, ``"sky"`` or ``"none"``. ``time_s`` shows a time of an
    ``animation``, as :meth:`pose`. ``bounds`` are two corners, m, of the box in which light is
    computed, by default the scene's: things that move should stay in it
    (:meth:`Scene.bounds_over`). ``adapter`` is part of a GPU's name. ``progress`` is called with a
    stage, the steps done and their number.

    Further arguments are settings, with the names and values of the command line (``_`` for ``-``):
    ``frames=16``, ``resolution=128``, ``preset="high"``; :func:`settings` lists them.

    The result of a picture does not depend on those before it, but for the layer ``motion``.
    Threads may share a renderer; they take turns.
    """

    def __init__(
        self,
        scene: Scene,
        camera: CameraLike | None = None,
        size: tuple[int, int] = (640, 360),
        *,
        layers: Iterable[str] = (),
        surroundings: str = "auto",
        time_s: float | None = None,
        animation: AnimationLike = 0,
        bounds: Any = None,
        adapter: str | None = None,
        progress: Progress | None = None,
        **settings: Any,
    ) -> None:
        names = [layers] if isinstance(layers, str) else list(layers)
        shown = _scene(scene)
        self._take(scene)
        time = None if time_s is None else self._time(time_s, animation)
        given = [(name, _text(name, value)) for name, value in settings.items()]
        self._size = size_of("size", size)
        self._adapter = adapter
        self._renderer = _lumivox.Renderer(
            shown,
            _camera(camera),
            self._size,
            given,
            list(dict.fromkeys(names)),
            surroundings,
            None if bounds is None else _corners(bounds),
            time,
            adapter,
            progress,
        )
        self._take_settings()

    def render(self, camera: CameraLike | None = None, progress: Progress | None = None) -> Picture:
        """A picture from a camera, by default from the last one."""
        return self._picture(self._renderer.render(_camera(camera), progress))

    def refine(
        self, frames: int = 1, camera: CameraLike | None = None, progress: Progress | None = None
    ) -> Picture:
        """The mean of the last picture and ``frames`` more frames, for views that get better while
        they are shown. A ``camera``, or a change of scene or settings, begins a new mean."""
        count = whole("frames", frames, 1, 65536)
        return self._picture(self._renderer.refine(count, _camera(camera), progress))

    def set_settings(
        self, size: tuple[int, int] | None = None, progress: Progress | None = None, **settings: Any
    ) -> None:
        """Changes the size of pictures and any settings, without redoing what does not depend on
        them. Settings that are not named stay."""
        given = [(name, _text(name, value)) for name, value in settings.items()]
        wanted = self._size if size is None else size_of("size", size)
        self._renderer.set_settings(wanted, given, progress)
        self._size = wanted
        self._take_settings()

    def _take_settings(self) -> None:
        own = dict(self._renderer.settings)
        self._screen = (own["exposure"], own["tone_map"])

    def _picture(self, made: list[tuple[str, bytearray, int, str]]) -> Picture:
        width, height = self._size
        arrays: dict[str, npt.NDArray[Any]] = {}
        for name, data, channels, kind in made:
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

    def _take(self, scene: Scene) -> None:
        self._animations = scene.animations
        self._has_cameras = bool(scene.cameras)

    def _time(self, time_s: float, animation: AnimationLike) -> tuple[float, int | None]:
        return seconds("time_s", time_s), animation_number(self._animations, animation)

    def pose(self, time_s: float, animation: AnimationLike = 0) -> None:
        """Shows the scene at a time of an animation, as :meth:`Scene.pose`. Voxels that have not
        moved stay."""
        self._renderer.pose(*self._time(time_s, animation))

    def pictures(
        self, cameras: Cameras, times_s: Any = None, animation: AnimationLike = 0
    ) -> Iterator[Picture]:
        """The pictures from many cameras, one after the other: ``tqdm(renderer.pictures(...))``.

        With ``times_s`` (N,), s, each is that of a time of an ``animation``, and one camera may stand
        for all; a camera that is named moves as the scene's does.
        """
        return self._pictures(*moments(cameras, times_s), animation, None)

    def _pictures(
        self, views: Views, times_s: Times, animation: AnimationLike, before: Moment | None
    ) -> Iterator[Picture]:
        """``before`` is the moment that the first picture's motion is told from."""
        self._renderer.start_motion(None)
        if before is not None:
            camera = self._at(*before, animation)
            self._renderer.start_motion(_camera(self.camera if camera is None else camera))
        for moment in zip(views, times_s):
            yield self.render(self._at(*moment, animation))

    def _at(
        self, camera: CameraLike | None, time_s: float | None, animation: AnimationLike
    ) -> CameraLike | None:
        """Shows a time; the camera that is meant then."""
        if time_s is None:
            return camera
        self.pose(time_s, animation)
        return 0 if camera is None and self._has_cameras else camera

    def render_many(
        self,
        cameras: Cameras,
        times_s: Any = None,
        animation: AnimationLike = 0,
        progress: Progress | None = None,
    ) -> dict[str, npt.NDArray[Any]]:
        """The N pictures of :meth:`pictures` as arrays: ``radiance`` (N, H, W, 3), ``coverage`` and
        the layers (N, H, W) or (N, H, W, C). ``progress`` is called after each picture."""
        return self._stack(*moments(cameras, times_s), animation, None, progress)

    def _stack(
        self,
        views: Views,
        times_s: Times,
        animation: AnimationLike,
        before: Moment | None,
        progress: Progress | None,
    ) -> dict[str, npt.NDArray[Any]]:
        stacked: dict[str, npt.NDArray[Any]] = {}
        for number, picture in enumerate(self._pictures(views, times_s, animation, before)):
            parts = {"radiance": picture.radiance, "coverage": picture.coverage, **picture.layers}
            for name, part in parts.items():
                if name not in stacked:
                    stacked[name] = np.empty((len(views), *part.shape), part.dtype)
                stacked[name][number] = part
            if progress is not None:
                progress("pictures", number + 1, len(views))
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
        and redoes only what depends on the difference. The grid stays as it is."""
        self._renderer.update(_scene(scene), progress)
        self._take(scene)

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
    time_s: float | None = None,
    animation: AnimationLike = 0,
    bounds: Any = None,
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
        time_s=time_s,
        animation=animation,
        bounds=bounds,
        adapter=adapter,
        progress=progress,
        **settings,
    )
    return renderer.render(progress=progress)


def render_many(
    scene: Scene,
    cameras: Cameras,
    size: tuple[int, int] = (256, 256),
    *,
    times_s: Any = None,
    animation: AnimationLike = 0,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, npt.NDArray[Any]]:
    """N pictures as arrays (N, H, W, C), with one set of voxels for all: those of
    :meth:`Renderer.render_many`. ``options`` are further arguments of :class:`Renderer`. With
    ``times_s`` light is computed in the box around all poses, unless ``bounds`` are given."""
    views, times = moments(cameras, times_s)
    options = {"size": size, "progress": progress, **options}
    return of_moments(scene, views, times, animation, options)._stack(views, times, animation, None, progress)


def of_moments(
    scene: Scene, views: Views, times_s: Times, animation: AnimationLike, options: dict[str, Any]
) -> Renderer:
    """The renderer of pictures of some times: it begins with the first."""
    _scene(scene)
    if times_s[0] is not None:
        around = {"time_s": times_s[0], "animation": animation}
        options = {"bounds": scene.bounds_over(times_s, animation), **around, **options}
    return Renderer(scene, views[0], **options)
