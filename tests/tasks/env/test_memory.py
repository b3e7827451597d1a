"""Memory is told before it is taken."""

import warnings

import jax
import jax.numpy as jnp
import pytest
from handmade import shoebox

import home_mjx
from home_mjx import HouseBank, HouseholdEnv
from home_mjx.tasks import estimate_memory, make_config
from home_mjx.tasks.env import env as bound


@pytest.fixture(scope="module")
def env():
    config = make_config(sensors=("depth", "state"), width=8, height=8)
    return HouseholdEnv(config).bind(HouseBank.from_compiled([shoebox()]))


def test_the_estimate_is_what_arrays_take(env):
    states = jax.jit(jax.vmap(env.reset))(jax.random.split(jax.random.key(0), 3))
    found = estimate_memory(env, 3)
    assert found.states == sum(x.nbytes for x in jax.tree.leaves(states))
    assert found.observations == sum(x.nbytes for x in jax.tree.leaves(states.obs)) == 3 * 4 * (64 + 10)
    assert found.bank == sum(x.nbytes for x in jax.tree.leaves(env.bank))
    assert found.total == found.bank + 2 * found.states
    assert "states 2 x" in str(found)


def test_large_banks_in_a_program_are_warned_of_once(env, monkeypatch):
    monkeypatch.setattr(bound, "MIN_LARGE_BANK_BYTES", 1000)
    large = env.core.bind(env.params)
    state = jax.eval_shape(env.core.reset, env.params, jax.random.key(0))
    with pytest.warns(UserWarning, match=r"env\.core\.step"):
        jax.make_jaxpr(large.step)(state, jnp.zeros(4))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        jax.make_jaxpr(large.step)(state, jnp.zeros(4))
        jax.make_jaxpr(large.core.step)(large.params, state, jnp.zeros(4))


def test_a_spec_tells_before_the_device_holds_anything(tmp_path):
    from generated import generate_flats

    from home_mjx import EnvSpec

    generate_flats(tmp_path, [0])
    spec = EnvSpec(
        "PointNav-v0", "home_mjx.tasks.suite:PointNav", {"sensors": ("state",)}, houses=str(tmp_path), num_houses=1
    )
    with jax.default_device(jax.devices("cpu")[0]):
        found = estimate_memory(home_mjx.make(spec), 1000)
    assert found.states == 1000 * found.state_per_env
    assert found.bank > 1e6
