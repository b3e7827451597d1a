"""Sounds of a row: user-facing dataclass, and packed form as arrays."""

import math
from dataclasses import dataclass
from typing import ClassVar

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.core.checks import check_known, check_number
from home_mjx.core.pytree import Pytree, array
from home_mjx.errors import ConfigError

NUM_SOUNDS = 4  # maximum number of sounds of a row
NO_DESCRIPTOR = -1
SOUND_PREFIX = "sound_"  # of the keys of columns
VOICE_CLIP = "voice"  # clip name of the words that an agent says
VOICE_CLIP_NUMBER = -2  # number of that clip; see `word_sounds`


@dataclass(frozen=True)
class SoundEvent:
    """Sound that a descriptor's target emits, with its schedule.

    Attributes:
        emitter: Index of the descriptor: an object, which emits from its middle, a place or an agent.
        clip: Name of a clip of `home_mjx.audio_jax.CLIPS`; or "voice" for the words of an agent.
        period: Repetition period [s]; inf: played once.
        duration: Duration of each repetition [s]; inf: unlimited.
        gain: Factor on the sound pressure.
        destination: Index of the descriptor that a place moves to along the shortest path; -1: it does not move.
        speed: Speed of that motion [m/s].

    Raises:
        ConfigError: A value is invalid.

    Example:
        >>> SoundEvent(0, "bell", period=3.0, duration=1.0).gain
        1.0
    """

    PREFIX: ClassVar[str] = SOUND_PREFIX
    emitter: int
    clip: str
    period: float = math.inf
    duration: float = math.inf
    gain: float = 1.0
    destination: int = NO_DESCRIPTOR
    speed: float = 0.0

    def __post_init__(self) -> None:
        check_known("clip", [self.clip], (*CLIPS, VOICE_CLIP))
        check_number("emitter", self.emitter, 0, integer=True)
        check_number("destination", self.destination, NO_DESCRIPTOR, integer=True)
        for name in ("period", "duration"):
            if not getattr(self, name) > 0:
                raise ConfigError(f"`{name}` must be positive, got {getattr(self, name)}")
        for name in ("gain", "speed"):
            check_number(name, getattr(self, name), 0)
        if self.clip == VOICE_CLIP and (
            math.isfinite(min(self.period, self.duration)) or self.destination != NO_DESCRIPTOR
        ):
            raise ConfigError(
                "a voice sounds when and where its agent speaks",
                hint="Leave out `period`, `duration` and `destination`.",
            )


class SoundEvents(Pytree):
    """Sounds of one episode: e entries, see `SoundEvent`."""

    PREFIX = SOUND_PREFIX
    emitter: Int[Array, "*t e"] = array(
        "descriptor; -1 if none", dtype=np.int8, values="descriptor", fill=NO_DESCRIPTOR
    )
    clip: Int[Array, "*t e"] = array(
        "index into CLIPS; `VOICE_CLIP_NUMBER`: words of the agent", dtype=np.int16, values="clip", fill=0
    )
    period: Float[Array, "*t e"] = array("repetition period [s]", dtype=np.float32, values="seconds", fill=math.inf)
    duration: Float[Array, "*t e"] = array("duration [s]", dtype=np.float32, values="seconds", fill=math.inf)
    gain: Float[Array, "*t e"] = array("factor on the sound pressure", dtype=np.float32, values="gain", fill=0.0)
    destination: Int[Array, "*t e"] = array(
        "descriptor; -1 if it does not move", dtype=np.int8, values="descriptor", fill=NO_DESCRIPTOR
    )
    speed: Float[Array, "*t e"] = array("speed of motion [m/s]", dtype=np.float32, values="speed", fill=0.0)


def clip_name(number: int) -> str:
    """Return the name of a clip by its number in `SoundEvents`: an index into CLIPS, or `VOICE_CLIP_NUMBER`.

    The number must be one of these: -1, silence, has no name, but raises no error.

    Example:
        >>> clip_name(0), clip_name(VOICE_CLIP_NUMBER)
        ('radio', 'voice')
    """
    return VOICE_CLIP if number == VOICE_CLIP_NUMBER else CLIPS[number]


def has_voices(emission: SoundEvents) -> Bool[Array, "*t"]:
    """Return whether a row's sounds include words of an agent; then they are audible only, in no other observation."""
    return jnp.any((emission.clip == VOICE_CLIP_NUMBER) & (emission.emitter >= 0), axis=-1)
