"""Rays that carry one octave each, against the Monte Carlo that shares nothing with the engine."""

import jax
import jax.numpy as jnp
import numpy as np
from acoustic_rooms import rising
from decay_oracle import fly
from scenes import HEAD, scene_of

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Omni, Traced
from home_mjx.audio_jax.propagation.paths import air_attenuation
from home_mjx.audio_jax.propagation.tracing import trace

CONFIG = AudioConfig(receiver=Omni(), late=Traced(num_rays=7 * 1500, num_bounces=110, octave_rays=True))


def test_octaves_decay_by_their_own_scattering():
    """Energy in the room falls by 20 dB as the oracle's particles do: one direction for all was 53 % off at 125 Hz."""
    room, dt = rising(), 0.01
    scene, place = scene_of(room.house), jnp.asarray(room.listeners[0], jnp.float32)
    run = jax.jit(lambda key: trace(scene, SoundSource(place + 1), Listener(place, HEAD), key, CONFIG))
    truth = fly(room.blocks, room.listeners[0], room.listeners[1:2], 1.0, dt, 20_000).left
    ours = np.zeros(truth.shape)
    for seed in range(4):
        rays = jax.tree.map(lambda x: np.asarray(x, float), run(jax.random.key(seed)))
        ours += np.array([left_at(rays, k * dt * CONFIG.speed_of_sound) for k in range(truth.shape[1])]).T / 4
    times = [[np.argmax(x < 10**-2.5) - np.argmax(x < 10**-0.5) for x in y] for y in (ours, truth)]
    np.testing.assert_allclose(*times, rtol=0.07)
    assert times[0][0] / times[0][-1] > 2


def left_at(rays, distance):
    """Energy (7,) of all rays when they have flown so far [m]."""
    hits = np.concatenate([np.zeros((1, CONFIG.traced.num_rays)), rays.travelled])
    energy = np.concatenate([rays.initial_energy[None], rays.remaining])
    last = np.maximum((hits <= distance).sum(axis=0) - 1, 0)
    each = np.arange(CONFIG.traced.num_rays)
    air = np.exp(-np.maximum(distance - hits[last, each], 0)[:, None] * np.asarray(air_attenuation(CONFIG)))
    return (energy[last, each] * air).sum(axis=0)


def test_each_ray_carries_its_octave_alone():
    """A seventh of the rays each; energies that leave sum to one per octave."""
    room = rising()
    source, ears = SoundSource(jnp.asarray(room.source, jnp.float32)), Listener(jnp.float32(room.listeners[0]), HEAD)
    config = AudioConfig(receiver=Omni(), late=Traced(num_rays=70, num_bounces=3, octave_rays=True))
    rays = jax.jit(lambda scene: trace(scene, source, ears, jax.random.key(0), config))(scene_of(room.house))
    carried = np.asarray(rays.remaining > 0)
    np.testing.assert_array_equal(carried, np.broadcast_to(np.repeat(np.eye(7, dtype=bool), 10, axis=0), carried.shape))
    np.testing.assert_allclose(np.asarray(rays.initial_energy).sum(axis=0), 1, rtol=1e-6)
