"""The archive is installed by Blender itself, which then renders."""

from __future__ import annotations

import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

import pack
from conftest import HERE, ROOT, environment

PROGRAM = """
import sys, bpy
bpy.ops.extensions.package_install_files(filepath=sys.argv[1], repo="user_default", enable_on_install=True)
import lumivox
print("package", lumivox.__file__)
scene = bpy.context.scene
scene.render.engine = "LUMIVOX"
scene.render.resolution_x = scene.render.resolution_y = 16
scene.lumivox.samples, scene.lumivox.resolution = 1, 16
scene.render.filepath = sys.argv[2]
bpy.ops.render.render(write_still=True)
bpy.ops.preferences.addon_disable(module="bl_ext.user_default.lumivox")
print("left", hasattr(scene, "lumivox"))
"""


@pytest.fixture(scope="session")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A wheel of the package as it is built for tests."""
    package = ROOT / "crates/lumivox-python/python/lumivox"
    made = tmp_path_factory.mktemp("wheel") / "lumivox-0.1.0-cp310-abi3-linux_x86_64.whl"
    about = "lumivox-0.1.0.dist-info"
    with zipfile.ZipFile(made, "w") as archive:
        for file in sorted(package.iterdir()):
            if file.suffix in (".py", ".so", ".pyi"):
                archive.write(file, f"lumivox/{file.name}")
        archive.writestr(f"{about}/METADATA", "Metadata-Version: 2.1\nName: lumivox\nVersion: 0.1.0\n")
        archive.writestr(
            f"{about}/WHEEL",
            "Wheel-Version: 1.0\nGenerator: tests\nRoot-Is-Purelib: false\nTag: cp310-abi3-linux_x86_64\n",
        )
        archive.writestr(f"{about}/RECORD", "")
    return made


@pytest.mark.skipif(sys.platform != "linux", reason="the test's wheel is for Linux")
def test_blender_installs_the_archive_and_renders(wheel: Path, tmp_path: Path) -> None:
    archive, picture = tmp_path / "lumivox-blender.zip", tmp_path / "picture.png"
    subprocess.run(
        [sys.executable, str(HERE.parent / "pack.py"), str(wheel), "-o", str(archive)], check=True
    )
    user = tmp_path / "user"
    clean = environment(PYTHONPATH="", BLENDER_USER_RESOURCES=str(user))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(archive), str(picture)],
        env=clean,
        capture_output=True,
        text=True,
    )
    told = done.stdout + done.stderr
    assert done.returncode == 0, told
    assert picture.read_bytes().startswith(b"\x89PNG"), told
    assert f"package {user}" in done.stdout and "left False" in done.stdout, told


def test_what_is_not_a_wheel_is_refused(tmp_path: Path) -> None:
    command = [sys.executable, str(HERE.parent / "pack.py"), str(tmp_path / "other.whl")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 1 and "not a wheel of lumivox" in done.stderr


def test_the_manifest_names_the_wheel() -> None:
    import tomllib

    told = tomllib.loads(pack.manifest("lumivox-1.whl"))
    assert told["wheels"] == ["./wheels/lumivox-1.whl"]
    assert told["id"] == "lumivox" and told["blender_version_min"] == "5.0.0"
