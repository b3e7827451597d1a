"""Navigation tasks: to a room, to an object of a category, to a point; and mixes of tasks.

Anderson et al., "On Evaluation of Embodied Navigation Agents", 2018 (arXiv:1807.06757); for objects Batra et al.,
"ObjectNav Revisited", 2020 (arXiv:2006.13171).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from home_mjx.core.checks import check_flag, check_number
from home_mjx.errors import ConfigError
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.rules.build_bank import TaskGenerator, TaskRow
from home_mjx.tasks.rules.enums import FAILURE, SUCCESS, Feature
from home_mjx.tasks.rules.house_view import HouseView
from home_mjx.tasks.rules.program import Condition, Selector, TaskStage, Transition
from home_mjx.tasks.rules.row_task import GeneratorTask, RowTask

STOP_CONDITION = Condition(Feature.STOPPED, minimum=1)
# Coarse categories that are never goals: part of the house, above the view, or unknown.
EXCLUDED_CATEGORIES = frozenset(
    ("unknown", "wall", "floor", "ceiling", "door", "window", "arch", "person", "curtain", "ceiling_fan")
)


def arrival_stage(conditions: tuple[Condition, ...], stop: bool, reward: float, guide: int = 0) -> TaskStage:
    """Return a stage that succeeds where all `conditions` hold; with `stop` on STOPPED only, which fails elsewhere."""
    if not stop:
        return TaskStage((Transition(SUCCESS, conditions, reward=reward),), guide)
    return TaskStage(
        (Transition(SUCCESS, (*conditions, STOP_CONDITION), reward=reward), Transition(FAILURE, (STOP_CONDITION,))),
        guide,
    )


@dataclass(frozen=True)
class NavigationTask(GeneratorTask):
    """Options that navigation tasks share.

    Attributes:
        stop: Agents must choose `stop` at the goal: nothing else is success, and a wrong `stop` fails.
        success_reward: Added on success.
    """

    stop: bool = False
    success_reward: float = 2.5

    def __post_init__(self) -> None:
        super().__post_init__()
        check_flag("stop", self.stop)
        check_number("success_reward", self.success_reward, 0)

    @property
    def requires_stop(self) -> bool:
        """True if agents must choose the action `stop`: the option `stop`."""
        return self.stop


@dataclass(frozen=True)
class RoomNav(NavigationTask):
    """Go into a room of some type; any label of a room counts, as in House3D."""

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield a row per room type of the house, endlessly, in a new random order each round; none without any."""
        types = np.array(list(view.rooms_by_type), int)
        while len(types):
            for kind in random.permutation(types).tolist():
                stage = arrival_stage((Condition(Feature.INSIDE, 0, minimum=1),), self.stop, self.success_reward)
                yield TaskRow([Selector.rooms(room_type=kind)], [stage])


@dataclass(frozen=True)
class ObjectNav(NavigationTask):
    """Go to any object of a category, and look at it.

    Attributes:
        success_distance: Maximum distance to the object on success [m].
    """

    success_distance: float = 1.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("success_distance", self.success_distance, 0)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield a row per coarse category in the house, endlessly, in a new random order each round; none without any.

        `EXCLUDED_CATEGORIES` are left out.
        """
        things = [thing for thing in view.objects if thing.coarse not in EXCLUDED_CATEGORIES]
        kinds = np.array(sorted({thing.semantic(Semantic.COARSE) for thing in things}), int)
        there = Condition(Feature.DISTANCE, 0, maximum=self.success_distance), Condition(Feature.SEEN, 0, minimum=1)
        while len(kinds):
            for kind in random.permutation(kinds).tolist():
                yield TaskRow([Selector.objects(coarse=kind)], [arrival_stage(there, self.stop, self.success_reward)])


@dataclass(frozen=True)
class PointGoals(NavigationTask):
    """Go to a point: PointNav as rows, for mixes with other tasks.

    Attributes:
        num_points: Number of distinct points per house; each has a field of distances.
        success_distance: Maximum distance to the point on success [m].
    """

    num_points: int = 8
    success_distance: float = 0.36

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("num_points", self.num_points, 1, integer=True)
        check_number("success_distance", self.success_distance, 0)

    def rows(self, view: HouseView, random: np.random.Generator) -> Iterator[TaskRow]:
        """Yield a row per point, centres of random cells, endlessly, in a new random order each round.

        The cells are off door leaves: `num_points`, or all if there are fewer; no rows without any.
        """
        free = view.graph.place[~view.graph.at_leaf]
        points = free[random.permutation(len(free))[: self.num_points]]
        stage = arrival_stage(
            (Condition(Feature.DISTANCE, 0, maximum=self.success_distance),), self.stop, self.success_reward
        )
        while len(points):
            for point in random.permutation(points):
                yield TaskRow([Selector.point(point.tolist())], [stage])


@dataclass(frozen=True)
class HouseTasks(RowTask):
    """A mix of tasks, all equally frequent.

    Attributes:
        tasks: Generators of the tasks.
    """

    tasks: Sequence[TaskGenerator] = (RoomNav(), ObjectNav())

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "tasks", check_mix(self.tasks))

    @property
    def requires_stop(self) -> bool:
        """True if one of the tasks needs `stop`."""
        return any(getattr(task, "requires_stop", False) for task in self.tasks)

    @property
    def requires_hands(self) -> bool:
        """True if one of the tasks needs hands."""
        return any(getattr(task, "requires_hands", False) for task in self.tasks)

    @property
    def requires_switches(self) -> bool:
        """True if one of the tasks needs states of lamps and appliances."""
        return any(getattr(task, "requires_switches", False) for task in self.tasks)

    @property
    def requires_hearing(self) -> bool:
        """True if one of the tasks needs hearing."""
        return any(getattr(task, "requires_hearing", False) for task in self.tasks)

    @property
    def num_sources(self) -> int:
        """Number of simultaneous sound sources: the maximum over the tasks."""
        return max((getattr(task, "num_sources", 1) for task in self.tasks), default=1)

    @property
    def clips(self) -> tuple[str, ...]:
        """Clips of all tasks."""
        return tuple(dict.fromkeys(clip for task in self.tasks for clip in getattr(task, "clips", ())))

    @property
    def generators(self) -> tuple[TaskGenerator, ...]:
        """Generators of all tasks."""
        return tuple(self.tasks)


def check_mix(tasks: Any) -> tuple[TaskGenerator, ...]:
    """Return tasks as a tuple, unchanged, if they can be mixed.

    Raises:
        ConfigError: There are no tasks, or one is no `TaskGenerator` (such as a class), or controls agents itself.
    """
    if not isinstance(tasks, tuple | list) or not tasks:
        hint = "Write tasks=(RoomNav(), ObjectNav())."
        raise ConfigError(f"`tasks` of a mix must be a tuple of tasks, got {tasks!r}", hint=hint)
    for task in tasks:
        if isinstance(task, type) or not isinstance(task, TaskGenerator):
            hint = "Write RoomNav(), ...; PointGoals() are PointNav's rows, and a mix in a mix is its `tasks`."
            raise ConfigError(f"a mix is made of tasks that write rows, got {task!r}", hint=hint)
        if getattr(task, "num_acting", None) is not None:
            hint = "Make an environment of its own for it."
            raise ConfigError(f"{task.name} controls agents itself, so it cannot be part of a mix", hint=hint)
    return tuple(tasks)
