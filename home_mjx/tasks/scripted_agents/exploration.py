"""Exploration: cover the floor of a house.

Coverage as the measure: Chen et al., "Learning Exploration Policies for Navigation", 2019 (arXiv:1903.01959).
"""

from dataclasses import dataclass, fields
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.core.pytree import Pytree
from home_mjx.navigation.grid import cell_at_feet, is_home_cell
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.experts.cell_search import seek_cells

TILE_EDGE = 0.5  # [m] edge length of a tile
MIN_COVER_RADIUS = 0.5  # [m] minimum cover radius: below it, a tile may not be coverable from any position


class Tiles(Pytree):
    """Floor of a house in tiles, per level, row and column."""

    free: Int[Array, "levels ty tx"]  # number of walkable cells in the tile
    room: Int[Array, "levels ty tx"]  # room of the walkable cell nearest to the tile's centre; -1 if none
    middle: Bool[Array, "levels rows columns"]  # mask of these nearest cells in the house's grids


class ExplorationState(Pytree):
    """Coverage of one episode; A agents."""

    free: Int[Array, "levels ty tx"]
    room: Int[Array, "levels ty tx"]
    covered: Bool[Array, "levels ty tx"]
    gained: Float[Array, " a"]  # [m²], area that each agent covered in the last step
    collisions: Int[Array, " a"]  # steps with `Snapshot.has_collided`

    def expert(self, snapshot: Snapshot) -> Array:
        """Return all agents' actions towards uncovered tiles, by `seek_cells`; `stop` if none is left."""
        tiles = divide_in_tiles(snapshot.bank, snapshot.house)
        left = _expand_to_cells(~self.covered, snapshot.bank)
        return seek_cells(snapshot, tiles.middle & left, left)


@dataclass(frozen=True)
class Exploration(Task):
    """Task of covering as much of the house's free floor as possible within the episode; several agents cooperate.

    The floor is divided into tiles of 0.5 m. A tile is covered once an agent was within `cover_radius` of its centre,
    in the same room. The episode ends at the time limit, or when all agents have stopped.

    Attributes:
        cover_radius: Distance from an agent within which tiles are covered [m].
        area_reward: Reward per square metre of free floor that an agent covers first.
        step_cost: Cost of every step.
        contact_cost: Cost of a step in which the agent touches anything but the floor.
        success_coverage: Minimum covered fraction of the floor for the metric `success`.
    """

    cover_radius: float = 2.0
    area_reward: float = 0.5
    step_cost: float = 0.01
    contact_cost: float = 0.01
    success_coverage: float = 0.9

    def __post_init__(self) -> None:
        for option in fields(self):
            check_number(option.name, getattr(self, option.name), 0)
        check_number("cover_radius", self.cover_radius, MIN_COVER_RADIUS)
        check_number("success_coverage", self.success_coverage, 0, 1)

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> ExplorationState:
        """Return the state with the tiles that are covered at the start."""
        tiles, zero = divide_in_tiles(snapshot.bank, snapshot.house), jnp.zeros_like(snapshot.pose.yaw)
        near = self._near(snapshot, tiles.room)
        return ExplorationState(
            free=tiles.free,
            room=tiles.room,
            covered=jnp.any(near, axis=0),
            gained=zero,
            collisions=zero.astype(jnp.int32),
        )

    def update(self, snapshot: Snapshot, state: ExplorationState) -> ExplorationState:
        """Add the tiles that agents cover now, and collisions; `gained` is each agent's newly covered area [m^2].

        A tile that several agents cover first in the same step counts for each of them.
        """
        near = self._near(snapshot, state.room)
        cells = jnp.sum(state.free[None] * (near & ~state.covered[None]), axis=(1, 2, 3))
        return state.replace(
            covered=state.covered | jnp.any(near, axis=0),
            gained=cells.astype(jnp.float32) * jnp.float32(snapshot.bank.spec.cell**2),
            collisions=state.collisions + snapshot.has_collided.astype(jnp.int32),
        )

    def reward(self, snapshot: Snapshot, before: ExplorationState, state: ExplorationState) -> Float[Array, " a"]:
        """Return `area_reward` times each agent's newly covered area, minus costs of step and contact."""
        terms = self.reward_terms(snapshot, before, state)
        return terms["area"] + (terms["steps"] + terms["contacts"])

    def reward_terms(
        self, snapshot: Snapshot, before: ExplorationState, state: ExplorationState
    ) -> dict[str, Float[Array, " a"]]:
        """Return the terms of `reward`; costs are negative."""
        return {
            "area": jnp.float32(self.area_reward) * state.gained,
            "steps": jnp.full_like(state.gained, -jnp.float32(self.step_cost)),
            "contacts": -jnp.float32(self.contact_cost) * snapshot.in_contact.astype(jnp.float32),
        }

    def metrics(self, snapshot: Snapshot, state: ExplorationState) -> dict[str, Float[Array, ""]]:
        """Return the covered fraction of the free floor, success (from `success_coverage` on), and mean collisions.

        A house without free floor has coverage 0.
        """
        whole = jnp.maximum(jnp.sum(state.free), 1).astype(jnp.float32)
        coverage = jnp.sum(state.free * state.covered).astype(jnp.float32) / whole
        return {
            "coverage": coverage,
            "success": (coverage >= jnp.float32(self.success_coverage)).astype(jnp.float32),
            "collisions": jnp.mean(state.collisions.astype(jnp.float32)),
        }

    def _near(self, snapshot: Snapshot, room: Int[Array, "levels ty tx"]) -> Bool[Array, "a levels ty tx"]:
        """Return which tiles each agent covers: centres in its room, on its level, at most `cover_radius` away in plan.

        Agents outside rooms cover none.
        """
        bank, house = snapshot.bank, snapshot.house
        edge = jnp.float32(_cells_per_edge(bank) * bank.spec.cell)
        levels, rows, columns = room.shape
        y, x = ((jnp.arange(n, dtype=jnp.float32) + 0.5) * edge for n in (rows, columns))

        def one(feet: Float[Array, "3"]) -> Bool[Array, "levels ty tx"]:
            """Return the mask of one agent."""
            at = cell_at_feet(bank, house, feet)
            own = bank.navigation.room[house, at[0], at[1], at[2]]
            local = feet[:2] - bank.navigation.origin[house]
            near = jnp.hypot((x - local[0])[None], (y - local[1])[:, None]) <= jnp.float32(self.cover_radius)
            here = (jnp.arange(levels) == at[0])[:, None, None] & (room == own) & (own >= 0)
            return near[None] & here

        return jax.vmap(one)(snapshot.feet)


def divide_in_tiles(bank: HouseBank, house: Int[Array, ""]) -> Tiles:
    """Return the tiles of a house's grids, by cells of its home region; see `Tiles`.

    Tiles begin at cell (0, 0); those at the far edges may extend beyond the grid, where nothing is free. Of equally
    near cells the one in the lowest row and column is the middle.
    """
    count, home = _cells_per_edge(bank), is_home_cell(bank, house, bank.navigation.cell[house])
    levels, rows, columns = home.shape
    place = (np.arange(count) + 0.5) / count - 0.5
    away = jnp.asarray(np.hypot(place[:, None], place[None]).ravel(), jnp.float32)
    parts, rooms = (_group_by_tile(values, count) for values in (home, bank.navigation.room[house]))
    best = jnp.argmin(jnp.where(parts, away, jnp.inf), axis=-1)
    any_ = jnp.any(parts, axis=-1)
    room = jnp.where(any_, jnp.take_along_axis(rooms, best[..., None], axis=-1)[..., 0], -1)
    chosen = (jnp.arange(count * count) == best[..., None]) & any_[..., None]
    whole = chosen.reshape(*best.shape, count, count).swapaxes(2, 3)
    whole = whole.reshape(levels, best.shape[1] * count, best.shape[2] * count)[:, :rows, :columns]
    return Tiles(free=jnp.sum(parts, axis=-1).astype(jnp.int32), room=room.astype(jnp.int32), middle=whole)


def _cells_per_edge(bank: HouseBank) -> int:
    """Return the number of cells along the edge of a tile, rounded, at least 1."""
    return max(round(TILE_EDGE / bank.spec.cell), 1)


def _group_by_tile(values: Array, count: int) -> Array:
    """Group cell values (levels, rows, columns) by tile (levels, ty, tx, cells), padded with 0 beyond the grid."""
    levels, rows, columns = values.shape
    values = jnp.pad(values, ((0, 0), (0, -rows % count), (0, -columns % count)))
    tiles = values.reshape(levels, values.shape[1] // count, count, values.shape[2] // count, count)
    return tiles.swapaxes(2, 3).reshape(levels, tiles.shape[1], tiles.shape[3], count * count)


def _expand_to_cells(tiles: Bool[Array, "levels ty tx"], bank: HouseBank) -> Bool[Any, "levels rows columns"]:
    """Return the cells of a house's grids, each with the value of its tile."""
    rows, columns = bank.navigation.room.shape[2:]
    return jnp.repeat(jnp.repeat(tiles, _cells_per_edge(bank), axis=1), _cells_per_edge(bank), axis=2)[
        :, :rows, :columns
    ]
