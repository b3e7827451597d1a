"""Early sound of one frame, in which every path has its own delay, different in every sample.

Paths are read from the source, see `reads.py`, and added up with weights of their own in a few sums per channel. Only
these sums are filtered, see `base/shapes.py`. A still path is one convolution.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.response import path_weights
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Head
from home_mjx.audio_jax.kernels.first import slack
from home_mjx.audio_jax.kernels.reads import Reads, Ways, before, margin
from home_mjx.audio_jax.moving_sources.pairs import Pairs
from home_mjx.audio_jax.moving_sources.synthesis import early_frame, filtered_first
from home_mjx.audio_jax.receivers.channels import channel_delays
from home_mjx.audio_jax.receivers.hrtf import to_head


def early_sound(
    sources: Float[Array, "n w"], past: int, pairs: Pairs, config: AudioConfig, head: Head | None = None
) -> Float[Array, "e m"]:
    """What each channel hears of several sources through paths that move.

    Args:
        sources: What leaves each source at 1 m, from `past` samples before the frame on and for as long as is known.
        past: Samples before the frame's first one.
        pairs: Paths at the frame's start and end, with a leading axis of sources.
        config: Options.
        head: Measured; None: a rigid sphere.
    """
    return early_frame(jax.vmap(lambda source, pair: _reads(source, past, pair, config, head))(sources, pairs), config)


def _reads(source: Float[Array, " n"], past: int, pairs: Pairs, config: AudioConfig, head: Head | None) -> Reads:
    toward, distances = _to_head(pairs)
    ways = _ways(pairs, channel_delays(toward, distances, config, head))
    earlier = min(past, config.response_length) + before(config)  # no path is longer than a response
    padded = jnp.pad(source, (before(config), margin(config)))[past + before(config) - earlier :]
    padded, start = jnp.pad(padded, (margin(config), 0)), earlier - before(config) + margin(config)
    first, begin = _filtered(padded, start, pairs, ways, config)
    ends = ((pairs.old, toward[0], distances[0]), (pairs.new, toward[2], distances[2]))
    old, new = (path_weights(paths.gain, way, at, config, head) for paths, way, at in ends)
    rows = jax.tree.map(lambda x: jnp.concatenate([x[:1], x]), ways)  # the first is heard through two filters
    starts = jnp.stack([start - begin, start - begin, jnp.int32(start)])
    parts = np.cumsum([0, first.shape[1], first.shape[1]]).astype(np.int32)
    return Reads(padded, first, 2 * (starts + parts), rows, _shares(old, new))


def _shares(old: Float[Array, "p e s"], new: Float[Array, "p e s"]) -> Float[Array, "q e s two"]:
    """At the frame's start, and what comes until its end; of the first path what each end's filter leaves."""
    nothing = jnp.zeros_like(old[:1])
    first, last = (jnp.concatenate(x) for x in ((old[:1], nothing, old[1:]), (nothing, new[:1], new[1:])))
    return jnp.stack([first, last - first], axis=-1)


def _ways(pairs: Pairs, ears: Float[Array, "three p d"]) -> Ways:
    old, new = pairs.old.distance, pairs.new.distance
    step = pairs.new.direction * new[:, None] - pairs.old.direction * old[:, None]
    bend = jnp.maximum(jnp.sum(step**2, axis=1) - (new - old) ** 2, 0.0)
    return Ways(old, new, bend, jnp.swapaxes(ears, 0, 1))


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


def _filtered(
    padded: Float[Array, " n"], start: int, pairs: Pairs, ways: Ways, config: AudioConfig
) -> tuple[Float[Array, "2 m"], Array]:
    """What the first path's filters make of the source around its delay, and the sample with which it begins.

    Args:
        padded: The source.
        start: Its sample that is heard first where there is no delay.
        pairs: Paths.
        ways: The same, as they run.
        config: Options.
    """
    way = (ways.new[0] * jnp.float32(config.sample_rate / config.speed_of_sound)).astype(jnp.int32)
    begin = jnp.clip(start - way - slack(config) - margin(config), -slack(config), padded.shape[0])
    return filtered_first(padded, begin, jnp.stack([pairs.old.gain[0], pairs.new.gain[0]]), config), begin
