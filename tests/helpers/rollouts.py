"""One batch of scenes, stepped by one compiled function that all tests share."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from tiny_houses import Box, TinyHouse, make_bank

from home_mjx import physics
from home_mjx.physics import PhysicsConfig, Template

LENGTH = 20  # control steps of one call: 2 s

SLOPE = np.deg2rad(20)
WALL = [Box((1.55, y, 1.25), (0.05, 0.75, 1.25)) for y in np.arange(-6, 12, 1.5)]  # 1.5 m pieces: seams
SCENES = {
    "free": TinyHouse(
        static=[Box((-2, 2, 0.2), (0.5, 0.5, 0.2))],
        movable=[
            Box((-2, -2, 0.6), (0.2, 0.15, 0.1), mass=3, roll=0.35),
            Box((-2, 2, 0.8), (0.2, 0.15, 0.1), mass=40, roll=0.35),
        ],
    ),
    "light": TinyHouse(movable=[Box((0.5, 0, 0.15), (0.15, 0.15, 0.15), mass=5)]),
    "wardrobe": TinyHouse(movable=[Box((0.65, 0, 1.0), (0.3, 0.5, 1.0), mass=200)]),
    "sofa": TinyHouse(movable=[Box((0.6, 0, 0.4), (0.4, 0.8, 0.4), mass=45)]),
    "wall": TinyHouse(static=WALL),
    "slide": TinyHouse(static=WALL),
    "fall": TinyHouse(
        static=[Box((2, 2, 0.2), (0.4, 0.4, 0.2)), Box((0, 0, 0.004), (2, 2, 0.004))],
        movable=[
            Box((-1.5, 1, 1.0), (0.2, 0.15, 0.1), mass=3),
            Box((2, 2, 0.501), (0.2, 0.2, 0.1), yaw=0.5, mass=100),
            Box((-1.5, -1, 0.2), (0.15, 0.15, 0.2), mass=20),
            Box((-1.5, -1, 0.501), (0.1, 0.1, 0.1), mass=2),
        ],
    ),
    "surfaces": TinyHouse(  # a slope of 20 degrees with a slippery and a rough box; a ball and what it falls on
        static=[Box((0, 3, 0.8), (1.5, 1.5, 0.2), roll=SLOPE)],
        movable=[
            Box((-0.7, 3 - 0.3 * np.sin(SLOPE), 0.8 + 0.3 * np.cos(SLOPE)), (0.1,) * 3, 0, 2, SLOPE, friction=0.1),
            Box((0.7, 3 - 0.3 * np.sin(SLOPE), 0.8 + 0.3 * np.cos(SLOPE)), (0.1,) * 3, 0, 2, SLOPE, friction=0.7),
            Box((-2, -2, 0.55), (0.15, 0.15, 0.15), mass=4, restitution=0.5),
            Box((1, -2, 0.95), (0.1, 0.15, 0.1), mass=1, restitution=0.8),
        ],
    ),
    "crowded": TinyHouse(
        floor=0.3,
        static=[Box((1.2, 0, 1.5), (0.05, 2, 1.2), yaw=0.3)],
        movable=[Box((0.5, 0.1 * k, 0.5 + 0.4 * k), (0.2, 0.15, 0.19), yaw=0.4 * k, mass=3 + 4 * k) for k in range(4)],
    ),
}
ACTIONS = {"free": (1, 0, 1), "slide": (1, 1, 0), "fall": (0, 0, 0), "surfaces": (0, 0, 0), "crowded": (1, 0.2, 0.1)}
NAMES = tuple(SCENES)
BATCH = len(NAMES)


class Rollout(NamedTuple):
    """After each control step; leading axes time, scene."""

    agent_pos: np.ndarray
    agent_yaw: np.ndarray
    agent_velocity: np.ndarray
    contact: np.ndarray
    body_pos: np.ndarray
    body_quat: np.ndarray
    door_angle: np.ndarray


def build(impl="jax"):
    """The bank and its template."""
    bank = make_bank(list(SCENES.values()))
    return bank, Template(PhysicsConfig(impl=impl), bank.spec)


def actions(names=NAMES, length=LENGTH):
    rows = jnp.array([ACTIONS.get(name, (1, 0, 0)) for name in names], jnp.float32)
    return jnp.broadcast_to(rows[None, :, None], (length, len(names), 1, 3))


def start(bank, template, house):
    """Agents at the origin of each house, looking along +x."""

    def one(h):
        feet = jnp.zeros((1, 3), jnp.float32).at[0, 2].set(bank.physics.floor[h])
        return physics.reset(template, bank, h, feet, jnp.zeros(1, jnp.float32))

    return jax.jit(jax.vmap(one))(house)


def make_run(template):
    """A compiled `run(bank, house, data, actions) -> data, Rollout`."""

    def observe(data):
        pos, yaw = physics.agent_pose(template, data)
        velocity, contact = physics.agent_velocity(template, data), physics.agent_contact(template, data)
        return Rollout(
            pos, yaw, velocity, contact, *physics.body_pose(template, data), data.qpos[template.layout.door_qpos]
        )

    @jax.jit
    def run(bank, house, data, actions):
        def step(data, action):
            data = jax.vmap(lambda h, d, a: physics.step(template, bank, h, d, a))(house, data, action)
            return data, jax.vmap(observe)(data)

        return jax.lax.scan(step, data, actions)

    def run_strict(*args):
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            data, rollout = run(*args)
        return data, Rollout(*map(np.asarray, rollout))

    return run_strict
