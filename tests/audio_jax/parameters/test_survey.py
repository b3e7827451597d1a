"""A survey of a room: its measures are those of a long decay in that room."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from scenes import HEAD, scene_of

from home_mjx.audio_jax import AudioConfig, Listener, SoundSource, impulse_response
from home_mjx.audio_jax.base.options import Traced
from home_mjx.audio_jax.parameters import survey_floor, survey_room

CONFIG = AudioConfig(response_seconds=1.2, late=Traced(num_rays=500, num_bounces=60))
SOURCE, LISTENER = SoundSource(jnp.float32([-1.0, -1.0, 1.2])), Listener(jnp.float32([1, 1, 1.6]), HEAD)


@pytest.fixture(scope="module")
def survey():
    run = jax.jit(lambda scene: survey_room(scene, SOURCE, LISTENER, jax.random.key(0), CONFIG))
    return jax.tree.map(np.asarray, run(scene_of(shoebox((6.0, 5.0, 3.0), 0.2, 0.3))))


def test_measures_are_those_of_an_even_room(survey):
    """6 x 5 x 3 m, absorption 0.2: T30 0.534 s by Monte Carlo; level by Barron's theory, rays and waveform together."""
    np.testing.assert_allclose(survey.parameters.t30[2:5], [0.534] * 3, rtol=0.08)
    distance, time = np.linalg.norm([2, 2, 0.4]), 0.534
    late = 31200 * time / 90 * np.exp(-0.04 * distance / time)  # Barron and Lee, JASA 84 (1988), as is 100 / r²
    expected = 10 * np.log10(100 / distance**2 + late)
    np.testing.assert_allclose(survey.parameters.strength[2:5], expected, atol=1.0)
    assert np.all(survey.parameters.c80 > survey.parameters.c50)
    assert np.all((survey.parameters.d50 > 0.5) & (survey.parameters.d50 < 1))


def test_ears_agree_at_low_and_differ_at_high_frequencies(survey):
    """The coherence of a diffuse field at two points a head apart falls with frequency."""
    assert survey.iacc[0] > 0.8
    assert np.all(survey.iacc[3:] < 0.7)
    assert np.all((survey.lateral_fraction > 0.1) & (survey.lateral_fraction < 0.5))


def test_the_response_is_that_of_the_engine():
    scene = scene_of(shoebox((6.0, 5.0, 3.0), 0.2, 0.3))
    small = AudioConfig(late=Traced(num_rays=16, num_bounces=6))
    run = jax.jit(lambda s, q: survey_room(s, SOURCE, LISTENER.replace(quat=q), jax.random.key(0), small).response)
    plain = jax.jit(lambda s: impulse_response(s, SOURCE, LISTENER, jax.random.key(0), small))(scene)
    np.testing.assert_allclose(run(scene, HEAD), plain, atol=1e-5)
    assert not run(scene, 1.05 * HEAD).any()  # silent without a quaternion of unit length


def test_a_floor_sounds_as_single_places_do(survey):
    """The same place twice: as one waveform says within its noise. One nearer: louder by what Barron says."""
    places = jnp.stack([LISTENER.pos, LISTENER.pos, jnp.float32([-0.5, -0.5, 1.3])])
    run = jax.jit(lambda scene: survey_floor(scene, SOURCE, places, jax.random.key(0), CONFIG))
    found = jax.tree.map(np.asarray, run(scene_of(shoebox((6.0, 5.0, 3.0), 0.2, 0.3))))
    np.testing.assert_allclose(found.t30[0, 2:5], [0.534] * 3, rtol=0.08)
    np.testing.assert_allclose(found.strength[0, 2:5], survey.parameters.strength[2:5], atol=1.0)
    assert np.array_equal(found.strength[0], found.strength[1])
    distance = np.linalg.norm([[2, 2, 0.4], [0.5, 0.5, 0.1]], axis=1)
    level = 10 * np.log10(100 / distance**2 + 31200 * 0.534 / 90 * np.exp(-0.04 * distance / 0.534))
    np.testing.assert_allclose(found.strength[2, 2:5] - found.strength[0, 2:5], level[1] - level[0], atol=1.0)
