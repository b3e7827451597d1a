"""Environments over two devices: the bits of one device, nothing exchanged, with Auto and Explicit axes."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from jax.sharding import AxisType

import home_mjx
from home_mjx import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.sharding import (
    BY_ENV,
    ENV_AXIS,
    REPLICATED,
    EnvSharding,
    env_index,
    make_mesh,
    mean_over_devices,
    sum_over_devices,
)

NUM = 4  # environments
COLLECTIVES = re.compile(r"all-gather|all-reduce|all-to-all|collective-permute")
AXIS_TYPES = [AxisType.Auto, AxisType.Explicit]
OPTIONS = {"sensors": ("depth", "state", "goal"), "width": 8, "height": 8, "impl": "kinematic"}

if len(jax.devices()) < 2:
    pytest.skip("there is one device", allow_module_level=True)


def sharding_of(axis_type: AxisType = AxisType.Auto, split_houses: bool = False) -> EnvSharding:
    return EnvSharding(make_mesh(jax.devices()[:2], axis_type), split_houses)


def keys_of(num: int = NUM) -> jax.Array:
    return jax.random.key_data(jax.random.split(jax.random.key(0), num))


def envs_of(*sizes: tuple[float, float, float]) -> list:
    """One environment per size of a room; banks of rooms of similar sizes have equal shapes."""
    banks = [HouseBank.from_compiled([shoebox(size)]) for size in sizes]
    return [home_mjx.make("PointNav-v0", bank, **OPTIONS) for bank in banks]


@pytest.fixture(scope="module")
def env():
    return envs_of((6.0, 5.0, 3.0))[0]


@pytest.mark.parametrize("axis_type", AXIS_TYPES, ids=lambda kind: kind.name)
def test_two_devices_step_as_one_and_exchange_nothing(env, axis_type: AxisType):
    sharding = sharding_of(axis_type)
    reset, step = jax.vmap(env.core.reset, (None, 0)), jax.vmap(env.core.step, (None, 0, 0))
    actions = jax.random.uniform(jax.random.key(1), (NUM, env.action_size), minval=-1.0)
    params = sharding.put_params(env.params)
    states = sharding.map_envs(reset)(params, sharding.put_envs(keys_of()))
    program = sharding.map_envs(step).lower(params, states, sharding.put_envs(actions)).compile()
    assert not COLLECTIVES.search(program.as_text() or "")
    after = program(params, states, sharding.put_envs(actions))
    assert after.obs["goal"].sharding.spec[0] == ENV_AXIS
    assert {shard.device for shard in after.obs["goal"].addressable_shards} == set(jax.devices()[:2])
    alone = jax.jit(step)(env.params, jax.jit(reset)(env.params, keys_of()), actions)
    jax.tree.map(np.testing.assert_array_equal, after, alone)


@pytest.mark.parametrize("axis_type", AXIS_TYPES, ids=lambda kind: kind.name)
def test_each_device_has_houses_of_its_own(axis_type: AxisType):
    envs, sharding = envs_of((6.0, 5.0, 3.0), (5.8, 4.9, 2.8)), sharding_of(axis_type, split_houses=True)
    reset = jax.vmap(envs[0].core.reset, (None, 0))
    params = sharding.put_params([env.params for env in envs])
    node_box = params.bank.geometry.node_box
    assert node_box.addressable_shards[0].data.shape == (1, *envs[0].bank.geometry.node_box.shape)
    states = sharding.map_envs(reset)(params, sharding.put_envs(keys_of()))
    half = NUM // 2
    for index, env in enumerate(envs):
        part = slice(index * half, (index + 1) * half)
        alone = jax.jit(reset)(env.params, keys_of()[part])
        jax.tree.map(lambda x, y, part=part: np.testing.assert_array_equal(np.asarray(x)[part], y), states, alone)


def test_collectives_are_over_all_devices():
    sharding = sharding_of()
    program = sharding.map(
        lambda x: (x + env_index(len(x)), sum_over_devices(x.sum()), mean_over_devices(x.mean())),
        (BY_ENV,),
        (BY_ENV, REPLICATED, REPLICATED),
    )
    shifted, total, mean = program(sharding.put_envs(jnp.arange(6.0)))
    assert shifted.tolist() == [0, 1, 2, 6, 7, 8]
    assert (float(total), float(mean)) == (15.0, 2.5)


def test_what_does_not_split_is_refused(env):
    with pytest.raises(ConfigError, match="multiple of the 2 devices, got 3"):
        sharding_of().put_envs(jnp.zeros(3))
    split = sharding_of(split_houses=True)
    with pytest.raises(ConfigError, match="expected parameters of 2 devices, got 1"):
        split.put_params([env.params])
    with pytest.raises(ConfigError, match="differ"):
        split.put_params([{"x": jnp.zeros(2)}, {"x": jnp.zeros(3)}])
