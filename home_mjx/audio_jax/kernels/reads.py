"""Delay-line reads of one audio frame: time-varying delay of each path, and its gains into the shared filter buses.

Delays change continuously within a frame, so the Doppler shift is right at every frequency. The first path is read from
its own filtered signals, one for each end of the frame.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import FIRST, HALF_WIDTH, READ, at_twice_the_rate, read_weights
from home_mjx.audio_jax.base.shapes import num_taps
from home_mjx.core.pytree import Pytree

FILTERED = 2  # paths read from filtered signals, one for each end of the frame


class Ways(Pytree):
    """Paths in one frame: lengths at its start and end, and additional delays of ears.

    A path comes from an image source, which moves at constant velocity relative to the head, as source and head do. So
    its length is right at every time, not only at the frame's ends.
    """

    old: Float[Array, " p"]  # [m]
    new: Float[Array, " p"]  # [m]
    bend: Float[Array, " p"]  # [m²], squared transverse displacement of the image source
    ears: Float[Array, "p three d"]  # [samples], delays re the centre of the head at the start, the middle and the end


class Reads(Pytree):
    """Reads of one source in a frame: the first `FILTERED` paths from `filtered`, the others from `source`."""

    source: Float[Array, " n"]
    filtered: Float[Array, "two m"]
    start: Int[Array, " three"]  # half sample in the concatenated parts that sample 0 reads at zero delay
    ways: Ways
    share: Float[Array, "q e s two"]  # gain into each bus at the frame's start, and its change until the end


def sums_of(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
    """Read the paths of several sources and mix them into buses.

    Args:
        reads: Reads with a leading axis of sources.
        config: Options.
    """
    return jnp.sum(jax.vmap(lambda one: _added(_heard(one, config), one.share, fade_of(config)))(reads), axis=0)


def part_sizes(reads: Reads) -> tuple[int, ...]:
    """Return the number of half samples of each part."""
    return (*[2 * reads.filtered.shape[-1]] * FILTERED, 2 * reads.source.shape[-1])


def way_rows(ways: Ways) -> Float[Array, "*n p w"]:
    """Pack each path into a row for kernels: lengths at both ends, bend, delays of ears."""
    lengths = (x[..., None] for x in (ways.old, ways.new, ways.bend))
    return jnp.concatenate([*lengths, ways.ears.reshape(*ways.old.shape, -1)], axis=-1)


def way_delays(
    way: Ways, time: Float[Array, " k"], config: AudioConfig
) -> tuple[Int[Array, " k"], Float[Array, "d k"]]:
    """Compute the delay of a path: whole samples to the centre of the head, and the remainder per ear [samples].

    Args:
        way: One path.
        time: Time in frames: 0 to 1 within the frame, also before and after.
        config: Options.
    """
    curve = time * (1 - time)
    line = way.old + time * (way.new - way.old)  # in this form static paths are exact
    across = curve * way.bend
    length = line - across / jnp.maximum(line + jnp.sqrt(jnp.maximum(line**2 - across, 0.0)), 1e-6)
    samples = length * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    start, middle, end = (x[:, None] for x in way.ears)
    late = start + time[None] * (end - start) + 4 * curve[None] * (middle - (start + end) / 2)
    return whole.astype(jnp.int32), (samples - whole)[None] + late


def before(config: AudioConfig) -> int:
    """Return the samples before the frame that affect it through the filters."""
    return num_taps(config.sample_rate) + HALF_WIDTH - 1


def margin(config: AudioConfig) -> int:
    """Return the samples that are read beyond a delay."""
    return READ + math.ceil(config.lead_seconds * config.sample_rate)


def times(config: AudioConfig) -> Float[Array, " k"]:
    """Return the times of the samples that are read, in frames; their number is a fast transform size."""
    count = int(next_fast_len(before(config) + config.frame + HALF_WIDTH, real=True) or 0)
    return jnp.asarray((np.arange(count) - before(config)) / config.frame, jnp.float32)


def frame_begin(config: AudioConfig) -> int:
    """Return the index of the frame's first sample in a filtered bus."""
    return before(config) + HALF_WIDTH


def fade_of(config: AudioConfig) -> Float[Array, " k"]:
    """Return the weight of the frame's end in each sample."""
    return jnp.clip(times(config), 0.0, 1.0)


def _heard(reads: Reads, config: AudioConfig) -> Float[Array, "q d k"]:
    """Read the signal of each path, sample by sample."""
    time, sizes = times(config), part_sizes(reads)
    number = jnp.arange(time.shape[0], dtype=jnp.int32)
    ends = np.cumsum([0, *sizes]).astype(np.int32)
    part = np.minimum(np.arange(reads.ways.old.shape[0]), FILTERED)
    halves = [at_twice_the_rate(x) for x in (*reads.filtered, reads.source)]
    # Without the barrier, compilers recompute it for every path.
    double = jax.lax.optimization_barrier(jnp.concatenate(halves))

    def one(_: None, row: tuple[Ways, Array, Array, Array]) -> tuple[None, Float[Array, "d k"]]:
        way, start, first, last = row
        whole, rest = way_delays(way, time, config)
        low = jnp.floor(-2 * rest)
        at = (start + 2 * (number - whole))[None] + low.astype(jnp.int32)
        at = jnp.clip(at, first - FIRST, last - READ - FIRST)
        heard = jnp.zeros(rest.shape, jnp.float32)
        for i, weight in enumerate(read_weights(-2 * rest - low)):
            heard = heard + weight * double.at[at + (FIRST + i)].get(mode="promise_in_bounds")
        return None, heard

    # A scan over paths: with all paths at once, compilers keep an index for each value that is read.
    bounds = jnp.asarray(ends[:-1][part]), jnp.asarray(ends[1:][part])
    return jax.lax.scan(one, None, (reads.ways, reads.start[part], *bounds))[1]


def _added(
    heard: Float[Array, "q d k"], share: Float[Array, "q e s two"], fade: Float[Array, " k"]
) -> Float[Array, "e s k"]:
    """Mix all paths with gains that are interpolated over the frame."""
    weights = jnp.swapaxes(jnp.concatenate([share[..., 0], share[..., 1]]), 0, 1)
    sounds = jnp.swapaxes(jnp.concatenate([heard, heard * fade[None, None]]), 0, 1)
    if sounds.shape[0] == 1:  # all channels share the delays
        return jnp.einsum("eqs,qk->esk", weights, sounds[0], precision="highest")
    return jnp.einsum("eqs,eqk->esk", weights, sounds, precision="highest")
