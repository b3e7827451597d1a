"""Goals of a house as tasks draw, save and load them."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import DatasetError
from home_mjx.navigation.grid import cell_of, geodesic_distance, near_home, place_position
from home_mjx.navigation.spawn import random_yaw
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.state import ON_FLOOR, Episodes

SAME_PLACE = 0.01  # [m]: a goal of the bank is the goal of a file if it is as near
OTHER_BANK = "Use a bank of the houses that the episodes were drawn in, compiled alike."
ASIDE = 0.025  # [m], from the middle of a cell, half of the clearance with which houses are compiled
ATTEMPTS = 64  # draws per episode


def choose_goal(snapshot: Snapshot, key: Array, min_distance: float) -> Int[Array, ""]:
    """A random goal of the house at least `min_distance` [m] from the first agent, if there is one."""
    bank, house = snapshot.bank, snapshot.house
    distance = geodesic_distance(bank, house, None, snapshot.pose.pos[0])
    fit = jnp.isfinite(distance) & (distance >= jnp.float32(min_distance))
    fit = fit | ~jnp.any(fit)
    return jax.random.categorical(key, jnp.where(fit, 0.0, -jnp.inf)).astype(jnp.int32)


def sample_goal(
    bank: HouseBank, house: Int[Array, ""], key: Array, min_length: Float[Array, ""], max_length: Float[Array, ""]
) -> tuple[Float[Array, "3"], Float[Array, ""], dict[str, Array]]:
    """One of the house's starts and a goal whose shortest path has a length within limits [m].

    Starts are as likely as any other by area, but for where leaves of doors stand, or cut it off from the rest.

    Returns:
        Start, yaw, and the columns `goal` and `length`; the length is inf if none of `ATTEMPTS` starts had such a goal.
    """
    place, turn, choose = jax.random.split(key, 3)
    starts = jax.vmap(lambda k: _random_start(bank, house, k))(jax.random.split(place, ATTEMPTS))
    lengths = jax.vmap(lambda p: geodesic_distance(bank, house, None, p))(starts)
    fits = (lengths >= min_length) & (lengths <= max_length) & jnp.isfinite(lengths)
    attempt = jnp.argmax(jnp.any(fits, axis=1)).astype(jnp.int32)  # the first that can be used
    weight = jnp.where(fits[attempt], jnp.float32(0), -jnp.inf)
    goal = jax.random.categorical(choose, jnp.where(jnp.any(fits[attempt]), weight, 0.0)).astype(jnp.int32)
    length = jnp.where(fits[attempt, goal], lengths[attempt, goal], jnp.float32(jnp.inf))
    return starts[attempt], random_yaw(turn), {"goal": goal, "length": length}


def _random_start(bank: HouseBank, house: Int[Array, ""], key: Array) -> Float[Array, "3"]:
    """Anywhere beside the middle of the cell that one of the house's starts is in [m]."""
    which, shift = jax.random.split(key)
    known = bank.navigation.start[bank.known_house(house)]
    point = known[jax.random.randint(which, (), 0, known.shape[0])]
    middle = place_position(bank, house, cell_of(bank, house, point))
    return jnp.append(middle[:2] + jax.random.uniform(shift, (2,), jnp.float32, -ASIDE, ASIDE), point[2])


def possible(bank: HouseBank, episode: Episodes) -> Bool[Array, ""]:
    """Whether the start lies on a floor, within the grid, in or beside a cell from which paths lead to the goals."""
    off = place_position(bank, episode.house, cell_of(bank, episode.house, episode.start)) - episode.start
    near = jnp.all(jnp.abs(off) < jnp.array([bank.spec.cell, bank.spec.cell, ON_FLOOR], jnp.float32))
    return near & near_home(bank, episode.house, episode.start)


def to_json(bank: HouseBank, house: int, columns: dict[str, Any]) -> dict[str, Any]:
    """The goal's place and the length of the shortest path."""
    goal = np.asarray(bank.navigation.goal[house, int(columns["goal"])])
    return {"goal": goal.tolist(), "length": float(columns["length"])}


def from_json(bank: HouseBank, house: int, line: dict[str, Any]) -> dict[str, Any]:
    """The goal of the bank at the line's place.

    Raises:
        DatasetError: The house has no goal there.
        KeyError, TypeError, ValueError: The line is broken.
    """
    place, length = np.array(line["goal"], float), float(line["length"])
    if place.shape != (3,) or not np.isfinite(place).all():
        raise ValueError("`goal` must be three finite numbers")
    if not 0 <= length < np.inf:
        raise ValueError("`length` must be a finite number that is not negative")
    away = np.linalg.norm(np.asarray(bank.navigation.goal[house]) - place, axis=-1)
    if away.min() > SAME_PLACE:
        raise DatasetError(f"house {line['house']} has no goal at {line['goal']}", hint=OTHER_BANK)
    return {"goal": int(away.argmin()), "length": length}
