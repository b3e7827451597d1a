"""Early sound of one frame, with a time-varying delay per path.

Paths are read from the source through delay lines (`delay_reads.py`) and mixed into a few buses per channel. Only these
buses are filtered, see `base/filter_basis.py`. The result for a static path is an exact convolution.
"""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.response import path_basis_weights
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.kernels.delay_reads import DelayReads, PathDelays, filter_history, read_margin
from home_mjx.audio_jax.kernels.direct_filter import delay_margin
from home_mjx.audio_jax.moving_sources.dispatch import filter_direct, render_early_frame
from home_mjx.audio_jax.moving_sources.path_matching import PathPairs
from home_mjx.audio_jax.receivers.channels import channel_delays
from home_mjx.audio_jax.receivers.spherical_head import world_to_head


def render_early_paths(
    sources: Float[Array, "n w"], past: int, pairs: PathPairs, config: AudioConfig, head: MeasuredHead | None = None
) -> Float[Array, "e m"]:
    """Render the summed early sound of several sources through moving paths.

    Args:
        sources: Signal of each source at 1 m, from `past` samples before the frame on.
        past: Number of samples before the frame's first one.
        pairs: Paths at the frame's start and end, with a leading axis of sources.
        config: Options.
        head: Measured HRTFs; None: a rigid sphere.

    Returns:
        Pressure per channel, `config.frame` samples.
    """
    return render_early_frame(
        jax.vmap(lambda source, pair: _source_reads(source, past, pair, config, head))(sources, pairs), config
    )


def _source_reads(
    source: Float[Array, " n"], past: int, pairs: PathPairs, config: AudioConfig, head: MeasuredHead | None
) -> DelayReads:
    """Return a source's reads: two rows of the direct path, filtered for each frame end, then the other paths.

    `past`: number of samples of `source` before the frame.
    """
    toward, distances = _to_head(pairs)
    ways = _path_delays(pairs, channel_delays(toward, distances, config, head))
    # Delays beyond the response length are not read.
    earlier = min(past, config.response_length) + filter_history(config)
    padded = jnp.pad(source, (filter_history(config), read_margin(config)))[past + filter_history(config) - earlier :]
    padded, start = jnp.pad(padded, (read_margin(config), 0)), earlier - filter_history(config) + read_margin(config)
    first, begin = _filter_direct(padded, start, pairs, ways, config)
    ends = ((pairs.old, toward[0], distances[0]), (pairs.new, toward[2], distances[2]))
    old, new = (path_basis_weights(paths.gain, way, at, config, head) for paths, way, at in ends)
    rows = jax.tree.map(lambda x: jnp.concatenate([x[:1], x]), ways)  # the first path is read from two filter outputs
    starts = jnp.stack([start - begin, start - begin, jnp.int32(start)])
    parts = np.cumsum([0, first.shape[1], first.shape[1]]).astype(np.int32)
    return DelayReads(padded, first, 2 * (starts + parts), rows, _bus_gains(old, new))


def _bus_gains(old: Float[Array, "p e s"], new: Float[Array, "p e s"]) -> Float[Array, "q e s two"]:
    """Return bus gains at the frame's start and their change in it, of q = p + 1 rows.

    The first path has two rows: one fades out from `old` to 0, one in from 0 to `new`. The others change continuously.
    """
    nothing = jnp.zeros_like(old[:1])
    first, last = (jnp.concatenate(x) for x in ((old[:1], nothing, old[1:]), (nothing, new[:1], new[1:])))
    return jnp.stack([first, last - first], axis=-1)


def _path_delays(pairs: PathPairs, delays: Float[Array, "three p d"]) -> PathDelays:
    """Return path lengths [m] at both ends and curvature, with `delays`: delays at start, middle and end [samples].

    Curvature is the squared motion of the image source across the line of sight [m²], at least 0.
    """
    old, new = pairs.old.distance, pairs.new.distance
    step = pairs.new.direction * new[:, None] - pairs.old.direction * old[:, None]
    bend = jnp.maximum(jnp.sum(step**2, axis=1) - (new - old) ** 2, 0.0)
    return PathDelays(old, new, bend, jnp.swapaxes(delays, 0, 1))


def _to_head(pairs: PathPairs) -> tuple[Float[Array, "three p 3"], Float[Array, "three p"]]:
    """Return directions of incidence in the head frame and path lengths [m] at the frame's start, middle and end.

    In the middle, positions of image sources and orientations (normalised quaternions) are means of both ends. The
    length in the middle is at least 1 cm.
    """
    old, new = pairs.old, pairs.new
    mid = (old.direction * old.distance[:, None] + new.direction * new.distance[:, None]) / 2
    between = jnp.linalg.norm(mid, axis=1)
    mid = mid / jnp.maximum(between, 1e-6)[:, None]
    turned = jnp.where(jnp.sum(pairs.old_quat * pairs.new_quat) < 0, -pairs.new_quat, pairs.new_quat)
    quat = pairs.old_quat + turned
    quat = quat / jnp.maximum(jnp.linalg.norm(quat), 1e-6)
    at = [(old.direction, pairs.old_quat), (mid, quat), (new.direction, pairs.new_quat)]
    toward = jnp.stack([world_to_head(direction, quat) for direction, quat in at])
    return toward, jnp.stack([old.distance, jnp.maximum(between, 1e-2), new.distance])


def _filter_direct(
    padded: Float[Array, " n"], start: int, pairs: PathPairs, ways: PathDelays, config: AudioConfig
) -> tuple[Float[Array, "2 m"], Array]:
    """Filter the source with the first path's octave filters of both frame ends, around that path's delay.

    Args:
        padded: The source signal with padding.
        start: Index of its sample at the frame's first sample for a delay of 0.
        pairs: Paths at both ends of the frame.
        ways: Their delays within the frame.
        config: Options.

    Returns:
        The two filtered signals, and the index of the source sample at which they begin.
    """
    way = (ways.end_length[0] * jnp.float32(config.sample_rate / config.speed_of_sound)).astype(jnp.int32)
    begin = jnp.clip(start - way - delay_margin(config) - read_margin(config), -delay_margin(config), padded.shape[0])
    return filter_direct(padded, begin, jnp.stack([pairs.old.gain[0], pairs.new.gain[0]]), config), begin
