"""What can be chosen about an environment; everything here is fixed when its step is compiled."""

import dataclasses
from dataclasses import dataclass, field
from typing import Any

from home_mjx.audio_jax import CLIPS, AudioConfig
from home_mjx.errors import ConfigError, check_known
from home_mjx.physics import PhysicsConfig

PIXEL_KINDS = ("rgb", "depth", "normal")
ID_KINDS = ("instance", "fine", "coarse", "nyu40", "room", "level", "material")
VECTOR_SENSORS = ("audio", "state", "goal")
SENSORS = PIXEL_KINDS + ID_KINDS + VECTOR_SENSORS
DEFAULT_SENSORS = ("rgb", "depth", "instance", "fine", "audio", "state", "goal")


@dataclass(frozen=True)
class EnvConfig:
    """Options of an environment.

    Attributes:
        sensors: What is observed, from `SENSORS`; nothing else is computed.
        width: Image width [px].
        height: Image height [px].
        fovy: Vertical field of view [degrees].
        eye_height: Camera and ears above the floor [m].
        depth_max: Observed depth is clipped here [m].
        look_rate: Fastest change of pitch [rad/s].
        pitch_max: Largest look up or down [rad].
        episode_length: Steps until truncation.
        source_height: Sound source above the floor [m].
        clip: Name of the sound that the source plays, see `home_mjx.audio_jax.clip`.
        executor: Ray executor, None for the platform's best.
        physics: Agents, bodies and solver.
        audio: Sound.
    """

    sensors: tuple[str, ...] = DEFAULT_SENSORS
    width: int = 64
    height: int = 64
    fovy: float = 90.0
    eye_height: float = 1.5
    depth_max: float = 10.0
    look_rate: float = 1.5
    pitch_max: float = 1.0
    episode_length: int = 500
    source_height: float = 1.0
    clip: str = "radio"
    executor: str | None = None
    physics: PhysicsConfig = field(default_factory=PhysicsConfig)
    audio: AudioConfig = field(default_factory=AudioConfig)

    def __post_init__(self) -> None:
        check_known("sensor", self.sensors, SENSORS)
        check_known("clip", [self.clip], CLIPS)
        for name in ("width", "height", "episode_length"):
            if getattr(self, name) < 1:
                raise ConfigError(f"`{name}` must be at least 1, got {getattr(self, name)}")
        if not 1 <= self.fovy < 180:
            raise ConfigError(f"`fovy` must be in [1, 180) degrees, got {self.fovy}")

    @property
    def image_kinds(self) -> tuple[str, ...]:
        """The sensors that need camera rays."""
        return tuple(s for s in self.sensors if s in PIXEL_KINDS + ID_KINDS)


def make_config(**options: Any) -> EnvConfig:
    """An `EnvConfig` from keyword options; those of `physics` and `audio` may be given flat.

    Raises:
        ConfigError: For an unknown option, with the closest known one.

    Example:
        >>> make_config(width=32, num_agents=2).physics.num_agents
        2
    """
    parts = {"physics": PhysicsConfig, "audio": AudioConfig}
    nested = {part: _names(cls) for part, cls in parts.items()}
    check_known("option", options, [*_names(EnvConfig), *nested["physics"], *nested["audio"]])
    top = {name: value for name, value in options.items() if name in _names(EnvConfig)}
    for part, cls in parts.items():
        flat = {name: value for name, value in options.items() if name in nested[part] and name not in top}
        top[part] = dataclasses.replace(top.get(part, cls()), **flat)
    if "sensors" in top:
        top["sensors"] = tuple(top["sensors"])
    return EnvConfig(**top)


def _names(cls: type) -> list[str]:
    return [f.name for f in dataclasses.fields(cls)]
