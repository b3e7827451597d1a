"""One frame of sound while sources and heads move."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.motion.early import early_frame, longest_step
from home_mjx.audio_jax.motion.pairs import paired
from home_mjx.audio_jax.motion.reception import Reception, late_part
from home_mjx.audio_jax.motion.tail import late_frame, tail_levels


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
    pairs = paired(old.paths, new.paths, old.quat, new.quat, longest_step(config))
    late = jnp.stack([late_part(heard, config) for heard in (old, new)])
    tail = jnp.stack([tail_levels(heard.energy, config) for heard in (old, new)])
    return early_frame(source, config.memory_length - 1, pairs, config) + late_frame(source, late, tail, config)
