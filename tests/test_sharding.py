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
from home_mjx import sharding as sharding_module
from home_mjx.errors import ConfigError
from home_mjx.sharding import (
    BY_ENV,
    EMPTY_ARGUMENTS_CRASH,
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


@pytest.mark.parametrize("crash", [EMPTY_ARGUMENTS_CRASH, True])
@pytest.mark.parametrize("axis_type", AXIS_TYPES, ids=lambda kind: kind.name)
def test_arrays_without_elements_are_split_like_others(axis_type: AxisType, crash: bool, monkeypatch):
    """Arguments, results and captured constants; with jaxlib 0.11 they end the process in a plain `shard_map`."""
    monkeypatch.setattr(sharding_module, "EMPTY_ARGUMENTS_CRASH", crash)
    sharding, captured = sharding_of(axis_type), np.zeros((3, 0), np.float32)

    def local(whole, split):
        assert [x.shape for x in jax.tree.leaves((whole, split))] == [(0, 5), (3,), (2, 0), (2, 3)]
        looped = jax.lax.fori_loop(0, 2, lambda _, x: x + jnp.sum(captured * 2.0, axis=1), split["x"])
        return {"sum": looped + whole["x"], "none": split["none"], "device": env_index(2)[None]}, sum_over_devices(1)

    whole = {"none": jnp.zeros((0, 5), jnp.int32), "x": jnp.ones(3)}
    split = {"none": jnp.zeros((NUM, 0)), "x": jnp.ones((NUM, 3))}
    program = sharding.map(local, (REPLICATED, BY_ENV), (BY_ENV, REPLICATED))
    found, count = program(sharding.put(whole, REPLICATED), sharding.put_envs(split))
    assert found["none"].shape == (NUM, 0)
    assert found["none"].sharding.spec[0] == ENV_AXIS
    np.testing.assert_array_equal(found["sum"], np.full((NUM, 3), 2.0))
    assert found["device"].tolist() == [0, 2]
    assert int(count) == 2


def test_what_does_not_split_is_refused(env):
    with pytest.raises(ConfigError, match="multiple of the 2 devices, got 3"):
        sharding_of().put_envs(jnp.zeros(3))
    split = sharding_of(split_houses=True)
    with pytest.raises(ConfigError, match="expected parameters of 2 devices, got 1"):
        split.put_params([env.params])
    with pytest.raises(ConfigError, match="differ"):
        split.put_params([{"x": jnp.zeros(2)}, {"x": jnp.zeros(3)}])
