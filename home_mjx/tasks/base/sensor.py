"""The seam of sensors: what agents observe."""

from typing import Any

from jaxtyping import Array, Int

from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake
from home_mjx.tasks.base.config import VIEW_KINDS, EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs


class Sensor:
    """Base of sensors: a name, what it promises, and how it observes.

    All methods are for one environment with A agents and run inside `jit`. These are the agents that act, see
    `Task.num_acting`: `config` and `snapshot` are of no others.

    Attributes:
        name: As given in `sensors=`.
        costly: It casts rays. `AutoReset` then computes it for final observations only if asked to.
        keeper: The sensor whose memory it reads instead of its own, such as the sound of which it gives a spectrum.
            That is kept up to date once for all that read it, and observed only if it is asked for as well.

    Example:
        >>> class Compass(Sensor):
        ...     name = "compass"
        ...
        ...     def spec(self, config):
        ...         return {"compass": ArraySpec((), "float32", -np.pi, np.pi, "yaw [rad]")}
        ...
        ...     def observe(self, config, snapshot, state):
        ...         return {"compass": snapshot.pose.yaw}
        >>> register_sensor(Compass())  # doctest: +SKIP
        >>> env = home_mjx.make("PointNav-v0", sensors=("rgb", "compass"))  # doctest: +SKIP
    """

    name: str = ""
    costly: bool = False
    keeper: "Sensor | None" = None

    def spec(self, config: EnvConfig) -> Specs:
        """Observations by name, each as one agent has it."""
        raise NotImplementedError

    def bakes(self, config: EnvConfig) -> tuple[Bake, ...]:
        """Return the bakes of houses that the sensor reads; `make` computes those that are missing."""
        return ()

    def init(self, config: EnvConfig) -> Any:
        """What the sensor remembers, before the first `update`; the same structure as `update` returns."""
        return ()

    def update(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> Any:
        """What the sensor remembers after a reset (`snapshot.step` is 0) or a step. Called once for each."""
        return state

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> dict[str, Array]:
        """What `spec` promises, with a leading agent axis. Called any number of times; changes nothing."""
        raise NotImplementedError

    def status(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> Int[Array, ""] | int:
        """Flags of `Status`: what the sensor has lost."""
        return 0


_REGISTRY: dict[str, Sensor] = {}


def register_sensor(sensor: Sensor) -> None:
    """Makes a sensor known by its name, for `sensors=` of every environment made from now on.

    Raises:
        ConfigError: It is no `Sensor`, has no name, or the name is taken.
    """
    if not isinstance(sensor, Sensor):
        raise ConfigError(f"expected a sensor, got {sensor!r}", hint="Write register_sensor(MySensor()), an instance.")
    if sensor.name in VIEW_KINDS:
        raise ConfigError(f"the name `{sensor.name}` of a sensor is taken by a kind of image")
    if not sensor.name:
        raise ConfigError(f"sensor {type(sensor).__name__} has no name", hint="Set the attribute `name`.")
    if sensor.name in _REGISTRY and type(_REGISTRY[sensor.name]) is not type(sensor):
        raise ConfigError(f"the name `{sensor.name}` of a sensor is taken")
    _REGISTRY[sensor.name] = sensor


def registered_sensors() -> dict[str, Sensor]:
    """Sensors by name, those of images apart: cameras make these."""
    return dict(_REGISTRY)
