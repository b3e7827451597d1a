"""Heaps of moving things, to try contacts on."""

import numpy as np
from c_oracle import Boxes, Oracle

from home_mjx.physics import PhysicsConfig

BODIES, STATIC, AGENTS = 6, 10, 2


def unit(quats: np.ndarray) -> np.ndarray:
    return quats / np.linalg.norm(quats, axis=-1, keepdims=True)


def heap(rng) -> tuple[Oracle, np.ndarray, np.ndarray, np.ndarray]:
    """Agents and bodies in one heap with static boxes, moving: all touch several others, many deeply."""
    static = Boxes(
        rng.uniform(-1.2, 1.2, (STATIC, 3)), rng.normal(size=(STATIC, 4)), rng.uniform(0.05, 0.8, (STATIC, 3))
    )
    static.pos[:, 2] = rng.uniform(0, 1, STATIC)
    static.quat[: STATIC // 2, 1:3] = 0
    bodies = Boxes(rng.uniform(-1, 1, (BODIES, 3)), rng.normal(size=(BODIES, 4)), rng.uniform(0.08, 0.4, (BODIES, 3)))
    bodies.pos[:, 2] = rng.uniform(0.1, 1.2, BODIES)
    bodies.quat[: BODIES // 2, 1:3] *= 0.05
    static, bodies = static._replace(quat=unit(static.quat)), bodies._replace(quat=unit(bodies.quat))
    oracle = Oracle(PhysicsConfig(num_agents=AGENTS), static, bodies, rng.uniform(1, 60, BODIES))
    agents = np.c_[rng.uniform(-1, 1, (AGENTS, 2)), rng.uniform(0.75, 0.82, AGENTS), rng.uniform(-3, 3, AGENTS)]
    qpos = np.r_[agents.ravel(), np.c_[bodies.pos, bodies.quat].ravel()]
    return oracle, qpos, 0.5 * rng.normal(size=4 * AGENTS + 6 * BODIES), rng.uniform(-1, 1, (AGENTS, 3))
