"""Late energy over time: a histogram of traced arrivals, and exponential decay beyond the last bounce."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.tracing import Trace

RELATIVE_SMOOTHING = 0.15  # half width of the smoothing of late arrivals re their time
MAX_LOG_RATIO = 50.0  # maximum log ratio of energies, so that the decay of silence stays finite


def energy_histogram(
    trace: Trace, ear_gain: Float[Array, "n e bands"], config: AudioConfig
) -> Float[Array, "k e bands"]:
    """Compute energy per time bin, channel and octave, re the free field of the source at 1 m.

    Traced arrivals are smoothed over a width proportional to their time, because few rays arrive in bursts where a room
    has dense reflections. Energy that remains in a ray after its last bounce is extrapolated. It decays exponentially
    at the rate of all rays over the later part of the traced time. Its contribution to the channels per unit of energy
    is also measured there. There is no fixed cross-over time.

    Args:
        trace: Traced rays, from `trace`.
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
    decay = jnp.clip(ratio, 1e-3, MAX_LOG_RATIO) / (last - first).astype(jnp.float32)  # per bin
    index = jnp.arange(config.num_bins, dtype=jnp.int32)
    inside = ((index >= first) & (index < last)).astype(jnp.float32)
    given = jnp.einsum("k,kec->ec", inside, traced, precision="highest")
    lived = (before - after) / decay  # energy integrated over the bins between the two, for exponential decay
    yield_per_bin = given / jnp.maximum(lived, 1e-30)[None]

    ends = (trace.travelled[-1:] / metres).astype(jnp.int32)
    ended = _sum_in_bins(ends, trace.remaining[-1:, :, None], config.num_bins)[:, 0]
    living = _linear_recurrence(jnp.exp(-decay), ended) - 0.5 * ended  # on average, rays end in the middle of their bin
    traced = jnp.einsum("kj,jec->kec", jnp.asarray(_smoothing_matrix(config.num_bins)), traced, precision="highest")
    return traced + yield_per_bin[None] * living[:, None, :]


def _sum_in_bins(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """Sum values by bin in a deterministic order; values beyond the last bin are dropped."""
    return jax.lax.platform_dependent(
        bins, values, cpu=functools.partial(_scatter, count=count), default=functools.partial(_contract, count=count)
    )


def _scatter(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """Compute `_sum_in_bins` by scatter, which is sequential on CPUs."""
    return jax.ops.segment_sum(values.reshape(-1, *values.shape[2:]), bins.reshape(-1), count)


def _contract(bins: Int[Array, "a n"], values: Float[Array, "a n e c"], count: int) -> Float[Array, "k e c"]:
    """Compute `_sum_in_bins` by products with indicator matrices, because GPU scatters add in no fixed order."""

    def add(total: Array, row: tuple[Array, Array]) -> tuple[Array, None]:
        """Add one row of values."""
        member = (row[0][None] == jnp.arange(count, dtype=jnp.int32)[:, None]).astype(jnp.float32)
        return total + jnp.einsum("kn,nec->kec", member, row[1], precision="highest"), None

    return jax.lax.scan(add, jnp.zeros((count, *values.shape[2:]), values.dtype), (bins, values))[0]


@functools.cache
def _smoothing_matrix(count: int) -> Float[np.ndarray, "k j"]:
    """Return the share of bin j moved to bin k, sum 1 over k: triangles around j.

    Their half width is `RELATIVE_SMOOTHING` j bins, at least 1, which moves nothing.
    """
    index = np.arange(count)
    share = np.maximum(1 - np.abs(index[:, None] - index[None]) / np.maximum(RELATIVE_SMOOTHING * index, 1), 0)
    return (share / share.sum(axis=0)).astype(np.float32)


def _fit_range(trace: Trace, metres: float, config: AudioConfig) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """Return the decay fit's first and last (exclusive) bin; first is 30 % of last.

    Last is when a tenth of all rays reached their last bounce, 2 to `config.num_bins`; rays without energy never do.
    """
    alive = jnp.max(trace.remaining[-1], axis=1) > 0
    ends = jnp.sort(jnp.where(alive, trace.travelled[-1], jnp.inf))[alive.size // 10]
    last = jnp.clip(ends / metres, 2, config.num_bins).astype(jnp.int32)
    return jnp.minimum((0.3 * last.astype(jnp.float32)).astype(jnp.int32), last - 1), last


def _energy_at(trace: Trace, index: Int[Array, ""], metres: float) -> Float[Array, " bands"]:
    """Sum the energy left in all rays after a path of `index` bins, `metres` [m] long each, from the listener."""
    bounces = jnp.sum(trace.travelled <= index.astype(jnp.float32) * metres, axis=0, dtype=jnp.int32)
    energy = jnp.concatenate([trace.initial_energy[None], trace.remaining])
    chosen = (bounces[None] == jnp.arange(energy.shape[0], dtype=jnp.int32)[:, None]).astype(jnp.float32)
    return jnp.einsum("bn,bnc->c", chosen, energy, precision="highest")


def _linear_recurrence(factor: Float[Array, " bands"], added: Float[Array, "k bands"]) -> Float[Array, "k bands"]:
    """Evaluate the recurrence y[k] = factor y[k - 1] + added[k] with y[-1] = 0."""

    def join(left: tuple[Array, Array], right: tuple[Array, Array]) -> tuple[Array, Array]:
        """Join two steps of the recurrence."""
        return left[0] * right[0], left[1] * right[0] + right[1]

    return jax.lax.associative_scan(join, (jnp.broadcast_to(factor, added.shape), added))[1]
