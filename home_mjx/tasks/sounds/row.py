"""Sounds of a row: user-facing dataclass, and packed form as arrays."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.sources import CLIPS
from home_mjx.core.checks import check_known, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

NUM_SOUNDS = 4  # maximum number of sounds of a row
NO_DESCRIPTOR = -1
SOUND_COLUMN = "sound_{}"
VOICE_CLIP = "voice"  # clip name of the words that an agent says
VOICE_CLIP_NUMBER = -2  # number of that clip; see `voice`


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
        >>> Sound(0, "bell", period=3.0, duration=1.0).gain
        1.0
    """

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
    """Sounds of one episode: s entries, see `SoundEvent`."""

    emitter: Int[Array, "*t s"]  # descriptor; -1 if none
    clip: Int[Array, "*t s"]  # index into CLIPS; VOICED: words of the agent
    period: Float[Array, "*t s"]  # [s]
    duration: Float[Array, "*t s"]  # [s]
    gain: Float[Array, "*t s"]
    destination: Int[Array, "*t s"]  # descriptor; -1 if it does not move
    speed: Float[Array, "*t s"]  # [m/s]


def pack_sounds(sounds: Sequence[SoundEvent], num_descriptors: int) -> dict[str, np.ndarray]:
    """Pack sounds into the columns of an `SoundEvents`.

    Raises:
        ConfigError: There are more than `NUM_SOUNDS`, or one refers to a missing descriptor.

    Example:
        >>> written_sounds([Sound(0, "bell")], 1)["sound_emitter"].tolist()
        [0, -1, -1, -1]
    """
    if len(sounds) > NUM_SOUNDS:
        raise ConfigError(f"a task has at most {NUM_SOUNDS} sounds, got {len(sounds)}")
    for number in (number for sound in sounds for number in (sound.emitter, sound.destination)):
        if number >= num_descriptors:
            raise ConfigError(f"a sound refers to descriptor {number}, but the task has {num_descriptors}")
    rows = [(s.emitter, _clip_number(s.clip), s.period, s.duration, s.gain, s.destination, s.speed) for s in sounds]
    rows += [(NO_DESCRIPTOR, 0, math.inf, math.inf, 0.0, NO_DESCRIPTOR, 0.0)] * (NUM_SOUNDS - len(sounds))
    kinds = {"emitter": np.int8, "clip": np.int16, "destination": np.int8}
    names = SoundEvents.__dataclass_fields__
    return {
        SOUND_COLUMN.format(name): np.array(values, kinds.get(name, np.float32))
        for name, values in zip(names, zip(*rows, strict=True), strict=True)
    }


def extract_sounds(columns: Mapping[str, Array]) -> SoundEvents:
    """Extract the sounds from the columns of one or many rows."""
    return SoundEvents(**{name: columns[SOUND_COLUMN.format(name)] for name in SoundEvents.__dataclass_fields__})


def unpack_sounds(columns: Mapping[str, np.ndarray]) -> list[SoundEvent]:
    """Unpack the sounds of a row; the inverse of `pack_sounds`."""
    values = {
        name: np.asarray(columns[SOUND_COLUMN.format(name)]).tolist() for name in SoundEvents.__dataclass_fields__
    }
    values["clip"] = [clip_name(number) for number in values["clip"]]
    rows = [dict(zip(values, row, strict=True)) for row in zip(*values.values(), strict=True)]
    return [SoundEvent(**row) for row in rows if row["emitter"] != NO_DESCRIPTOR]


def clip_name(number: int) -> str:
    """Return the name of the clip with this number in an `SoundEvents`.

    Example:
        >>> clip_name(0), clip_name(VOICED)
        ('radio', 'voice')
    """
    return VOICE_CLIP if number == VOICE_CLIP_NUMBER else CLIPS[number]


def _clip_number(clip: str) -> int:
    return VOICE_CLIP_NUMBER if clip == VOICE_CLIP else CLIPS.index(clip)


def has_voices(emission: SoundEvents) -> Bool[Array, "*t"]:
    """Return whether the words of any agent are sounds; then no other observation has them."""
    return jnp.any((emission.clip == VOICE_CLIP_NUMBER) & (emission.emitter >= 0), axis=-1)
