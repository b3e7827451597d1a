"""Environments split over two devices, as docs/devices.md says."""

import functools
import re

import jax
import numpy as np
import pytest
from checked import checked
from handmade import shoebox

import home_mjx
from home_mjx import HouseBank
from home_mjx.sharding import EnvSharding, make_mesh

NUM = 4


@pytest.mark.slow
def test_each_of_two_devices_steps_its_part_as_if_alone():
    """The same bits as a batch of that part on one device, and nothing is exchanged."""
    bank = HouseBank.from_compiled([shoebox()])
    env = home_mjx.make("PointNav-v0", bank, sensors=("depth", "state", "goal"), width=8, height=8)
    sharding = EnvSharding(make_mesh(jax.devices()[:2]))
    batch = jax.vmap(env.core.step, (None, 0, 0))
    both = sharding.map_envs(batch)
    keys = jax.random.key_data(jax.random.split(jax.random.key(0), NUM))
    begun = jax.jit(jax.vmap(functools.partial(env.core.reset, observe=False), (None, 0)))(env.params, keys)
    actions = jax.random.uniform(jax.random.key(1), (NUM, 4), minval=-1.0)
    args = sharding.put_params(env.params), sharding.put_envs(begun), sharding.put_envs(actions)
    text = both.lower(*args).compile().as_text()
    assert text is not None
    assert not re.search(r"all-gather|all-reduce|all-to-all|collective-permute", text)
    states = checked(both)(*args)
    assert {shard.device for shard in states.obs["goal"].addressable_shards} == set(jax.devices()[:2])
    one = checked(jax.jit(batch))
    for part in (slice(0, 2), slice(2, 4)):
        alone = one(env.params, *jax.tree.map(lambda x, part=part: x[part], (begun, actions)))
        got = jax.tree.map(lambda x, part=part: np.asarray(x)[part], states)
        jax.tree.map(np.testing.assert_array_equal, got, alone)
