#!/usr/bin/env python3
"""Packs the extension with a wheel of the Python package into an archive that Blender installs."""

from __future__ import annotations

import argparse
import sys
import zipfile
from pathlib import Path

SOURCE = Path(__file__).resolve().parent / "extension"


def manifest(wheel: str) -> str:
    """The extension's manifest, with the wheel that it brings."""
    text = (SOURCE / "blender_manifest.toml").read_text(encoding="utf-8")
    table = "\n[permissions]"
    assert table in text
    return text.replace(table, f'\nwheels = ["./wheels/{wheel}"]\n{table}', 1)


def pack(wheel: Path, target: Path) -> None:
    """Writes the archive."""
    with zipfile.ZipFile(target, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("blender_manifest.toml", manifest(wheel.name))
        for file in sorted(SOURCE.rglob("*.py")):
            archive.write(file, file.relative_to(SOURCE))
        archive.write(wheel, f"wheels/{wheel.name}", zipfile.ZIP_STORED)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "wheel",
        type=Path,
        help="the wheel, as of: maturin build --release -m crates/lumivox-python/Cargo.toml",
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("lumivox-blender.zip"), help="the archive (default: %(default)s)"
    )
    arguments = parser.parse_args()
    wheel = arguments.wheel
    if not (wheel.is_file() and wheel.name.startswith("lumivox-") and wheel.suffix == ".whl"):
        sys.exit(f"error: {wheel} is not a wheel of lumivox; make one with maturin (docs/python.md)")
    pack(wheel, arguments.output)
    print(f"{arguments.output}: install it in Blender with Edit > Preferences > Get Extensions > Install from Disk")


if __name__ == "__main__":
    main()
