"""Environments that compile fast, for tests of adapters; every registered id."""

import jax
import numpy as np

import home_mjx

IDS = home_mjx.list_envs()
CHEAP = {"sensors": ("state",), "episode_length": 5}
KINDS = ("continuous", "discrete")


def cheap(env_id, bank, **options):
    return home_mjx.make(env_id, bank, **{**CHEAP, **options})


def assert_equal(a, b):
    """Two trees of the same structure, bit for bit."""
    assert jax.tree.structure(a) == jax.tree.structure(b)
    jax.tree.map(np.testing.assert_array_equal, a, b)


def row(tree, index):
    return jax.tree.map(lambda x: x[index], tree)
