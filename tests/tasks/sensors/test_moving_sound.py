"""What agents hear of sound that moves within a frame."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.base.options import Motion
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks import EnvParams, HouseholdEnv, make_config
from home_mjx.tasks.suite import PointNav

MOST = 64_000  # bytes per agent


def core_of(**options):
    physics = PhysicsConfig(impl="kinematic", num_agents=2)
    return HouseholdEnv(make_config(sensors=("audio", "state"), physics=physics, **options), PointNav())


def test_an_agent_remembers_little(generated_bank):
    """Of a source: less than a tenth of an impulse response; with its frame less than the limit."""
    key = jax.ShapeDtypeStruct((2,), np.uint32)
    state = jax.eval_shape(core_of(late="traced").reset, EnvParams(generated_bank), key).world.sensor_states["audio"]
    assert sum(x.size * x.dtype.itemsize for x in jax.tree.leaves(state)) < 2 * MOST
    whole = jax.eval_shape(
        core_of(late="traced", motion=False).reset, EnvParams(generated_bank), key
    ).world.sensor_states["audio"]
    size = [sum(x.size for x in jax.tree.leaves(s.response)) for s in (state, whole)]
    assert 8 * size[0] < size[1]


@pytest.mark.slow
def test_who_stands_still_hears_the_same_either_way(generated_bank):
    """Frames of impulse responses, and of paths that do not move; who walks hears something else."""
    heard = {}
    for motion in (False, True):
        core = core_of(motion=Motion(tail_seconds=0.0) if motion else None, late="traced", num_rays=16, num_bounces=4)
        params, step = EnvParams(generated_bank), jax.jit(core.step)
        state = jax.jit(core.reset)(params, jax.random.key(3))
        frames = [state.obs["audio"]]
        for speed in (0.0, 0.0, 1.0):
            state = step(params, state, jnp.zeros((2, 4)).at[:, 0].set(speed))
            frames.append(state.obs["audio"])
        heard[motion] = np.stack(frames)
    loudest = np.abs(heard[False]).max()
    assert loudest > 0
    np.testing.assert_allclose(heard[True][:3], heard[False][:3], atol=1e-5 * loudest)
    assert np.abs(heard[True][3] - heard[False][3]).max() > 1e-3 * loudest
