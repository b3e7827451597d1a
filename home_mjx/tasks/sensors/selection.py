"""Sensors from their names in `sensors=`."""

from collections.abc import Iterator

from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError, UnknownNameError
from home_mjx.tasks.base.config import DEFAULT_SENSORS, VIEW_KINDS, EnvConfig
from home_mjx.tasks.base.sensor import Sensor, register_sensor, registered_sensors
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.sensors.cameras import Cameras
from home_mjx.tasks.sensors.ear_levels import EarLevels
from home_mjx.tasks.sensors.hearing import Hearing, LogMel, Stft
from home_mjx.tasks.sensors.interaural_cues import Interaural, SourceTarget
from home_mjx.tasks.sensors.localization import GpsCompass, Lidar, LocalMap
from home_mjx.tasks.sensors.proprioception import HeldObject, OwnState, PrevAction, PrevReward
from home_mjx.tasks.switches.states import NearbySwitches

register_sensor(Hearing())
register_sensor(OwnState())
register_sensor(GpsCompass())
register_sensor(Lidar())
register_sensor(LocalMap())
register_sensor(Stft())
register_sensor(LogMel())
register_sensor(HeldObject())
register_sensor(PrevAction())
register_sensor(PrevReward())
register_sensor(EarLevels())
register_sensor(Interaural())
register_sensor(SourceTarget())
register_sensor(NearbySwitches())


# Sensor names of other simulators and their counterparts here.
FOREIGN_SENSOR_HINTS = {
    "gps": "`gps_compass`",
    "compass": "`gps_compass`",
    "pointgoal": "`goal`",
    "pointgoal_with_gps_compass": "`goal`, which follows the agent as that does",
    "objectgoal": "`goal_words`",
    "semantic": "`instance`, or `fine`, `coarse` or `nyu40` for categories",
    "segmentation": "`instance`, or `fine`, `coarse` or `nyu40` for categories",
    "spectrogram": "`log_mel` or `stft`",
    "audiogoal": "`audio`",
}
HEARING_SENSORS = ("audio", "stft", "log_mel", "ear_levels", "interaural")
NAME_ROLE, OBSERVATION_ROLE = "the name", "an observation"


def resolve_sensor_names(config: EnvConfig, task: Task) -> tuple[str, ...]:
    """Return the names of all requested observations, each once, in order; without any, the default and the task's own.

    Raises:
        ConfigError: A sensor is unknown, with the closest known one.
    """
    names = config.sensors if config.sensors is not None else (*DEFAULT_SENSORS, *task.observation_spec)
    known = [*VIEW_KINDS, *registered_sensors(), *task.observation_spec]
    for name in names:
        if name not in known and name in FOREIGN_SENSOR_HINTS:
            raise UnknownNameError(f"unknown sensor `{name}`", hint=f"Give {FOREIGN_SENSOR_HINTS[name]}.")
    check_known("sensor", names, known)
    return tuple(dict.fromkeys(names))


def select_sensors(config: EnvConfig, task: Task) -> tuple[Sensor, ...]:
    """Return the sensors of an environment whose `config.sensors` are resolved, without those of its task.

    The cameras come first. Sensors of other packages are taken to observe sound.

    Raises:
        ConfigError: Two of them, or one and the task, use the same name. Or the task's words are audible only, and none
            of the sensors observes sound.
    """
    known = registered_sensors()
    names = config.sensors or ()
    named = tuple(known[name] for name in names if name in known)
    sensors = (*((Cameras(),) if config.all_cameras else ()), *named)
    _check_names(config, sensors, task)
    if task.requires_hearing and not any(
        sensor.name in HEARING_SENSORS or not _is_builtin(sensor) for sensor in sensors
    ):
        message = f"words of {type(task).__name__} are sounds, which none of the sensors hears: {', '.join(names)}"
        raise ConfigError(message, element="sensors", hint=f"Add one of {', '.join(HEARING_SENSORS)}.")
    return sensors


def state_owners(sensors: tuple[Sensor, ...]) -> tuple[Sensor, ...]:
    """Return the sensors whose state is stored, each once: the sensors themselves, or their `state_owner`."""
    return tuple({(sensor.state_owner or sensor).name: sensor.state_owner or sensor for sensor in sensors}.values())


def _check_names(config: EnvConfig, sensors: tuple[Sensor, ...], task: Task) -> None:
    """Raise `ConfigError` if two owners use the same name, because one of the two observations would be lost."""
    first: dict[str, tuple[Sensor | Task, str]] = {}
    for owner in (*sensors, task):
        for name, role in _used_names(config, owner):
            other, other_role = first.setdefault(name, (owner, role))
            if other is not owner:
                ours = _is_builtin(owner) and not _is_builtin(other)  # users can rename only their own
                raise ConfigError(
                    f"`{name}` is {other_role} of {_describe(other)} and {role} of {_describe(owner)}",
                    hint=f"Rename it in {_definition_of(other, other_role) if ours else _definition_of(owner, role)}, "
                    "or leave one of the two out of `sensors`.",
                )


def _used_names(config: EnvConfig, owner: Sensor | Task) -> Iterator[tuple[str, str]]:
    """Yield the names that a sensor or the task uses, each with its role."""
    chosen = config.sensors or ()
    if isinstance(owner, Task):
        yield from ((name, OBSERVATION_ROLE) for name in owner.observation_spec if name in chosen)
        return
    yield owner.name, NAME_ROLE
    if isinstance(owner, Cameras):
        yield from ((name, "an image") for name in chosen if name in VIEW_KINDS)
    yield from ((name, OBSERVATION_ROLE) for name in owner.spec(config))


def _is_builtin(owner: Sensor | Task) -> bool:
    """Return whether a sensor or task is of this package, so that users cannot rename it."""
    return type(owner).__module__.startswith("home_mjx.")


def _describe(owner: Sensor | Task) -> str:
    """Return the kind and class name of a sensor or task, for messages."""
    return f"the {'task' if isinstance(owner, Task) else 'sensor'} {type(owner).__name__}"


def _definition_of(owner: Sensor | Task, role: str) -> str:
    """Return the attributes that define a name of an owner, as text for a hint."""
    name = type(owner).__name__
    if role == NAME_ROLE:
        return f"`{name}.name`"
    return f"`{name}.{'observation_spec' if isinstance(owner, Task) else 'spec'}` and `{name}.observe`"
