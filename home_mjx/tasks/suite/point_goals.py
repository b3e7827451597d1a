"""Point goals of a house: sampling, saving and loading."""

import json
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import DatasetError
from home_mjx.navigation.grid import cell_at_feet, geodesic_distance, grid_position, is_near_home_region
from home_mjx.navigation.spawn import random_yaw
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.state import MAX_FLOOR_OFFSET, Episodes

MAX_GOAL_OFFSET = 0.01  # [m], maximum distance between a file's goal and the bank's goal
OTHER_BANK_HINT = "Use a bank of the houses that the episodes were drawn in, compiled alike."
ROW_FORMAT_HINT = "Rows of tasks go to any place of the floor: docs/own_task.md, File format."
MAX_START_OFFSET = (
    0.025  # [m], maximum offset of a start from the centre of its cell: half of the clearance of compiled houses
)
NUM_START_SAMPLES = 64  # samples of a start per episode


def pick_goal(snapshot: Snapshot, key: Array, min_distance: float, same_storey: bool = False) -> Int[Array, ""]:
    """Sample the index of a goal of the house uniformly, among those with a path; a condition no goal meets is dropped.

    Without any path, it is one of all goals.

    Args:
        snapshot: The environment.
        key: Random key.
        min_distance: Minimum length of the path from the first agent [m].
        same_storey: Sample a goal on the first agent's storey; this condition goes first.
    """
    bank, house = snapshot.bank, snapshot.house
    distance = geodesic_distance(bank, house, None, snapshot.feet[0])
    fit = jnp.isfinite(distance)
    for wanted in [is_on_storey(bank, house, snapshot.feet[0])] * same_storey + [distance >= jnp.float32(min_distance)]:
        fit = jnp.where(jnp.any(fit & wanted), fit & wanted, fit)
    fit = fit | ~jnp.any(fit)
    return jax.random.categorical(key, jnp.where(fit, 0.0, -jnp.inf)).astype(jnp.int32)


def is_on_storey(bank: HouseBank, house: Int[Array, ""], feet: Float[Array, "3"]) -> Bool[Array, " goals"]:
    """Return a mask of the house's goals on the level of a point on a floor [m]."""
    goals = bank.navigation.goal[bank.clip_house_index(house)]
    levels = jax.vmap(lambda goal: cell_at_feet(bank, house, goal)[0])(goals)
    return levels == cell_at_feet(bank, house, feet)[0]


def sample_goal(
    bank: HouseBank,
    house: Int[Array, ""],
    key: Array,
    min_length: Float[Array, ""],
    max_length: Float[Array, ""],
    same_storey: bool = False,
) -> tuple[Float[Array, "3"], Float[Array, ""], dict[str, Array]]:
    """Sample a start of the house, and a goal whose shortest path has a length within limits [m], both inclusive.

    Starts are uniform by area, but not where door leaves are, nor where leaves cut off an area from the rest. The first
    of `NUM_START_SAMPLES` starts with such a goal is taken, and one of its goals, all equally likely.

    Args:
        bank: The houses.
        house: Index of the house.
        key: Random key.
        min_length: Minimum length of the shortest path [m].
        max_length: Maximum length of the shortest path [m].
        same_storey: Sample start and goal on the same storey.

    Returns:
        Start on the floor [m], yaw [rad], and the columns `goal` and `length` [m]; the length is inf if none of
        `NUM_START_SAMPLES` starts had such a goal.
    """
    place, turn, choose = jax.random.split(key, 3)
    starts = jax.vmap(lambda k: _random_start(bank, house, k))(jax.random.split(place, NUM_START_SAMPLES))
    lengths = jax.vmap(lambda p: geodesic_distance(bank, house, None, p))(starts)
    fits = (lengths >= min_length) & (lengths <= max_length) & jnp.isfinite(lengths)
    if same_storey:
        fits = fits & jax.vmap(lambda p: is_on_storey(bank, house, p))(starts)
    attempt = jnp.argmax(jnp.any(fits, axis=1)).astype(jnp.int32)  # the first usable start
    weight = jnp.where(fits[attempt], jnp.float32(0), -jnp.inf)
    goal = jax.random.categorical(choose, jnp.where(jnp.any(fits[attempt]), weight, 0.0)).astype(jnp.int32)
    length = jnp.where(fits[attempt, goal], lengths[attempt, goal], jnp.float32(jnp.inf))
    return starts[attempt], random_yaw(turn), {"goal": goal, "length": length}


def _random_start(bank: HouseBank, house: Int[Array, ""], key: Array) -> Float[Array, "3"]:
    """Sample a floor point within `MAX_START_OFFSET` in x and y of the centre of a random start point's cell [m]."""
    which, shift = jax.random.split(key)
    known = bank.navigation.start[bank.clip_house_index(house)]
    point = known[jax.random.randint(which, (), 0, known.shape[0])]
    middle = grid_position(bank, house, cell_at_feet(bank, house, point))
    return jnp.append(
        middle[:2] + jax.random.uniform(shift, (2,), jnp.float32, -MAX_START_OFFSET, MAX_START_OFFSET), point[2]
    )


def is_solvable(bank: HouseBank, episode: Episodes) -> Bool[Array, ""]:
    """Return whether the start is within a cell size and `MAX_FLOOR_OFFSET` of the floor, and near the home region.

    Near is in or beside a cell with paths to all goals, so every goal of the house is reachable.
    """
    off = grid_position(bank, episode.house, cell_at_feet(bank, episode.house, episode.start)) - episode.start
    near = jnp.all(jnp.abs(off) < jnp.array([bank.spec.cell, bank.spec.cell, MAX_FLOOR_OFFSET], jnp.float32))
    return near & is_near_home_region(bank, episode.house, episode.start)


def to_json(bank: HouseBank, house: int, columns: dict[str, Any]) -> dict[str, Any]:
    """Return JSON values: `goal`, the goal's position [m], and `length`, that of the shortest path [m]."""
    goal = np.asarray(bank.navigation.goal[house, int(columns["goal"])])
    return {"goal": goal.tolist(), "length": float(columns["length"])}


def read_numbers(line: dict[str, Any], name: str, shape: tuple[int, ...]) -> np.ndarray:
    """Return finite numbers of a JSON line, as a float array of a shape; booleans are no numbers.

    Raises:
        KeyError: They are missing.
        ValueError: They have another shape, or are not finite numbers.
    """
    try:
        found = np.array(line[name])
    except ValueError:  # lists of different lengths
        found = np.array(None)
    if found.shape != shape or found.dtype.kind not in "iuf" or not np.isfinite(found).all():
        expected = "a finite number" if shape == () else "three finite numbers"
        raise ValueError(f"`{name}` must be {expected}, got {json.dumps(line[name]):.60}")
    return found.astype(float)


def from_json(bank: HouseBank, house: int, line: dict[str, Any]) -> dict[str, Any]:
    """Return `goal`, the index of the bank's goal nearest to the line's position, and `length` [m].

    That goal is at most `MAX_GOAL_OFFSET` away. Whether the length is that of the shortest path is not checked.

    Raises:
        DatasetError: The house has no goal there.
        KeyError, ValueError: The line is malformed.
    """
    place, length = read_numbers(line, "goal", (3,)), float(read_numbers(line, "length", ()))
    if length < 0:
        raise ValueError("`length` must be a finite number of at least 0")
    away = np.linalg.norm(np.asarray(bank.navigation.goal[house]) - place, axis=-1)
    if away.min() > MAX_GOAL_OFFSET:
        message = f"house {line['house']} has no goal at {line['goal']}; its nearest one is {away.min():.2f} m away"
        raise DatasetError(message, hint=f"{OTHER_BANK_HINT} {ROW_FORMAT_HINT}")
    return {"goal": int(away.argmin()), "length": length}
