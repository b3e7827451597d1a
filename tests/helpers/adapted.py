"""Environments that compile fast, for tests of adapters."""

import jax
import numpy as np
import pytest

import home_mjx

CHEAP = {"sensors": ("state",), "episode_length": 5}


def cases(*combinations):
    """Parameters: PointNav with every combination, all but the first one slow. Other ids: `test_checkers.py`."""
    return [
        pytest.param("PointNav-v0", *values, marks=[pytest.mark.slow] * (number > 0))
        for number, values in enumerate(combinations)
    ]


def cheap(env_id, bank, **options):
    return home_mjx.make(env_id, bank, **{**CHEAP, **options})


def assert_equal(a, b):
    """Two trees of the same structure, bit for bit."""
    assert jax.tree.structure(a) == jax.tree.structure(b)
    jax.tree.map(np.testing.assert_array_equal, a, b)


def row(tree, index):
    return jax.tree.map(lambda x: x[index], tree)
