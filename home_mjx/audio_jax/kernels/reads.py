"""What is read of a source in one frame: how each path's delay runs, and its share in sums that are filtered later.

Paths are read from the source at times that run on evenly, so pitch is right at every frequency (Doppler). The first
one is read from what its own filters make of the source, those of both ends of the frame.
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

FILTERED = 2  # ways that are read from what filters made, one for each end of the frame


class Ways(Pytree):
    """Paths in one frame: lengths at its start and end, and how late ears hear what they bring.

    A path comes from an image of its source, which moves evenly relative to the head, as source and head do: then its
    length is right at every moment, not only at the frame's ends.
    """

    old: Float[Array, " p"]  # [m]
    new: Float[Array, " p"]  # [m]
    bend: Float[Array, " p"]  # [m²]: the square of the way of its image across it
    ears: Float[Array, "p three d"]  # [samples] later than the middle of the head: at the start, the middle and the end


class Reads(Pytree):
    """All that a frame reads of one source: the first `FILTERED` ways from `filtered`, the others from `source`."""

    source: Float[Array, " n"]
    filtered: Float[Array, "two m"]
    start: Int[Array, " three"]  # half sample of each part, all of them in a row, that is heard where there is no delay
    ways: Ways
    share: Float[Array, "q e s two"]  # in each sum, at the frame's start, and by how much more at its end


def sums_of(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
    """Paths of several sources, read and added up.

    Args:
        reads: With a leading axis of sources.
        config: Options.
    """
    return jnp.sum(jax.vmap(lambda one: _added(_heard(one, config), one.share, fade_of(config)))(reads), axis=0)


def part_sizes(reads: Reads) -> tuple[int, ...]:
    """Half samples of each part."""
    return (*[2 * reads.filtered.shape[-1]] * FILTERED, 2 * reads.source.shape[-1])


def way_rows(ways: Ways) -> Float[Array, "*n p w"]:
    """Numbers of each path side by side, as kernels read them: lengths at both ends, the bend, delays of ears."""
    lengths = (x[..., None] for x in (ways.old, ways.new, ways.bend))
    return jnp.concatenate([*lengths, ways.ears.reshape(*ways.old.shape, -1)], axis=-1)


def way_delays(
    way: Ways, time: Float[Array, " k"], config: AudioConfig
) -> tuple[Int[Array, " k"], Float[Array, "d k"]]:
    """How much earlier left its source what a path brings: whole samples to the middle of the head, and beyond that.

    Args:
        way: One path.
        time: In frames: from 0 to 1, and before and after.
        config: Options.
    """
    curve = time * (1 - time)
    line = way.old + time * (way.new - way.old)  # apart, so that still paths are exact
    across = curve * way.bend
    length = line - across / jnp.maximum(line + jnp.sqrt(jnp.maximum(line**2 - across, 0.0)), 1e-6)
    samples = length * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    start, middle, end = (x[:, None] for x in way.ears)
    late = start + time[None] * (end - start) + 4 * curve[None] * (middle - (start + end) / 2)
    return whole.astype(jnp.int32), (samples - whole)[None] + late


def before(config: AudioConfig) -> int:
    """Samples before the frame in which filters that ring on in it have begun."""
    return num_taps(config.sample_rate) + HALF_WIDTH - 1


def margin(config: AudioConfig) -> int:
    """Samples that are read beyond a delay."""
    return READ + math.ceil(config.lead_seconds * config.sample_rate)


def times(config: AudioConfig) -> Float[Array, " k"]:
    """Of samples that are read, in frames: as many as a transform takes."""
    count = int(next_fast_len(before(config) + config.frame + HALF_WIDTH, real=True) or 0)
    return jnp.asarray((np.arange(count) - before(config)) / config.frame, jnp.float32)


def frame_begin(config: AudioConfig) -> int:
    """Which sample of a filtered sum is the frame's first."""
    return before(config) + HALF_WIDTH


def fade_of(config: AudioConfig) -> Float[Array, " k"]:
    """How much of a frame's end each sample has."""
    return jnp.clip(times(config), 0.0, 1.0)


def _heard(reads: Reads, config: AudioConfig) -> Float[Array, "q d k"]:
    """Each way's sound, sample by sample."""
    time, sizes = times(config), part_sizes(reads)
    number = jnp.arange(time.shape[0], dtype=jnp.int32)
    ends = np.cumsum([0, *sizes]).astype(np.int32)
    part = np.minimum(np.arange(reads.ways.old.shape[0]), FILTERED)
    halves = [at_twice_the_rate(x) for x in (*reads.filtered, reads.source)]
    # Compilers would make it anew for every path that is read from it.
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

    # One path after the other: all at once, compilers keep an index for each of the values that are read.
    bounds = jnp.asarray(ends[:-1][part]), jnp.asarray(ends[1:][part])
    return jax.lax.scan(one, None, (reads.ways, reads.start[part], *bounds))[1]


def _added(
    heard: Float[Array, "q d k"], share: Float[Array, "q e s two"], fade: Float[Array, " k"]
) -> Float[Array, "e s k"]:
    """All ways with shares that run from those at the start to those at the end."""
    weights = jnp.swapaxes(jnp.concatenate([share[..., 0], share[..., 1]]), 0, 1)
    sounds = jnp.swapaxes(jnp.concatenate([heard, heard * fade[None, None]]), 0, 1)
    if sounds.shape[0] == 1:  # all channels hear at once
        return jnp.einsum("eqs,qk->esk", weights, sounds[0], precision="highest")
    return jnp.einsum("eqs,eqk->esk", weights, sounds, precision="highest")
