"""Keys and actions of types that mean something else are refused, not cut to what fits."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.tasks.base.state import to_raw_key
from home_mjx.tasks.env.checks import clip_action, validate_choice

KEYS = [
    *(jnp.zeros(2), jnp.zeros(2, bool), jnp.zeros(2, complex), jnp.zeros((), jnp.uint32)),
    *(jnp.zeros(3, jnp.uint32), jnp.zeros((4, 2), jnp.uint32), jax.random.split(jax.random.key(0), 3)),
]


@pytest.mark.parametrize("key", KEYS, ids=range(len(KEYS)))
def test_what_is_no_key_is_refused(key):
    with pytest.raises(ConfigError, match=r"expected (a|one) random key"):
        to_raw_key(key)


def test_typed_and_raw_keys_are_the_same():
    key = jax.random.key(7)
    np.testing.assert_array_equal(to_raw_key(key), to_raw_key(jax.random.key_data(key)))


@pytest.mark.parametrize("dtype", [bool, complex, np.complex64])
def test_what_is_no_real_number_is_no_action(dtype):
    with pytest.raises(ConfigError, match="expected real numbers as action"):
        clip_action(np.zeros(4, dtype), 1, 4)


@pytest.mark.parametrize("dtype", [bool, complex, np.float32])
def test_what_is_no_integer_is_no_choice(dtype):
    with pytest.raises(ConfigError, match="expected an integer as action"):
        validate_choice(np.zeros((), dtype), 1, 4)


def test_whole_numbers_are_real_numbers():
    action, changed = clip_action(jnp.array([1, 0, -1, 0]), 1, 4)
    assert action.tolist() == [[1, 0, -1, 0]]
    assert not changed
