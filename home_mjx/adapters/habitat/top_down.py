"""Habitat's measure `top_down_map`: the storey of the agent with its path, start and goal, by Habitat's values."""

import math
from enum import IntEnum
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Int, UInt8

from home_mjx.core.compile_cache import compiler_options
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.metrics.top_down import CellOccupancy, MapMemory, TopDownMap, top_down_map, update_map_memory

NUM_PATH_COLORS = 245  # number of values of the path, from `MapValue.PATH` at the start
MARK_REACH = 1  # number of cells of a mark to each side of its middle


class MapValue(IntEnum):
    """Values of the cells of `map`, as in Habitat's `maps`."""

    INVALID = 0
    VALID = 1
    BORDER = 2
    SOURCE = 4
    TARGET = 6
    PATH = 10


class MapMeasure:
    """The measure of one environment, over an episode.

    Args:
        env: The environment.
        max_steps: Number of steps over which the path runs through its values.
    """

    def __init__(self, env: Env[HouseholdEnv], max_steps: int) -> None:
        core, self._max_steps = env.core, max_steps

        def update(params: EnvParams, state: State, memory: MapMemory | None) -> tuple[MapMemory, TopDownMap]:
            """Return the memory after a step, and the map."""
            snapshot = core.snapshot(params, state)
            memory = update_map_memory(snapshot, memory)
            return memory, top_down_map(snapshot, state.task, memory)

        self._update = jax.jit(update, compiler_options=compiler_options())
        self._memory: MapMemory | None = None
        self._paths: dict[int, UInt8[np.ndarray, "rows columns"]] = {}
        self._last: tuple[int, Int[np.ndarray, "2"]] | None = None

    def update(self, params: EnvParams, state: State) -> dict[str, Any]:
        """Return the measure after a reset or a step: `map`, `fog_of_war_mask`, `agent_map_coord`, `agent_angle`.

        Rows go along Habitat's +z, columns along its +x, and a pixel is a cell of the grid. Angles are those of
        Habitat: pi towards its -z, which is row 0, and pi / 2 less to the right [rad].
        """
        if self._memory is None:
            shapes = jax.eval_shape(lambda p, s: self._update(p, s, None)[0], params, state)
            self._memory = jax.tree.map(lambda leaf: jnp.zeros(leaf.shape, leaf.dtype), shapes)
        self._memory, found = self._update(params, state, self._memory)
        plan: TopDownMap = jax.tree.map(np.asarray, found)
        step = int(state.world.step)
        if step == 0:
            self._paths, self._last = {}, None
        path = self._walk(int(plan.level), np.asarray(plan.agents[0]), plan.occupancy.shape, step)
        place = (len(path) - 1 - int(plan.agents[0, 0]), int(plan.agents[0, 1]))
        turn = math.remainder(float(plan.yaw[0]) + math.pi / 2, 2 * math.pi)
        return {
            "map": draw_map(plan, path)[::-1],
            "fog_of_war_mask": np.asarray(plan.seen)[::-1].astype(np.uint8),
            "agent_map_coord": [place],
            "agent_angle": [np.array(turn)],
        }

    def _walk(self, level: int, cell: Int[np.ndarray, "2"], shape: tuple[int, ...], step: int) -> np.ndarray:
        """Return the path on a level, 0 elsewhere, after a straight move to a cell."""
        path = self._paths.setdefault(level, np.zeros(shape, np.uint8))
        if self._last is not None and self._last[0] == level:
            row, column = line_cells(self._last[1], cell)
            path[row, column] = MapValue.PATH + min(step * NUM_PATH_COLORS // self._max_steps, NUM_PATH_COLORS)
        self._last = level, cell
        return path


def line_cells(first: Int[np.ndarray, "2"], last: Int[np.ndarray, "2"]) -> Int[np.ndarray, "2 n"]:
    """Return rows and columns of the cells from one cell to another, both included.

    Example:
        >>> line_cells(np.array([0, 0]), np.array([1, 2])).tolist()
        [[0, 0, 1], [0, 1, 2]]
    """
    count = int(np.abs(last - first).max()) + 1
    return np.round(np.linspace(first, last, count)).astype(int).T


def draw_map(plan: TopDownMap, path: UInt8[np.ndarray, "rows columns"]) -> UInt8[np.ndarray, "rows columns"]:
    """Return a map with the values of `MapValue`, rows as in `plan`; marks are over the path."""
    valid, goal, start = np.asarray(plan.occupancy) == CellOccupancy.FREE, np.asarray(plan.goal), np.asarray(plan.start)
    found = np.where(valid, np.where(_is_border(valid), MapValue.BORDER, MapValue.VALID), 0).astype(np.uint8)
    found = np.where(path > 0, path, found)
    if goal.any():
        found[goal] = MapValue.TARGET
        _mark(found, np.argwhere(goal).mean(axis=0).astype(int), MapValue.TARGET)
    if start[0] >= 0:
        _mark(found, start, MapValue.SOURCE)
    return found


def _is_border(valid: Bool[np.ndarray, "rows columns"]) -> Bool[np.ndarray, "rows columns"]:
    """Return a mask of valid cells with a neighbour, of four, that is not valid; the map's edge is no neighbour."""
    wide = np.pad(valid, 1, mode="edge")
    inner = wide[:-2, 1:-1] & wide[2:, 1:-1] & wide[1:-1, :-2] & wide[1:-1, 2:]
    return valid & ~inner


def _mark(found: UInt8[np.ndarray, "rows columns"], cell: Int[np.ndarray, "2"], value: MapValue) -> None:
    """Draw a square around a cell."""
    row, column = (slice(max(int(at) - MARK_REACH, 0), int(at) + MARK_REACH + 1) for at in cell)
    found[row, column] = value
