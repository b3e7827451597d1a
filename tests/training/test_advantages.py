"""Advantages against the definition, summed backwards by hand."""

import jax.numpy as jnp
import numpy as np

from home_mjx.training.rollout import Transitions, compute_advantages, split_keys, to_envs, to_rows

DISCOUNT, LAMBDA = 0.9, 0.8


def test_advantages_are_those_of_the_definition(rng: np.random.Generator):
    """Row 0 ends by its task in step 2, row 1 by time in step 3, row 2 goes on."""
    reward, value, cut = rng.normal(size=(3, 6, 3)).astype(np.float32)
    last = rng.normal(size=3).astype(np.float32)
    done = np.zeros((6, 3), bool)
    done[2, 0] = done[3, 1] = True
    cut = np.where(np.eye(6, 3, k=-2, dtype=bool) & (np.arange(3) == 1), cut, 0)
    assert np.flatnonzero(cut).tolist() == [3 * 3 + 1]
    following = np.vstack([value[1:], last])
    following[2, 0], following[3, 1] = 0.0, cut[3, 1]  # the task's end is worth nothing, time's what it cut off
    error = reward + DISCOUNT * following - value
    wanted = np.zeros((6, 3))
    for row in range(3):
        for t in range(6):
            weight = 1.0
            for later in range(t, 6):
                wanted[t, row] += weight * error[later, row]
                weight *= DISCOUNT * LAMBDA
                if done[later, row]:
                    break
    steps = Transitions.build_unchecked(
        obs={}, is_first=jnp.asarray(done), action=jnp.zeros((6, 3)), outputs={"value": jnp.asarray(value)},
        reward=jnp.asarray(reward), done=jnp.asarray(done), truncation_value=jnp.asarray(cut),
    )  # fmt: skip
    found = compute_advantages(steps, jnp.asarray(last), DISCOUNT, LAMBDA)
    np.testing.assert_allclose(found, wanted, atol=1e-5)


def test_rows_are_agents_of_one_environment_after_the_other():
    x = jnp.arange(24).reshape(3, 2, 4)
    assert to_rows(x, 2).tolist() == [row for env in x.tolist() for row in env]
    assert jnp.array_equal(to_envs(to_rows(x, 2), 2), x)
    assert to_rows(x, 1) is x


def test_keys_of_rows_do_not_depend_on_the_batch():
    keys = jnp.arange(8, dtype=jnp.uint32).reshape(4, 2)
    following, now = split_keys(keys)
    alone = split_keys(keys[2:3])
    assert jnp.array_equal(alone[0][0], following[2])
    assert jnp.array_equal(alone[1][0], now[2])
    assert len({tuple(key) for key in np.concatenate([keys, following, now]).tolist()}) == 12
