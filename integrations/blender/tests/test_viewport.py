"""What a viewport shows, when, and what its thread does about changes; without a window."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import bpy
import numpy as np
import pytest
from mathutils import Matrix

import extension
import scenes
from conftest import SMALL, read, shown
from extension.changes import Change
from extension import engine
from extension.engine import LumivoxEngine
from extension.properties import settings_of
from extension.session import Session
from extension.viewport import Request, Viewport

PREVIEW = {**SMALL, "frames": 8}


def until(condition: Callable[[], Any], limit_s: float = 120.0) -> Any:
    end = time.monotonic() + limit_s
    while time.monotonic() < end:
        if result := condition():
            return result
        time.sleep(0.01)
    raise AssertionError(f"not within {limit_s} s")


@pytest.fixture
def viewport() -> Any:
    made = Viewport(Session(), explain=str)
    yield made
    made.close()
    made.join(20.0)


def ask(viewport: Viewport, settings: Any = PREVIEW) -> bool:
    data, view = read()
    return viewport.ask(Request(data, view, settings))


def complete(viewport: Viewport) -> Any:
    def done() -> Any:
        shown = viewport.latest
        return shown if shown and shown.frames == shown.wanted and shown.wanted else None

    return until(done)


def test_a_picture_gets_better_until_it_is_complete(box: Any, viewport: Viewport) -> None:
    viewport._pixel_s = 1.0
    seen = []
    assert ask(viewport)
    while not seen or seen[-1].frames < 8 or seen[-1].pixels.shape[0] < 24:
        last = seen[-1] if seen else None
        shown = until(lambda: viewport.latest if viewport.latest is not last else None)
        seen.append(shown)
    # First a coarse one, then the whole picture with more and more frames.
    assert seen[0].pixels.shape[0] < 24
    frames = [shown.frames for shown in seen if shown.pixels.shape[0] == 24]
    assert frames == sorted(frames) and frames[-1] == 8
    # Asking again changes nothing.
    assert not ask(viewport)
    # It is the picture of a render.
    data, view = read()
    session = Session()
    session.show(data, view, PREVIEW, ["depth"])
    expected = session.picture(view).radiance / 683.0
    np.testing.assert_allclose(seen[-1].pixels[..., :3], expected, rtol=1e-5)


def test_edits_do_not_load_the_scene_again(box: Any, viewport: Viewport) -> None:
    ask(viewport)
    complete(viewport)
    renderer = viewport._session.renderer
    before = viewport.latest.pixels
    for edit in ("transform", "light", "camera", "world", "material"):
        if edit == "transform":
            bpy.data.objects["box"].location.x += 0.2
        elif edit == "light":
            bpy.data.objects["lamp"].data.energy *= 1.5
        elif edit == "camera":
            bpy.context.scene.camera.location.x += 0.2
        elif edit == "world":
            node = bpy.context.scene.world.node_tree.nodes["Background"]
            node.inputs["Color"].default_value = (0.3, 0.2, 0.1, 1.0)
        else:
            inputs = scenes._principled(bpy.data.materials["red"]).inputs
            inputs["Base Color"].default_value = (0.1, 0.1, 0.7, 1.0)
        bpy.context.view_layer.update()
        old = viewport.latest
        assert ask(viewport), edit
        until(lambda: viewport.latest is not old)
        seen = complete(viewport)
        assert viewport._session.last_change < Change.SCENE, edit
        assert viewport._session.renderer is renderer, edit
        assert not np.array_equal(seen.pixels, before), edit
        before = seen.pixels


def test_only_the_newest_request_counts(box: Any, viewport: Viewport) -> None:
    ask(viewport, {**PREVIEW, "frames": 4096})
    until(lambda: viewport.latest)
    for step in range(20):
        bpy.context.scene.camera.location.x += 0.02
        bpy.context.view_layer.update()
        assert ask(viewport, PREVIEW)
    seen = complete(viewport)
    data, view = read()
    session = Session()
    session.show(data, view, PREVIEW, ["depth"])
    np.testing.assert_allclose(seen.pixels[..., :3], session.picture(view).radiance / 683.0, rtol=1e-5)


def test_errors_are_shown_and_forgotten(box: Any, viewport: Viewport) -> None:
    ask(viewport, {**PREVIEW, "resolution": 17})
    error = until(lambda: viewport.latest and viewport.latest.error)
    assert "resolution" in error
    ask(viewport)
    assert complete(viewport).error == ""


def test_a_picture_that_failed_may_be_asked_for_again(
    box: Any, viewport: Viewport, monkeypatch: pytest.MonkeyPatch
) -> None:
    def lost(*_: Any) -> None:
        raise RuntimeError("the device is lost")

    ask(viewport)
    complete(viewport)
    monkeypatch.setattr(viewport._session.renderer, "refine", lost)
    box.camera.location.x += 0.2
    bpy.context.view_layer.update()
    ask(viewport)
    until(lambda: viewport.latest.error)
    # Not at once: the error itself is drawn.
    assert not ask(viewport)
    until(lambda: ask(viewport))
    assert complete(viewport).error == ""


def test_a_closed_viewport_ends_its_thread(box: Any, viewport: Viewport) -> None:
    ask(viewport, {**PREVIEW, "frames": 60000})
    until(lambda: viewport.latest)
    viewport.close()
    viewport.join(20.0)
    assert not viewport._thread.is_alive()
    assert not ask(viewport)


class Window:
    """An engine in a viewport that records what it draws."""

    view_update = LumivoxEngine.view_update
    view_draw = LumivoxEngine.view_draw
    _ask = LumivoxEngine._ask
    _viewport = _data = _box = _texture = None
    _history = 0

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.drawn: list[Any] = []
        self.said = ""

        def picture(engine: Any, scene: Any, region: Any, shown: Any, known: Any) -> Any:
            self.drawn.append(shown)
            return shown

        monkeypatch.setitem(sys.modules, "extension.draw", SimpleNamespace(picture=picture))
        monkeypatch.setattr(extension, "draw", sys.modules["extension.draw"], raising=False)

    def update_stats(self, stats: str, info: str) -> None:
        self.said = info

    def tag_redraw(self) -> None:
        pass


@pytest.mark.parametrize("is_held", (False, True))
def test_a_viewport_is_closed_when_blender_frees_its_engine(
    box: Any, monkeypatch: pytest.MonkeyPatch, is_held: bool
) -> None:
    looks, while_it_lives, held, viewport = [], [], [], Viewport()
    monkeypatch.setattr(bpy.app.timers, "register", lambda look, **_: looks.append(look))

    class Engine(bpy.types.RenderEngine):
        bl_idname, bl_label = "FREED", "Freed"

        def render(self, depsgraph: Any) -> None:
            self._viewport = viewport
            engine._redraw_when_ready(self)
            while_it_lives.append((looks[0](), viewport.is_closed))
            if is_held:
                held.append(self)

    bpy.utils.register_class(Engine)
    try:
        box.render.engine = "FREED"
        bpy.ops.render.render()
    finally:
        bpy.utils.unregister_class(Engine)
    assert while_it_lives == [(0.03, False)]
    assert looks[0]() is None and viewport.is_closed


def through(camera: Any) -> Any:
    """The context of a viewport that looks through a camera."""
    depsgraph = bpy.context.evaluated_depsgraph_get()
    projection = camera.calc_matrix_camera(depsgraph, x=32, y=24)
    return SimpleNamespace(
        region=SimpleNamespace(width=32, height=24),
        space_data=SimpleNamespace(clip_start=0.01),
        region_data=SimpleNamespace(
            view_matrix=camera.matrix_world.inverted(), window_matrix=projection
        ),
    )


def test_undo_reaches_viewports(box: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    window = Window(monkeypatch)

    def updated(scene: Any, depsgraph: Any) -> None:
        # Blender calls it there, too, with what has changed.
        window.view_update(context, depsgraph)

    bpy.context.view_layer.update()
    context = through(box.camera)
    bpy.ops.ed.undo_push(message="before")
    window.view_update(context, bpy.context.evaluated_depsgraph_get())
    before = window._data
    bpy.app.handlers.depsgraph_update_post.append(updated)
    try:
        bpy.data.objects["box"].data.vertices[7].co.z += 1.0
        bpy.data.objects["box"].data.update()
        bpy.context.view_layer.update()
        assert window._data != before
        bpy.ops.ed.undo_push(message="after")
        # Blender may put what it brings back where something else was read from.
        forgotten: list[int] = []
        monkeypatch.setattr(window._reader, "forget_all", lambda: forgotten.append(1))
        bpy.ops.ed.undo()
        window.view_update(context, bpy.context.evaluated_depsgraph_get())
        assert window._data == before and forgotten == [1]
    finally:
        bpy.app.handlers.depsgraph_update_post.remove(updated)
        window._viewport.close()
        window._viewport.join(20.0)


def test_a_viewport_shows_what_its_view_sees(box: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    """The glue to Blender, in which only drawing is replaced."""
    window = Window(monkeypatch)
    box.lumivox.preview_samples, box.lumivox.preview_resolution = 4, 16
    bpy.context.view_layer.update()
    depsgraph = bpy.context.evaluated_depsgraph_get()
    context = through(box.camera)
    window.view_draw(context, depsgraph)
    assert window.drawn == []
    window.view_update(context, depsgraph)
    try:
        complete(window._viewport)
        window.view_draw(context, depsgraph)
        assert window.said == "Lumivox: 4 of 4 frames"
        seen = window.drawn[-1].pixels[..., :3]
        settings = settings_of(box, True)
        expected = shown(settings, ["depth"]).radiance / 683.0
        np.testing.assert_allclose(seen, expected, rtol=1e-4, atol=1e-5)
        # Another view is asked for when it is drawn; the timer redraws.
        old = window._viewport.latest
        context.region_data.view_matrix = context.region_data.view_matrix @ Matrix.Translation((0.3, 0, 0))
        window.view_draw(context, depsgraph)
        until(lambda: window._viewport.latest is not old)
        assert not np.array_equal(complete(window._viewport).pixels[..., :3], seen)
    finally:
        window._viewport.close()


def test_the_first_picture_is_lit(viewport: Viewport) -> None:
    """Of the window's usual size, with the viewport's own settings."""
    scenes.materials()
    scene = bpy.context.scene
    scene.render.resolution_x, scene.render.resolution_y = 960, 540
    ask(viewport, settings_of(scene, True))
    shown = until(lambda: viewport.latest)
    assert shown.error == "" and shown.pixels[..., :3].mean() > 0.1
