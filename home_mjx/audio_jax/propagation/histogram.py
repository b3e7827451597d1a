"""Late energy over time: arrivals put into bins, and the decay beyond the last traced bounce."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.tracing import Trace

BLUR = 0.15  # resolution in time of late arrivals, relative to their time
STEEPEST = 50.0  # largest logarithm of a ratio of energies, so that silence stays finite


def energy_histogram(
    trace: Trace, ear_gain: Float[Array, "n e bands"], config: AudioConfig
) -> Float[Array, "k e bands"]:
    """Energy per time bin, channel and octave, re the free field of the source at 1 m.

    The traced bounces fill the bins, the later the more widely: what few rays bring in bursts comes densely in a room.
    A ray's further life is the decay of the rays as a whole: the energy left at its end falls exponentially at the rate
    at which all rays fell over the later part of the traced time, and gives the ears as much per energy and second as
    rays did there. Nothing is cut or joined at a fixed time.

    Args:
        trace: What `trace` gave.
        ear_gain: Energy gain of each channel for each ray's direction.
        config: Options.

    Returns:
        Histogram of `config.num_bins` bins.
    """
    metres = config.bin_seconds * config.speed_of_sound
    heard = trace.energy[:, :, None, :] * ear_gain[None]
    traced = _sum_in_bins((trace.arrival / metres).astype(jnp.int32), heard, config.num_bins)

    first, last = _fit_range(trace, metres, config)
    before, after = _energy_at(trace, first, metres), _energy_at(trace, last, metres)
    ratio = jnp.log(jnp.maximum(before, 1e-30)) - jnp.log(jnp.maximum(after, 1e-30))
    decay = jnp.clip(ratio, 1e-3, STEEPEST) / (last - first).astype(jnp.float32)  # per bin
    index = jnp.arange(config.num_bins, dtype=jnp.int32)
    inside = ((index >= first) & (index < last)).astype(jnp.float32)
    given = jnp.einsum("k,kec->ec", inside, traced, precision="highest")
    lived = (before - after) / decay  # energy times bins between the two, falling exponentially
    yield_per_bin = given / jnp.maximum(lived, 1e-30)[None]

    ends = (trace.travelled[-1:] / metres).astype(jnp.int32)
    ended = _sum_in_bins(ends, trace.remaining[-1:, :, None], config.num_bins)[:, 0]
    living = _recur(jnp.exp(-decay), ended) - 0.5 * ended  # rays end in the middle of their bin
    traced = jnp.einsum("kj,jec->kec", jnp.asarray(_spread(config.num_bins)), traced, precision="highest")
    return traced + yield_per_bin[None] * living[:, None, :]


def _sum_in_bins(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """Sums of values by bin, in the same order every time; those beyond the last bin are left out."""
    return jax.lax.platform_dependent(
        bins, values, cpu=functools.partial(_scatter, count=count), default=functools.partial(_multiply, count=count)
    )


def _scatter(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """One value after the other, as CPUs do it."""
    return jax.ops.segment_sum(values.reshape(-1, *values.shape[2:]), bins.reshape(-1), count)


def _multiply(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """Products with matrices of ones, row by row: on GPUs additions to one place have no fixed order."""

    def add(total: Array, row: tuple[Array, Array]) -> tuple[Array, None]:
        member = (row[0][None] == jnp.arange(count, dtype=jnp.int32)[:, None]).astype(jnp.float32)
        return total + jnp.einsum("kn,nec->kec", member, row[1], precision="highest"), None

    return jax.lax.scan(add, jnp.zeros((count, *values.shape[2:]), values.dtype), (bins, values))[0]


@functools.cache
def _spread(count: int) -> Float[np.ndarray, "k j"]:
    """Share of bin j that goes to bin k: triangles as wide as `BLUR` of their time, no energy lost."""
    index = np.arange(count)
    share = np.maximum(1 - np.abs(index[:, None] - index[None]) / np.maximum(BLUR * index, 1), 0)
    return (share / share.sum(axis=0)).astype(np.float32)


def _fit_range(trace: Trace, metres: float, config: AudioConfig) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """First and last bin between which the decay is read: up to where a tenth of the living rays have ended."""
    alive = jnp.max(trace.remaining[-1], axis=1) > 0
    ends = jnp.sort(jnp.where(alive, trace.travelled[-1], jnp.inf))[alive.size // 10]
    last = jnp.clip(ends / metres, 2, config.num_bins).astype(jnp.int32)
    return jnp.minimum((0.3 * last.astype(jnp.float32)).astype(jnp.int32), last - 1), last


def _energy_at(trace: Trace, index: Int[Array, ""], metres: float) -> Float[Array, " bands"]:
    """Energy of all rays together at the start of a bin."""
    bounces = jnp.sum(trace.travelled <= index.astype(jnp.float32) * metres, axis=0, dtype=jnp.int32)
    energy = jnp.concatenate([trace.leaving[None], trace.remaining])
    chosen = (bounces[None] == jnp.arange(energy.shape[0], dtype=jnp.int32)[:, None]).astype(jnp.float32)
    return jnp.einsum("bn,bnc->c", chosen, energy, precision="highest")


def _recur(factor: Float[Array, " bands"], added: Float[Array, "k bands"]) -> Float[Array, "k bands"]:
    """y[k] = factor y[k - 1] + added[k]."""

    def join(left: tuple[Array, Array], right: tuple[Array, Array]) -> tuple[Array, Array]:
        return left[0] * right[0], left[1] * right[0] + right[1]

    return jax.lax.associative_scan(join, (jnp.broadcast_to(factor, added.shape), added))[1]
