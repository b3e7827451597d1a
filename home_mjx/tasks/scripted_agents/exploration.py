"""Exploration: come near every part of the house.

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
from home_mjx.navigation.grid import cell_of, is_home
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.base.task import Task
from home_mjx.tasks.experts.explore import seek

TILE = 0.5  # [m], edge of what is covered at once
LEAST_RADIUS = 0.5  # [m]: less, and a tile might not be covered from anywhere


class Tiles(Pytree):
    """A house's floor in tiles, per level, row and column."""

    free: Int[Array, "levels ty tx"]  # cells in it where agents can walk
    room: Int[Array, "levels ty tx"]  # of the one of these cells that is nearest to its middle; -1 none
    middle: Bool[Array, "levels rows columns"]  # which cells of the house's grids these nearest ones are


class ExplorationState(Pytree):
    """What has been covered; A agents."""

    free: Int[Array, "levels ty tx"]
    room: Int[Array, "levels ty tx"]
    covered: Bool[Array, "levels ty tx"]
    gained: Float[Array, " a"]  # [m²], that each agent covered in the last step
    collisions: Int[Array, " a"]  # steps in which an agent touched anything but the floor

    def expert(self, snapshot: Snapshot) -> Array:
        """Towards the nearest tile that nobody has covered; `stop` where none is left."""
        tiles = tiles_of(snapshot.bank, snapshot.house)
        left = _of_cells(~self.covered, snapshot.bank)
        return seek(snapshot, tiles.middle & left, left)


@dataclass(frozen=True)
class Exploration(Task):
    """Cover as much of the house's free floor as the time allows; several agents do it together.

    The floor is divided into tiles of 0.5 m. One is covered once an agent was within `cover_radius` of its middle, in
    the same room. The episode ends with the time, or when all agents have stopped.

    Attributes:
        cover_radius: [m].
        area_reward: Per square metre of free floor that an agent covers first.
        step_cost: Taken every step.
        contact_cost: Taken while touching anything but the floor.
        success_coverage: Part of the floor from which on the metric `success` is 1.
    """

    cover_radius: float = 2.0
    area_reward: float = 0.5
    step_cost: float = 0.01
    contact_cost: float = 0.01
    success_coverage: float = 0.9

    def __post_init__(self) -> None:
        for option in fields(self):
            check_number(option.name, getattr(self, option.name), 0)
        check_number("cover_radius", self.cover_radius, LEAST_RADIUS)
        check_number("success_coverage", self.success_coverage, 0, 1)

    def init(self, snapshot: Snapshot, key: Array, columns: dict[str, Array] | None) -> ExplorationState:
        """What can be covered from the start."""
        tiles, zero = tiles_of(snapshot.bank, snapshot.house), jnp.zeros_like(snapshot.pose.yaw)
        near = self._near(snapshot, tiles.room)
        return ExplorationState(
            free=tiles.free,
            room=tiles.room,
            covered=jnp.any(near, axis=0),
            gained=zero,
            collisions=zero.astype(jnp.int32),
        )

    def update(self, snapshot: Snapshot, state: ExplorationState) -> ExplorationState:
        """What is covered now."""
        near = self._near(snapshot, state.room)
        cells = jnp.sum(state.free[None] * (near & ~state.covered[None]), axis=(1, 2, 3))
        return state.replace(
            covered=state.covered | jnp.any(near, axis=0),
            gained=cells.astype(jnp.float32) * jnp.float32(snapshot.bank.spec.cell**2),
            collisions=state.collisions + snapshot.contact.astype(jnp.int32),
        )

    def reward(self, snapshot: Snapshot, before: ExplorationState, state: ExplorationState) -> Float[Array, " a"]:
        """The area, less costs."""
        costs = jnp.float32(self.step_cost) + jnp.float32(self.contact_cost) * snapshot.contact.astype(jnp.float32)
        return jnp.float32(self.area_reward) * state.gained - costs

    def metrics(self, snapshot: Snapshot, state: ExplorationState) -> dict[str, Float[Array, ""]]:
        """Part of the free floor that is covered, whether that is enough, collisions."""
        whole = jnp.maximum(jnp.sum(state.free), 1).astype(jnp.float32)
        coverage = jnp.sum(state.free * state.covered).astype(jnp.float32) / whole
        return {
            "coverage": coverage,
            "success": (coverage >= jnp.float32(self.success_coverage)).astype(jnp.float32),
            "collisions": jnp.mean(state.collisions.astype(jnp.float32)),
        }

    def _near(self, snapshot: Snapshot, room: Int[Array, "levels ty tx"]) -> Bool[Array, "a levels ty tx"]:
        """Which tiles each agent covers from where it is."""
        bank, house = snapshot.bank, snapshot.house
        edge = jnp.float32(_cells(bank) * bank.spec.cell)
        levels, rows, columns = room.shape
        y, x = ((jnp.arange(n, dtype=jnp.float32) + 0.5) * edge for n in (rows, columns))

        def one(pos: Float[Array, "3"]) -> Bool[Array, "levels ty tx"]:
            at = cell_of(bank, house, pos)
            own = bank.navigation.room[house, at[0], at[1], at[2]]
            local = pos[:2] - bank.navigation.origin[house]
            near = jnp.hypot((x - local[0])[None], (y - local[1])[:, None]) <= jnp.float32(self.cover_radius)
            here = (jnp.arange(levels) == at[0])[:, None, None] & (room == own) & (own >= 0)
            return near[None] & here

        return jax.vmap(one)(snapshot.pose.pos)


def tiles_of(bank: HouseBank, house: Int[Array, ""]) -> Tiles:
    """The tiles of a house."""
    count, home = _cells(bank), is_home(bank, house, bank.navigation.cell[house])
    levels, rows, columns = home.shape
    place = (np.arange(count) + 0.5) / count - 0.5
    away = jnp.asarray(np.hypot(place[:, None], place[None]).ravel(), jnp.float32)
    parts, rooms = (_in_tiles(values, count) for values in (home, bank.navigation.room[house]))
    best = jnp.argmin(jnp.where(parts, away, jnp.inf), axis=-1)
    any_ = jnp.any(parts, axis=-1)
    room = jnp.where(any_, jnp.take_along_axis(rooms, best[..., None], axis=-1)[..., 0], -1)
    chosen = (jnp.arange(count * count) == best[..., None]) & any_[..., None]
    whole = chosen.reshape(*best.shape, count, count).swapaxes(2, 3)
    whole = whole.reshape(levels, best.shape[1] * count, best.shape[2] * count)[:, :rows, :columns]
    return Tiles(free=jnp.sum(parts, axis=-1).astype(jnp.int32), room=room.astype(jnp.int32), middle=whole)


def _cells(bank: HouseBank) -> int:
    """Cells along the edge of a tile."""
    return max(round(TILE / bank.spec.cell), 1)


def _in_tiles(values: Array, count: int) -> Array:
    """Values of cells (levels, rows, columns) as (levels, ty, tx, cells of a tile); beyond the grid they are 0."""
    levels, rows, columns = values.shape
    values = jnp.pad(values, ((0, 0), (0, -rows % count), (0, -columns % count)))
    tiles = values.reshape(levels, values.shape[1] // count, count, values.shape[2] // count, count)
    return tiles.swapaxes(2, 3).reshape(levels, tiles.shape[1], tiles.shape[3], count * count)


def _of_cells(tiles: Bool[Array, "levels ty tx"], bank: HouseBank) -> Bool[Any, "levels rows columns"]:
    """The value of the tile that each cell is in."""
    rows, columns = bank.navigation.room.shape[2:]
    return jnp.repeat(jnp.repeat(tiles, _cells(bank), axis=1), _cells(bank), axis=2)[:, :rows, :columns]
