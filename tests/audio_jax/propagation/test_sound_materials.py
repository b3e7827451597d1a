"""Materials of one environment for sound, changed inside `jit`, against closed forms."""

import jax
import jax.numpy as jnp
import numpy as np
from handmade import shoebox, two_rooms
from scenes import HEAD, scene_of

from home_mjx.audio_jax import AudioConfig, Listener, SoundSource, early_paths, sound_materials
from home_mjx.audio_jax.base.options import Air, EarlyPaths, Omni, Traced
from home_mjx.audio_jax.propagation.histogram import energy_histogram
from home_mjx.audio_jax.propagation.image_source_paths import image_source_reflections
from home_mjx.audio_jax.propagation.tracing import trace

SIZE = (6.0, 5.0, 3.0)
SOURCE, EARS = SoundSource(jnp.float32([-1.3, -0.7, 1.2])), Listener(jnp.float32([1.4, 1.1, 1.6]), HEAD)
RAYS = AudioConfig(
    response_seconds=1.0, receiver=Omni(), late=Traced(num_rays=300, num_bounces=40), air=Air(humidity=60.0)
)
PLACES = 16


def with_absorption(scene, value):
    table = sound_materials(scene)
    return scene.replace(sound_materials=table.replace(absorption=jnp.full_like(table.absorption, value)))


def test_the_late_level_follows_absorption():
    """At 500 Hz, where air takes little, the mean over a room of all that was reflected is 16 π (1 - α) / (α S).

    That is its balance of power, re the free field at 1 m. One compiled program; the bank's own α is 0.9. The same in a
    batch by `vmap`, in which each environment has a table of its own.
    """
    scene = scene_of(shoebox(SIZE, 0.9, scattering=1.0))
    half = np.array(SIZE) / 2 - 0.01
    places = np.random.default_rng(5).uniform(-half, half, (PLACES, 3)) + np.array([0, 0, SIZE[2] / 2])

    @jax.jit
    def late(absorption):
        damped = with_absorption(scene, absorption)

        def at(place):
            traced = trace(damped, SOURCE, Listener(place, HEAD), jax.random.key(0), RAYS)
            gains = jnp.ones((*traced.direction.shape[:1], 2, 7))
            return energy_histogram(traced, gains, RAYS)[:, 0, 2].sum()

        return jax.vmap(at)(jnp.float32(places)).mean()

    alphas = np.array([0.1, 0.2, 0.4], np.float32)
    alone = np.array([float(late(jnp.float32(a))) for a in alphas])
    surface = 2 * (6 * 5 + 5 * 3 + 3 * 6)
    expected = 16 * np.pi * (1 - alphas) / (alphas * surface)
    np.testing.assert_allclose(10 * np.log10(alone / expected), 0, atol=0.4)
    np.testing.assert_allclose(jax.vmap(late)(jnp.asarray(alphas)), alone, rtol=1e-4)


def test_reflections_and_walls_follow_their_tables():
    """Amplitudes of reflections are sqrt(1 - α), those behind a wall the root of what it lets through."""
    quiet = AudioConfig(receiver=Omni(), late=Traced(num_rays=1))
    room, pair = scene_of(shoebox(SIZE, 0.9, scattering=0.0)), scene_of(two_rooms(transmission=0.5, absorption=0.6))

    @jax.jit
    def reflected(absorption):
        return early_paths(with_absorption(room, absorption), SOURCE, EARS, quiet).gain[1:7]

    ratio = np.asarray(reflected(jnp.float32(0.19))) / np.asarray(reflected(jnp.float32(0.0)))
    np.testing.assert_allclose(ratio, 0.9, rtol=1e-5)

    @jax.jit
    def behind(transmission):
        table = sound_materials(pair)
        scene = pair.replace(
            sound_materials=table.replace(transmission=jnp.full_like(table.transmission, transmission))
        )
        ends = SoundSource(jnp.float32([-2, 0.3, 1.2])), Listener(jnp.float32([2.2, -0.5, 1.6]), HEAD)
        return early_paths(scene, *ends, quiet).gain[0]

    ratio = np.asarray(behind(jnp.float32(0.01))) / np.asarray(behind(jnp.float32(1.0)))
    np.testing.assert_allclose(ratio, 0.1, rtol=1e-5)


def test_zero_absorption_everywhere_is_finite():
    """Nothing is lost but by air: a room that rings for ever stays a number, and each mirror gives all it gets."""
    scene = with_absorption(scene_of(shoebox(SIZE, 0.3, scattering=0.3)), 0.0)
    config = AudioConfig(receiver=Omni(), late=Traced(num_rays=64, num_bounces=40), air=Air(humidity=50.0))

    @jax.jit
    def run(scene):
        traced = trace(scene, SOURCE, EARS, jax.random.key(0), config)
        energy = energy_histogram(traced, jnp.ones((*traced.direction.shape[:1], 2, 7)), config)
        return energy, image_source_reflections(
            scene, SOURCE, EARS, AudioConfig(early=EarlyPaths(reflection_order=2, num_reflections=24))
        )

    energy, paths = run(scene)
    assert np.all(np.isfinite(energy))
    assert float(energy[-1].sum()) > 0
    assert np.all(np.isfinite(paths.gain))
