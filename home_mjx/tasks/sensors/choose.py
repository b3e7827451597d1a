"""From the names in `sensors=` to sensors."""

from home_mjx.core.checks import check_known
from home_mjx.tasks.base.config import DEFAULT_SENSORS, VIEW_KINDS, EnvConfig
from home_mjx.tasks.base.sensor import Sensor, register_sensor, registered_sensors
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.sensors.cameras import Cameras
from home_mjx.tasks.sensors.hearing import Hearing
from home_mjx.tasks.sensors.own_state import OwnState

register_sensor(Hearing())
register_sensor(OwnState())


def sensor_names(config: EnvConfig, task: Task) -> tuple[str, ...]:
    """What is observed.

    Raises:
        ConfigError: A sensor is unknown, with the closest known one.
    """
    names = config.sensors if config.sensors is not None else (*DEFAULT_SENSORS, *task.observation_spec)
    check_known("sensor", names, [*VIEW_KINDS, *registered_sensors(), *task.observation_spec])
    return names


def choose_sensors(config: EnvConfig) -> tuple[Sensor, ...]:
    """Sensors of an environment whose `config.sensors` are named; those of its task apart."""
    known = registered_sensors()
    named = tuple(known[name] for name in config.sensors or () if name in known)
    return (*((Cameras(),) if config.views else ()), *named)
