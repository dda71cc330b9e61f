"""The render engine: renders, animations and viewports."""

from __future__ import annotations

import traceback
import weakref
from collections.abc import Callable
from typing import Any

import bpy
import numpy as np

from . import passes, status
from .passes import Moment
from .properties import box_of, settings_of
from .session import Session
from .translate import Reader
from .translate.camera import View, of_object, of_region
from .translate.scene import key_of
from .units import place
from .viewport import Request, Viewport


class Cancelled(Exception):
    """The user has stopped the render."""


class _Kept:
    """What stays from one frame of an animation to the next."""

    def __init__(self) -> None:
        self.session: Session | None = None
        self.reader: Reader | None = None

    def take(self) -> tuple[Session, Reader]:
        if self.session is None or self.reader is None:
            self.session, self.reader = Session(), Reader()
        return self.session, self.reader

    def drop(self) -> None:
        self.session = self.reader = None


KEPT = _Kept()


@bpy.app.handlers.persistent
def _drop(*_: Any) -> None:
    KEPT.drop()


class _History:
    """Counts what Blender replaces without telling viewports what has changed: undo and files."""

    count = 0


@bpy.app.handlers.persistent
def _replace(*_: Any) -> None:
    _History.count += 1


def explain(error: Exception) -> str:
    """A message about an error, with its remedy."""
    import lumivox

    if isinstance(error, (lumivox.Error, ValueError, RuntimeError)):
        return f"Lumivox: {error}"
    return f"Lumivox: {type(error).__name__}: {error}"


class LumivoxEngine(bpy.types.RenderEngine):
    """Lumivox beside Cycles and EEVEE."""

    bl_idname = "LUMIVOX"
    bl_label = "Lumivox"
    bl_use_preview = True
    bl_use_eevee_viewport = True
    bl_use_shading_nodes_custom = False
    bl_use_postprocess = True

    _viewport: Viewport | None = None
    _data: Any = None
    _box: Any = None
    _texture: Any = None
    _history = 0

    # --- renders ---

    def update_render_passes(self, scene: Any = None, renderlayer: Any = None) -> None:
        self.register_pass(scene, renderlayer, "Combined", 4, "RGBA", "COLOR")
        for known in passes.wanted(renderlayer):
            channels = known.channels
            self.register_pass(
                scene, renderlayer, known.name, len(channels), channels, known.kind
            )

    def render(self, depsgraph: Any) -> None:
        try:
            self._render(depsgraph)
        except Cancelled:
            pass
        except Exception as error:
            if not isinstance(error, (ValueError, RuntimeError, OSError)):
                traceback.print_exc()
            # The state on the device may be half of another scene's.
            KEPT.drop()
            self._fail(depsgraph, explain(error))

    def _fail(self, depsgraph: Any, message: str) -> None:
        """Ends a render that has failed with a message; its picture is empty, since Blender takes
        none for granted."""
        size = picture_size(depsgraph.scene.render)
        result = self.begin_result(0, 0, *size, layer=depsgraph.view_layer_eval.name)
        self.end_result(result)
        self.error_set(message)
        self.report({"ERROR"}, message)

    def _render(self, depsgraph: Any) -> None:
        scene = depsgraph.scene
        view_layer = depsgraph.view_layer_eval
        is_transparent = scene.render.film_transparent
        asked = passes.wanted(view_layer)
        before, after = self._neighbours(depsgraph, asked)
        session, reader = (Session(), Reader()) if self.is_preview else KEPT.take()
        # Another frame has another depsgraph.
        reader.forget_all()
        self.update_stats("", "Lumivox: reading the scene")
        data = reader.read(depsgraph)
        view = self._camera_view(depsgraph)
        settings = settings_of(scene, False)
        if self.is_preview:
            settings |= {"frames": 8, "resolution": 32}
        layers = passes.layers(asked)

        def progress(stage: str, done: float, total: int) -> None:
            self.update_stats("", f"Lumivox: {stage}")
            if stage == "render" and total:
                self.update_progress(done / total)
            if self.test_break():
                raise Cancelled

        session.show(data, view, settings, layers, box_of(scene, depsgraph), progress)
        result = self.begin_result(0, 0, view.width, view.height, layer=view_layer.name)
        is_cancelled = True
        try:
            def put(picture: Any) -> None:
                _put(result, "Combined", passes.combined(picture, view, data.world, is_transparent))

            picture = self._refined(session, view, settings["frames"], progress, result, put)
            put(picture)
            middles = None
            if any(known.is_of_middle for known in asked):
                middles = session.samples_of_pixels(view, progress)
            for known in asked:
                source = middles if known.is_of_middle else picture
                _put(result, known.name, passes.make(known, source, view, data, before, after))
            is_cancelled = False
        finally:
            self.end_result(result, cancel=is_cancelled)
        if not self.is_preview:
            for note in status.set_of(scene.name, status_of(session, picture, view)):
                self.report({"WARNING"}, note)

    def _refined(
        self,
        session: Session,
        view: View,
        frames: int,
        progress: Any,
        result: Any,
        put: Callable[[Any], None],
    ) -> Any:
        """The picture with all its frames; in the window it gets better while it is made."""
        if bpy.app.background:
            return session.picture(view, progress)
        done, step, camera = 0, 1, view
        while True:
            step = min(step, frames - done)
            picture = session.refine(step, camera, progress)
            done, step, camera = done + step, done + step, None
            if done >= frames:
                return picture
            put(picture)
            self.update_result(result)

    def _neighbours(
        self, depsgraph: Any, asked: list[passes.Pass]
    ) -> tuple[Moment | None, Moment | None]:
        """The frames before and after, for the vector pass."""
        if all(known.name != "Vector" for known in asked):
            return None, None
        scene = depsgraph.scene
        frame, subframe, moments = scene.frame_current, scene.frame_subframe, []
        try:
            for other in (frame - 1, frame + 1):
                self.frame_set(other, subframe)
                moments.append(Moment(self._camera_view(depsgraph), _matrices(depsgraph)))
        finally:
            self.frame_set(frame, subframe)
        return moments[0], moments[1]

    def _camera_view(self, depsgraph: Any) -> View:
        return camera_view(self.camera_override or depsgraph.scene.camera, depsgraph)

    # --- viewports ---

    def view_update(self, context: Any, depsgraph: Any) -> None:
        if self._viewport is None:
            self._viewport = Viewport()
            self._reader = Reader()
            _redraw_when_ready(self)
        try:
            if self._history != _History.count:
                self._history = _History.count
                self._reader.forget_all()
            self._reader.take_updates(depsgraph)
            self._data = self._reader.read(depsgraph)
            self._box = box_of(depsgraph.scene, depsgraph)
        except Exception as error:
            traceback.print_exc()
            self.update_stats("", explain(error))
        self._ask(context, depsgraph)

    def view_draw(self, context: Any, depsgraph: Any) -> None:
        # Not at the top: Blender has no GPU module for drawing in the background.
        from . import draw

        self._ask(context, depsgraph)
        shown = self._viewport.latest if self._viewport else None
        if shown is None:
            return
        scene = depsgraph.scene
        if shown.error:
            self.update_stats("", shown.error)
        else:
            self.update_stats("", f"Lumivox: {shown.frames} of {shown.wanted} frames")
            status.set_of(scene.name, shown.status)
        self._texture = draw.picture(self, scene, context.region, shown, self._texture)

    def _ask(self, context: Any, depsgraph: Any) -> None:
        """Asks for the view as it is now, if it has changed."""
        if self._viewport is None or self._data is None:
            return
        region = context.region
        size = (max(region.width, 1), max(region.height, 1))
        space = context.space_data
        view = of_region(context.region_data, size, space.clip_start)
        scene = depsgraph.scene
        request = Request(
            self._data, view, settings_of(scene, True), self._box, scene.render.film_transparent
        )
        self._viewport.ask(request)


def status_of(session: Session, picture: Any, view: View) -> status.Status:
    """What panels tell about a picture."""
    renderer = session.renderer
    if renderer is None:
        return status.Status(notes=session.data.notes if session.data else ())
    return status.Status(
        adapter=renderer.adapter,
        voxels=renderer.voxels,
        voxel_m=renderer.voxel_size_m,
        voxel_share=passes.voxel_share(picture, view, renderer.voxel_size_m),
        notes=session.data.notes if session.data else (),
    )


def _redraw_when_ready(engine: LumivoxEngine) -> None:
    """Redraws a viewport from Blender's own thread when its picture has become better; closes it
    when Blender has freed the engine."""
    shown, known = None, weakref.ref(engine)
    close = weakref.finalize(engine, engine._viewport.close)

    def look() -> float | None:
        nonlocal shown
        here = known()
        if here is None:
            return None
        try:
            # All attributes of an engine that Blender has freed raise an error.
            viewport = here._viewport
            if viewport.latest is not shown:
                shown = viewport.latest
                here.tag_redraw()
        except ReferenceError:
            close()
            return None
        return 0.03

    # Viewports may outlive the file.
    bpy.app.timers.register(look, persistent=True)


def picture_size(render: Any) -> tuple[int, int]:
    """The size of a scene's pictures, without its region."""
    lengths = (render.resolution_x, render.resolution_y)
    width, height = (max(1, length * render.resolution_percentage // 100) for length in lengths)
    return width, height


def camera_view(camera: Any, depsgraph: Any) -> View:
    """What a render of a camera shows, or the region of it that is rendered."""
    render = depsgraph.scene.render
    size = picture_size(render)
    if camera is None:
        raise ValueError("the scene has no camera: add one with Add > Camera")
    if render.pixel_aspect_x != render.pixel_aspect_y:
        raise ValueError("pixels must be square: set both numbers of Output > Format > Aspect to 1")
    part = None
    if render.use_border:
        left, right = _pixels(render.border_min_x, size[0]), _pixels(render.border_max_x, size[0])
        bottom, top = _pixels(render.border_min_y, size[1]), _pixels(render.border_max_y, size[1])
        part = (left, size[1] - top, max(1, right - left), max(1, top - bottom))
    camera = camera.evaluated_get(depsgraph)
    if camera.data.type == "PANO":
        raise ValueError("panoramic cameras are not supported: choose a perspective one")
    return of_object(camera, depsgraph, size, part)


def _pixels(share: float, length: int) -> int:
    """A share of a length as Blender rounds it, in numbers of 32 bits."""
    return int(np.float32(share) * np.float32(length))


def _matrices(depsgraph: Any) -> dict[tuple[Any, ...], Any]:
    """The matrices of all instances, by the keys of each slot."""
    found: dict[tuple[Any, ...], Any] = {}
    for item in depsgraph.object_instances:
        if item.show_self and item.object.type != "LIGHT":
            key = key_of(item)
            matrix = place(item.matrix_world)
            for slot in range(max(1, len(item.object.material_slots))):
                found[*key, slot] = matrix
    return found


def _put(result: Any, name: str, pixels: np.ndarray) -> None:
    """Stores a pass, whose first row is the top one, in Blender's, whose first is the bottom."""
    known = result.layers[0].passes.find_by_name(name, "")
    if known is not None:
        known.rect.foreach_set(np.ascontiguousarray(pixels[::-1], np.float32).ravel())


_HANDLERS = {
    "render_complete": _drop,
    "render_cancel": _drop,
    "load_pre": _drop,
    "load_post": _replace,
    "undo_post": _replace,
    "redo_post": _replace,
}


def register() -> None:
    bpy.utils.register_class(LumivoxEngine)
    for name, handler in _HANDLERS.items():
        getattr(bpy.app.handlers, name).append(handler)


def unregister() -> None:
    for name, handler in _HANDLERS.items():
        known = getattr(bpy.app.handlers, name)
        if handler in known:
            known.remove(handler)
    KEPT.drop()
    bpy.utils.unregister_class(LumivoxEngine)
