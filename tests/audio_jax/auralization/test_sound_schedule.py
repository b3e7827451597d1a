"""Schedules of sources against loops in Python, and several sources against each alone."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax import AudioConfig, SoundSources, convolve_clip_frame, convolve_frame, emitted_signal
from home_mjx.audio_jax.auralization.convolution import RATE_STEPS, _remainder, schedule_gain

RATE = 16000
CONFIG = AudioConfig(response_seconds=0.1)


def by_hand(time: int, every: float, lasts: float) -> float | None:
    """1 or 0; None within the ramps of 5 ms."""
    if lasts == np.inf:
        return 1.0
    at = time if every == np.inf else time % (every * RATE)
    if min(abs(at), abs(at - lasts * RATE)) <= 0.005 * RATE:
        return None
    return float(0 <= at < lasts * RATE)


@pytest.mark.parametrize(("every", "lasts"), [(np.inf, np.inf), (1.0, 0.25), (3.0, 1.0), (np.inf, 0.5)])
def test_sources_sound_when_they_should(every: float, lasts: float):
    time = np.arange(-3 * RATE, 6 * RATE, 97, dtype=np.int32)
    found = np.asarray(schedule_gain(jnp.asarray(time), jnp.float32(every), jnp.float32(lasts), RATE))
    expected = [by_hand(int(t), every, lasts) for t in time]
    for value, wanted in zip(found.tolist(), expected, strict=True):
        assert 0 <= value <= 1 if wanted is None else value == wanted


def test_remainders_are_exact(rng):
    """Against NumPy's, for small and large divisors, on both sides of multiples and far from zero."""
    for divisor in (1, 2, 3, 700, 16_000, 128_000, 2**24 + 1, 2**30 - 1):
        multiple = divisor * (rng.integers(-(2**30), 2**30, 5000) // divisor)
        near = (multiple[:, None] + np.arange(-2, 3)).clip(-(2**30), 2**30).ravel()
        value = np.concatenate([near, rng.integers(-(2**30), 2**30, 5000)]).astype(np.int32)
        np.testing.assert_array_equal(_remainder(jnp.asarray(value), jnp.int32(divisor)), value % divisor)


def test_sounds_begin_and_end_without_a_click():
    time = jnp.arange(2 * RATE)
    found = np.asarray(schedule_gain(time, jnp.float32(1.0), jnp.float32(0.5), RATE))
    assert np.abs(np.diff(found)).max() <= 1 / (0.005 * RATE) + 1e-6
    assert found.max() == 1


def sources(rng: np.random.Generator) -> tuple[jax.Array, SoundSources, jax.Array]:
    never = jnp.full(3, jnp.inf)
    sounds = SoundSources(
        pos=jnp.zeros((3, 3)),
        body=jnp.full(3, -1),
        clip=jnp.array([0, 1, -1]),
        gain=jnp.array([1.0, 0.5, 1.0]),
        period=never,
        duration=never,
    )
    return jnp.asarray(rng.normal(size=(2, 700)), jnp.float32), sounds, jnp.array([0, 1, -1])


def test_each_source_plays_its_own_clip_as_loud_as_it_should(rng: np.random.Generator):
    clips, sounds, row = sources(rng)
    left = emitted_signal(clips, sounds, row, jnp.int32(300), jnp.int32(300), CONFIG)
    response = jnp.asarray(rng.normal(size=(2, CONFIG.response_length)), jnp.float32)
    for number, gain in ((0, 1.0), (1, 0.5)):
        heard = convolve_frame(left[number], response, response, CONFIG)
        alone = convolve_clip_frame(clips[number], jnp.int32(300), response, response, CONFIG)
        np.testing.assert_allclose(heard, gain * alone, atol=1e-4)
    np.testing.assert_array_equal(left[2], 0)


def test_a_sound_that_plays_once_is_followed_by_its_own_tail_alone(rng: np.random.Generator):
    """The second frame of a pulse of one frame is what the response still holds of it."""
    _, sounds, _ = sources(rng)
    once = jax.tree.map(lambda x: x[:1], sounds).replace(duration=jnp.array([CONFIG.frame / RATE]))
    pulse = jnp.zeros((2, CONFIG.response_length)).at[:, 800].set(1.0)
    frames = []
    for number in range(3):
        time = jnp.int32(number * CONFIG.frame)
        left = emitted_signal(jnp.ones((1, 700)), once, jnp.array([0]), time, time, CONFIG)
        frames.append(np.asarray(convolve_frame(left[0], pulse, pulse, CONFIG))[0])
    heard = np.concatenate(frames)
    ramp = round(0.005 * RATE)
    assert np.abs(heard[:800]).max() < 1e-5
    np.testing.assert_allclose(heard[800 + ramp : 800 + CONFIG.frame - ramp], 1, atol=1e-4)
    assert np.abs(heard[800 + CONFIG.frame :]).max() < 1e-5


@pytest.mark.parametrize("rate", [0.5, 1.0, 1.25, 393 / 256])
def test_clips_played_faster_are_interpolated_without_a_seam(rng, rate: float):
    """Against NumPy's interpolation of the endless loop, also long after the start, where floats are too coarse."""
    clips, sounds, row = sources(rng)
    loop = clips.shape[1] * RATE_STEPS
    wave = np.asarray(clips[0], float)
    for phase in (0, 699, 100_003, loop - 50):
        got = emitted_signal(clips, sounds, row, jnp.int32(phase), jnp.int32(0), CONFIG, jnp.float32(rate))[0]
        span = np.arange(1 - CONFIG.memory_length, CONFIG.frame + CONFIG.num_lookahead)
        at = (phase + span) * rate
        whole = np.floor(at).astype(int)
        wanted = wave[whole % 700] + (at - whole) * (wave[(whole + 1) % 700] - wave[whole % 700])
        np.testing.assert_allclose(got, wanted, atol=1e-5)
