"""Streaming against one long convolution."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.signal import fftconvolve

from home_mjx.audio_jax.auralization.clips import clip_samples
from home_mjx.audio_jax.auralization.convolution import convolve_clip_frame
from home_mjx.audio_jax.base.config import AudioConfig

CONFIG = AudioConfig(response_seconds=0.2)


@pytest.fixture(scope="module")
def frame():
    """`convolve_clip_frame`, compiled, under strict promotion."""
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        compiled = jax.jit(lambda *args: convolve_clip_frame(*args, CONFIG))
        zeros = jnp.zeros((2, CONFIG.response_length))
        compiled(jnp.zeros(5000), jnp.int32(0), zeros, zeros)
    return compiled


def random_response(rng: np.random.Generator) -> jax.Array:
    length = CONFIG.response_length
    return jnp.asarray(rng.normal(size=(2, length)) * np.exp(-np.arange(length) / 500), jnp.float32)


def test_a_still_scene_streams_as_one_convolution(frame, rng):
    """120 frames, over the clip's end more than once: no seam anywhere."""
    clip = rng.normal(size=5000).astype(np.float32)
    response = random_response(rng)
    heard = np.concatenate([frame(clip, jnp.int32(i * CONFIG.frame), response, response) for i in range(120)], axis=1)
    played = np.tile(clip, 42).astype(float)  # the clip before time 0 is heard too
    length = CONFIG.response_length
    start = 5000 * 2
    for ear in range(2):
        whole = fftconvolve(played, np.asarray(response[ear], float))[start : start + heard.shape[1]]
        assert start >= length
        assert np.max(np.abs(heard[ear] - whole)) < 1e-5 * np.max(np.abs(whole))


def test_responses_crossfade_without_a_step(frame, rng):
    """The frame starts as the old response sounds and ends as the new one does."""
    clip = jnp.asarray(clip_samples("radio", CONFIG))
    old, new = random_response(rng), random_response(rng)
    phase = jnp.int32(7000)
    mixed, only_old, only_new = (np.asarray(frame(clip, phase, a, b)) for a, b in [(old, new), (old, old), (new, new)])
    weight = np.arange(1, CONFIG.frame + 1) / CONFIG.frame
    np.testing.assert_allclose(mixed, (1 - weight) * only_old + weight * only_new, atol=2e-5)


def test_phase_is_taken_modulo_the_clip_and_may_be_batched(rng):
    clip = jnp.asarray(rng.normal(size=3000), jnp.float32)
    response = random_response(rng)
    phases = jnp.array([100, 100 + 3000 * 400000], jnp.int32)
    both = jax.jit(jax.vmap(lambda p: convolve_clip_frame(clip, p, response, response, CONFIG)))(phases)
    np.testing.assert_allclose(both[0], both[1], atol=1e-6)


def test_a_clip_shorter_than_the_response_still_loops(rng):
    clip = jnp.asarray(rng.normal(size=10), jnp.float32)
    pulse = jnp.zeros((2, CONFIG.response_length)).at[:, 25].set(1.0)
    heard = convolve_clip_frame(clip, jnp.int32(0), pulse, pulse, CONFIG)
    np.testing.assert_allclose(heard[0], np.asarray(clip)[(np.arange(CONFIG.frame) - 25) % 10], atol=1e-5)
