"""Episodes drawn beforehand: house, start, goal and shortest path, to be replayed and compared."""

import json
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.core.pytree import Pytree
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.navigation.grid import cell_of, geodesic_distance, place_position, random_position

SAME_PLACE = 0.01  # [m]: a goal of the bank is the goal of a file if it is as near
OTHER_BANK = "Use a bank of the houses that the episodes were drawn in, compiled alike."
ON_FLOOR = 0.3  # [m]: starts are no farther from a floor
ATTEMPTS = 64  # draws per episode


class Episodes(Pytree):
    """Many episodes, or one of them without the leading axis.

    Starts are settled: they lie on the floor in free space, and houses are compiled with movable objects at rest.
    """

    house: Int[Array, "*e"]  # index into the bank
    start: Float[Array, "*e 3"]  # [m], on the floor
    yaw: Float[Array, "*e"]  # [rad]
    goal: Int[Array, "*e"]  # index into the goals of the house, and so of its distance field
    length: Float[Array, "*e"]  # [m], shortest path

    def pick(self, index: Int[Array, "..."]) -> "Episodes":
        """One episode, or some; also inside `jit`."""
        return jax.tree.map(lambda rows: rows[index], self)


def sample_episodes(
    bank: HouseBank, num: int, seed: int = 0, *, min_length: float = 1.0, max_length: float = np.inf
) -> Episodes:
    """Random episodes: every house as often as any other, starts by area, goals of the house's own.

    Args:
        bank: The houses.
        num: How many.
        seed: Of the draw.
        min_length: Least shortest path [m].
        max_length: Greatest shortest path [m].

    Raises:
        ConfigError: No path of such a length was found for one of them.

    Example:
        >>> episodes = sample_episodes(env.bank, 1000, min_length=2.0)  # doctest: +SKIP
        >>> states = jax.vmap(env.reset)(keys, episodes.pick(jnp.arange(64)))  # doctest: +SKIP
    """
    check_number("num", num, 1, whole=True)
    keys = jax.random.split(jax.random.key(seed), num)
    house = jnp.arange(num, dtype=jnp.int32) % bank.num_houses
    episodes = _draw(bank, house, keys, jnp.float32(min_length), jnp.float32(max_length))
    lost = np.flatnonzero(~np.isfinite(np.asarray(episodes.length)))
    if len(lost):
        name = _house_ids(bank)[int(house[lost[0]])]
        raise ConfigError(
            f"house {name} has hardly a path of {min_length} m to {max_length} m",
            hint="Choose other lengths, or other houses.",
        )
    return episodes


@jax.jit
def _draw(bank: HouseBank, house: Array, keys: Array, low: Float[Array, ""], high: Float[Array, ""]) -> Episodes:
    def one(house: Int[Array, ""], key: Array) -> Episodes:
        place, turn, choose = jax.random.split(key, 3)
        starts = jax.vmap(lambda k: random_position(bank, house, k))(jax.random.split(place, ATTEMPTS))
        lengths = jax.vmap(lambda p: geodesic_distance(bank, house, None, p))(starts)
        fits = (lengths >= low) & (lengths <= high) & jnp.isfinite(lengths)
        attempt = jnp.argmax(jnp.any(fits, axis=1)).astype(jnp.int32)  # the first that can be used
        weight = jnp.where(fits[attempt], jnp.float32(0), -jnp.inf)
        goal = jax.random.categorical(choose, jnp.where(jnp.any(fits[attempt]), weight, 0.0)).astype(jnp.int32)
        length = jnp.where(fits[attempt, goal], lengths[attempt, goal], jnp.float32(jnp.inf))
        yaw = jax.random.uniform(turn, (), jnp.float32, -jnp.pi, jnp.pi)
        return Episodes(house=house, start=starts[attempt], yaw=yaw, goal=goal, length=length)

    return jax.vmap(one)(house, keys)


def save_episodes(path: str | Path, bank: HouseBank, episodes: Episodes) -> None:
    """Writes episodes as JSON lines, with ids and places instead of indices, so that any bank of the houses will do."""
    ids, goals = _house_ids(bank), np.asarray(bank.navigation.goal)
    e = jax.tree.map(np.asarray, episodes)
    lines = [
        {
            "house": ids[e.house[i]],
            "start": e.start[i].tolist(),
            "yaw": float(e.yaw[i]),
            "goal": goals[e.house[i], e.goal[i]].tolist(),
            "length": float(e.length[i]),
        }
        for i in range(len(e.house))
    ]
    try:
        Path(path).write_text("".join(json.dumps(line) + "\n" for line in lines), encoding="utf-8")
    except OSError as error:
        raise ConfigError(f"episodes cannot be written: {error.strerror}", file=path) from None


def load_episodes(path: str | Path, bank: HouseBank) -> Episodes:
    """Reads what `save_episodes` has written.

    Args:
        path: The file.
        bank: Holds the houses, compiled with the same options.

    Raises:
        DatasetError: A line is broken, names a house that the bank lacks or a goal that the house lacks, or starts
            where no way leads to the goal.
    """
    index = {name: i for i, name in enumerate(_house_ids(bank))}
    goals = np.asarray(bank.navigation.goal)
    rows = []
    for number, line in enumerate(_lines(path), 1):
        try:
            rows.append(_row(json.loads(line), index, goals))
        except DatasetError as error:
            raise DatasetError(error.message, file=path, element=f"line {number}", hint=error.hint) from None
        except (ValueError, KeyError, TypeError) as error:
            what = f"`{error.args[0]}` is missing" if isinstance(error, KeyError) else str(error)
            raise DatasetError(f"no episode: {what}", file=path, element=f"line {number}") from None
    if not rows:
        raise DatasetError("file holds no episode", file=path)
    house, start, yaw, goal, length = (np.array(column) for column in zip(*rows, strict=True))
    reals = {"start": start, "yaw": yaw, "length": length}
    whole = {"house": house, "goal": goal}
    episodes = Episodes(
        **{name: jnp.asarray(values, jnp.float32) for name, values in reals.items()},
        **{name: jnp.asarray(values, jnp.int32) for name, values in whole.items()},
    )
    lost = np.flatnonzero(~np.asarray(_are_possible(bank, episodes)))
    if len(lost):
        message = "from its start no agent can walk to its goal"
        raise DatasetError(message, file=path, element=f"line {lost[0] + 1}", hint=OTHER_BANK)
    return episodes


@jax.jit
def _are_possible(bank: HouseBank, episodes: Episodes) -> Bool[Array, " e"]:
    """Whether starts are on a floor, within the grid, in or beside a cell that has a path to the goal."""

    def one(e: Episodes) -> Bool[Array, ""]:
        off = place_position(bank, e.house, cell_of(bank, e.house, e.start)) - e.start
        near = jnp.all(jnp.abs(off) < jnp.array([bank.spec.cell, bank.spec.cell, ON_FLOOR], jnp.float32))
        return near & jnp.isfinite(geodesic_distance(bank, e.house, e.goal, e.start))

    return jax.vmap(one)(episodes)


def _lines(path: str | Path) -> list[str]:
    try:
        return Path(path).read_text(encoding="utf-8").splitlines()
    except (OSError, ValueError) as error:
        raise DatasetError(f"episodes cannot be read: {error}", file=path) from None


def _row(line: dict[str, Any], index: dict[str, int], goals: Float[np.ndarray, "h g 3"]) -> tuple:
    if line["house"] not in index:
        raise DatasetError(f"the bank has no house {line['house']}", hint=OTHER_BANK)
    house = index[line["house"]]
    start, place = np.array(line["start"], float), np.array(line["goal"], float)
    if start.shape != (3,) or place.shape != (3,) or not np.isfinite([*start, *place]).all():
        raise ValueError("`start` and `goal` must be three finite numbers")
    away = np.linalg.norm(goals[house] - place, axis=-1)
    if away.min() > SAME_PLACE:
        raise DatasetError(f"house {line['house']} has no goal at {line['goal']}", hint=OTHER_BANK)
    yaw, length = float(line["yaw"]), float(line["length"])
    if not np.isfinite(yaw) or not 0 <= length < np.inf:
        raise ValueError("`yaw` must be a finite number, `length` one that is not negative")
    return house, start, yaw, int(away.argmin()), length


def _house_ids(bank: HouseBank) -> list[str]:
    return [bytes(row).rstrip(b"\0").decode() for row in np.asarray(bank.house_id)]
