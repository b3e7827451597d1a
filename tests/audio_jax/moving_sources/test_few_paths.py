"""Frames in which only some of the paths that were found sound."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from scenes import HEAD, scene_of

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import EarlyPaths, Motion, NoLate, Omni
from home_mjx.audio_jax.moving_sources.frames import render_frame
from home_mjx.audio_jax.moving_sources.receiver_state import pad_paths, render_receiver_state
from home_mjx.audio_jax.propagation.paths import Paths

ALL = AudioConfig(
    receiver=Omni(), motion=Motion(tail_seconds=0.0), late=NoLate(), early=EarlyPaths(num_edges=8, num_reflections=12)
)


def test_the_direct_path_and_the_strongest_are_kept_in_their_order():
    """The direct one has filters of its own, so it is kept also where it is silent."""
    gain = jnp.float32([0.0, 0.3, 0.1, 0.0, 0.5, 0.2])[:, None] * jnp.ones(7)
    paths = Paths(jnp.arange(6.0) + 1, gain, jnp.ones((6, 3)), jnp.int32([10, 11, 12, 13, 14, 15]))
    assert pad_paths(paths, 4).name.tolist() == [10, 11, 14, 15]
    assert pad_paths(paths, 8).name.tolist() == [10, 11, 12, 13, 14, 15, -1, -1]


def test_paths_that_sound_are_enough():
    """In an empty room seven of 21: eight places make the same frame, and fewer leave out the weakest reflections."""
    scene, clip = scene_of(shoebox((6.0, 5.0, 3.0), 0.2, 0.3)), np.random.default_rng(0).normal(size=20_000)

    def heard(config):
        received = jax.jit(
            lambda x: render_receiver_state(
                scene,
                SoundSource(jnp.float32([1.0, 0.5, 1.2])),
                Listener(jnp.stack([x, -1.0, 1.6]), HEAD),
                jax.random.key(0),
                config,
            )
        )
        past = jnp.asarray(clip[: config.memory_length - 1 + config.frame + config.num_lookahead], jnp.float32)
        old, new = received(jnp.float32(-1.0)), received(jnp.float32(-0.9))
        assert old.paths.distance.size == config.num_paths
        return np.asarray(jax.jit(lambda *ends: render_frame(past, *ends, config))(old, new))

    every, some, few = (heard(replace(ALL, motion=Motion(number, 0.0))) for number in (None, 8, 4))
    np.testing.assert_allclose(some, every, atol=2e-6 * np.abs(every).max())
    missing = np.sum((few - every) ** 2) / np.sum(every**2)
    assert missing == pytest.approx(0.1, abs=0.09)
