"""Pictures from one camera and from many."""

from __future__ import annotations

import gc
import os
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import lumivox
from lumivox import Camera, GpuError, InputError, Light, Material, OutputError, Picture, Renderer, Scene

from conftest import SMALL, floor, quad

CAMERAS = [Camera.look_at((x, 1.0, 3.5), (0, 1, 0)) for x in (-0.4, 0.0, 0.4)]


def test_a_picture_matches_the_command_line(cornell: Scene, tmp_path: Path) -> None:
    # From outside, so that a part is background.
    outside = "0.5,1,5,0,1,0,50"
    picture = lumivox.render(cornell, outside, (40, 30), **SMALL)
    assert 0.1 < picture.coverage.mean() < 0.9
    values = [f"--{name.replace('_', '-')}={value}" for name, value in SMALL.items()]
    for name, written in (("a.exr", picture.to_exr()), ("a.png", picture.to_png())):
        output = tmp_path / name
        command = ["render", "builtin:cornell", "--size=40x30", f"--camera={outside}", *values]
        run = [sys.executable, "-m", "lumivox", *command, "-o", str(output)]
        subprocess.run(run, check=True, capture_output=True)
        assert output.read_bytes() == written, name


def test_arrays_have_their_shapes(renderer: Renderer) -> None:
    picture = renderer.render("front")
    assert picture.radiance.shape == (32, 48, 3)
    assert picture.coverage.shape == (32, 48)
    kinds = {name: (layer.shape[2:], layer.dtype.name) for name, layer in picture.layers.items()}
    assert kinds == {
        "irradiance": ((3,), "float32"),
        "depth": ((), "float32"),
        "instance": ((), "int32"),
        "material": ((), "int32"),
        "normal": ((3,), "float32"),
    }
    # The array is a writable view of the bytes that the extension has filled.
    assert picture.radiance.base is not None and picture.radiance.flags.writeable
    assert picture.screen().shape == (32, 48, 3)
    assert picture.to_png().startswith(b"\x89PNG")
    assert picture._repr_png_() == picture.to_png()
    assert np.asarray(picture).shape == (32, 48, 3)


def test_a_refined_picture_is_that_of_all_its_frames(cornell: Scene) -> None:
    options = {**SMALL, "frames": 5}
    renderer = Renderer(cornell, "front", (48, 32), **options)
    first = renderer.refine(1, CAMERAS[0])
    whole = [renderer.refine(count) for count in (1, 3)][-1]
    expected = renderer.render(CAMERAS[0])
    assert np.array_equal(whole.radiance, expected.radiance)
    assert not np.array_equal(first.radiance, expected.radiance)
    # Another camera begins a new mean.
    assert np.array_equal(renderer.refine(5, CAMERAS[1]).radiance, renderer.render(CAMERAS[1]).radiance)
    with pytest.raises(InputError, match="frames"):
        renderer.refine(0)


def test_changed_settings_give_the_picture_of_a_new_renderer(cornell: Scene) -> None:
    renderer = Renderer(cornell, "front", (48, 32), **SMALL)
    before = renderer.render()
    renderer.set_settings((24, 16), frames=3)
    assert renderer.size == (24, 16) and renderer.settings["frames"] == "3"
    changed = renderer.render()
    new = lumivox.render(cornell, "front", (24, 16), **{**SMALL, "frames": 3})
    assert np.array_equal(changed.radiance, new.radiance)
    # Other settings stay; a wrong name changes nothing.
    assert renderer.settings["resolution"] == "32"
    with pytest.raises(InputError, match="frames"):
        renderer.set_settings(fames=3)
    renderer.set_settings((48, 32), frames=SMALL["frames"])
    assert np.array_equal(renderer.render().radiance, before.radiance)


def test_layers_hold_the_expected_quantities() -> None:
    scene = floor(Material(base_color=(0.5, 0.25, 0.125)))
    quad(scene, (-0.5, 1, 0.5), (1, 0, 0), (0, 0, -1), Material(), "table")
    scene.lights = [Light("directional", 1000)]
    above = Camera.look_at((0, 3, 0), (0, 0, 0), 40)
    layers = ("albedo", "normal", "depth", "instance", "material", "direct", "shadow")
    seen = lumivox.render(scene, above, (31, 31), layers=layers, surroundings="none", **SMALL)
    albedo, normal, depth = (seen.layers[name] for name in layers[:3])
    assert (seen.layers["instance"][15, 15], seen.layers["instance"][0, 0]) == (1, 0)
    assert (seen.layers["material"][15, 15], seen.layers["material"][0, 0]) == (1, 0)
    assert depth[15, 15] == pytest.approx(2, abs=2e-3)
    np.testing.assert_allclose(normal[15, 15], (0, 1, 0), atol=1e-2)
    # 8 bits a channel.
    np.testing.assert_allclose(albedo[0, 0], (0.5, 0.25, 0.125), atol=5e-3)
    # A diffuse surface in 1000 lux.
    lit = 1000 * 0.8 / np.pi
    np.testing.assert_allclose(seen.layers["direct"][15, 15], lit, rtol=6e-3)
    assert seen.layers["shadow"][15, 15] == pytest.approx(1)
    far = lumivox.render(scene, Camera.look_at((0, 3, 0), (0, 9, 0)), (8, 8), layers=layers, **SMALL)
    assert (far.layers["instance"] == -1).all() and (far.coverage == 0).all()


def test_render_many_matches_single_renders(cornell: Scene, renderer: Renderer) -> None:
    stacked = renderer.render_many(CAMERAS)
    assert stacked["radiance"].shape == (3, 32, 48, 3)
    assert stacked["instance"].shape == (3, 32, 48)
    backwards = renderer.render_many(CAMERAS[::-1])
    alone = Renderer(cornell, CAMERAS[1], (48, 32), layers=("depth",), **SMALL).render()
    for name in stacked:
        assert (stacked[name] == backwards[name][::-1]).all(), name
    assert (stacked["radiance"][1] == alone.radiance).all()
    assert (stacked["depth"][1] == alone.layers["depth"]).all()
    assert (stacked["radiance"][0] != stacked["radiance"][2]).any()


def test_cameras_are_found_by_name_and_number(cornell: Scene, renderer: Renderer) -> None:
    by_name = renderer.render("front").radiance
    assert (by_name == renderer.render(0).radiance).all()
    assert (by_name == renderer.render(cornell.cameras[0]).radiance).all()
    with pytest.raises(InputError, match="frnt"):
        renderer.render("frnt")
    with pytest.raises(InputError, match="camera: is a object"):
        renderer.render(object())  # type: ignore[arg-type]


def test_an_updated_renderer_matches_a_new_one(cornell: Scene) -> None:
    scene = cornell.copy()
    renderer = Renderer(scene, size=(24, 16), **SMALL)
    first = renderer.render().radiance
    scene.set_material("red", base_color=(0, 0.5, 0))
    scene.lights = [Light(intensity=40, position=(0.3, 1.5, 0.2))]
    scene.set_instance(0, name="floor")
    renderer.update(scene)
    changed = renderer.render().radiance
    assert (changed != first).any()
    assert (changed == lumivox.render(scene, size=(24, 16), **SMALL).radiance).all()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"frame": 3}, 'there is no setting "frame"; did you mean "frames"'),
        ({"zzzz": 3}, r"there is no setting \"zzzz\"; `lumivox.settings\(\)` lists them"),
        ({"frames": 0}, "frames"),
        ({"frames": 2.5}, "frames"),
        ({"frames": object()}, "frames: is a object"),
        ({"preset": "hihg"}, 'preset is "hihg".*did you mean "high"'),
        ({"resolution": 100}, "resolution"),
        ({"size": (0, 4)}, r"size: is \(0, 4\)"),
        ({"size": (4.0, 4.0)}, r"size: is \(4.0, 4.0\)"),
        ({"size": 4}, r"size: has the shape \(\)"),
        ({"layers": ["dept"]}, 'there is no layer "dept"; did you mean "depth"'),
        ({"layers": ["depth"], "view": "voxels"}, "beside"),
        ({"surroundings": "moon"}, 'there is no surroundings "moon"'),
        ({"shadow_str": 2}, "setting of the look vxct"),
    ],
)
def test_bad_settings_are_named(cornell: Scene, arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(InputError, match=message):
        Renderer(cornell, **{"size": (8, 8), **SMALL, **arguments})


def test_settings_match_the_parameter_table(renderer: Renderer) -> None:
    names = {row["name"] for row in lumivox.settings()}
    assert {"frames", "resolution", "cones", "exposure"} <= names
    assert renderer.settings["frames"] == "2"
    assert set(renderer.settings) <= names
    assert renderer.voxels > 0 and renderer.voxel_size_m > 0


def test_a_missing_driver_raises_an_error() -> None:
    # The loader finds no driver, as on a fresh machine.
    nowhere = {**os.environ, "VK_DRIVER_FILES": "/dev/null", "VK_ICD_FILENAMES": "/dev/null", "EGL_PLATFORM": "none"}
    program = "import lumivox; lumivox.render(lumivox.Scene.builtin('cornell'), size=(8, 8))"
    run = subprocess.run([sys.executable, "-c", program], env=nowhere, capture_output=True, text=True)
    assert run.returncode == 1 and "lumivox.errors.GpuError" in run.stderr
    assert "mesa-vulkan-drivers" in run.stderr.splitlines()[-1]


def test_an_unknown_gpu_raises_an_error(cornell: Scene) -> None:
    with pytest.raises(GpuError, match="no such gpu") as raised:
        Renderer(cornell, adapter="no such gpu", **SMALL)
    assert raised.value.code == 4


def test_an_argument_that_is_not_a_scene_raises() -> None:
    with pytest.raises(InputError, match="scene: is a str, but must be a lumivox.Scene"):
        lumivox.render("cornell")  # type: ignore[arg-type]


def test_progress_callbacks_can_stop_the_work(cornell: Scene) -> None:
    told: list[tuple[str, float, int]] = []
    lumivox.render(cornell, size=(8, 8), progress=lambda *step: told.append(step), **SMALL)
    stages = [stage for stage, _, _ in told]
    assert stages.index("voxelize") < stages.index("light") < stages.index("render")
    assert told[-1] == ("render", 2, 2)

    def stop(stage: str, done: float, total: int) -> None:
        if stage == "render":
            raise LookupError("enough")

    with pytest.raises(LookupError, match="enough"):
        lumivox.render(cornell, size=(8, 8), progress=stop, **SMALL)


def test_ctrl_c_stops_a_render_but_keeps_the_renderer(renderer: Renderer, cornell: Scene) -> None:
    endless = Renderer(cornell, size=(16, 16), **{**SMALL, "frames": 65536})
    timer = threading.Timer(0.5, os.kill, (os.getpid(), signal.SIGINT))
    with pytest.raises(KeyboardInterrupt):
        # Start the timer here: on a busy machine the signal might come before the picture begins.
        timer.start()
        endless.render()
    assert endless.irradiance((0, 1, 0)).lux > 0


def test_rendering_releases_the_gil(cornell: Scene) -> None:
    renderer = Renderer(cornell, size=(64, 48), **{**SMALL, "frames": 8})
    done = threading.Event()
    counted = 0

    def count() -> None:
        nonlocal counted
        while not done.wait(0.001):
            counted += 1

    counter = threading.Thread(target=count)
    counter.start()
    renderer.render()
    done.set()
    counter.join()
    assert counted >= 10


def test_threads_share_a_renderer(renderer: Renderer) -> None:
    alone = [renderer.render(camera).radiance for camera in CAMERAS]
    results: dict[int, Any] = {}

    def work(index: int) -> None:
        results[index] = renderer.render(CAMERAS[index]).radiance

    threads = [threading.Thread(target=work, args=(index,)) for index in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    for index, expected in enumerate(alone):
        assert (results[index] == expected).all()


def test_use_in_a_forked_process_raises_an_error(renderer: Renderer) -> None:
    read, write = os.pipe()
    child = os.fork()
    if child == 0:
        try:
            renderer.render()
            message = "no exception"
        except InputError as error:
            message = str(error)
        os.write(write, message.encode())
        os._exit(0)
    os.waitpid(child, 0)
    message = os.read(read, 4096).decode()
    os.close(read)
    os.close(write)
    assert "forked" in message and "spawn" in message


def test_a_renderer_outlives_its_scene() -> None:
    scene = floor()
    renderer = Renderer(scene, size=(8, 8), **SMALL)
    before = renderer.render().radiance
    scene.set_material(0, base_color=0)
    del scene
    assert (renderer.render().radiance == before).all()


def test_a_render_survives_deletion_of_scene_and_renderer() -> None:
    scene = floor()
    kept: list[Any] = [Renderer(scene, size=(8, 8), **{**SMALL, "frames": 200}), scene]
    expected = kept[0].render().radiance
    results: list[Any] = []
    begun, freed = threading.Event(), threading.Event()

    def tell(stage: str, done: float, total: int) -> None:
        begun.set()
        assert freed.wait(60)

    def work(renderer: Renderer) -> None:
        results.append(renderer.render(progress=tell).radiance)

    # While it renders, the thread's argument is the only reference left.
    thread = threading.Thread(target=work, args=(kept[0],))
    thread.start()
    assert begun.wait(60)
    scene.set_material(0, base_color=0)
    kept.clear()
    del scene
    gc.collect()
    freed.set()
    thread.join()
    assert (results[0] == expected).all()


def test_memory_stays_flat(cornell: Scene) -> None:
    def resident_mib() -> float:
        pages = int(Path("/proc/self/statm").read_text().split()[1])
        return pages * os.sysconf("SC_PAGE_SIZE") / 2**20

    small = Renderer(cornell, size=(48, 32), **SMALL)

    def render(times: int) -> None:
        for number in range(times):
            small.render(CAMERAS[number % 2])
            if number % 10 == 0:
                small.irradiance(np.zeros((1000, 3)), frames=1)

    def renew(times: int) -> None:
        for _ in range(times):
            Renderer(cornell, size=(16, 12), **SMALL).render()
            lumivox.irradiance(cornell, (0, 0.5, 0), method="paths", samples=1)

    for work, warm, times in ((render, 25, 250), (renew, 5, 15)):
        work(warm)
        before = resident_mib()
        work(times)
        grown = resident_mib() - before
        print(f"{work.__name__}: {grown:.1f} MiB more after {times}")
        # A leaked picture of 48 x 32 has 24 KiB, all 250 have 6 MiB; a renderer has megabytes.
        assert grown < 4, work.__name__


def test_faces_report_area_reflectance_and_radiance() -> None:
    scene = floor(Material(base_color=0.5))
    scene.set_environment(1000)
    flat = Renderer(scene, size=(8, 8), surroundings="none", **{**SMALL, "bounces": 2})
    faces = flat.faces()
    count = len(faces["axis"])
    assert count >= flat.voxels and faces["cell"].shape == (count, 3)
    assert len(np.unique(faces["cell"], axis=0)) == flat.voxels
    up = faces["axis"] == 2
    # 4 m by 4 m, all of it facing up, to the rounding of sums in fixed point.
    assert faces["vector_area"][up, 1].sum() == pytest.approx(16, rel=0.01)
    np.testing.assert_allclose(faces["position"][up, 1], 0, atol=1e-3)
    # The floor reflects half of an open sky; cones are within a twentieth.
    np.testing.assert_allclose(faces["radiance"][up], 500, rtol=0.05)
    np.testing.assert_allclose(faces["reflectance"][up], 0.5, rtol=0.01)
    assert (faces["emission"] == 0).all()


def test_arrays_support_dlpack(renderer: Renderer) -> None:
    picture = renderer.render()
    shared = np.from_dlpack(picture.radiance)
    assert shared.dtype == np.float32 and np.shares_memory(shared, picture.radiance)
    assert np.shares_memory(np.from_dlpack(picture.layers["depth"]), picture.layers["depth"])


def test_pictures_of_arrays_are_shown_and_written(tmp_path: Path) -> None:
    grey = Picture(np.full((4, 6, 3), 0.18), exposure=0, tone_map="linear")
    # sRGB of 0.18 (IEC 61966-2-1): 118.
    assert np.abs(grey.screen().astype(int) - 118).max() <= 1
    png = grey.to_png(tmp_path / "grey.png")
    assert (tmp_path / "grey.png").read_bytes() == png
    with pytest.raises(OutputError, match="missing"):
        grey.to_png(tmp_path / "missing" / "a.png")
    grey.tone_map = "film"
    with pytest.raises(InputError, match="tone_map"):
        grey.screen()
    with pytest.raises(InputError, match=r"radiance: has the shape \(2, 2\)"):
        Picture(np.zeros((2, 2)))


def test_the_package_contains_the_program() -> None:
    def run(*arguments: str) -> subprocess.CompletedProcess[str]:
        command = [sys.executable, "-m", "lumivox", *arguments]
        return subprocess.run(command, capture_output=True, text=True)

    listed = run("scenes")
    assert listed.returncode == 0 and "cornell" in listed.stdout
    assert run("render", "no/such.glb", "-o", "a.png").returncode == 3
    assert run("rendre").returncode == 2
