"""A scene on the device: takes each state of it with the least work, and makes pictures."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from . import backdrop, changes, glb, model
from .changes import Change
from .translate.camera import View
from .units import nits

Box = tuple[tuple[float, ...], tuple[float, ...]]
Progress = Callable[[str, float, int], object]

#: A scene whose longest edge is below this share of that of its voxels' box gets a box of its own.
SMALLER = 0.5


class Session:
    """Keeps a scene and its voxels on the device from one picture to the next."""

    def __init__(self) -> None:
        self.data: model.Scene | None = None
        self.scene: Any = None
        self.renderer: Any = None
        #: The work that the last :meth:`show` did, for tests.
        self.last_change = Change.NOTHING
        self._settings: dict[str, Any] = {}
        self._layers: frozenset[str] = frozenset()
        self._box: Box | None = None
        self._grid: Box | None = None
        self._view: View | None = None

    def show(
        self,
        data: model.Scene,
        view: View,
        settings: Mapping[str, Any],
        layers: Iterable[str] = (),
        box: Box | None = None,
        progress: Progress | None = None,
    ) -> Change:
        """Shows a state of the scene in pictures of a view. ``layers`` are Lumivox's; ``box`` is
        where light is computed, by default around the scene.

        If it is stopped or fails, the next call builds everything again.
        """
        wanted = frozenset(layers)
        change = changes.between(self.data, data)
        if self.renderer is None or not wanted <= self._layers or box != self._box:
            change = Change.SCENE
        # This may be stopped half way.
        before, self.data = self.data, None
        if not data.instances:
            # Lumivox takes no scene without surfaces.
            self.renderer = self.scene = None
            self._layers, self._box = wanted, box
        elif change == Change.SCENE:
            self._build(data, wanted, view, settings, box, progress)
        else:
            old_grid, is_new = self._grid, not self._settings.keys() <= settings.keys()
            if change > Change.NOTHING:
                _edit(self.scene, before, data)
                self._grid = self._fitting(settings)
            if is_new:
                # A renderer keeps settings that are not named.
                self._grid = box or self.scene.bounds
            if is_new or self._grid != old_grid:
                change = Change.SCENE
                self._start(view, settings, progress)
            else:
                if change > Change.NOTHING:
                    self.renderer.update(self.scene, progress)
                if view.canvas != self.renderer.size or settings != self._settings:
                    self.renderer.set_settings(view.canvas, progress, **settings)
        self._settings = dict(settings)
        self.data, self.last_change = data, change
        return change

    def picture(self, view: View, progress: Progress | None = None) -> Any:
        """A picture with all frames of the settings."""
        if self.renderer is None:
            return self._without_surfaces(view)
        return self.renderer.render(_camera(view), progress)

    def refine(self, frames: int, view: View | None, progress: Progress | None = None) -> Any:
        """The last picture with more frames; with a view, the first frames of a new one."""
        if view is not None:
            self._view = view
        if self.renderer is None:
            return self._without_surfaces(self._view)
        camera = None if view is None else _camera(view)
        return self.renderer.refine(frames, camera, progress)

    def samples_of_pixels(self, view: View, progress: Progress | None = None) -> Any:
        """A picture of one frame, whose layers are those of the middles of pixels."""
        if self.renderer is None:
            return self._without_surfaces(view)
        frames = self._settings.get("frames", 16)
        self.renderer.set_settings(progress=progress, frames=1)
        try:
            return self.renderer.render(_camera(view), progress)
        finally:
            self.renderer.set_settings(frames=frames)

    def _without_surfaces(self, view: View) -> Any:
        assert self.data is not None
        return backdrop.picture(view, self.data.world, self._layers)

    def _build(
        self,
        data: model.Scene,
        layers: frozenset[str],
        view: View,
        settings: Mapping[str, Any],
        box: Box | None,
        progress: Progress | None,
    ) -> None:
        self.renderer = self.scene = None
        self._layers, self._box = layers, box
        self.scene = load(data, progress)
        self._grid = box or self.scene.bounds
        self._start(view, settings, progress)

    def _start(self, view: View, settings: Mapping[str, Any], progress: Progress | None) -> None:
        import lumivox

        # Free the memory of the old one first.
        self.renderer = None
        bounds = None if self._grid == self.scene.bounds else self._grid
        self.renderer = lumivox.Renderer(
            self.scene,
            _camera(view),
            view.canvas,
            layers=sorted(self._layers),
            surroundings="none",
            bounds=bounds,
            progress=progress,
            **settings,
        )

    def _fitting(self, settings: Mapping[str, Any]) -> Box | None:
        """The box of voxels for the scene as it is now: the last one if it still fits."""
        bounds = self.scene.bounds
        if self._box is not None or bounds is None or settings.get("volume") == "cascades":
            return self._grid
        (low, high), (least, most) = bounds, self._grid
        longest = max(b - a for a, b in zip(least, most))
        if max(b - a for a, b in zip(low, high)) < SMALLER * longest:
            return bounds
        slack = 1e-3 * longest
        leaves = any(a < b - slack for a, b in zip(low, least)) or any(
            a > b + slack for a, b in zip(high, most)
        )
        return _union(self._grid, bounds) if leaves else self._grid


def load(data: model.Scene, progress: Progress | None = None) -> Any:
    """A scene of Lumivox."""
    import lumivox

    with TemporaryDirectory(prefix="lumivox") as folder:
        path = Path(folder) / "scene.glb"
        path.write_bytes(glb.write(data))
        scene = lumivox.Scene.load(path, progress=progress)
    placed = scene.instances
    if len(placed) != len(data.instances) or len(scene.materials) < len(data.materials):
        raise RuntimeError(
            f"{data.name}: Lumivox has read {len(placed)} of {len(data.instances)} instances; please report it with the file"
        )
    scene.lights = [lumivox.Light(**light) for light in data.lights]
    _surround(scene, data.world)
    return scene


def _edit(scene: Any, old: model.Scene | None, new: model.Scene) -> None:
    """Changes what differs between two states that have the same parts."""
    import lumivox

    assert old is not None
    if old.lights != new.lights:
        scene.lights = [lumivox.Light(**light) for light in new.lights]
    if old.world != new.world:
        _surround(scene, new.world)
    for number, (before, after) in enumerate(zip(old.materials, new.materials)):
        if before != after:
            fields = {name: getattr(after, name) for name in changes.EDITABLE}
            fields["emissive"] = tuple(nits(channel) for channel in after.emissive)
            scene.set_material(number, **fields)
    for number, (before, after) in enumerate(zip(old.instances, new.instances)):
        if (before.matrix, before.material) != (after.matrix, after.material):
            scene.set_instance(
                number, world_from_local=after.matrix, material=after.material
            )


def _surround(scene: Any, world: model.World) -> None:
    factor = tuple(nits(channel) for channel in world.radiance)
    scene.set_environment(factor, map=world.panorama, rotation_deg=world.rotation_deg)


def _camera(view: View) -> Any:
    import lumivox

    return view.camera(lumivox)


def _union(a: Box | None, b: Box | None) -> Box | None:
    if a is None or b is None:
        return a or b
    low, high = np.minimum(a[0], b[0]), np.maximum(a[1], b[1])
    return tuple(low.tolist()), tuple(high.tolist())
