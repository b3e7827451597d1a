"""Ranges of domain randomisation: parameters of the jitted functions."""

import math
from collections.abc import Iterable, Mapping
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.auralization.clips import CLIPS
from home_mjx.audio_jax.contact_sounds.options import STEP_LENGTH_RANGE
from home_mjx.core.checks import check_known, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError

PROBABILITIES = ("lamps", "textures")  # fields that are probabilities, not ranges
# Minimum and maximum of each range.
RANGE_LIMITS = {
    "lamp_gain": (0.0, 100.0),
    "daylight": (0.0, 100.0),
    "sun_azimuth": (-360.0, 360.0),  # [degrees]
    "sun_elevation": (-90.0, 90.0),  # [degrees]
    "exposure": (0.01, 100.0),
    "colors": (0.0, 1.0),
    "camera_height": (-2.0, 2.0),  # [m]
    "camera_pitch": (-90.0, 90.0),  # [degrees]
    "camera_fovy": (-170.0, 170.0),  # [degrees]
    "friction": (0.01, 100.0),
    "mass": (0.01, 100.0),
    "volume": (0.0, 1000.0),
    "move_noise": (0.0, 100.0),
    "depth_noise": (0.0, 100.0),
    "color_noise": (0.0, 100.0),
    "contact_sound_volume": (0.0, 1000.0),
    "footstep_distance": STEP_LENGTH_RANGE,  # [m]
    "equalizer": (-60.0, 60.0),  # [dB]
    "playback_rate": (0.25, 4.0),
    "stereo_noise": (0.0, 100.0),
}


class Variation(Pytree):
    """Domain randomisation: each episode samples its own values uniformly from these ranges, by its key.

    A field of `EnvParams`, so that other ranges need no recompilation. Fields that are None do not vary and cost
    nothing. Make it with `Variation.of`, which validates the numbers. Samples of a field do not depend on the other
    fields.

    Attributes:
        lamps: Probability that the lamps of a room are on.
        lamp_gain: Factor of the light of all lamps.
        daylight: Factor of the light of sun and sky; 0 is night.
        sun_azimuth: Direction to the sun from +x towards +y [degrees], instead of that of `LitShader`.
        sun_elevation: Elevation of the sun above the horizon [degrees], instead of that of `LitShader`.
        exposure: Exposure factor of the cameras; of these fields the only one with an effect on the shader "fast".
        colors: Maximum relative change of colour: red, green and blue of each material are multiplied by 1 ± this.
        textures: Probability that a textured material has another texture of the bank.
        camera_height: Offset of the height of all cameras [m].
        camera_pitch: Offset of the pitch of all cameras, up [degrees].
        camera_fovy: Offset of the vertical field of view of pinhole cameras [degrees].
        friction: Factor of the friction of movable bodies.
        mass: Factor of the mass of movable bodies.
        volume: Factor of the pressure of all clips and words.
        clips: Weight of each of `CLIPS` as the sound of the house's own source; tasks with sounds keep theirs.
        move_noise: Level of actuation noise of discrete actions, Habitat's `noise_multiplier`; 1: a LoCoBot.
        depth_noise: Level of noise in depth images of pinhole cameras; 1: a Kinect.
        color_noise: Level of noise in colour images of pinhole cameras, as a factor of variances; 1: a common image
            sensor.
        contact_sound_volume: Factor of the pressure of all contact sounds, see `ContactSoundConfig`.
        footstep_distance: Distance between footsteps [m], instead of that of `ContactSoundConfig`: another cadence of
            walking.
        equalizer: Gain of each octave of the clips' pressure [dB], sampled for every octave on its own.
        playback_rate: Factor of pitch and tempo of all clips.
        stereo_noise: Level of noise of a stereo camera in depth images of pinhole cameras; 1: a RealSense D435. With
            `depth_noise`, both are added.

    Example:
        >>> ranges = Variation.of(lamps=0.5, daylight=(0, 1.5), camera_height=(-0.2, 0.2))
        >>> ranges.daylight.tolist()
        [0.0, 1.5]
    """

    lamps: Float[Array, ""] | None = None
    lamp_gain: Float[Array, "2"] | None = None
    daylight: Float[Array, "2"] | None = None
    sun_azimuth: Float[Array, "2"] | None = None
    sun_elevation: Float[Array, "2"] | None = None
    exposure: Float[Array, "2"] | None = None
    colors: Float[Array, "2"] | None = None
    textures: Float[Array, ""] | None = None
    camera_height: Float[Array, "2"] | None = None
    camera_pitch: Float[Array, "2"] | None = None
    camera_fovy: Float[Array, "2"] | None = None
    friction: Float[Array, "2"] | None = None
    mass: Float[Array, "2"] | None = None
    volume: Float[Array, "2"] | None = None
    clips: Float[Array, " clips"] | None = None
    move_noise: Float[Array, "2"] | None = None
    depth_noise: Float[Array, "2"] | None = None
    color_noise: Float[Array, "2"] | None = None
    contact_sound_volume: Float[Array, "2"] | None = None
    footstep_distance: Float[Array, "2"] | None = None
    equalizer: Float[Array, "2"] | None = None
    playback_rate: Float[Array, "2"] | None = None
    stereo_noise: Float[Array, "2"] | None = None

    @classmethod
    def of(cls, **ranges: Any) -> "Variation":
        """Return validated ranges by name.

        Args:
            **ranges: A probability for `lamps` and `textures`. Names of sounds, or their weights by name, for `clips`.
                For all others (minimum, maximum), or one number that is the same in all episodes. None: not varied.

        Raises:
            ConfigError: A name is unknown, with the closest known one, or a range is empty or out of limits.

        Example:
            >>> Variation.of(colors=(0.0, 0.3), clips=("radio", "bell")).clips.sum().item()
            2.0
        """
        check_known("variation", ranges, RANGE_NAMES)
        return cls(**{name: _to_array(name, value) for name, value in ranges.items() if value is not None})

    def to_dict(self) -> dict[str, Any]:
        """Return arguments of `of` for the same ranges as plain numbers, such as for JSON; on the host.

        Numbers are rounded to 6 decimals. Ranges are [minimum, maximum]; `clips` has the positive weights by name.

        Example:
            >>> Variation.of(lamps=0.5, friction=(1, 2)).to_dict()
            {'lamps': 0.5, 'friction': [1.0, 2.0]}
        """
        given = {name: np.asarray(getattr(self, name)) for name in RANGE_NAMES if getattr(self, name) is not None}
        plain = {name: np.round(array.astype(float), 6).tolist() for name, array in given.items()}
        if "clips" in plain:
            plain["clips"] = {name: weight for name, weight in zip(CLIPS, plain["clips"], strict=True) if weight}
        return plain


RANGE_NAMES = tuple(Variation.__dataclass_fields__)


def normalize_ranges(given: Any) -> dict[str, Any]:
    """Return ranges in any form that `to_variation` takes, validated, in the form of `to_dict`; {} for None.

    They are plain numbers by name, rounded to 6 decimals; `clips` are positive weights by name. Fields that do not vary
    are left out. Raises as `to_variation`.

    Example:
        >>> normalize_ranges({"lamps": 0.5, "volume": 2})
        {'lamps': 0.5, 'volume': [2.0, 2.0]}
    """
    variation = to_variation(given)
    return {} if variation is None else variation.to_dict()


def to_variation(given: Any) -> Variation | None:
    """Convert a form that `make` accepts: None (returned as is), a `Variation`, or its ranges by name.

    A `Variation` is copied by `to_dict`, which rounds its numbers.

    Raises:
        ConfigError: Another type, or a range is invalid.
    """
    if given is None:
        return None
    if isinstance(given, Variation):
        return Variation.of(**given.to_dict())
    if not hasattr(given, "keys"):
        raise ConfigError(f"`variation` must be ranges by name, got {given!r}", hint="Write variation={'lamps': 0.5}.")
    return Variation.of(**given)


def _to_array(name: str, value: Any) -> Array:
    """Return a range, a probability or weights of clips, validated, as a float32 array."""
    if name == "clips":
        return jnp.asarray(_clip_weights(value), jnp.float32)
    if name in PROBABILITIES:
        check_number(name, value, 0, 1)
        return jnp.asarray(value, jnp.float32)
    return jnp.asarray(_check_range(name, value), jnp.float32)


def _check_range(name: str, value: Any) -> tuple[float, float]:
    """Return (minimum, maximum) of a range; one number is both. `ConfigError` if empty or beyond `RANGE_LIMITS`."""
    least, most = RANGE_LIMITS[name]
    ends = np.asarray(value).tolist() if isinstance(value, np.ndarray | Array) else value
    pair = (ends, ends) if not isinstance(ends, tuple | list) else ends
    if len(pair) != 2:
        raise ConfigError(f"`{name}` must be (minimum, maximum), got {value!r}", element=f"Variation.{name}")
    for end in pair:
        check_number(name, end, least, most)
    if pair[0] > pair[1]:
        hint = f"Write {name}=({pair[1]}, {pair[0]})."
        raise ConfigError(f"`{name}` is empty: from {pair[0]} to {pair[1]}", element=f"Variation.{name}", hint=hint)
    return float(pair[0]), float(pair[1])


def _clip_weights(value: Any) -> list[float]:
    """Return a weight for each of `CLIPS`, from names (1 each) or weights by name; 0 for others.

    Raises `ConfigError` for other types, unknown names, negative weights, or if no weight is positive.
    """
    names = [value] if isinstance(value, str) else value
    if not isinstance(names, Iterable) or not all(isinstance(name, str) for name in names):
        hint = 'Write clips=("radio", "bell"), or {"radio": 1, "bell": 3}.'
        raise ConfigError(f"`clips` must be names of sounds, got {value!r}", element="Variation.clips", hint=hint)
    weights = dict(value) if isinstance(value, Mapping) else dict.fromkeys(names, 1)
    check_known("clip", weights, CLIPS)
    for name, weight in weights.items():
        check_number(f"clips.{name}", weight, 0)
    if not math.fsum(weights.values()) > 0:
        hint = 'Name at least one: clips=("radio", "bell").'
        raise ConfigError("`clips` has no sound to draw", element="Variation.clips", hint=hint)
    return [float(weights.get(name, 0)) for name in CLIPS]
