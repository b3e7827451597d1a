"""Instruction and goal of an episode, as text and as positions on a plan."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.state import Episodes, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.language.phrases import describe_goal
from home_mjx.tasks.language.vocabulary import detokenize
from home_mjx.tasks.rules.row_task import RowState
from home_mjx.tasks.suite.point_nav import PointNavState


class Instruction(NamedTuple):
    """Instruction of an episode.

    Attributes:
        task: Name of the task.
        text: Instruction; a description of the goal for tasks without one.
        path_length: Length of the shortest path [m]; NaN if unknown.
    """

    task: str
    text: str
    path_length: float


class GoalMarkers(NamedTuple):
    """Positions and rooms of the current goal.

    Attributes:
        places: Points [m].
        rooms: True for goal rooms of the house.
    """

    places: Float[np.ndarray, "n 3"]
    rooms: Bool[np.ndarray, " r"]


def get_instruction(env: Env[HouseholdEnv], state: State) -> Instruction:
    """Return task, instruction and shortest path length of the episode of one environment's state.

    The task is the row's own, else the environment's. A task without rows has its name as text, and an unknown length.
    """
    task = env.spec.id.rpartition("-v")[0] if env.spec is not None else type(env.task).__name__
    if isinstance(state.task, PointNavState):
        return _asked_of_point(task, env.params.tasks, state)
    if not isinstance(state.task, RowState):
        return Instruction(task, task, np.nan)
    names, number = env.params.tasks.names, int(state.task.task)
    task = names[number] if number < len(names) else task
    text = describe_goal(task, np.asarray(state.task.tokens), np.asarray(state.task.program.descriptor))
    return Instruction(task, text, float(state.task.length))


def _asked_of_point(task: str, episodes: Episodes | None, state: State) -> Instruction:
    """Return the instruction of PointNav; its length is known only for stored episodes."""
    if episodes is None:
        return Instruction(task, "go to the point", np.nan)
    length = float(episodes.columns["length"][int(state.world.episode) % len(episodes)])
    return Instruction(task, f"go to the point {length:.1f} m away", length)


def get_goal_markers(bank: HouseBank, state: State, boxes: Float[np.ndarray, "i 2 3"]) -> GoalMarkers:
    """Return the goal points and rooms of the current stage's goal; no point and no room if it has none.

    Points are the goal's place, else the centres of all its objects. `boxes` are the current bounds of all instances
    [m]. PointNav has its goal on the floor and no rooms; other tasks without rows have no goal.
    """
    house = int(state.world.house)
    nothing, nowhere = np.zeros((0, 3)), np.zeros(bank.navigation.room_type.shape[1], bool)
    if isinstance(state.task, PointNavState):
        return GoalMarkers(np.asarray(bank.navigation.goal[house, int(state.task.goal)])[None], nowhere)
    if not isinstance(state.task, RowState):
        return GoalMarkers(nothing, nowhere)
    guide = int(state.task.program.guide[max(int(state.task.stage), 0)])
    if guide < 0:
        return GoalMarkers(nothing, nowhere)
    place = np.asarray(state.task.program.place[guide])
    points = boxes[np.asarray(state.task.targets.instance[guide])].mean(axis=1)
    places = place[None] if np.isfinite(place).all() else points
    return GoalMarkers(places, np.asarray(state.task.targets.room[guide]))


def get_utterances(state: State) -> tuple[str, ...]:
    """Return the utterances of one environment's last step, see `format_utterances`; () without a `RowState`."""
    if not isinstance(state.task, RowState):
        return ()
    return format_utterances(np.asarray(state.world.spoken_token), np.asarray(state.task.reply))


def format_utterances(said: Int[np.ndarray, " a"], replies: Int[np.ndarray, " a"]) -> tuple[str, ...]:
    """Format the word that each agent said (token; -1: none, omitted), and the oracle's reply (-1: none) after a colon.

    Example:
        >>> from home_mjx.tasks.language.vocabulary import tokenize
        >>> format_utterances(np.array([*tokenize("colour"), -1]), np.array([*tokenize("red"), -1]))
        ('colour: red',)
    """
    pairs = zip(said.tolist(), replies.tolist(), strict=True)
    return tuple(": ".join(detokenize([token]) for token in pair if token >= 0) for pair in pairs if pair[0] >= 0)
