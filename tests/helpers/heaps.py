"""Heaps of moving things, to try contacts on."""

import numpy as np
from c_oracle import Boxes, Leaves, Oracle

from home_mjx.physics import PhysicsSetup
from home_mjx.physics.base.doors import TRAY_BOXES
from home_mjx.schema.contact_materials import damping_ratio
from home_mjx.schema.mjcf import contact_parameters

BODIES, STATIC, AGENTS, DOORS = 6, 10, 2, 4
RAMPS = np.array([[0.3, 0.2, 0.6, 0.8, 1.0, 0.5, 0.0, 0.6], [0, 0, 1, 0, -1, 1, 0, 1]])  # the second is none


def unit(quats: np.ndarray) -> np.ndarray:
    return quats / np.linalg.norm(quats, axis=-1, keepdims=True)


def heap(rng, num_bodies: int = BODIES, trays: bool = False) -> tuple[Oracle, np.ndarray, np.ndarray, np.ndarray]:
    """Agents, bodies and doors in one heap with static boxes, moving: all touch several others, many deeply.

    The sliding door may have a tray.
    """
    static = Boxes(
        rng.uniform(-1.2, 1.2, (STATIC, 3)), rng.normal(size=(STATIC, 4)), rng.uniform(0.05, 0.8, (STATIC, 3))
    )
    static.pos[:, 2] = rng.uniform(0, 1, STATIC)
    static.quat[: STATIC // 2, 1:3] = 0
    size = num_bodies, 3
    bodies = Boxes(rng.uniform(-1, 1, size), rng.normal(size=(num_bodies, 4)), rng.uniform(0.08, 0.4, size))
    bodies.pos[:, 2] = rng.uniform(0.1, 1.2, num_bodies)
    bodies.quat[: num_bodies // 2, 1:3] *= 0.05
    static, bodies = static._replace(quat=unit(static.quat)), bodies._replace(quat=unit(bodies.quat))
    config = PhysicsSetup(num_agents=AGENTS)
    mass = rng.uniform(1, 60, num_bodies)
    doors = leaves(rng)
    doors = doors._replace(tray=tray(rng)) if trays else doors
    oracle = Oracle(config, static, bodies, mass, doors, surfaces(rng, config, num_bodies))
    agents = np.c_[rng.uniform(-1, 1, (AGENTS, 2)), rng.uniform(0.75, 0.82, AGENTS), rng.uniform(-3, 3, AGENTS)]
    low, high = oracle.doors.range.T  # some beyond the ends of their ways
    qpos = np.r_[agents.ravel(), np.c_[bodies.pos, bodies.quat].ravel(), rng.uniform(low - 0.1, high + 0.1)]
    return oracle, qpos, 0.5 * rng.normal(size=4 * AGENTS + 6 * num_bodies + DOORS), rng.uniform(-1, 1, (AGENTS, 3))


def surfaces(rng, config, num_bodies: int) -> np.ndarray:
    """Of bodies of all kinds: slippery and rough ones, those that bounce and others."""
    ratio = [damping_ratio(e) for e in rng.choice([0.0, 0.1, 0.3, 0.6, 0.9], num_bodies)]
    return np.stack(
        [rng.uniform(0.1, 1, num_bodies), *contact_parameters(np.array(ratio), config.timing.sim_dt)], axis=1
    )


def tray(rng) -> np.ndarray:
    """Boxes of a sliding door besides its own, all about it."""
    return np.c_[rng.uniform(-0.5, 0.5, (TRAY_BOXES, 3)), rng.uniform(0.02, 0.3, (TRAY_BOXES, 3))][None]


def leaves(rng) -> Leaves:
    """Doors about the heap, a little askew on their hinges; the last slides, and not along itself."""
    half = np.c_[rng.uniform(0.2, 0.5, DOORS), rng.uniform(0.02, 0.04, DOORS), rng.uniform(0.5, 1, DOORS)]
    yaw = rng.uniform(-3, 3, DOORS)
    arm = half[:, :1] * np.c_[np.cos(yaw), np.sin(yaw)] + rng.uniform(-0.02, 0.02, (DOORS, 2))
    low = rng.uniform(-2, 0, DOORS)
    ends = np.c_[low, low + rng.uniform(0.5, 2, DOORS)]
    slide = np.zeros((DOORS, 2))
    slide[-1] = np.cos(yaw[0]), np.sin(yaw[0])
    arm[-1] = 0
    middle, mass = rng.uniform(-1, 1, (DOORS, 2)), rng.uniform(5, 30, DOORS)
    return Leaves(middle, arm, half[:, 2] + 0.01, yaw, half, mass, ends, slide)
