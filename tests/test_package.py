"""What ``import labkit`` offers, and what it does not load."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import labkit as lk

ROOT = Path(__file__).parents[1]


def python(program):
    environment = os.environ | {"PYTHONPATH": str(ROOT)}
    words = [sys.executable, "-c", program]
    done = subprocess.run(words, capture_output=True, text=True, env=environment, check=False)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_every_name_in_all_exists():
    """Any other name is an AttributeError."""
    assert all(getattr(lk, name) is not None for name in lk.__all__)
    with pytest.raises(AttributeError, match="Robot9"):
        _ = lk.Robot9


def test_a_public_name_means_the_same_whichever_module_was_loaded_first():
    """A name loaded late may not be hidden by a module of the same name."""
    kinds = "print({name: type(getattr(labkit, name)).__name__ for name in labkit.__all__})"
    modules = ", ".join(f"labkit.{path.stem}" for path in (ROOT / "labkit").glob("[a-z]*.py"))
    assert python(f"import labkit, {modules}; {kinds}") == python(f"import labkit; {kinds}")


def test_importing_labkit_loads_no_drawing_nor_notebook_package():
    """Nor what detects tags, analyses loops or grades; `dir` lists the late names all the same."""
    loaded = {
        name.split(".")[0] for name in python("import sys, labkit; print(*sys.modules)").split()
    }
    assert not loaded & {"matplotlib", "IPython", "anywidget", "ipywidgets", "cv2", "scipy",
                         "control", "click", "msgspec", "nbgrader", "pandas"}  # fmt: skip
    assert set(lk.__all__) <= set(dir(lk))
