"""The notebooks of examples/python, without a screen and with small sizes."""

from __future__ import annotations

import os
from importlib import import_module
from pathlib import Path
from typing import Any

import pytest

nbformat: Any = import_module("nbformat")
nbclient: Any = import_module("nbclient")

FOLDER = Path(__file__).parents[3] / "examples" / "python"

#: The sizes of the tests by notebook, which must define all of these names.
SMALL: dict[str, dict[str, Any]] = {
    "dataset": {"SCENE": "cornell", "VIEWS": 3, "SIZE": (24, 16), "FRAMES": 1, "RESOLUTION": 32},
    "daylight": {"HOURS": (9, 12), "RESOLUTION": 32, "GRID": (3, 4), "FRAMES": 2, "SAMPLES": 64},
    "error": {
        **{"SCENE": "cornell", "SIZE": (32, 18), "TRUTH": 64, "SAMPLES": (1, 16)},
        **{"FRAMES": (1, 2), "PRESETS": ("fast",)},
    },
}


def test_every_notebook_is_tested() -> None:
    assert {file.stem for file in FOLDER.glob("*.ipynb")} == set(SMALL)


@pytest.mark.parametrize("name", SMALL)
def test_notebook(name: str, tmp_path: Path) -> None:
    notebook = nbformat.read(FOLDER / f"{name}.ipynb", as_version=4)
    (parameters,) = (cell for cell in notebook.cells if "parameters" in cell.metadata.get("tags", ()))
    for key in SMALL[name]:
        assert f"{key} = " in parameters.source, key
    assert all(not cell.get("outputs") for cell in notebook.cells), "notebooks are kept without outputs"
    if not os.environ.get("LUMIVOX_NOTEBOOKS_LARGE"):
        parameters.source = "\n".join(f"{key} = {value!r}" for key, value in SMALL[name].items())
    # An exception in a cell is raised here.
    nbclient.NotebookClient(notebook, timeout=600, kernel_name="python3").execute(cwd=str(tmp_path))
    outputs = [output for cell in notebook.cells for output in cell.get("outputs", ())]
    pictures = [output["data"]["image/png"] for output in outputs if "image/png" in output.get("data", {})]
    assert pictures, "a notebook shows what it has found"
    folder = os.environ.get("LUMIVOX_NOTEBOOKS_LARGE")
    if folder:
        nbformat.write(notebook, Path(folder) / f"{name}.ipynb")
