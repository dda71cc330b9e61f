"""Many machines with Ray (https://www.ray.io): ``pip install lumivox[ray]``.

>>> import lumivox.ray  # doctest: +SKIP
>>> ray.init("auto")  # doctest: +SKIP
>>> truth = lumivox.ray.reference(scene, size=(1920, 1080), samples=4096)  # doctest: +SKIP

Each worker is an actor with a device and the scene. Workers take the next piece of work when they have
finished one, so slow ones hold nobody up; those that the cluster gets later join, and the work of one
that dies is done by another. The result has the bits of one machine.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from ._arrays import size_of, whole
from .errors import Error, InputError
from .reference import Reference, merge, reference_part
from .render import CameraLike, Cameras, Renderer, moments, of_moments
from .scene import AnimationLike, Progress, Scene

try:
    import ray
    from ray.exceptions import ObjectLostError, RayActorError
except ImportError as error:
    raise ImportError("lumivox.ray needs Ray; install it with: pip install 'lumivox[ray]'") from error

#: A scene, or a function that makes or loads it on each machine.
SceneLike = Scene | Callable[[], Scene]

#: The default limit of workers.
MOST_WORKERS = 64


class _Worker:
    """A device and a scene, in a process of its own."""

    def __init__(self, scene: SceneLike) -> None:
        self._scene = scene if isinstance(scene, Scene) else scene()
        self._renderer: Renderer | None = None

    def ready(self) -> None:
        """Nothing; it is done once the worker has started."""

    def trace(self, batches: tuple[int, int], options: dict[str, Any]) -> bytes:
        return reference_part(self._scene, batches=batches, **options)

    def render(self, numbers: tuple[int, int], options: dict[str, Any]) -> dict[str, Any]:
        # All pieces of a call have the same options, and a worker serves one call.
        views, times, animation = options["moments"]
        if self._renderer is None:
            own = options["options"]
            self._renderer = of_moments(self._scene, views, times, animation, own)
        first, end = numbers
        before = (views[first - 1], times[first - 1]) if first > 0 else None
        return self._renderer._stack(views[first:end], times[first:end], animation, before, None)


def _options() -> dict[str, Any]:
    """A GPU for each worker if the cluster has any, else a core."""
    resources: dict[str, float] = ray.cluster_resources()  # type: ignore[no-untyped-call]
    has_gpus = resources.get("GPU", 0) >= 1
    return {"num_gpus": 1} if has_gpus else {"num_cpus": 1}


def _work(
    scene: SceneLike,
    method: str,
    pieces: Sequence[Any],
    options: dict[str, Any],
    workers: int | None,
    retries: int,
    worker_options: dict[str, Any] | None,
    progress: Progress | None,
) -> Iterator[tuple[int, Any]]:
    """The numbers and results of all pieces, in the order in which they are done."""
    if not ray.is_initialized():
        raise InputError('Ray has not started; call ray.init() on this machine, or ray.init("auto") in a cluster')
    if not isinstance(scene, Scene) and not callable(scene):
        kind = type(scene).__name__
        raise InputError(f"scene: is a {kind}, but must be a lumivox.Scene, or a function that returns one")
    most = MOST_WORKERS if workers is None else whole("workers", workers, 1, 1 << 16)
    retries = whole("retries", retries, 0)
    # One copy of the scene in each machine's object store.
    source = ray.put(scene) if isinstance(scene, Scene) else scene
    actor_class: Any = ray.remote(_Worker)
    actor_class = actor_class.options(**(worker_options or _options()))
    waiting = deque(range(len(pieces)))
    tries = [0] * len(pieces)
    starting: dict[Any, Any] = {}
    running: dict[Any, tuple[Any, int]] = {}
    failed_starts = 0

    def start() -> None:
        # An actor waits until it fits into the cluster; an autoscaler sees the demand.
        actor = actor_class.remote(source)
        starting[actor.ready.remote()] = actor

    for _ in range(min(most, len(pieces))):
        start()
    done = 0
    try:
        while done < len(pieces):
            (ref, *_), _ = ray.wait([*starting, *running], num_returns=1)
            if ref in starting:
                actor = starting.pop(ref)
                try:
                    ray.get(ref)
                except RayActorError as error:
                    failed_starts += 1
                    if failed_starts > retries:
                        raise Error(f"a worker could not start: {error}") from error
                    start()
                    continue
            else:
                actor, piece = running.pop(ref)
                try:
                    result = ray.get(ref)
                except (RayActorError, ObjectLostError) as error:
                    tries[piece] += 1
                    if tries[piece] > retries:
                        raise Error(
                            f"piece {piece} was lost {tries[piece]} times with its worker; the last time: {error}"
                        ) from error
                    waiting.appendleft(piece)
                    ray.kill(actor)
                    start()
                    continue
                done += 1
                yield piece, result
                del result
                if progress is not None:
                    progress("pieces", done, len(pieces))
            if waiting:
                piece = waiting.popleft()
                running[getattr(actor, method).remote(pieces[piece], options)] = (actor, piece)
            else:
                # Nothing is left to do: free its GPU for others.
                ray.kill(actor)
    finally:
        for actor in [*starting.values(), *(actor for actor, _ in running.values())]:
            ray.kill(actor)


def reference(
    scene: SceneLike,
    camera: CameraLike | None = None,
    size: tuple[int, int] = (640, 360),
    *,
    samples: int = 256,
    batches: int = 4,
    seed: int = 0,
    bounces: int | None = None,
    surroundings: str = "auto",
    adapter: str | None = None,
    workers: int | None = None,
    retries: int = 3,
    worker_options: dict[str, Any] | None = None,
    allow_mixed: bool = False,
    progress: Progress | None = None,
) -> Reference:
    """:func:`lumivox.reference` on a Ray cluster, to the same bits where all GPUs and drivers are alike
    (a mix is refused unless ``allow_mixed``).

    ``scene`` is sent to the workers, or made there by a function, as from a file that all of them
    read. ``samples`` is a multiple of 16; workers trace pieces of ``batches`` times 16 samples. There are
    at most ``workers`` (default: 64), as many as the cluster has room for; each takes a GPU, or a
    core where there is none, or what ``worker_options`` says (as ``{"num_gpus": 0.5}``). A piece that
    is lost with its worker is traced again, up to ``retries`` times. ``progress`` is called with
    ``"pieces"``, those done and their number.
    """
    samples = whole("samples", samples, 16, 1 << 24)
    if samples % 16:
        raise InputError(f"samples: is {samples}, but must be a multiple of 16, a batch")
    step, total = whole("batches", batches, 1, 1 << 20), samples // 16
    pieces = [(first, min(first + step, total)) for first in range(0, total, step)]
    options = {
        "camera": camera,
        "size": size_of("size", size),
        "seed": seed,
        "bounces": bounces,
        "surroundings": surroundings,
        "adapter": adapter,
    }
    work = _work(scene, "trace", pieces, options, workers, retries, worker_options, progress)
    return merge((part for _, part in work), allow_mixed=allow_mixed, adapter=adapter)


def render_many(
    scene: SceneLike,
    cameras: Cameras,
    size: tuple[int, int] = (256, 256),
    *,
    times_s: Any = None,
    animation: AnimationLike = 0,
    views: int = 16,
    workers: int | None = None,
    retries: int = 3,
    worker_options: dict[str, Any] | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> dict[str, Any]:
    """:func:`lumivox.render_many` on a Ray cluster: arrays (N, H, W, C) by name.

    A worker renders pieces of ``views`` pictures, with one set of voxels for all of them. Scene and
    workers are as for :func:`reference`, ``options`` (layers, surroundings, settings) as for
    :class:`lumivox.Renderer`. Animations do not travel: with ``times_s`` the scene is a function that
    loads it.
    """
    seen, times = moments(cameras, times_s)
    if times_s is not None and isinstance(scene, Scene):
        raise InputError("scene: its animations do not travel; give a function that loads it on the workers")
    step, count = whole("views", views, 1), len(seen)
    pieces = [(first, min(first + step, count)) for first in range(0, count, step)]
    given = {"options": {**options, "size": size_of("size", size)}, "moments": (seen, times, animation)}
    arrays: dict[str, Any] = {}
    for piece, parts in _work(scene, "render", pieces, given, workers, retries, worker_options, progress):
        for name, part in parts.items():
            if name not in arrays:
                arrays[name] = np.empty((count, *part.shape[1:]), part.dtype)
            arrays[name][piece * step : piece * step + len(part)] = part
    return arrays
