"""Early sound of one frame, in which every path has its own delay, different in every sample.

What a path's filters make of the source's sound is read at times that run evenly between those at the ends of short
blocks: two kernels of fractional delay per block, between which every sample fades. So pitch is right at every
frequency (Doppler), and a still path is one convolution.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.auralization.response import ear_delays, head_angles, octave_spectra, pulse_width, pulses
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS
from home_mjx.audio_jax.motion.pairs import Pairs
from home_mjx.core.pytree import Pytree

BLOCK = 40  # samples, 2.5 ms, in which delays of agents change by less than a quarter of a sample
FASTEST = 10.0  # [m/s], at which paths may grow or shrink; faster ones are faded
SPREAD = 0.002  # [s], by which delays of two ears differ, and change by turns of the head, in one frame
SLOWEST_SOUND = 250.0  # [m/s], of all airs that can be chosen


class Delays(Pytree):
    """When what is heard left its source, at both ends of each block."""

    whole: Int[Array, "p 2 b"]  # [samples], less than both
    rest: Float[Array, "p 2 b two"]  # [samples], beyond that


def early_frame(source: Float[Array, " n"], past: int, pairs: Pairs, config: AudioConfig) -> Float[Array, "2 m"]:
    """What both ears hear through paths that move during one frame.

    Args:
        source: What leaves the source at 1 m, from `past` samples before the frame on and for as long as is known.
        past: Samples before the frame's first one.
        pairs: Paths at the frame's start and end.
        config: Options.
    """
    angles = _ear_angles(pairs, config)
    turned = jnp.clip(_between(angles, _times(config)), 0.0, jnp.pi)
    # Compilers would compute these anew for every sample that they are about, and kernels for every product.
    delays, turned = jax.lax.optimization_barrier((path_delays(pairs, angles, config), turned))
    latest = jnp.max(delays.whole, axis=(1, 2))
    filtered = _filtered(source, past, latest, delays, pairs, config)
    begin = BLOCK * jnp.arange(num_blocks(config), dtype=jnp.int32)[None, None] + latest[:, None, None] - delays.whole

    def add(path: Int[Array, ""], heard: Float[Array, "2 b s"]) -> Float[Array, "2 b s"]:
        return heard + _one_path(filtered[path], begin[path], delays.rest[path], turned[path], config)

    # One path after the other: all that one needs stays near the processor, and a sum in one go would take longer.
    nothing = jnp.zeros((2, num_blocks(config), BLOCK), jnp.float32)
    whole = jax.lax.fori_loop(0, filtered.shape[0], add, nothing)
    return whole.reshape(2, -1)[:, : config.frame]


def _one_path(
    sound: Float[Array, " u"],
    begin: Int[Array, "2 b"],
    rest: Float[Array, "2 b two"],
    angle: Float[Array, "2 k"],
    config: AudioConfig,
) -> Float[Array, "2 b s"]:
    """A path's sound at both ears in all blocks: from where each begins to be read, with delays beyond that."""
    width = pulse_width(config)
    cut = jax.vmap(jax.vmap(lambda start: jax.lax.dynamic_slice_in_dim(sound, start, BLOCK + width - 1)))
    ends = (pulses(angle[:, i : i + begin.shape[1]], rest[..., i], config) for i in (0, 1))
    first, last = (jnp.flip(kernel, -1) for kernel in ends)
    read, first, slope = jax.lax.optimization_barrier((cut(begin), first, last - first))
    share = (jnp.arange(BLOCK, dtype=jnp.float32) / BLOCK)[None, None]
    heard = jnp.zeros((*begin.shape, BLOCK), jnp.float32)
    for tap in range(width):
        a, b = first[..., tap, None], slope[..., tap, None]
        heard = heard + read[..., tap : tap + BLOCK] * (a + share * b)
    return heard


def path_delays(pairs: Pairs, angles: Float[Array, "three p 2"], config: AudioConfig) -> Delays:
    """Delays of all paths at both ears, at the ends of blocks; `angles` are those to the ears' axes.

    A path comes from an image of its source, which moves evenly relative to the head, as source and head do: then its
    length is right at every moment, not only at the frame's ends. Delays of ears are a parabola through those at its
    start, middle and end.
    """
    time = _times(config)
    old, new = pairs.old.distance[:, None], pairs.new.distance[:, None]
    step = pairs.new.direction * new - pairs.old.direction * old
    bend = jnp.maximum(jnp.sum(step**2, axis=1, keepdims=True) - (new - old) ** 2, 0.0)
    line = old + time * (new - old)  # apart, so that still paths are exact
    curve = time * (1 - time) * bend
    length = line - curve / jnp.maximum(line + jnp.sqrt(jnp.maximum(line**2 - curve, 0.0)), 1e-6)
    samples = length * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    rest = (samples - whole)[:, None] + _between(ear_delays(angles, config), time)
    carry = jnp.floor(rest)
    whole, rest = whole[:, None] + carry, rest - carry
    base = jnp.minimum(whole[..., :-1], whole[..., 1:])
    ends = jnp.stack([whole[..., :-1] - base + rest[..., :-1], whole[..., 1:] - base + rest[..., 1:]], axis=-1)
    return Delays(base.astype(jnp.int32), ends)


def num_blocks(config: AudioConfig) -> int:
    """Blocks in a frame; the last one may reach beyond it."""
    return -(-config.frame // BLOCK)


def longest_step(config: AudioConfig) -> float:
    """[m], by which a path may grow or shrink in a frame."""
    return FASTEST * config.frame / config.sample_rate


def _times(config: AudioConfig) -> Float[Array, "1 k"]:
    """When blocks begin and end, in frames."""
    ends = jnp.arange(num_blocks(config) + 1, dtype=jnp.float32)
    return jnp.minimum(ends * jnp.float32(BLOCK / config.frame), 1.0)[None]


def _ear_angles(pairs: Pairs, config: AudioConfig) -> Float[Array, "three p 2"]:
    """Between paths and the axes of both ears, at the start, in the middle and at the end."""
    old, new = pairs.old, pairs.new
    mid = old.direction * old.distance[:, None] + new.direction * new.distance[:, None]
    mid = mid / jnp.maximum(jnp.linalg.norm(mid, axis=1, keepdims=True), 1e-6)
    turned = jnp.where(jnp.sum(pairs.old_quat * pairs.new_quat) < 0, -pairs.new_quat, pairs.new_quat)
    quat = pairs.old_quat + turned
    quat = quat / jnp.maximum(jnp.linalg.norm(quat), 1e-6)
    at = [(old.direction, pairs.old_quat), (mid, quat), (new.direction, pairs.new_quat)]
    return jnp.stack([head_angles(direction, quat, config) for direction, quat in at])


def _between(ends: Float[Array, "three p 2"], time: Float[Array, "1 k"]) -> Float[Array, "p 2 k"]:
    """The parabola through three values at times 0, 0.5 and 1."""
    start, middle, end = (x[..., None] for x in ends)
    time = time[None]
    return start + time * (end - start) + 4 * time * (1 - time) * (middle - (start + end) / 2)


def _filtered(
    source: Float[Array, " n"],
    past: int,
    latest: Int[Array, " p"],
    delays: Delays,
    pairs: Pairs,
    config: AudioConfig,
) -> Float[Array, "p u"]:
    """The source's sound through each path's filters; sample 0 is what the frame's first sample reads first."""
    taps, width = math.ceil(CAUSAL_SECONDS * config.sample_rate), pulse_width(config)
    slack = math.ceil((longest_step(config) / SLOWEST_SOUND + SPREAD) * config.sample_rate)
    length = num_blocks(config) * BLOCK + slack + width
    size = int(next_fast_len(length + taps, real=True) or 0)
    after = width - HALF_WIDTH  # samples that a kernel looks back
    before = taps + after + slack
    padded = jnp.pad(source, (before, size))
    start = past + before - latest - after - taps
    window = jax.vmap(lambda s: jax.lax.dynamic_slice_in_dim(padded, s, size))(jnp.maximum(start, 0))
    filters = jnp.stack([octave_spectra(paths.gain, size, config) for paths in (pairs.old, pairs.new)])
    both = jnp.fft.irfft(jnp.fft.rfft(window, size)[None] * filters, size)[..., taps : taps + length]
    first, last = (jnp.mean((latest[:, None] - x).astype(jnp.float32), axis=1) for x in _ends(delays))
    place = jnp.arange(length, dtype=jnp.float32)[None] - after
    share = (place - first[:, None]) / jnp.maximum(last - first + config.frame, 1.0)[:, None]
    return both[0] + jnp.clip(share, 0.0, 1.0) * (both[1] - both[0])


def _ends(delays: Delays) -> tuple[Int[Array, "p 2"], Int[Array, "p 2"]]:
    """Whole delays of the frame's first and last block."""
    return delays.whole[..., 0], delays.whole[..., -1]
