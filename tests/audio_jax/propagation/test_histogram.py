"""Binning of arrivals and extrapolation of the decay, on traces made by hand."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy_measures import t30

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.histogram import _contract, _scatter, energy_histogram
from home_mjx.audio_jax.propagation.tracing import Trace

CONFIG = AudioConfig(response_seconds=1.0)
SPEED = CONFIG.speed_of_sound
RAYS, BOUNCES, MEAN_PATH = 8000, 12, 2.5
EARS = jnp.ones((RAYS, 2, 7))
LEAVING = jnp.full((RAYS, 7), 1 / RAYS)
BOTH = np.array([2.0, 0.5])[None, :, None]


@pytest.fixture(scope="module")
def histogram():
    """`energy_histogram`, compiled under strict promotion."""

    def run(trace: Trace, ears: jax.Array) -> np.ndarray:
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            return np.asarray(compiled(trace, ears), float)

    compiled = jax.jit(lambda trace, ears: energy_histogram(trace, ears, CONFIG))
    return run


def poisson_rays(rng: np.random.Generator, absorption: np.ndarray, delivery: float = 50.0) -> Trace:
    """Rays with free paths exponential about 2.5 m, whose energy therefore falls as exp(-absorption c t / 2.5 m).

    They give the listener `delivery` times their energy per second.
    """
    segments = rng.exponential(MEAN_PATH, (BOUNCES, RAYS))
    travelled = np.cumsum(segments, axis=0)
    remaining = np.cumprod(np.ones((BOUNCES, RAYS, 1)) * (1 - absorption), axis=0) / RAYS
    before = remaining / (1 - absorption)
    given = delivery / SPEED * segments[..., None] * before
    arrival = travelled - rng.uniform(0, 1, segments.shape) * segments
    arrays = (rng.normal(size=(RAYS, 3)), arrival, given, travelled, remaining, LEAVING)
    return Trace(*(jnp.asarray(a, jnp.float32) for a in arrays))


def test_an_exponential_decay_goes_on_as_it_was(histogram, rng):
    """Twelve bounces (90 ms) continued over a second: decay time per octave, level, and no kink where rays end."""
    absorption = np.linspace(0.1, 0.4, 7)
    ours = histogram(poisson_rays(rng, absorption), EARS)
    rate = absorption * SPEED / MEAN_PATH  # [1/s]
    time = (np.arange(CONFIG.num_bins) + 0.5) * CONFIG.bin_seconds
    exact = 50.0 * CONFIG.bin_seconds * np.exp(-time[:, None] * rate)
    for band in range(7):
        assert t30(ours[:, 0, band], CONFIG.bin_seconds) == pytest.approx(13.8155 / rate[band], rel=0.02)
    smooth = ours[:, 0].reshape(-1, 5, 7).sum(axis=1) / exact.reshape(-1, 5, 7).sum(axis=1)
    assert np.max(np.abs(10 * np.log10(smooth[:12]))) < 0.8


def test_every_ear_and_ray_is_weighted(histogram, rng):
    """Histograms are linear in the ears' gains."""
    trace = poisson_rays(rng, np.full(7, 0.2))
    plain = histogram(trace, EARS)
    np.testing.assert_allclose(histogram(trace, EARS * BOTH), plain * BOTH, rtol=2e-5)


def test_arrivals_fall_into_their_bins(histogram):
    """Against numpy's histogram, for rays that have lost everything at the end; later ones blurred by 15 %."""
    rng = np.random.default_rng(1)
    arrival = rng.uniform(0, 1.2 * SPEED, (BOUNCES, RAYS)).astype(np.float32)
    energy = rng.uniform(0, 1, (BOUNCES, RAYS, 7)).astype(np.float32)
    nothing = jnp.zeros((BOUNCES, RAYS, 7))
    travelled = jnp.asarray(np.sort(arrival, axis=0))
    trace = Trace(jnp.ones((RAYS, 3)), jnp.asarray(arrival), jnp.asarray(energy), travelled, nothing, LEAVING)
    ours = histogram(trace, EARS)
    edges = np.arange(CONFIG.num_bins + 1) * np.float32(CONFIG.bin_seconds * SPEED)
    for band in (0, 6):
        exact, _ = np.histogram(arrival, edges, weights=energy[..., band].astype(float))
        np.testing.assert_allclose(ours[:6, 1, band], exact[:6], rtol=1e-4)
        np.testing.assert_allclose(ours[:, 1, band].sum(), exact.sum(), rtol=1e-5)
        for time in (50, 150, 240):
            width = int(0.15 * time)
            near = slice(time - width, time + width)
            assert ours[near, 1, band].mean() == pytest.approx(exact[near].mean(), rel=0.05)


def test_blur_is_as_wide_as_its_share_of_time(histogram):
    """A single arrival at 0.4 s spreads over 0.34 .. 0.46 s about its time."""
    arrival = jnp.full((1, RAYS), 0.402 * SPEED)
    trace = Trace(jnp.ones((RAYS, 3)), arrival, jnp.ones((1, RAYS, 7)), arrival, jnp.zeros((1, RAYS, 7)), LEAVING)
    ours = histogram(trace, EARS)[:, 0, 3]
    time = (np.arange(ours.size) + 0.5) * CONFIG.bin_seconds
    assert ours.sum() == pytest.approx(RAYS, rel=1e-5)
    assert np.average(time, weights=ours) == pytest.approx(0.402, abs=2e-3)
    assert np.ptp(time[ours > 0]) == pytest.approx(0.12, abs=0.009)


def test_both_ways_to_sum_agree(rng):
    """The one of CPUs and the one of GPUs."""
    bins = jnp.asarray(rng.integers(0, 60, (5, 300)), jnp.int32)
    values = jnp.asarray(rng.uniform(size=(5, 300, 2, 7)), jnp.float32)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        both = [np.asarray(f(bins, values, 50)) for f in (_scatter, _contract)]
    np.testing.assert_allclose(both[0], both[1], rtol=1e-5)


def test_rays_that_all_leave_the_house_give_silence(histogram):
    """No NaN, no tail."""
    zeros = jnp.zeros((BOUNCES, RAYS))
    octaves = zeros[..., None] * jnp.ones(7)
    trace = Trace(jnp.ones((RAYS, 3)), zeros, octaves, zeros, octaves, LEAVING)
    np.testing.assert_array_equal(histogram(trace, EARS), 0)
