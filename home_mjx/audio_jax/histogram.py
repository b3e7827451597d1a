"""Late energy over time: arrivals put into bins, and the decay beyond the last traced bounce."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.config import AudioConfig
from home_mjx.audio_jax.tracing import Trace

STEEPEST = 50.0  # largest logarithm of a ratio of energies, so that silence stays finite


def energy_histogram(trace: Trace, ear_gain: Float[Array, "n 2 7"], config: AudioConfig) -> Float[Array, "k 2 7"]:
    """Energy per time bin, ear and octave, re the free field of the source at 1 m.

    The traced bounces fill the bins directly. A ray's further life is the decay of the rays as a whole: the energy left
    at its end falls exponentially at the rate at which all rays fell over the later part of the traced time, and gives
    the ears as much per energy and second as rays did there. Nothing is cut or joined at a fixed time.

    Args:
        trace: What `trace` gave.
        ear_gain: Energy gain of both ears for each ray's direction.
        config: Options.

    Returns:
        Histogram of `config.num_bins` bins.
    """
    metres = config.bin_seconds * config.speed_of_sound
    heard = trace.energy[:, :, None, :] * ear_gain[None]
    bins = (trace.arrival / metres).astype(jnp.int32)
    traced = _sum_in_bins(bins.reshape(-1), heard.reshape(-1, 2, heard.shape[-1]), config.num_bins)

    first, last = _fit_range(trace, metres, config)
    before, after = _energy_at(trace, first, metres), _energy_at(trace, last, metres)
    ratio = jnp.log(jnp.maximum(before, 1e-30)) - jnp.log(jnp.maximum(after, 1e-30))
    decay = jnp.clip(ratio, 1e-3, STEEPEST) / (last - first).astype(jnp.float32)  # per bin
    index = jnp.arange(config.num_bins)
    inside = ((index >= first) & (index < last)).astype(jnp.float32)
    given = jnp.einsum("k,kec->ec", inside, traced, precision="highest")
    lived = (before - after) / decay  # energy times bins between the two, falling exponentially
    yield_per_bin = given / jnp.maximum(lived, 1e-30)[None]

    ends = (trace.travelled[-1] / metres).astype(jnp.int32)
    ended = _sum_in_bins(ends, trace.remaining[-1][:, None, :], config.num_bins)[:, 0]
    living = _recur(jnp.exp(-decay), ended) - 0.5 * ended  # rays end in the middle of their bin
    return traced + yield_per_bin[None] * living[:, None, :]


def _sum_in_bins(bins: Int[Array, " n"], values: Float[Array, "n e c"], count: int) -> Float[Array, "k e c"]:
    """Sums of values by bin; those beyond the last bin are left out.

    A product with a matrix of ones, since additions to one place have no fixed order on a GPU.
    """
    member = (bins[None, :] == jnp.arange(count)[:, None]).astype(jnp.float32)
    return jnp.einsum("kn,nec->kec", member, values, precision="highest")


def _fit_range(trace: Trace, metres: float, config: AudioConfig) -> tuple[Int[Array, ""], Int[Array, ""]]:
    """First and last bin between which the decay is read: up to where a tenth of the living rays have ended."""
    alive = jnp.max(trace.remaining[-1], axis=1) > 0
    ends = jnp.sort(jnp.where(alive, trace.travelled[-1], jnp.inf))[alive.size // 10]
    last = jnp.clip(ends / metres, 2, config.num_bins).astype(jnp.int32)
    return jnp.minimum((0.3 * last.astype(jnp.float32)).astype(jnp.int32), last - 1), last


def _energy_at(trace: Trace, index: Int[Array, ""], metres: float) -> Float[Array, "7"]:
    """Energy of all rays together at the start of a bin."""
    bounces = jnp.sum(trace.travelled <= index.astype(jnp.float32) * metres, axis=0)
    start = jnp.full((1, *trace.remaining.shape[1:]), 1 / bounces.size, jnp.float32)
    energy = jnp.concatenate([start, trace.remaining])
    chosen = (bounces[None] == jnp.arange(energy.shape[0])[:, None]).astype(jnp.float32)
    return jnp.einsum("bn,bnc->c", chosen, energy, precision="highest")


def _recur(factor: Float[Array, "7"], added: Float[Array, "k 7"]) -> Float[Array, "k 7"]:
    """y[k] = factor y[k - 1] + added[k]."""

    def join(left: tuple[Array, Array], right: tuple[Array, Array]) -> tuple[Array, Array]:
        return left[0] * right[0], left[1] * right[0] + right[1]

    return jax.lax.associative_scan(join, (jnp.broadcast_to(factor, added.shape), added))[1]
