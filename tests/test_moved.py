"""Import paths of 0.1.0 that have moved: each names the new one, and the new one is there."""

import importlib
import pickle
import subprocess
import sys

import pytest

from home_mjx import moved

# Every import path that 0.1.0's documentation named and that is gone: its guides' imports and its API page.
DOCUMENTED = (
    "home_mjx.raycast_render.cast.cast",
    "home_mjx.raycast_render.image.camera",
    "home_mjx.raycast_render.image.noise",
    "home_mjx.raycast_render.image.preset",
    "home_mjx.raycast_render.image.render.render",
    "home_mjx.raycast_render.image.schedule",
    "home_mjx.scene_compile.bank.HouseBank",
    "home_mjx.scene_compile.compile.CompileOptions",
    "home_mjx.scene_compile.compile.compile_house",
    "home_mjx.scene_compile.compiled.CompiledHouse",
    "home_mjx.scene_compile.compiled.Ray",
    "home_mjx.scene_compile.compiled.Semantic",
    "home_mjx.scene_compile.dataset_job",
    "home_mjx.scene_compile.generate",
    "home_mjx.scene_compile.house.House",
    "home_mjx.scene_compile.house_stream.HouseStream",
    "home_mjx.scene_compile.mjcf.export_mjcf",
    "home_mjx.scene_compile.selection",
    "home_mjx.scene_compile.semantics.options.SemanticOptions",
    "home_mjx.scene_compile.suncg.finding.RULES",
    "home_mjx.scene_compile.suncg.open_dataset",
    "home_mjx.tasks.geodesic.goal_fields",
    "home_mjx.tasks.grid",
)


@pytest.mark.parametrize("old", moved.MOVED)
def test_the_new_place_exports_the_names(old: str):
    package, names = moved.MOVED[old]
    assert set(names) <= set(importlib.import_module(package).__all__)
    assert len(set(names)) == len(names) > 0


@pytest.mark.parametrize("old", moved.MOVED)
def test_importing_the_old_path_names_the_new_one(old: str):
    package, names = moved.MOVED[old]
    with pytest.raises(ModuleNotFoundError) as caught:
        importlib.import_module(old)
    assert str(caught.value) == f"`{old}` has moved. Use: from {package} import {', '.join(names)}"


@pytest.mark.parametrize("old", moved.MOVED)
def test_a_name_that_left_its_package_names_the_new_one(old: str):
    """By `from package import name` and as an attribute."""
    package, _, name = old.rpartition(".")
    if old == "home_mjx.raycast_render.cast":
        pytest.skip("the package has a function of this name")
    with pytest.raises(ImportError, match=f"from {moved.MOVED[old][0]} import"):
        exec(f"from {package} import {name}", {})
    with pytest.raises(AttributeError, match=f"from {moved.MOVED[old][0]} import"):
        getattr(importlib.import_module(package), name)


@pytest.mark.parametrize("path", DOCUMENTED)
def test_every_documented_path_has_a_row(path: str):
    """And its row names what the path ended in, if that was a name."""
    (old,) = [old for old in moved.MOVED if f"{path}.".startswith(f"{old}.")]
    name = path.rpartition(".")[2]
    assert path == old or name in moved.MOVED[old][1] or name in ("camera", "noise", "preset", "schedule")


def test_a_module_that_never_was_is_not_ours():
    with pytest.raises(ModuleNotFoundError, match=r"No module named 'home_mjx.nothing'"):
        importlib.import_module("home_mjx.nothing")
    with pytest.raises(ImportError, match=r"cannot import name 'nothing' from 'home_mjx.tasks'"):
        exec("from home_mjx.tasks import nothing", {})


def test_the_finder_is_last_and_there_once():
    program = """
import sys
before = list(sys.meta_path)
import home_mjx, importlib
importlib.reload(home_mjx)
assert [f for f in sys.meta_path if f not in before] == [sys.meta_path[-1]] == [home_mjx.moved.FINDER]
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=60)


def test_pickles_of_old_classes_say_where_the_class_is_now():
    with pytest.raises(ModuleNotFoundError, match=r"from home_mjx.schema import .*House"):
        pickle.loads(b"chome_mjx.scene_compile.house\nHouse\n.")  # protocol 0: the class by its name
