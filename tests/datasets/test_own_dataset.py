"""A dataset from a user's file: registered, opened by its scheme, compiled, put into a bank, walked in."""

import functools
import importlib.util
import json
import os
import pickle
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import ClassVar

import jax
import jax.numpy as jnp
import numpy as np
import pytest

import home_mjx
from home_mjx.core.paths import CACHE_VARIABLE
from home_mjx.datasets import dataset_schemes, open_dataset
from home_mjx.datasets.registry import find_format
from home_mjx.errors import UnknownIdError, UnknownNameError
from home_mjx.houses import HouseSet, compile_dataset, load_bank
from home_mjx.houses.house_cache import HouseCache
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema import FINE, Semantic
from home_mjx.schema.house import Joint

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def user_file(tmp_path_factory) -> Path:
    """The example, as a module in a folder of the user's."""
    path = tmp_path_factory.mktemp("user") / "my_boxes.py"
    path.write_text((ROOT / "examples" / "own_dataset.py").read_text())
    return path


@pytest.fixture(scope="module")
def module(user_file) -> ModuleType:
    spec = importlib.util.spec_from_file_location("my_boxes", user_file)
    assert spec is not None
    assert spec.loader is not None
    found = importlib.util.module_from_spec(spec)
    sys.modules["my_boxes"] = found
    spec.loader.exec_module(found)
    return found


@pytest.fixture
def cache(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv(CACHE_VARIABLE, str(tmp_path / "cache"))
    return tmp_path / "cache"


def test_a_scheme_opens_the_registered_dataset(module):
    assert "boxes" in dataset_schemes()
    assert find_format("boxes").open is module.BoxDataset
    dataset = open_dataset("boxes:12")
    assert dataset == module.BoxDataset("12") != open_dataset("boxes:11")
    assert dataset.house_ids == tuple(f"boxes-{i}" for i in range(12))
    assert pickle.loads(pickle.dumps(dataset)) == dataset
    with pytest.raises(UnknownIdError, match="boxes-1"):
        dataset.load_house("boxes-100")
    with pytest.raises(UnknownNameError, match="boxes"):
        open_dataset("boxs:12")


def test_categories_map_to_the_vocabulary(module):
    dataset = open_dataset("boxes:1")
    assert dataset.metadata.info("crate").coarse == "ottoman"
    with pytest.raises(UnknownNameError, match="Did you mean `crate`"):
        dataset.model_info("x", "crates")

    class Wrong(module.BoxDataset):
        categories: ClassVar = {"crate": ("ottomann", "ottoman", "otherprop")}

    with pytest.raises(UnknownNameError, match="Did you mean `ottoman`"):
        _ = Wrong("1").metadata


def test_crates_and_walls_are_compiled(module):
    dataset = open_dataset("boxes:2")
    house = compile_house(dataset.load_house("boxes-1"), dataset.metadata)
    assert house.report["rooms"] == 2
    assert house.report["partitions"] == 7 + 4  # walls, of which one is shared, and a floor and a ceiling per room
    crates = house.semantics[house.semantics[:, Semantic.FINE] == FINE.index("ottoman")]
    assert len(crates) == module.NUM_CRATES
    assert house.report["bodies"] + house.report["movable_but_stuck"] == module.NUM_CRATES
    np.testing.assert_allclose(house.bodies.size.max(axis=1), module.EDGE / 2, atol=1e-6)


@pytest.mark.parametrize("axis", [1.0, -1.0])
def test_joints_of_a_door_are_leaves(module, axis):
    """A leaf and a frame in the doorway; an axis that points down turns the other way."""
    dataset = open_dataset("boxes:1")
    house = dataset.load_house("boxes-0")
    crate = house.models["crate"]
    frame, leaf = [0.05, 2.0, 0.1], [0.8, 1.9, 0.04]
    low = crate.vertices / module.EDGE
    vertices = np.concatenate([low * frame + [-0.43, 0.05, 0], low * leaf + [0.0, 0.06, 0]])
    two = {name: np.concatenate([getattr(crate, name)] * 2) for name in ("uv", "slot", "group")}
    mesh = replace(crate, vertices=vertices, faces=np.concatenate([crate.faces, crate.faces + 8]), **two)
    joint = Joint(
        "door", "leaf", "hinge", (0.0, axis, 0.0), (-0.4, 0.0, 0.0), min(0.0, axis), max(0.0, axis), ((12, 23),)
    )
    pose = np.array([[0, 0, 1, 5], [0, 1, 0, 0], [-1, 0, 0, 2], [0, 0, 0, 1]], float)
    door = replace(house.levels[0].objects[0], model_id="door", model_key="door", joints=(joint,), transform=pose)
    level = replace(house.levels[0], objects=(door,))
    info = dataset.model_info("door", "crate")
    metadata = replace(dataset.metadata, models={"door": replace(info, fine="door", coarse="door", nyu40="door")})
    compiled = compile_house(replace(house, levels=(level,), models={"door": mesh}), metadata)
    assert compiled.report["hinged_leaves"] == 1
    assert (compiled.doors.closed[0], compiled.doors.low[0]) == (0.0, 0.0)
    np.testing.assert_allclose(compiled.doors.fully_open[0], 1.0, atol=0.02)
    rigid = compile_house(replace(house, levels=(level,), models={"door": mesh}), dataset.metadata)
    assert rigid.report["hinged_leaves"] == 0  # not a door


def test_a_bank_is_walked_in(module):
    bank = load_bank("boxes:12", num_houses=2)
    env = home_mjx.make("PointNav-v0", bank, sensors=("goal",), impl="kinematic", ctrl_dt=0.3)
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 4))
    step = jax.jit(jax.vmap(env.step))
    before = states.metrics["distance"]
    for _ in range(5):
        states = step(states, jnp.tile(jnp.array([1.0, 0.0, 0.0, 0.0]), (4, 1)))
    assert np.isfinite(states.metrics["distance"]).all()
    assert (states.metrics["distance"] != before).any()


def test_entries_are_cached_until_the_file_changes(module, user_file, cache):
    dataset = open_dataset("boxes:2")
    assert compile_dataset(dataset, ids=["boxes-0"]).compiled == 1
    assert compile_dataset("boxes:2", ids=["boxes-0"]).cached == 1
    assert HouseSet("boxes:2", num_houses=1).house_ids == ("boxes-0",)
    text = user_file.read_text()
    try:
        user_file.write_text(f"{text}\n# changed\n")
        houses = HouseCache(open_dataset("boxes:2"))
        houses.load("boxes-0")
        assert houses.num_compiled == 1
    finally:
        user_file.write_text(text)


def home_mjx_in(folder: Path, cache: Path, paths: list[Path], *arguments: str) -> str:
    """Output of the command line in a folder, with a cache of its own."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(map(str, paths)), CACHE_VARIABLE: str(cache)}
    command = [sys.executable, "-m", "home_mjx.cli", *arguments]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300, env=environment, cwd=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


def test_the_command_line_finds_it_by_its_entry_point(user_file, tmp_path):
    """A distribution is a folder beside the module that names its entry points."""
    info = user_file.parent / "my_boxes-1.0.dist-info"
    info.mkdir(exist_ok=True)
    (info / "METADATA").write_text("Metadata-Version: 2.1\nName: my-boxes\nVersion: 1.0\n")
    (info / "entry_points.txt").write_text("[home_mjx.datasets]\nboxes = my_boxes:BoxDataset\n")
    run = functools.partial(home_mjx_in, tmp_path, tmp_path / "cache", [user_file.parent, ROOT])
    assert "2 compiled" in run("compile", "boxes:2", "--workers", "1")
    found = json.loads(run("inspect", "boxes-1", "--dataset", "boxes:2", "--json"))
    assert (found["id"], found["counts"]["rooms"]) == ("boxes-1", 2)
    assert json.loads(run("inspect", "boxes:2", "--json"))["counts"]["houses"] == 2


def test_commands_import_its_module(user_file, tmp_path):
    """From the current folder, also in the processes that compile."""
    own = tmp_path / "own"
    own.mkdir()
    (own / "my_boxes.py").write_text(user_file.read_text())
    run = functools.partial(home_mjx_in, own, tmp_path / "cache", [ROOT])
    assert "2 compiled" in run("compile", "boxes:2", "--workers", "2", "--import", "my_boxes")
    assert json.loads(run("inspect", "boxes:2", "--json", "--import", "my_boxes"))["counts"]["houses"] == 2


def test_another_reader_of_the_same_files_has_its_own_cache_entries(module, cache):
    """A subclass with equal ids and digests was once given the houses of its base."""

    class Others(module.BoxDataset):
        pass

    first, second = open_dataset("boxes:3"), Others("3")
    house_id = first.house_ids[0]
    assert first.inputs().house(house_id) == second.inputs().house(house_id)
    assert HouseCache(first).entry_path(house_id) != HouseCache(second).entry_path(house_id)


def test_generated_houses_share_entries_with_their_folder():
    generated = open_dataset("procedural:1?seed=5&preset=flat")
    generated.prepare(generated.house_ids)
    house_id = generated.house_ids[0]
    folder = open_dataset(generated.root)
    assert HouseCache(generated).entry_path(house_id) == HouseCache(folder).entry_path(house_id)
