"""Base class and registry of sensors."""

from typing import Any

from jaxtyping import Array, Int

from home_mjx.errors import ConfigError
from home_mjx.houses.bakes import Bake
from home_mjx.tasks.base.config import VIEW_KINDS, EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.specs import Specs


class Sensor:
    """Base class of sensors: a name, an observation spec, and the functions that compute observations.

    All methods are for one environment with A agents and run inside `jit`. These are the acting agents, see
    `Task.num_acting`: `config` and `snapshot` are restricted to them.

    Attributes:
        name: Name in `sensors=`.
        casts_rays: True if the sensor casts rays. `AutoReset` then computes it for final observations only on request.
        state_owner: Sensor whose state it reads instead of its own, such as `audio` for spectra. That state is
            updated once for all its readers. The owner's observation is computed only if it is in `sensors=` as well.

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
    casts_rays: bool = False
    state_owner: "Sensor | None" = None

    def spec(self, config: EnvConfig) -> Specs:
        """Return the specs of the observations by name, for one agent; a subclass must implement it."""
        raise NotImplementedError

    def bakes(self, config: EnvConfig) -> tuple[Bake, ...]:
        """Return the bakes (precomputed house data) that the sensor reads, by default none; `make` adds them."""
        return ()

    def init(self, config: EnvConfig) -> Any:
        """Return the sensor state before the first `update`, by default (); `update` must return the same structure."""
        return ()

    def update(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> Any:
        """Return the sensor state after a reset (`snapshot.step` is 0) or step, once for each; by default unchanged."""
        return state

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> dict[str, Array]:
        """Return the observations of `spec` with a leading agent axis; required. Pure; called any number of times."""
        raise NotImplementedError

    def status(self, config: EnvConfig, snapshot: Snapshot, state: Any) -> Int[Array, ""] | int:
        """Return the flags of `Status` for data that the sensor lost in the last update; 0: none."""
        return 0


_REGISTRY: dict[str, Sensor] = {}


def register_sensor(sensor: Sensor) -> None:
    """Register a sensor by its name for `sensors=` of new environments; one of the same class and name is replaced.

    Raises:
        ConfigError: Not a `Sensor`, no name, or the name is taken by an image or a sensor of another class.
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
    """Return registered sensors by name, without images: those are made by the cameras."""
    return dict(_REGISTRY)
