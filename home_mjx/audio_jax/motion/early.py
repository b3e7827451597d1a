"""Early sound of one frame, in which every path has its own delay, different in every sample.

Paths are read from the source at times that run on evenly, so pitch is right at every frequency (Doppler), and added up
with weights of their own in a few sums per ear. Only these sums are filtered, see `base/shapes.py`. A still path is one
convolution.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int
from scipy.fft import next_fast_len

from home_mjx.audio_jax.auralization.response import ear_delays, head_angles, octave_spectra, path_weights
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import FIRST, HALF_WIDTH, READ, at_twice_the_rate, read_weights
from home_mjx.audio_jax.base.filters import CAUSAL_SECONDS
from home_mjx.audio_jax.base.shapes import num_taps, shapes
from home_mjx.audio_jax.motion.pairs import Pairs
from home_mjx.core.pytree import Pytree

FASTEST = 10.0  # [m/s], at which paths may grow or shrink; faster ones are faded
SPREAD = 0.002  # [s], by which delays of two ears differ, and change by turns of the head, in one frame
SLOWEST_SOUND = 250.0  # [m/s], of all airs that can be chosen
MARGIN = HALF_WIDTH + READ  # samples that are read beyond a delay


class Delays(Pytree):
    """How much earlier what is heard left its source, at each sample, both ears."""

    whole: Int[Array, "p k"]  # [samples], to the middle of the head
    rest: Float[Array, "p 2 k"]  # [samples], beyond that


def early_frame(source: Float[Array, " n"], past: int, pairs: Pairs, config: AudioConfig) -> Float[Array, "2 m"]:
    """What both ears hear through paths that move during one frame.

    Args:
        source: What leaves the source at 1 m, from `past` samples before the frame on and for as long as is known.
        past: Samples before the frame's first one.
        pairs: Paths at the frame's start and end.
        config: Options.
    """
    angles, distances = _to_ears(pairs, config)
    times = _times(config)
    delays = path_delays(pairs, ear_delays(angles, distances[:, :, None], config), times, config)
    front = _before(config) + MARGIN
    padded = jnp.pad(source, (front, MARGIN))
    start = front + past - _before(config)
    first, last, sample = _direct(padded, start, pairs, delays, config)
    heard = jnp.stack([_read(x, start - sample, delays, slice(0, 1)) for x in (first, last)])
    others = _read(at_twice_the_rate(padded), start, delays, slice(1, None))
    fade = jnp.clip(times, 0.0, 1.0)
    share = jnp.stack([1 - fade, fade])[:, None]  # (ends, 1, k)
    sounds = jnp.concatenate([heard, jnp.broadcast_to(others, (2, *others.shape))], axis=1) * share[:, :, None]
    ends = ((pairs.old, angles[0], distances[0]), (pairs.new, angles[2], distances[2]))
    weights = jnp.stack([path_weights(paths.gain, angle, at, config) for paths, angle, at in ends])
    sums = jnp.einsum("xpes,xpek->esk", weights, sounds, precision="highest")
    return _filtered(sums, config)


def path_delays(pairs: Pairs, ears: Float[Array, "three p 2"], time: Float[Array, " k"], config: AudioConfig) -> Delays:
    """Delays of all paths at both ears, at times in frames.

    A path comes from an image of its source, which moves evenly relative to the head, as source and head do: then its
    length is right at every moment, not only at the frame's ends.

    Args:
        pairs: Paths at the frame's start and end.
        ears: By how much ears hear later than the middle of the head at its start, middle and end [samples]; a
            parabola runs through these.
        time: From 0 to 1, and before and after.
        config: Options.
    """
    old, new, time = pairs.old.distance[:, None], pairs.new.distance[:, None], time[None]
    step = pairs.new.direction * new - pairs.old.direction * old
    bend = jnp.maximum(jnp.sum(step**2, axis=1, keepdims=True) - (new - old) ** 2, 0.0)
    line = old + time * (new - old)  # apart, so that still paths are exact
    curve = time * (1 - time) * bend
    length = line - curve / jnp.maximum(line + jnp.sqrt(jnp.maximum(line**2 - curve, 0.0)), 1e-6)
    samples = length * jnp.float32(config.sample_rate / config.speed_of_sound)
    whole = jnp.floor(samples)
    start, middle, end = (x[..., None] for x in ears)
    time = time[None]
    late = start + time * (end - start) + 4 * time * (1 - time) * (middle - (start + end) / 2)
    return Delays(whole.astype(jnp.int32), (samples - whole)[:, None] + late)


def longest_step(config: AudioConfig) -> float:
    """[m], by which a path may grow or shrink in a frame."""
    return FASTEST * config.frame / config.sample_rate


def _before(config: AudioConfig) -> int:
    """Samples before the frame in which filters that ring on in it have begun."""
    return num_taps(config.sample_rate) + HALF_WIDTH - 1


def _times(config: AudioConfig) -> Float[Array, " k"]:
    """Of samples that are read, in frames."""
    number = np.arange(-_before(config), config.frame + HALF_WIDTH)
    return jnp.asarray(number / config.frame, jnp.float32)


def _to_ears(pairs: Pairs, config: AudioConfig) -> tuple[Float[Array, "three p 2"], Float[Array, "three p"]]:
    """Angles between paths and the axes of both ears, and lengths of paths, at the start, in the middle, at the end."""
    old, new = pairs.old, pairs.new
    mid = (old.direction * old.distance[:, None] + new.direction * new.distance[:, None]) / 2
    between = jnp.linalg.norm(mid, axis=1)
    mid = mid / jnp.maximum(between, 1e-6)[:, None]
    turned = jnp.where(jnp.sum(pairs.old_quat * pairs.new_quat) < 0, -pairs.new_quat, pairs.new_quat)
    quat = pairs.old_quat + turned
    quat = quat / jnp.maximum(jnp.linalg.norm(quat), 1e-6)
    at = [(old.direction, pairs.old_quat), (mid, quat), (new.direction, pairs.new_quat)]
    angles = jnp.stack([head_angles(direction, quat, config) for direction, quat in at])
    return angles, jnp.stack([old.distance, jnp.maximum(between, 1e-2), new.distance])


def _direct(
    padded: Float[Array, " n"], start: int, pairs: Pairs, delays: Delays, config: AudioConfig
) -> tuple[Float[Array, " m"], Float[Array, " m"], Int[Array, ""]]:
    """The source through the filters that the first path has at both ends, at twice its rate, and from which sample on.

    Args:
        padded: The source.
        start: What is read first if there is no delay.
        pairs: Paths.
        delays: Of all of them.
        config: Options.
    """
    taps, count = int(np.ceil(CAUSAL_SECONDS * config.sample_rate)), delays.whole.shape[1]
    slack = int(np.ceil((count / config.frame * longest_step(config) / SLOWEST_SOUND + SPREAD) * config.sample_rate))
    length = count + 2 * slack + 2 * MARGIN
    size = int(next_fast_len(length + taps, real=True) or 0)
    earliest = start - delays.whole[0, -1] - slack - MARGIN
    begin = jnp.clip(earliest, -slack, padded.shape[0])
    window = jax.lax.dynamic_slice_in_dim(jnp.pad(padded, (taps + slack, size)), begin + slack, size)
    gains = jnp.stack([pairs.old.gain[0], pairs.new.gain[0]])
    filters = octave_spectra(gains, size, config)
    both = jnp.fft.irfft(jnp.fft.rfft(window, size)[None] * filters, size)[:, taps : taps + length]
    return at_twice_the_rate(both[0]), at_twice_the_rate(both[1]), begin


def _read(
    double: Float[Array, " n"], start: Int[Array, ""] | int, delays: Delays, paths: slice
) -> Float[Array, "p 2 k"]:
    """A sound at twice its rate as some paths bring it; from its sample `start` on if they had no delays."""
    whole, rest = delays.whole[paths, None], -2 * delays.rest[paths]
    low = jnp.floor(rest)
    number = start + jnp.arange(whole.shape[-1], dtype=jnp.int32)[None, None] - whole
    at = jnp.clip(2 * number + low.astype(jnp.int32), -FIRST, double.shape[0] - READ - FIRST)
    heard = jnp.zeros(rest.shape, jnp.float32)
    for i, weight in enumerate(read_weights(rest - low)):
        heard = heard + weight * double.at[at + (FIRST + i)].get(mode="promise_in_bounds")
    return heard


def _filtered(sums: Float[Array, "2 s k"], config: AudioConfig) -> Float[Array, "2 m"]:
    """All of `shapes`, each of its sum."""
    size = int(next_fast_len(sums.shape[-1], real=True) or 0)
    spectra = jnp.asarray(np.fft.rfft(shapes(config.sample_rate).kernel, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    begin = _before(config) + HALF_WIDTH
    return jnp.fft.irfft(whole, size)[:, begin : begin + config.frame]
