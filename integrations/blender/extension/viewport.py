"""Pictures for a viewport, made by a thread: quickly a coarse one, then better ones.

It knows nothing of Blender. The newest request counts; the one before it is dropped between two
frames.
"""

from __future__ import annotations

import math
import threading
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from . import model, passes
from .session import Box, Session
from .status import Status
from .translate.camera import View

#: The time in which the first picture after a change should be there, s.
FIRST_S = 0.25
#: The time without changes after which a finer picture begins, s: while a view is dragged, no frame
#: of a fine one has to be waited for.
STILL_S = 0.5
#: The time after an error until the same picture may be tried again, s: to show the error asks for
#: the picture, too.
PAUSE_S = 1.0
#: The most frames of a coarse picture.
COARSE_FRAMES = 8
#: How much coarser the first picture may be.
COARSEST = 8
#: The seconds that a pixel takes, until it is known.
GUESS_S = 2e-6


@dataclass(frozen=True)
class Request:
    """What a viewport is to show."""

    data: model.Scene
    view: View
    settings: Mapping[str, Any]
    box: Box | None = None
    is_transparent: bool = False

    def is_like(self, other: Request | None) -> bool:
        """Whether both ask for the same picture."""
        return other is not None and (self.data is other.data or self.data == other.data) and (
            (self.view, dict(self.settings), self.box, self.is_transparent)
            == (other.view, dict(other.settings), other.box, other.is_transparent)
        )


@dataclass(frozen=True)
class Shown:
    """A picture: pixels (H, W, 4) from the top, with the number of its frames."""

    pixels: np.ndarray
    frames: int
    wanted: int
    status: Status = field(default_factory=Status)
    error: str = ""


class _Newer(Exception):
    """There is a newer request, or the viewport is closed."""


class Viewport:
    """Makes the pictures of one viewport."""

    def __init__(
        self, session: Session | None = None, explain: Callable[[Exception], str] | None = None
    ) -> None:
        self._session = session or Session()
        self._explain = explain
        self._condition = threading.Condition()
        self._asked: Request | None = None
        self._request: Request | None = None
        self._again_at_s = math.inf
        self._pixel_s = GUESS_S
        self._thread: threading.Thread | None = None
        self.latest: Shown | None = None
        self.is_closed = False

    def ask(self, request: Request) -> bool:
        """Asks for a picture; whether it is another one than before."""
        with self._condition:
            is_early = time.monotonic() < self._again_at_s
            if self.is_closed or (is_early and request.is_like(self._asked)):
                return False
            self._asked = self._request = request
            self._again_at_s = math.inf
            if self._thread is None:
                self._thread = threading.Thread(target=self._run, name="Lumivox", daemon=True)
                self._thread.start()
            self._condition.notify()
            return True

    def close(self) -> None:
        """Stops the thread after the frame that it is at."""
        with self._condition:
            self.is_closed, self._request = True, None
            self._condition.notify()

    def join(self, timeout_s: float | None = None) -> None:
        """Waits for the end of the thread."""
        if self._thread is not None:
            self._thread.join(timeout_s)

    def _run(self) -> None:
        while True:
            with self._condition:
                while self._request is None and not self.is_closed:
                    self._condition.wait()
                if self.is_closed:
                    self._session = None
                    return
                request, self._request = self._request, None
            try:
                self._show(request)
            except _Newer:
                continue
            except Exception as error:
                if self._explain is None:
                    from .engine import explain as text_of
                else:
                    text_of = self._explain
                with self._condition:
                    # The device may be lost.
                    self._session = Session()
                    if self._asked is request:
                        self._again_at_s = time.monotonic() + PAUSE_S
                blank = np.zeros((1, 1, 4), np.float32)
                self.latest = Shown(blank, 0, 0, error=text_of(error))

    def _show(self, request: Request) -> None:
        from .engine import status_of

        wanted = int(request.settings.get("frames", 16))
        layers = passes.layers([])
        first = time.perf_counter()
        for step_number, divisor in enumerate(self._steps(request.view), 1):
            view = request.view.scaled(divisor)
            self._session.show(
                request.data, view, request.settings, layers, request.box, self._stop_if_closed
            )
            most = wanted if divisor == 1 else max(1, min(COARSE_FRAMES, wanted - 1))
            done, step, camera = 0, 1, view
            while done < most:
                step = min(step, most - done)
                begun = time.perf_counter()
                picture = self._session.refine(step, camera, self._stop_if_newer)
                took = (time.perf_counter() - begun) / step
                self._pixel_s = took / (view.canvas[0] * view.canvas[1])
                done, step, camera = done + step, done + step, None
                pixels = passes.combined(
                    picture, view, request.data.world, request.is_transparent
                )
                self.latest = Shown(
                    pixels, done, wanted, status_of(self._session, picture, view)
                )
                if divisor > 1 and time.perf_counter() - first > step_number * STILL_S:
                    break

    def _steps(self, view: View) -> list[int]:
        """How much coarser the pictures are, one after the other; the last is whole."""
        whole_s = self._pixel_s * view.canvas[0] * view.canvas[1]
        divisor = 1
        while divisor < COARSEST and whole_s / divisor**2 > FIRST_S:
            divisor *= 2
        return sorted({divisor, min(divisor, 2), 1}, reverse=True)

    def _stop_if_newer(self, *_: Any) -> None:
        if self._request is not None or self.is_closed:
            raise _Newer

    def _stop_if_closed(self, *_: Any) -> None:
        # A change that is stopped half way has to build everything again.
        if self.is_closed:
            raise _Newer
