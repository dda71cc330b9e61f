"""Ray: two workers on this machine, of which one dies in the middle."""

from __future__ import annotations

import logging
import os
import pickle
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

import lumivox
from lumivox import InputError, Scene

from conftest import SMALL
from moving import VIEW, moving

import ray

import lumivox.ray

SIZE = (16, 12)


@pytest.fixture(scope="module")
def cluster() -> Iterator[None]:
    # Two workers at a time; the object store holds small pictures.
    ray.init(num_cpus=2, num_gpus=0, include_dashboard=False, object_store_memory=100 << 20, logging_level=logging.ERROR)
    yield
    ray.shutdown()


def test_a_pickled_scene_is_complete(cornell: Scene) -> None:
    scene = cornell.copy()
    scene.set_sky(elevation_deg=30)
    again = pickle.loads(pickle.dumps(scene))
    parts = [
        lumivox.reference_part(each, size=SIZE, batches=(number, number + 1), surroundings="none")
        for number, each in enumerate((scene, again))
    ]
    # Parts of another scene would be refused: each has a fingerprint of all uploaded data.
    merged = lumivox.merge(parts)
    assert (merged.radiance == lumivox.reference(scene, size=SIZE, samples=32, surroundings="none").radiance).all()


def test_a_dying_worker_does_not_change_the_bits(cluster: None, cornell: Scene, tmp_path: Path) -> None:
    told: list[tuple[int, int]] = []
    folder = str(tmp_path)

    def make_scene() -> Scene:
        # Each process that has the scene leaves a file with its id as the name.
        (Path(folder) / str(os.getpid())).touch()
        return Scene.builtin("cornell")

    def progress(stage: str, done: float, total: int) -> None:
        assert stage == "pieces"
        told.append((int(done), total))
        if len(told) == 2:
            workers = [int(file.name) for file in tmp_path.iterdir()]
            assert len(workers) == 2 and os.getpid() not in workers
            os.kill(workers[0], signal.SIGKILL)

    truth = lumivox.ray.reference(
        make_scene, size=SIZE, samples=10 * 16, batches=1, workers=2, progress=progress
    )
    assert told == [(number, 10) for number in range(1, 11)]
    assert len(list(tmp_path.iterdir())) == 3, "one took the place of the dead"
    whole = lumivox.reference(cornell, size=SIZE, samples=160)
    for name, layer in whole.layers.items():
        assert (truth.layers[name] == layer).all(), name
    assert (truth.radiance == whole.radiance).all()


def test_a_worker_that_always_dies_raises_an_error(cluster: None) -> None:
    def dies() -> Scene:
        os._exit(1)

    with pytest.raises(lumivox.Error, match="a worker could not start"):
        lumivox.ray.reference(dies, size=SIZE, samples=16, retries=1)


def test_distributed_pictures_match_one_machine(cluster: None, tmp_path: Path) -> None:
    file = str(moving(tmp_path))
    times = [0.2 * number for number in range(5)]
    options: dict[str, Any] = {**SMALL, "layers": ["motion"], "times_s": times}
    film = lumivox.ray.render_many(lambda: Scene.load(file), VIEW, (24, 16), views=2, workers=2, **options)
    alone = lumivox.render_many(Scene.load(file), VIEW, (24, 16), **options)
    assert set(film) == set(alone)
    for name, array in alone.items():
        assert (film[name] == array).all(), name
    assert (alone["radiance"][0] != alone["radiance"][4]).any()
    # A piece's first picture has the motion since the previous piece's last picture.
    assert all((motion != 0).any() for motion in alone["motion"][1:])
    with pytest.raises(InputError, match="scene: its animations do not travel"):
        lumivox.ray.render_many(Scene.load(file), VIEW, times_s=times)


def test_bad_ray_arguments_raise_input_errors(cluster: None, cornell: Scene) -> None:
    for arguments, message in (
        ({"samples": 20}, "samples: is 20, but must be a multiple of 16"),
        ({"batches": 0}, "batches: is 0"),
        ({"workers": 0}, "workers: is 0"),
    ):
        with pytest.raises(InputError, match=message):
            lumivox.ray.reference(cornell, **arguments)  # type: ignore[arg-type]
    with pytest.raises(InputError, match="scene: is a str"):
        lumivox.ray.reference("cornell")  # type: ignore[arg-type]
    # Errors that a retry cannot fix are raised at once, unchanged.
    with pytest.raises(InputError, match="camera"):
        lumivox.ray.reference(cornell, "no such camera", size=SIZE, samples=16)
    with pytest.raises(InputError, match="cameras: has none"):
        lumivox.ray.render_many(cornell, [])
