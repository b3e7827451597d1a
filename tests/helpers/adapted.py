"""Environments that compile fast, for tests of adapters; every registered id."""

import jax
import numpy as np
import pytest

import home_mjx
from home_mjx.registry import find_spec

CHEAP = {"sensors": ("state",), "episode_length": 5}


def cases(*combinations, fast=1):
    """Parameters: every id for one agent with every combination; all are slow but the first ones of PointNav.

    Ids that are made with discrete actions need these: they wait for `stop`, or for words.
    """
    return [
        pytest.param(env_id, *values, marks=[pytest.mark.slow] * (env_id != "PointNav-v0" or number >= fast))
        for env_id, options in ((env_id, find_spec(env_id).options) for env_id in home_mjx.list_envs())
        for number, values in enumerate(combinations)
        if options.get("num_agents", 1) == 1
        if not (options.get("actions") == "discrete" and "continuous" in values)
    ]


def cheap(env_id, bank, **options):
    return home_mjx.make(env_id, bank, **{**CHEAP, **options})


def assert_equal(a, b):
    """Two trees of the same structure, bit for bit."""
    assert jax.tree.structure(a) == jax.tree.structure(b)
    jax.tree.map(np.testing.assert_array_equal, a, b)


def row(tree, index):
    return jax.tree.map(lambda x: x[index], tree)
