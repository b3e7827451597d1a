"""Options of Habitat's navigation tasks, and the environment that they make."""

import ast
import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from home_mjx.adapters.habitat.episodes import NavigationDataset, NavigationEpisode, read_dataset
from home_mjx.adapters.habitat.image_goals import check_point_goals
from home_mjx.adapters.habitat.observations import SENSORS
from home_mjx.adapters.habitat.rows import Offsets, to_episodes, to_tasks
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_flag, check_known, check_number
from home_mjx.datasets.registry import has_scheme, open_dataset
from home_mjx.env_factory import build_env
from home_mjx.errors import ConfigError, UnknownNameError, did_you_mean
from home_mjx.houses.house_set import HouseSet
from home_mjx.registry import DEFAULT_NUM_HOUSES, EnvSpec
from home_mjx.schema.agent import AgentBody
from home_mjx.schema.timing import Timing
from home_mjx.tasks.base.config import DISCRETE_CTRL_DT
from home_mjx.tasks.base.specs import DiscreteActions
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv

TASKS = {"pointnav": "PointGoals", "objectnav": "ObjectNav", "imagenav": "PointGoals"}
SUCCESS_DISTANCES = {"pointnav": 0.2, "objectnav": 1.0, "imagenav": 1.0}  # [m]
OWN_SENSORS = {
    "pointnav": ("rgb", "depth", "pointgoal_with_gps_compass"),
    "objectnav": ("rgb", "depth", "objectgoal", "compass", "gps"),
    "imagenav": ("rgb", "imagegoal"),
}
# Options by the keys of Habitat's configuration; those of sensors are the same for all cameras.
KEYS = {
    "habitat.seed": "seed",
    "habitat.environment.max_episode_steps": "max_episode_steps",
    "habitat.dataset.data_path": "data_path",
    "habitat.simulator.forward_step_size": "forward_step_size",
    "habitat.simulator.turn_angle": "turn_angle",
    "habitat.simulator.tilt_angle": "tilt_angle",
    "habitat.simulator.habitat_sim_v0.allow_sliding": "allow_sliding",
    "habitat.task.measurements.success.success_distance": "success_distance",
    **{
        f"habitat.simulator.agents.main_agent.sim_sensors.{sensor}_sensor.{name}": name
        for sensor in ("rgb", "depth", "semantic")
        for name in ("width", "height", "hfov", "min_depth", "max_depth")
    },
}


@dataclass(frozen=True)
class HabitatConfig:
    """Options with Habitat's names, units and defaults.

    Attributes:
        task: "pointnav", "objectnav" or "imagenav".
        houses: Houses as for `home_mjx.make`; None: generated ones.
        num_houses: Number of houses; None: as for `make`, or those of `data_path`.
        data_path: Episode file of Habitat; None: episodes are sampled.
        episodes_per_house: Number of sampled episodes per house.
        offsets: By house id, `CompiledHouse.offset` [m]; needed for files in the frame of a scene's own file.
        sensors: Names of observations, of `SENSORS`; None: those of the task.
        width: Image width [px].
        height: Image height [px].
        hfov: Horizontal field of view [degrees].
        min_depth: Depth that becomes 0 [m].
        max_depth: Depth that becomes 1 [m].
        forward_step_size: Distance of `move_forward` [m].
        turn_angle: Angle of turns [degrees].
        tilt_angle: Angle of looks [degrees]; None: there are none.
        allow_sliding: Whether agents slide along obstacles; False: they stop at contact.
        success_distance: Maximum distance on success [m]; None: 0.2 to points, 1.0 to objects and places of images.
        top_down_map: Whether `get_metrics` has `top_down_map`; one environment alone, not `VectorEnv`.
        max_episode_steps: Steps until an episode ends.
        seed: Seed of resets.
        options: Further options of `home_mjx.make`. Movement is kinematic unless `impl` is another.

    Raises:
        ConfigError: A value is invalid.
    """

    task: str = "pointnav"
    houses: Any = None
    num_houses: int | None = None
    data_path: str | Path | None = None
    episodes_per_house: int = 64
    offsets: Offsets = field(default_factory=dict)
    sensors: tuple[str, ...] | None = None
    width: int = 256
    height: int = 256
    hfov: float = 90.0
    min_depth: float = 0.0
    max_depth: float = 10.0
    forward_step_size: float = 0.25
    turn_angle: float = 10.0
    tilt_angle: float | None = None
    allow_sliding: bool = True
    success_distance: float | None = None
    top_down_map: bool = False
    max_episode_steps: int = 500
    seed: int = 100
    options: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        check_known("task", [self.task], TASKS)
        check_known("sensor of Habitat", self.sensor_names, SENSORS)
        check_flag("top_down_map", self.top_down_map)
        check_number("hfov", self.hfov, 1, 179)
        check_number("seed", self.seed, 0, integer=True)
        if not 0 <= self.min_depth < self.max_depth:
            raise ConfigError(f"`min_depth` {self.min_depth} must be at least 0, and less than `max_depth`")

    @property
    def sensor_names(self) -> tuple[str, ...]:
        """Names of the observations."""
        return OWN_SENSORS[self.task] if self.sensors is None else tuple(self.sensors)

    @property
    def goal_distance(self) -> float:
        """Maximum distance on success [m]."""
        return SUCCESS_DISTANCES[self.task] if self.success_distance is None else self.success_distance


def get_config(config_path: str, overrides: Sequence[str] = (), **changes: Any) -> HabitatConfig:
    """Return the options of a task by a name of Habitat's configurations; the file itself is not read.

    Args:
        config_path: Contains a task's name, as "benchmark/nav/pointnav/pointnav_gibson.yaml" does.
        overrides: `key=value` with keys of `KEYS`.
        **changes: Fields of `HabitatConfig`.

    Raises:
        ConfigError: The task, a key or a field is unknown, or a value is invalid.

    Example:
        >>> get_config("benchmark/nav/pointnav/pointnav_gibson.yaml", ["habitat.seed=7"]).seed
        7
    """
    task = next((name for name in TASKS if name in config_path), None)
    if task is None:
        hint = f"Known: {', '.join(TASKS)}."
        if "rearrange" in config_path:
            hint = "Files of rearrangement add objects that houses lack: `read_rearrangement` reads them; the task is "
            hint += "`home_mjx.make('Rearrange-v0')`."
        raise ConfigError(f"`{config_path}` names no known task", hint=hint)
    looks: dict[str, Any] = {"tilt_angle": 30.0, "turn_angle": 30.0} if task == "objectnav" else {}
    chosen = looks | dict(map(_parse_override, overrides)) | changes
    check_known("option", chosen, [one.name for one in dataclasses.fields(HabitatConfig)])
    return HabitatConfig(task, **chosen)


def _parse_override(text: str) -> tuple[str, Any]:
    """Return the field and the value of an override; `UnknownNameError` for unknown keys."""
    key, _, value = text.partition("=")
    if key not in KEYS:
        raise UnknownNameError(f"unknown key `{key}` of a configuration", hint=did_you_mean(key, KEYS))
    try:
        return KEYS[key], ast.literal_eval(value)
    except (ValueError, SyntaxError):
        return KEYS[key], value


def build(
    config: HabitatConfig, dataset: NavigationDataset | None = None
) -> tuple[Env[HouseholdEnv], tuple[NavigationEpisode, ...]]:
    """Return the environment of the options, and its episodes: of `dataset`, else of `data_path`, else sampled.

    Raises:
        ConfigError: An option is invalid.
        DatasetError: Houses or episodes cannot be read, or do not fit; see `to_tasks`.
    """
    if dataset is None and config.data_path is not None:
        dataset = read_dataset(config.data_path)
    houses, num_houses = _choose_houses(config, dataset)
    spec = EnvSpec(
        f"Habitat{TASKS[config.task]}-v0",
        f"home_mjx.tasks.suite:{TASKS[config.task]}",
        _options(config) | ({} if dataset is None else {"num_tasks": 1}),
        num_houses=num_houses,
        in_memory=True,
    )
    env = build_env(spec, houses)
    if dataset is None:
        return env, to_episodes(env.params.tasks, env.bank, config.offsets)
    path = config.data_path or "dataset"
    if config.task == "imagenav":
        check_point_goals(dataset, path)
    return env.with_tasks(to_tasks(dataset, env.bank, config.goal_distance, config.offsets, path)), dataset.episodes


def _choose_houses(config: HabitatConfig, dataset: NavigationDataset | None) -> tuple[Any, int]:
    """Return houses for `build_env`, those of the episodes if there are any, and their maximum number."""
    if dataset is not None and not isinstance(config.houses, HouseBank | HouseSet):
        ids = tuple(dict.fromkeys(episode.house_id for episode in dataset.episodes))
        return HouseSet(config.houses, ids=ids), len(ids)
    name: Any = config.houses
    known = len(open_dataset(name).house_ids) if has_scheme(name) else DEFAULT_NUM_HOUSES
    return name, config.num_houses or known


def _options(config: HabitatConfig) -> dict[str, Any]:
    """Return the options of `make` for the options with Habitat's names."""
    moves = DiscreteActions(config.forward_step_size, config.turn_angle, config.tilt_angle)
    half = math.tan(math.radians(config.hfov) / 2) * config.height / config.width
    least = math.ceil(moves.min_duration(AgentBody()) / Timing().sim_dt) * Timing().sim_dt
    return {
        "impl": "kinematic",
        "allow_sliding": config.allow_sliding,
        "actions": moves,
        "ctrl_dt": max(DISCRETE_CTRL_DT, least),
        "stop": True,
        "sensors": tuple(dict.fromkeys(SENSORS[name] for name in config.sensor_names)),
        "width": config.width,
        "height": config.height,
        "fovy": math.degrees(2 * math.atan(half)),
        "max_depth": config.max_depth,
        "episode_length": config.max_episode_steps,
        "success_distance": config.goal_distance,
        "num_tasks": config.episodes_per_house,
        **config.options,
    }
