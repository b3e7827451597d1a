"""Who is told to be outside: beyond the fence or under the ground floor, by every corner of every body."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from scipy.spatial.transform import Rotation

import home_mjx
from home_mjx import HouseBank, physics
from home_mjx.physics import PhysicsConfig, Template, is_out_of_bounds
from home_mjx.physics.dynamics import MIN_DEPTH_BELOW_FLOOR
from home_mjx.schema import AgentBody
from home_mjx.tasks import Status

CORNERS = np.array(list(itertools.product((-1.0, 1.0), repeat=3)))
NUM = 500


@pytest.fixture(scope="module")
def bank():
    crates = [Furniture((x, 0.5), size=(0.4, 0.3, 0.6), mass=5.0) for x in (-1.0, 1.0)]
    return HouseBank.from_compiled([shoebox(furniture=crates)])


def test_the_lot_ends_at_the_fence(generated_bank):
    """Nothing that is solid has its middle farther out than the fence."""
    arrays = generated_bank.physics
    for house in range(generated_bank.num_houses):
        middle = np.asarray(arrays.collider_pos[house])
        middle = middle[middle[:, 2] > -50, :2]  # the rest is padding
        np.testing.assert_array_equal(arrays.fence_rectangle[house], [middle.min(axis=0), middle.max(axis=0)])


def test_it_is_what_corners_say(bank):
    """Random poses about the edges of the lot and the floor; bodies that the house does not use count for nothing."""
    rng, bodies = np.random.default_rng(0), (AgentBody(), AgentBody(radius=0.2, height=1.0, eye_height=0.9))
    template = Template(PhysicsConfig(num_agents=2, bodies=bodies), bank.spec)
    start = physics.reset(template, bank, jnp.int32(0), jnp.zeros((2, 3)), jnp.zeros(2))
    layout, lot = template.layout, np.asarray(bank.physics.fence_rectangle[0], float)
    np.testing.assert_allclose(lot, [[-5.0, -4.5], [5.0, 4.5]], atol=1e-6)  # a room of 6 by 5 m, and 2 m around it
    count = 2 + layout.num_bodies
    pos = np.c_[rng.uniform(-5.5, 5.5, (NUM, count, 2)), rng.uniform(-0.2, 1.2, (NUM, count, 1))]
    turn = Rotation.random(NUM * count, random_state=1)
    quat = turn.as_quat(scalar_first=True).reshape(NUM, count, 4)
    agents = np.concatenate([pos[:, :2], np.zeros((NUM, 2, 1))], axis=-1)
    free = np.concatenate([pos[:, 2:], quat[:, 2:]], axis=-1)
    qpos = np.tile(np.asarray(start.qpos), (NUM, 1))
    qpos[:, layout.agent_qpos], qpos[:, layout.body_qpos] = agents.reshape(NUM, -1), free.reshape(NUM, -1)
    found = jax.vmap(lambda q: is_out_of_bounds(template, bank, jnp.int32(0), start.replace(qpos=q)))(
        jnp.asarray(qpos, jnp.float32)
    )
    matrix = turn.as_matrix().reshape(NUM, count, 3, 3)
    half = np.concatenate([np.zeros((2, 3)), np.asarray(bank.physics.body_size[0])])
    lowest = (pos[:, :, None] + np.einsum("ebij,bcj->ebci", matrix, CORNERS * half[:, None]))[..., 2].min(axis=-1)
    lowest[:, :2] = pos[:, :2, 2] - [0.8, 0.5]
    beyond = ((pos[..., :2] < lot[0]) | (pos[..., :2] > lot[1])).any(axis=-1)
    wanted = (beyond | (lowest < -MIN_DEPTH_BELOW_FLOOR)) & np.r_[True, True, np.asarray(bank.physics.body_valid[0])]
    near = abs(lowest + MIN_DEPTH_BELOW_FLOOR) < 1e-5
    assert (np.asarray(found)[~near] == wanted[~near]).all()
    assert wanted[:, :4].any(axis=0).all()
    assert not wanted[:, :4].all(axis=0).any()


def test_the_status_tells_of_it(bank):
    """Environment 1: the agent is beyond the fence; 2: a crate is under the floor; 3: it is only 2 cm deep in it."""
    env = home_mjx.make("PointNav-v0", bank, impl="kinematic", sensors=("state",))
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 5))
    crate = env.core.template(bank).layout.body_qpos.start
    qpos = states.physics.qpos.at[1, 0].set(5.2).at[2, crate + 2].set(0.24).at[3, crate + 2].set(0.28)
    after = jax.jit(jax.vmap(env.step))(states.replace(physics=states.physics.replace(qpos=qpos)), jnp.zeros((5, 4)))
    assert [Status(int(s)) for s in after.status] == [0, Status.OUTSIDE, Status.OUTSIDE, 0, 0]
