"""Banks of houses without bodies or doors have none, and what happens in them is what happens beside padding."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from numpy.testing import assert_allclose, assert_array_equal

import home_mjx
from home_mjx import HouseBank
from home_mjx.bank.packing.capacity import AXES, capacity_of
from home_mjx.schema.compiled import CompiledHouse, Doors

CHEST = Furniture((1.5, 0.5), size=(1.0, 0.6, 1.0))
STOOL = Furniture((-1.0, -1.5), mass=4.0)
NUM_STEPS = 20


def with_door(house: CompiledHouse) -> CompiledHouse:
    """The house with a leaf in a corner, which looks like its first piece of furniture."""
    box = {"pos": np.array([[-2.6, 2.3, 1.0]]), "quat": np.eye(1, 4), "size": np.array([[0.3, 0.02, 0.9]])}
    closed, wide = np.zeros(1), np.full(1, -1.0)
    pivot, rest = (
        np.array([[-2.9, 2.3]]),
        {"mass": np.ones(1), "slide": np.zeros((1, 2)), "is_front": np.zeros(1, bool)},
    )
    return replace(house, doors=Doors(np.ones(1, np.int32), pivot, closed, wide, wide, closed, **box, **rest))


BARE = shoebox(furniture=[CHEST])
OTHERS = {"bodies": shoebox(furniture=[CHEST, STOOL]), "doors": with_door(BARE)}


def walk(bank: HouseBank, impl: str, num_agents: int = 1, hands: bool = False):
    """Agents' places and what they see in house 0, whatever other houses there are."""
    options = {"sensors": ("depth", "instance"), "width": 8, "height": 8, "hands": hands}
    env = home_mjx.make("PointNav-v0", bank, impl=impl, num_agents=num_agents, **options)
    size = env.action_spec.shape
    actions = jax.random.uniform(jax.random.key(1), (NUM_STEPS, *size), jnp.float32, -1.0, 1.0)

    @jax.jit
    def run(params):
        state = env.core.reset(params, jax.random.key(0), 0)
        return jax.lax.scan(lambda s, a: 2 * (env.core.step(params, s, a),), state, actions)[1]

    states = run(env.params)
    return np.asarray(states.physics.qpos)[:, : 4 * num_agents], jax.tree.map(np.asarray, states.obs)


def test_axes_are_empty_only_where_they_may_be():
    empty = {name for name, count in capacity_of([BARE]).items() if not count}
    assert (
        empty
        == {
            "bodies",
            "arrangements",
            "hinged_leaves",
            "slides",
            "fronts",
            "compartments",
            "tray_boxes",
            "switches",
            "glowing",
        }
        == {name for name, axis in AXES.items() if axis.optional}
    )
    assert HouseBank.from_compiled([BARE]).physics.body_pos.shape == (1, 0, 3)


@pytest.mark.parametrize(
    "impl", ["fused", *(pytest.param(impl, marks=pytest.mark.slow) for impl in ("jax", "kinematic"))]
)
def test_agents_walk_and_see_without_padding_as_with_it(impl):
    alone, seen = walk(HouseBank.from_compiled([BARE]), impl)
    assert np.ptp(alone[:, :2], axis=0).max() > 0.2
    # MJX takes long to compile, and treats doors as it does bodies.
    for other in [OTHERS["bodies"]] if impl == "jax" else OTHERS.values():
        padded, as_well = walk(HouseBank.from_compiled([BARE, other]), impl)
        assert_allclose(padded, alone, atol=1e-4)
        assert_allclose(as_well["pixels/head_depth"], seen["pixels/head_depth"], atol=2e-3)
        assert np.mean(as_well["ids/head_instance"] == seen["ids/head_instance"]) > 0.99


@pytest.mark.parametrize("impl", ["fused", "kinematic"])
def test_hands_of_several_agents_find_nothing(impl):
    bank = HouseBank.from_compiled([BARE])
    busy, _ = walk(bank, impl, num_agents=2, hands=True)
    assert busy.shape == (NUM_STEPS, 8)
    assert np.isfinite(busy).all()


def test_one_kind_alone():
    for name, house in OTHERS.items():
        bank = HouseBank.from_compiled([house])
        assert (bank.spec.num_bodies > 0) == (name == "bodies")
        assert (bank.spec.num_doors > 0) == (name == "doors")
        walked, _ = walk(bank, "fused", hands=True)
        assert_array_equal(np.isfinite(walked), True)
