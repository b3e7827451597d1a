"""One frame of sound while sources and heads move."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.stream import faded_frame
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.motion.early import early_frame, longest_step
from home_mjx.audio_jax.motion.pairs import paired
from home_mjx.audio_jax.motion.reception import Reception
from home_mjx.audio_jax.motion.tail import tail_frame


def moving_frame(
    source: Float[Array, " w"], old: Reception, new: Reception, config: AudioConfig
) -> Float[Array, "2 m"]:
    """What both ears hear in one frame of a source that moves relative to them.

    Early paths keep their pitch: each sample has its own delay. The late part, whose phase says nothing, fades from the
    old response to the new one, and so does its tail.

    Args:
        source: What leaves the source at 1 m, see `given_off`: `config.memory_length` - 1 samples from before the
            frame, the frame, and `config.ahead` samples after it.
        old: At the frame's start.
        new: At its end, which is the next frame's `old`.
        config: Options.
    """
    past, length, frame = config.memory_length - 1, config.response_length, config.frame
    pairs = paired(old.paths, new.paths, old.quat, new.quat, longest_step(config))
    heard = source[past - (length - 1) : past + frame]
    sound = early_frame(source, past, pairs, config) + faded_frame(heard, old.late, new.late, config)
    if config.num_tail == 0:
        return sound
    before, after = (tail_frame(source, past, r.tail, r.quat, r.signs, config) for r in (old, new))
    fade = jnp.arange(1, frame + 1, dtype=jnp.float32)[None] / frame
    return sound + before + fade * (after - before)
