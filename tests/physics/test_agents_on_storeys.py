"""Agents on every storey, in every implementation: who stands on a floor stays there, whatever its height."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from storey_homes import HOMES, homes_bank
from storeys import METADATA

from home_mjx import HouseBank, physics
from home_mjx.datasets.outlines import RoomOutline, outline_house
from home_mjx.datasets.storeys import stack_levels
from home_mjx.navigation.grid import cell_at_feet, grid_position
from home_mjx.physics import PhysicsConfig, Template, agent_pose
from home_mjx.scene_compile.pipeline.compile import compile_house

HALF, STEPS = 0.8, 30
IMPLEMENTATIONS = ["fused", pytest.param("jax", marks=pytest.mark.slow), "c", "kinematic"]


def stepper(template, bank):
    """Function of houses, starts and actions that gives the positions of agents and contacts after each step."""

    def one(house, start, actions):
        state = physics.reset(template, bank, house, start[None], jnp.zeros(1))

        def step(state, action):
            state = physics.step(template, bank, house, state, action[None])
            return state, (agent_pose(template, state)[0][0], state.num_contacts[0])

        return jax.lax.scan(step, state, actions)[1]

    return jax.jit(jax.vmap(one))


@pytest.mark.parametrize("impl", IMPLEMENTATIONS)
def test_who_stands_still_stays_on_its_storey(impl, rng):
    bank = homes_bank()
    template = Template(PhysicsConfig(impl=impl), bank.spec)
    count = 4 if impl == "jax" else 16
    house = np.repeat(np.arange(bank.num_houses), count)
    start = np.concatenate([np.asarray(bank.navigation.start[h])[:count] for h in range(bank.num_houses)])
    steps = 3 if impl == "jax" else STEPS
    still = jnp.zeros((len(house), steps, 3))
    path, touched = stepper(template, bank)(jnp.asarray(house, jnp.int32), jnp.asarray(start), still)
    away = np.abs(np.asarray(path) - (start + np.array([0, 0, HALF]))[:, None])
    assert away.max() < 0.02, (house[away.max(axis=(1, 2)).argmax()], away.max())
    assert not np.asarray(touched).any()  # neither the ground nor an upper floor is an obstacle


@pytest.mark.parametrize("impl", ["fused", "kinematic"])
def test_agents_that_turn_and_walk_are_on_a_floor_or_on_stairs(impl, rng):
    """Random walks: the feet are never beside a surface of the grids."""
    bank = homes_bank()
    template = Template(PhysicsConfig(impl=impl), bank.spec)
    count = 32
    house = np.repeat(np.arange(bank.num_houses), count)
    start = np.concatenate([np.asarray(bank.navigation.start[h])[:count] for h in range(bank.num_houses)])
    turn = np.repeat(rng.uniform(-0.6, 0.6, (len(house), 6, 1)), 10, axis=1)
    actions = np.concatenate([np.ones_like(turn), np.zeros_like(turn), turn], axis=2)
    inputs = (house.astype(np.int32), start, actions.astype(np.float32))
    path = np.asarray(stepper(template, bank)(*(jnp.asarray(x) for x in inputs))[0])
    feet = path - np.array([0, 0, HALF])
    gap = np.asarray(
        jax.jit(jax.vmap(jax.vmap(lambda h, p: gap_to_surface(bank, h, p), (None, 0))))(
            jnp.asarray(house, jnp.int32), jnp.asarray(feet, jnp.float32)
        )
    )
    assert np.abs(gap).max() < 0.12, (house[np.abs(gap).max(axis=1).argmax()], np.abs(gap).max())


def gap_to_surface(bank, house, feet):
    """Height of feet above the cell on which they stand [m]."""
    return feet[2] - grid_position(bank, house, cell_at_feet(bank, house, feet))[2]


def test_a_kinematic_agent_stands_on_upper_floors_of_any_height():
    """In float32 the top of a slab may be above the height on which agents are put: 2.8500001 and 2.8499999."""
    (low,) = outline_house("x", [RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)])]).levels
    rises = np.round(np.arange(2.40, 3.11, 0.05), 2).tolist()
    plain = outline_house("x", [RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)])])
    houses = [replace(plain, id=f"rise{rise}", levels=stack_levels([low, low], rise)) for rise in rises]
    bank = HouseBank.from_compiled([compile_house(house, METADATA) for house in houses])
    template = Template(PhysicsConfig(impl="kinematic"), bank.spec)
    start = np.c_[np.full((len(rises), 2), 0.3), np.asarray(bank.navigation.floor[:, 1])].astype(np.float32)
    moves = np.tile(np.array([[0, 0, 0], [0, 0, 1], [-0.5, 0, 0]], np.float32), (len(rises), 1, 1))
    rows = np.arange(len(rises), dtype=np.int32)
    path = np.asarray(stepper(template, bank)(*(jnp.asarray(x) for x in (rows, start, moves)))[0])
    np.testing.assert_allclose(path[:, 1], start + np.array([0, 0, HALF]), atol=0.01)
    np.testing.assert_allclose(np.linalg.norm(path[:, 2] - path[:, 1], axis=1), 0.05, atol=0.01)


def test_there_are_homes_of_one_two_and_three_storeys():
    assert {len(storeys) for storeys, _ in HOMES.values()} == {1, 2, 3}
