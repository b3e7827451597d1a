"""Early sound of one frame, in which every path has its own delay, different in every sample.

Paths are read from the source at times that run on evenly, so pitch is right at every frequency (Doppler), and added up
with weights of their own in a few sums per channel. Only these sums are filtered, see `base/shapes.py`. A still path is
one convolution.
"""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.auralization.response import octave_spectra, path_weights
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import FIRST, HALF_WIDTH, READ, at_twice_the_rate, read_weights
from home_mjx.audio_jax.base.endpoints import Head
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS
from home_mjx.audio_jax.base.shapes import num_taps, shapes
from home_mjx.audio_jax.motion.pairs import Pairs
from home_mjx.audio_jax.receivers.channels import channel_delays
from home_mjx.audio_jax.receivers.hrtf import to_head
from home_mjx.core.pytree import Pytree

FASTEST = 10.0  # [m/s], at which paths may grow or shrink; faster ones are faded
SLOWEST_SOUND = 250.0  # [m/s], of all airs that can be chosen


class Ways(Pytree):
    """Paths in one frame: lengths at its start and end, and how late ears hear what they bring.

    A path comes from an image of its source, which moves evenly relative to the head, as source and head do: then its
    length is right at every moment, not only at the frame's ends.
    """

    old: Float[Array, " p"]  # [m]
    new: Float[Array, " p"]  # [m]
    bend: Float[Array, " p"]  # [m²]: the square of the way of its image across it
    ears: Float[Array, "p three d"]  # [samples] later than the middle of the head: at the start, the middle and the end


def early_sums(
    source: Float[Array, " n"], past: int, pairs: Pairs, config: AudioConfig, head: Head | None = None
) -> Float[Array, "e s k"]:
    """What is heard through paths that move during one frame: one sum per channel and shape, see `filtered`.

    Sums of several sources add up.

    Args:
        source: What leaves the source at 1 m, from `past` samples before the frame on and for as long as is known.
        past: Samples before the frame's first one.
        pairs: Paths at the frame's start and end.
        config: Options.
        head: Measured; None: a rigid sphere.
    """
    toward, distances = _to_head(pairs)
    ways = _ways(pairs, channel_delays(toward, distances, config, head))
    earlier = min(past, config.response_length) + _before(config)  # no path is longer than a response
    padded = jnp.pad(source, (_before(config), _margin(config)))[past + _before(config) - earlier :]
    sound = _sound(
        jnp.pad(padded, (_margin(config), 0)), earlier - _before(config) + _margin(config), pairs, ways, config
    )
    ends = ((pairs.old, toward[0], distances[0]), (pairs.new, toward[2], distances[2]))
    old, new = (path_weights(paths.gain, way, at, config, head) for paths, way, at in ends)
    rows = jax.tree.map(lambda x: jnp.concatenate([x[:1], x]), ways)  # the first is heard through two filters
    return _sums(_heard(sound, rows, config), old, new, jnp.clip(_times(config), 0.0, 1.0))


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


def _ways(pairs: Pairs, ears: Float[Array, "three p d"]) -> Ways:
    old, new = pairs.old.distance, pairs.new.distance
    step = pairs.new.direction * new[:, None] - pairs.old.direction * old[:, None]
    bend = jnp.maximum(jnp.sum(step**2, axis=1) - (new - old) ** 2, 0.0)
    return Ways(old, new, bend, jnp.swapaxes(ears, 0, 1))


def longest_step(config: AudioConfig) -> float:
    """[m], by which a path may grow or shrink in a frame."""
    return FASTEST * config.frame / config.sample_rate


def _before(config: AudioConfig) -> int:
    """Samples before the frame in which filters that ring on in it have begun."""
    return num_taps(config.sample_rate) + HALF_WIDTH - 1


def _margin(config: AudioConfig) -> int:
    """Samples that are read beyond a delay."""
    return READ + math.ceil(config.lead_seconds * config.sample_rate)


def _times(config: AudioConfig) -> Float[Array, " k"]:
    """Of samples that are read, in frames: as many as a transform takes."""
    count = int(next_fast_len(_before(config) + config.frame + HALF_WIDTH, real=True) or 0)
    return jnp.asarray((np.arange(count) - _before(config)) / config.frame, jnp.float32)


def _to_head(pairs: Pairs) -> tuple[Float[Array, "three p 3"], Float[Array, "three p"]]:
    """Directions of paths in the frame of the head, and their lengths, at the start, in the middle, at the end."""
    old, new = pairs.old, pairs.new
    mid = (old.direction * old.distance[:, None] + new.direction * new.distance[:, None]) / 2
    between = jnp.linalg.norm(mid, axis=1)
    mid = mid / jnp.maximum(between, 1e-6)[:, None]
    turned = jnp.where(jnp.sum(pairs.old_quat * pairs.new_quat) < 0, -pairs.new_quat, pairs.new_quat)
    quat = pairs.old_quat + turned
    quat = quat / jnp.maximum(jnp.linalg.norm(quat), 1e-6)
    at = [(old.direction, pairs.old_quat), (mid, quat), (new.direction, pairs.new_quat)]
    toward = jnp.stack([to_head(direction, quat) for direction, quat in at])
    return toward, jnp.stack([old.distance, jnp.maximum(between, 1e-2), new.distance])


class Sound(Pytree):
    """All that is read, at twice the sample rate: what the first path's filters make, twice, and the source."""

    double: Float[Array, " n"]
    start: Int[Array, "three"]  # half sample of each that is heard first where there is no delay
    first: Int[Array, "three"]  # half sample with which each begins
    last: Int[Array, "three"]  # and ends


def _sound(padded: Float[Array, " n"], start: int, pairs: Pairs, ways: Ways, config: AudioConfig) -> Sound:
    """From the source, of which sample `start` is heard first where there is no delay."""
    taps, count = int(np.ceil(CAUSAL_SECONDS * config.sample_rate)), _times(config).shape[0]
    spread = 2 * config.lead_seconds  # by which delays differ, and change by turns of the head, in one frame
    slack = int(np.ceil((count / config.frame * longest_step(config) / SLOWEST_SOUND + spread) * config.sample_rate))
    length = count + 2 * slack + 2 * _margin(config)
    size = int(next_fast_len(length + taps, real=True) or 0)
    way = (ways.new[0] * jnp.float32(config.sample_rate / config.speed_of_sound)).astype(jnp.int32)
    begin = jnp.clip(start - way - slack - _margin(config), -slack, padded.shape[0])
    window = jax.lax.dynamic_slice_in_dim(jnp.pad(padded, (taps + slack, size)), begin + slack, size)
    filters = octave_spectra(jnp.stack([pairs.old.gain[0], pairs.new.gain[0]]), size, config)
    both = jnp.fft.irfft(jnp.fft.rfft(window, size)[None] * filters, size)[:, taps : taps + length]
    parts = [at_twice_the_rate(x) for x in (both[0], both[1], padded)]
    ends = np.cumsum([0, *(x.shape[0] for x in parts)]).astype(np.int32)
    starts = jnp.stack([start - begin, start - begin, jnp.int32(start)])
    # Compilers would make it anew for every path that is read from it.
    double = jax.lax.optimization_barrier(jnp.concatenate(parts))
    return Sound(double, 2 * starts + ends[:-1], jnp.asarray(ends[:-1]), jnp.asarray(ends[1:]))


def _heard(sound: Sound, rows: Ways, config: AudioConfig) -> Float[Array, "q d k"]:
    """The first two rows read from what filters made, the others from the source."""
    time = _times(config)
    number = jnp.arange(time.shape[0], dtype=jnp.int32)
    part = jnp.asarray([0, 1, *[2] * (rows.old.shape[0] - 2)], jnp.int32)

    def one(_: None, row: tuple[Ways, Array, Array, Array]) -> tuple[None, Float[Array, "d k"]]:
        way, start, first, last = row
        whole, rest = way_delays(way, time, config)
        low = jnp.floor(-2 * rest)
        at = (start + 2 * (number - whole))[None] + low.astype(jnp.int32)
        at = jnp.clip(at, first - FIRST, last - READ - FIRST)
        heard = jnp.zeros(rest.shape, jnp.float32)
        for i, weight in enumerate(read_weights(-2 * rest - low)):
            heard = heard + weight * sound.double.at[at + (FIRST + i)].get(mode="promise_in_bounds")
        return None, heard

    # One path after the other: all at once, compilers keep an index for each of the values that are read.
    return jax.lax.scan(one, None, (rows, sound.start[part], sound.first[part], sound.last[part]))[1]


def _sums(
    heard: Float[Array, "q d k"], old: Float[Array, "p e s"], new: Float[Array, "p e s"], fade: Float[Array, " k"]
) -> Float[Array, "e s k"]:
    """All paths with weights that run from the old to the new ones; of the first what each end's filter leaves."""
    nothing = jnp.zeros_like(old[:1])
    first, last = (jnp.concatenate(x) for x in ((old[:1], nothing, old[1:]), (nothing, new[:1], new[1:])))
    weights = jnp.swapaxes(jnp.concatenate([first, last - first]), 0, 1)
    sounds = jnp.swapaxes(jnp.concatenate([heard, heard * fade[None, None]]), 0, 1)
    if sounds.shape[0] == 1:  # all channels hear at once
        return jnp.einsum("eqs,qk->esk", weights, sounds[0], precision="highest")
    return jnp.einsum("eqs,eqk->esk", weights, sounds, precision="highest")


def filtered(sums: Float[Array, "e s k"], config: AudioConfig) -> Float[Array, "e m"]:
    """All of `shapes`, each of its sum, in the frame."""
    size = sums.shape[-1]
    spectra = jnp.asarray(np.fft.rfft(shapes(config.sample_rate).kernel, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    begin = _before(config) + HALF_WIDTH
    return jnp.fft.irfft(whole, size)[:, begin : begin + config.frame]
