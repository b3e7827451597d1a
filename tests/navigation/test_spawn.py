"""Sampling of arrangements: agents never start in or too near to a body, however it leans."""

import jax
import jax.numpy as jnp
import numpy as np
from scipy.spatial.transform import Rotation

from home_mjx.navigation.spawn import _distance_to_box, random_arrangement

HEIGHT = 1.5  # [m]


def test_no_agent_starts_in_a_leaning_board(generated_bank):
    """A board of 2 m leans by 45 degrees over the start; at the height of its middle it is 0.6 m aside."""
    physics = generated_bank.physics
    houses, bodies = physics.body_valid.shape
    pose = np.tile(np.array([99.0, 0, 0, 1, 0, 0, 0], np.float32), (houses, 1, bodies, 1))
    pose[0, 0, 0] = [1.0, 0.0, 1.0, *Rotation.from_euler("y", -45, degrees=True).as_quat(scalar_first=True)]
    physics = physics.replace(
        arrangement_pose=jnp.asarray(pose),
        body_size=physics.body_size.at[0, 0].set(jnp.array([1.0, 0.4, 0.01])),
        body_valid=physics.body_valid.at[0, 0].set(True),
    )
    bank = generated_bank.replace(physics=physics)
    drawn = [
        int(random_arrangement(bank, jnp.int32(0), jnp.array([[x, 0.0, 0.0]], jnp.float32), jax.random.key(0)))
        for x in (0.4, 1.0, 1.6, 3.0)
    ]
    assert drawn == [-1, -1, -1, 0]


def test_distances_to_boxes_of_any_rotation_are_those_of_points_along_the_segment():
    random = np.random.default_rng(0)
    turns = [*Rotation.random(200, rng=random), *(Rotation.from_euler("zx", [a, 90 * a]) for a in range(8))]
    quat = np.array([turn.as_quat(scalar_first=True) for turn in turns])
    place = random.uniform([-1, -1, -0.3], [1, 1, 1.7], (len(quat), 3))
    pose = np.concatenate([place, quat], axis=1)
    half = random.uniform(0.01, 0.8, (len(quat), 3))
    found = jax.vmap(_distance_to_box, (None, None, 0, 0))(
        jnp.float32(HEIGHT), jnp.zeros(3), jnp.asarray(pose, jnp.float32), jnp.asarray(half, jnp.float32)
    )
    along = np.linspace(0, HEIGHT, 3001)[:, None] * [0, 0, 1]
    local = np.stack([turn.inv().apply(along - at) for turn, at in zip(turns, place, strict=True)])
    expected = np.linalg.norm(np.maximum(abs(local) - half[:, None], 0), axis=-1).min(axis=1)
    assert (expected == 0).any()
    np.testing.assert_allclose(found, expected, atol=1e-4)
