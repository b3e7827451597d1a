"""What ears hear of several sources, and of none."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import CLIPS
from home_mjx.tasks import make_config

TONE, BELL, SILENT = CLIPS.index("tone"), CLIPS.index("bell"), -1
OPTIONS = {"late": "traced", "num_rays": 4, "num_bounces": 1, "impl": "kinematic", "sensors": ("audio",)}


@pytest.fixture(scope="module")
def heard():
    """A function from the clips, gains and times [s] of two sources to what is heard in the first frame."""
    core = HouseholdEnv(make_config(num_sources=2, clips=("tone", "bell"), **OPTIONS))
    env = core.bind(HouseBank.from_compiled([shoebox()]))
    begun = jax.jit(functools.partial(core.reset, observe=False))(env.params, jax.random.key(0))
    apart = begun.world.sounds.pos.at[1].add(jnp.array([0.5, -0.5, 0.2]))
    perceive = jax.jit(functools.partial(core.observe, update=True))

    def hear(clips, gains=(1.0, 1.0), period=(jnp.inf, jnp.inf), duration=(jnp.inf, jnp.inf)):
        numbers = {"gain": gains, "period": period, "duration": duration}
        sounds = begun.world.sounds.replace(pos=apart, clip=jnp.array(clips, jnp.int32))
        sounds = sounds.replace(**{name: jnp.array(values, jnp.float32) for name, values in numbers.items()})
        state = perceive(env.params, begun.replace(world=begun.world.replace(sounds=sounds)))
        return np.asarray(state.obs["audio"]), int(state.status)

    return hear


def test_sounds_add_up(heard):
    both, first, second = (heard(clips)[0] for clips in ((TONE, BELL), (TONE, SILENT), (SILENT, BELL)))
    assert min(np.abs(first).max(), np.abs(second).max()) > 1e-3
    np.testing.assert_allclose(both, first + second, atol=1e-5)


def test_gain_is_of_the_pressure(heard):
    np.testing.assert_allclose(heard((TONE, BELL), gains=(2.0, 0.0))[0], 2 * heard((TONE, SILENT))[0], atol=1e-5)


def test_where_nothing_plays_nothing_is_heard(heard):
    frame, status = heard((SILENT, SILENT))
    np.testing.assert_array_equal(frame, 0)
    assert status == 0  # the cut response of a silent source is no loss


def test_what_begins_later_is_not_heard_yet(heard):
    """Of a sound that lasts a tenth of each second and begins with the episode, the first frame has nothing before."""
    whole, once = heard((TONE, SILENT))[0], heard((TONE, SILENT), duration=(0.1, jnp.inf))[0]
    assert np.abs(once).max() > 1e-3
    assert np.abs(once[:, :20]).max() < 1e-4 < np.abs(whole[:, :20]).max()
