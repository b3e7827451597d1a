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
from home_mjx.audio_jax.base.delays import FIRST_READ, HALF_WIDTH, NUM_READ, interpolation_weights, upsample_twice
from home_mjx.audio_jax.base.filter_basis import num_basis_taps
from home_mjx.core.pytree import Pytree

NUM_FILTERED = 2  # paths read from filtered signals, one for each end of the frame


class PathDelays(Pytree):
    """Paths in one frame: lengths at its start and end, and additional delays of ears.

    A path comes from an image source, which moves at constant velocity relative to the head, as source and head do. So
    its length is right at every time, not only at the frame's ends.
    """

    start_length: Float[Array, " p"]  # [m]
    end_length: Float[Array, " p"]  # [m]
    curvature: Float[Array, " p"]  # [m²], squared transverse displacement of the image source
    # [samples], delays re the centre of the head at the start, the middle and the end
    ear_delays: Float[Array, "p three d"]


class DelayReads(Pytree):
    """Reads of one source in a frame: the first `NUM_FILTERED` paths from `filtered`, the others from `source`."""

    source: Float[Array, " n"]
    filtered: Float[Array, "two m"]
    start: Int[Array, " three"]  # half sample in the concatenated parts that sample 0 reads at zero delay
    paths: PathDelays
    gain: Float[Array, "q e s two"]  # gain into each bus at the frame's start, and its change until the end


def mix_paths(reads: DelayReads, config: AudioConfig) -> Float[Array, "e s k"]:
    """Read the paths of all sources, the leading axis of `reads`, and sum them into buses (e s) at `sample_times`."""
    return jnp.sum(jax.vmap(lambda one: _mix(_read_paths(one, config), one.gain, fade_weights(config)))(reads), axis=0)


def part_sizes(reads: DelayReads) -> tuple[int, ...]:
    """Return the half samples, twice the samples, of each part of a source: two filtered signals, then the source."""
    return (*[2 * reads.filtered.shape[-1]] * NUM_FILTERED, 2 * reads.source.shape[-1])


def pack_paths(ways: PathDelays) -> Float[Array, "*n p w"]:
    """Pack each path into a row, units as in `PathDelays`: lengths at both ends, curvature, ear delays; w = 3 + 3 d.

    Delays of all d ears at the start precede those at the middle, which precede those at the end.
    """
    lengths = (x[..., None] for x in (ways.start_length, ways.end_length, ways.curvature))
    return jnp.concatenate([*lengths, ways.ear_delays.reshape(*ways.start_length.shape, -1)], axis=-1)


def path_delays(
    way: PathDelays, time: Float[Array, " k"], config: AudioConfig
) -> tuple[Int[Array, " k"], Float[Array, "d k"]]:
    """Compute the delay of a path [samples]: whole ones to the head centre, and the rest plus the delay of each ear.

    The squared length at time t is ((1 - t) start + t end)² - t (1 - t) curvature. Ear delays are parabolas through
    their three values. `time` counts frames: 0 to 1 within the frame, also before and after.
    """
    curve = time * (1 - time)
    line = way.start_length + time * (way.end_length - way.start_length)  # in this form static paths are exact
    across = curve * way.curvature
    length = line - across / jnp.maximum(line + jnp.sqrt(jnp.maximum(line**2 - across, 0.0)), 1e-6)
    samples = length * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    start, middle, end = (x[:, None] for x in way.ear_delays)
    late = start + time[None] * (end - start) + 4 * curve[None] * (middle - (start + end) / 2)
    return whole.astype(jnp.int32), (samples - whole)[None] + late


def filter_history(config: AudioConfig) -> int:
    """Return the number of samples before the frame that affect it through the basis filters."""
    return num_basis_taps(config.sample_rate) + HALF_WIDTH - 1


def read_margin(config: AudioConfig) -> int:
    """Return a margin on each side of a path's delayed sample that covers interpolation and ear delays [samples].

    It is an upper bound: `NUM_READ` half samples count as whole ones. What upsampling reads is not included.
    """
    return NUM_READ + math.ceil(config.max_lead_seconds * config.sample_rate)


def sample_times(config: AudioConfig) -> Float[Array, " k"]:
    """Return times of bus samples [frames] re the frame's start, from -`filter_history` samples; k: a fast FFT size."""
    count = int(next_fast_len(filter_history(config) + config.frame + HALF_WIDTH, real=True) or 0)
    return jnp.asarray((np.arange(count) - filter_history(config)) / config.frame, jnp.float32)


def frame_begin(config: AudioConfig) -> int:
    """Return the index of the frame's first sample in a bus after its filter, which adds `HALF_WIDTH` samples."""
    return filter_history(config) + HALF_WIDTH


def fade_weights(config: AudioConfig) -> Float[Array, " k"]:
    """Return the weight of the frame's end in each sample of a bus: 0 before the frame, in it linear to 1, then 1."""
    return jnp.clip(sample_times(config), 0.0, 1.0)


def _read_paths(reads: DelayReads, config: AudioConfig) -> Float[Array, "q d k"]:
    """Read the signal of each of q paths with d delays; reads beyond a signal are clamped to its ends."""
    time, sizes = sample_times(config), part_sizes(reads)
    number = jnp.arange(time.shape[0], dtype=jnp.int32)
    ends = np.cumsum([0, *sizes]).astype(np.int32)
    part = np.minimum(np.arange(reads.paths.start_length.shape[0]), NUM_FILTERED)
    halves = [upsample_twice(x) for x in (*reads.filtered, reads.source)]
    # Without the barrier, compilers recompute it for every path.
    double = jax.lax.optimization_barrier(jnp.concatenate(halves))

    def one(_: None, row: tuple[PathDelays, Array, Array, Array]) -> tuple[None, Float[Array, "d k"]]:
        """Read one path, whose half samples are from index `first` to `last` (exclusive)."""
        way, start, first, last = row
        whole, rest = path_delays(way, time, config)
        low = jnp.floor(-2 * rest)
        at = (start + 2 * (number - whole))[None] + low.astype(jnp.int32)
        at = jnp.clip(at, first - FIRST_READ, last - NUM_READ - FIRST_READ)
        heard = jnp.zeros(rest.shape, jnp.float32)
        for i, weight in enumerate(interpolation_weights(-2 * rest - low)):
            heard = heard + weight * double.at[at + (FIRST_READ + i)].get(mode="promise_in_bounds")
        return None, heard

    # A scan over paths: with all paths at once, compilers keep an index for each value that is read.
    bounds = jnp.asarray(ends[:-1][part]), jnp.asarray(ends[1:][part])
    return jax.lax.scan(one, None, (reads.paths, reads.start[part], *bounds))[1]


def _mix(
    heard: Float[Array, "q d k"], share: Float[Array, "q e s two"], fade: Float[Array, " k"]
) -> Float[Array, "e s k"]:
    """Mix all paths q into buses s of channels e with gains `share[..., 0]` + `fade` `share[..., 1]`."""
    weights = jnp.swapaxes(jnp.concatenate([share[..., 0], share[..., 1]]), 0, 1)
    sounds = jnp.swapaxes(jnp.concatenate([heard, heard * fade[None, None]]), 0, 1)
    if sounds.shape[0] == 1:  # all channels share the delays
        return jnp.einsum("eqs,qk->esk", weights, sounds[0], precision="highest")
    return jnp.einsum("eqs,eqk->esk", weights, sounds, precision="highest")
