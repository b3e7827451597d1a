"""Sources of an environment that point somewhere are as loud as their pattern says."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from parted import parted

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import ContactSoundConfig, first_order_directivity
from home_mjx.audio_jax.base.directivity import stack_directivities
from home_mjx.core.transforms import camera_quat
from home_mjx.tasks import AutoReset, Status, make_config
from home_mjx.tasks.sensors.cameras import eye_position
from home_mjx.tasks.suite import PointNav

BARE = {"late": "none", "motion": False, "num_reflections": 0, "impl": "kinematic", "sensors": ("audio",)}


@dataclasses.dataclass(frozen=True)
class TurningRadio(PointNav):
    """A radio 2 m from the agent's ears that turns by 90 degrees a step and faces them first; another one is silent."""

    def sounds(self, snapshot, state):
        ears = eye_position(snapshot.config, snapshot.pose)[0]
        away = jnp.arctan2(ears[1], ears[0])  # from the middle of the room
        place = ears - 2 * jnp.stack([jnp.cos(away), jnp.sin(away), jnp.zeros(())])
        yaw = away + jnp.float32([0.0, 1.0]) + snapshot.step.astype(jnp.float32) * jnp.float32(jnp.pi / 2)
        return snapshot.sounds.replace(
            pos=jnp.stack([place, jnp.zeros(3)]),
            quat=jax.vmap(lambda y: camera_quat(y, jnp.float32(0)))(yaw),
            directivity=stack_directivities([first_order_directivity(0.5), first_order_directivity(1.0)]),
        )


@pytest.mark.parametrize(
    "noises", [None, pytest.param(ContactSoundConfig(num_transients=1, num_sustained=1), marks=pytest.mark.slow)]
)
def test_a_radio_that_turns_away_is_heard_by_its_pattern(noises):
    """A cardioid: 1 ahead, 0.5 to the side, nothing behind, which is told."""
    core = HouseholdEnv(make_config(num_sources=2, contact_sounds=noises, **BARE), TurningRadio())
    env = core.bind(HouseBank.from_compiled([shoebox((12.0, 10.0, 3.0))]))
    reset, step = parted(core)
    state = reset(env.params, jax.random.key(0))
    energy, told = [], []
    for _ in range(4):
        energy.append(float(jnp.sum(state.world.sensor_states["audio"].response[0, 0] ** 2)))
        told.append(bool(int(state.status) & Status.UNHEARD))
        state = step(env.params, state, jnp.zeros(4))
    np.testing.assert_allclose(np.sqrt(np.array(energy) / energy[0]), [1, 0.5, 0, 0.5], atol=0.01)
    assert told == [False, False, True, False]


def test_batches_that_reset_themselves_have_such_sounds():
    batch = AutoReset(HouseholdEnv(make_config(num_sources=2, **BARE), TurningRadio()))
    params = batch.core.bind(HouseBank.from_compiled([shoebox()])).params
    first = jax.eval_shape(batch.reset, params, jax.random.split(jax.random.key(0), 2))
    after = jax.eval_shape(batch.step, params, first, jnp.zeros((2, 4)))
    assert jax.tree.structure(first) == jax.tree.structure(after)
    assert after.world.sounds.directivity.gain.shape == (2, 2, 181, 7)
