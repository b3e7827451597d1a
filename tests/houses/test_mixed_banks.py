"""Houses of five formats in one bank, stepped by one compiled program."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from gltf_files import BOXES, two_rooms
from habitat_files import write_dataset
from thor_houses import write_house

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.datasets import open_dataset
from home_mjx.houses.house_cache import load_compiled
from home_mjx.schema.compiled import CompiledHouse

pytestmark = pytest.mark.slow
FORMATS = ("procedural", "procthor", "mjcf", "gltf", "habitat")


@pytest.fixture(scope="module")
def houses(tmp_path_factory) -> dict[str, CompiledHouse]:
    """One small house of each format, compiled and kept in the cache."""
    root: Path = tmp_path_factory.mktemp("mixed")
    patch = pytest.MonkeyPatch()
    patch.setenv("HOME_MJX_CACHE", str(root / "cache"))
    for name in ("thor", "gltf", "mjcf"):
        (root / name).mkdir()
    geoms = []
    for name, (low, high) in BOXES.items():
        middle, half = (np.array(low) + high) / 2, (np.array(high) - low) / 2
        size, place = (" ".join(f"{v[i]:.4f}" for i in (0, 2, 1)) for v in (half, middle * [1, 1, -1]))
        geoms.append(f'<geom name="{name}" type="box" size="{size}" pos="{place}"/>')
    (root / "mjcf" / "flat.xml").write_text(f"<mujoco><worldbody>{''.join(geoms)}</worldbody></mujoco>")
    names = {
        "procedural": "procedural:1?seed=3&preset=flat",
        "procthor": f"procthor:{write_house(root / 'thor')}",
        "mjcf": f"mjcf:{root / 'mjcf' / 'flat.xml'}",
        "gltf": f"gltf:{two_rooms().write(root / 'gltf' / 'flat.glb')}",
        "habitat": f"habitat:{write_dataset(root / 'habitat')}",
    }
    datasets = {kind: open_dataset(name) for kind, name in names.items()}
    for dataset in datasets.values():
        dataset.prepare(dataset.house_ids[:1])
    yield {kind: load_compiled(dataset, dataset.house_ids[0]) for kind, dataset in datasets.items()}
    patch.undo()


def test_houses_of_all_formats_are_stepped_by_one_program(houses):
    """Every house is used by an episode; agents that walk are in it, and see and hear nothing that is not finite."""
    bank = HouseBank.from_compiled([houses[kind] for kind in FORMATS])
    sensors = ("depth", "goal", "state")
    env = home_mjx.make("PointNav-v0", bank, sensors=sensors, width=8, height=6, impl="kinematic")
    step = jax.jit(jax.vmap(env.step))
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 24))
    walk = jnp.zeros((24, env.action_size)).at[:, 0].set(1.0)
    for _ in range(5):
        states = step(states, walk)
    assert step._cache_size() == 1
    assert set(np.unique(states.world.house)) == set(range(len(FORMATS)))
    assert all(np.isfinite(value).all() for value in jax.tree.leaves(states.obs))
    depth = np.asarray(states.obs["pixels/head_depth"])
    assert (depth.reshape(24, -1).min(axis=1) < 8).all()  # each agent is in a room


@pytest.mark.parametrize("kind", FORMATS)
def test_every_room_of_a_house_is_in_its_home_region(houses, kind):
    house = houses[kind]
    grid = house.navigation
    reached = set(np.unique(grid.room[0][grid.region[0] == 0])) - {-1}
    assert len(reached) >= min(2, len(house.rooms.polygon))
