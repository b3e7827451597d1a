"""Steps of compiled code as parts of a program: split over devices, differentiated, batched in other ways."""

import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
import rollouts
from jax.sharding import AxisType, NamedSharding
from jax.sharding import PartitionSpec as P

from home_mjx import physics
from home_mjx.errors import ConfigError

EVEN = rollouts.BATCH // 2 * 2  # environments: two devices share them
HOUSES = jnp.arange(EVEN, dtype=jnp.int32)


@pytest.fixture(scope="module", params=["fused", "c"])
def scene(request):
    bank, template = rollouts.build(request.param)
    return bank, template, rollouts.start(bank, template, HOUSES)


def stepper(template):
    return jax.vmap(lambda *args: physics.step(template, *args), (None, 0, 0, 0))


def test_environments_split_over_devices_stay_there(scene):
    """Two devices step their halves, nothing is exchanged, and the bits are those of one device."""
    if len(jax.devices()) < 2:
        pytest.skip("there is one device")
    bank, template, start = scene
    mesh = jax.make_mesh((2,), ("envs",), axis_types=(AxisType.Auto,), devices=jax.devices()[:2])
    by_env, whole = NamedSharding(mesh, P("envs")), NamedSharding(mesh, P())
    actions = jax.random.uniform(jax.random.key(0), (EVEN, 1, 3), minval=-1.0)
    given = [jax.device_put(x, s) for x, s in zip((bank, HOUSES, start, actions), (whole, *[by_env] * 3), strict=True)]
    program = jax.jit(stepper(template)).lower(*given).compile()
    text = program.as_text()
    assert text is not None
    assert not re.search(r"all-gather|all-reduce|all-to-all|collective-permute", text)
    split = program(*given)
    assert {shard.device for shard in split.qpos.addressable_shards} == set(jax.devices()[:2])
    jax.tree.map(np.testing.assert_array_equal, split, jax.jit(stepper(template))(bank, HOUSES, start, actions))


def test_a_gradient_is_refused(scene):
    """Zeros would be wrong in silence. What is differentiated beside the physics does not meet the rule."""
    bank, template, start = scene

    def reward(scale, stop):
        actions = jnp.ones((EVEN, 1, 3)) * (jax.lax.stop_gradient(scale) if stop else scale)
        return scale * jnp.sum(stepper(template)(bank, HOUSES, start, actions).qpos)

    with pytest.raises(ConfigError, match=r"no gradient.*PhysicsConfig\(impl='jax'\)"):
        jax.grad(reward)(1.0, False)
    value, slope = jax.value_and_grad(reward)(1.0, True)
    assert float(slope) == float(value) != 0


def test_nested_batches_and_banks_of_their_own(scene):
    """`vmap` of `vmap` is one batch; a batch of banks is stepped bank by bank."""
    bank, template, start = scene
    actions = jax.random.uniform(jax.random.key(1), (EVEN, 1, 3), minval=-1.0)
    step = stepper(template)
    want = step(bank, HOUSES, start, actions).qpos
    pairs = jax.tree.map(lambda x: x.reshape(2, -1, *x.shape[1:]), (HOUSES, start, actions))
    nested = jax.vmap(step, (None, 0, 0, 0))(bank, *pairs).qpos
    np.testing.assert_array_equal(nested.reshape(want.shape), want)
    banks = jax.tree.map(lambda x: jnp.stack([x, x]), bank)
    np.testing.assert_array_equal(jax.vmap(step)(banks, *pairs).qpos.reshape(want.shape), want)
