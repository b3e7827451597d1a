"""Tensors and arrays share their memory."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("torch", reason="PyTorch is not installed")

import torch

from home_mjx.adapters.pytorch import to_jax, to_torch
from home_mjx.errors import ConfigError
from home_mjx.tasks import HouseholdEnv, make_config


def test_tensors_lie_where_the_arrays_do():
    """Observations of every type that a sensor gives."""
    config = make_config(sensors=("rgb", "depth", "instance", "valid", "audio", "state"))
    specs = HouseholdEnv(config).observation_spec
    random = np.random.default_rng(0)
    obs = {name: jnp.asarray(random.random((2, *spec.shape)) * 9).astype(spec.dtype) for name, spec in specs.items()}
    tensors = to_torch(obs)
    assert {x.dtype for x in tensors.values()} == {torch.uint8, torch.float32, torch.int32, torch.bool}
    assert tensors.keys() == obs.keys()
    for name, array in obs.items():
        assert tensors[name].data_ptr() == array.unsafe_buffer_pointer()
        np.testing.assert_array_equal(tensors[name].numpy(), array)


def test_typed_keys_are_refused_and_their_numbers_are_taken():
    keys = jax.random.split(jax.random.key(3), 4)
    with pytest.raises(ConfigError, match=r"typed random keys.*key<fry>\[4\].*jax\.random\.key_data"):
        to_torch({"keys": keys})
    tensor = to_torch(jax.random.key_data(keys))
    again = jax.random.wrap_key_data(to_jax(tensor))
    np.testing.assert_array_equal(jax.random.key_data(again), jax.random.key_data(keys))


@pytest.mark.parametrize("dtype", ["float32", "int32", "bool"])
def test_actions_lie_where_the_tensors_do(dtype):
    actions = {"move": torch.zeros((64, 4), dtype=getattr(torch, dtype)), "say": torch.ones(64, requires_grad=True)}
    arrays = to_jax(actions)
    for name, tensor in actions.items():
        assert isinstance(arrays[name], jax.Array)
        assert arrays[name].unsafe_buffer_pointer() == tensor.data_ptr()
    assert arrays["move"].dtype == dtype
    assert to_torch(arrays["move"]).data_ptr() == actions["move"].data_ptr()
    np.testing.assert_array_equal(arrays["say"], jnp.ones(64))
