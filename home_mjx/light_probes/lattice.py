"""Positions of probes: one lattice per room, so that light is never interpolated through a wall."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import KDTree

from home_mjx.geometry.polygons import is_inside_polygon
from home_mjx.schema.compiled import RoomTable

WALL_GAP = 0.05  # [m], distance of the outermost probes from the bounds of a room
FACADE_GAP = 0.15  # [m], distance from a room's probes beyond which a wall that faces away is outdoors
DEFAULT_HEIGHT = 2.5  # [m], assumed where a room has no ceiling
NUM_DONORS = 4  # valid probes from which an invalid one gets its light


@dataclass(frozen=True)
class ProbeLattice:
    """Probes of all rooms of a house. A room's probes follow each other, z fastest, then y.

    Attributes:
        pos: Positions [m].
        room: Room of each probe.
        inside: Whether it is inside the room's outline.
        first: First probe of each room; -1 for rooms without an outline.
        origin: Position of the first probe [m].
        step: Distance to the next along each axis [m].
        count: Number along each axis.
    """

    pos: Float[np.ndarray, "p 3"]
    room: Int[np.ndarray, " p"]
    inside: Bool[np.ndarray, " p"]
    first: Int[np.ndarray, " r"]
    origin: Float[np.ndarray, "r 3"]
    step: Float[np.ndarray, "r 3"]
    count: Int[np.ndarray, "r 3"]


def place_probes(rooms: RoomTable, spacing: float) -> ProbeLattice:
    """Place probes about `spacing` [m] apart over the bounds of each room, from `WALL_GAP` within them on."""
    number = len(rooms.type)
    first, count = np.full(number, -1, np.int32), np.ones((number, 3), np.int32)
    origin, step = np.zeros((number, 3), np.float32), np.ones((number, 3), np.float32)
    pos, room, inside, total = [np.zeros((0, 3))], [np.zeros(0, np.int32)], [np.zeros(0, bool)], 0
    for r in (r for r in range(number) if len(rooms.polygon[r]) >= 3):
        low, high = _bounds(rooms, r)
        count[r] = np.maximum(np.round((high - low) / spacing).astype(int) + 1, 2)
        first[r], origin[r], step[r] = total, low, (high - low) / (count[r] - 1)
        grid = np.stack(np.meshgrid(*(np.arange(n) for n in count[r]), indexing="ij"), -1).reshape(-1, 3)
        pos.append(origin[r] + grid * step[r])
        room.append(np.full(len(grid), r, np.int32))
        inside.append(is_inside_polygon(rooms.polygon[r], pos[-1][:, :2]))
        total += len(grid)
    return ProbeLattice(
        np.concatenate(pos).astype(np.float32), np.concatenate(room), np.concatenate(inside), first, origin, step, count
    )


def _bounds(rooms: RoomTable, room: int) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Return the lowest and the highest position of a room's probes [m]."""
    outline, floor, ceiling = rooms.polygon[room], float(rooms.floor[room]), float(rooms.ceiling[room])
    ceiling = ceiling if np.isfinite(ceiling) and ceiling > floor else floor + DEFAULT_HEIGHT
    low, high = np.append(outline.min(axis=0), floor), np.append(outline.max(axis=0), ceiling)
    gap = np.minimum(WALL_GAP, (high - low) / 4)
    return low + gap, high - gap


def find_donors(
    lattice: ProbeLattice, valid: Bool[np.ndarray, " p"]
) -> tuple[Int[np.ndarray, " q"], Int[np.ndarray, "q k"], Float[np.ndarray, "q k"]]:
    """Return the invalid probes, for each the nearest valid ones of its room, and their weights, whose sum is 1.

    Where a room has no valid probe the weights are 0.
    """
    missing = np.flatnonzero(~valid)
    donor, weight = np.zeros((len(missing), NUM_DONORS), np.int64), np.zeros((len(missing), NUM_DONORS), np.float32)
    for room in np.unique(lattice.room[missing]):
        good, rows = np.flatnonzero(valid & (lattice.room == room)), np.flatnonzero(lattice.room[missing] == room)
        if len(good):
            apart, near = KDTree(lattice.pos[good]).query(lattice.pos[missing[rows]], NUM_DONORS)
            found = np.where(np.isfinite(apart), 1 / np.maximum(apart, 1e-3) ** 2, 0.0)
            donor[rows] = good[np.minimum(near, len(good) - 1)]
            weight[rows] = found / found.sum(axis=1, keepdims=True)
    return missing, donor, weight


def find_inner(lattice: ProbeLattice, axis: int, side: int) -> tuple[Int[np.ndarray, " n"], Int[np.ndarray, " n"]]:
    """Return the outermost probes of all rooms along x or y (`axis`) on one `side`, -1 or 1, and those next to them."""
    count = lattice.count[lattice.room]
    own = np.arange(len(lattice.room)) - lattice.first[lattice.room]
    stride = count[:, 2] if axis == 1 else count[:, 1] * count[:, 2]
    place = own // stride % count[:, axis]
    rows = np.flatnonzero(place == np.where(side < 0, 0, count[:, axis] - 1))
    return rows, rows - side * stride[rows]


def locate(
    lattice: ProbeLattice, pos: Float[np.ndarray, "n 3"], room: Int[np.ndarray, " n"]
) -> tuple[Int[np.ndarray, " n"], Float[np.ndarray, "n 3"]]:
    """Return the first of the eight probes around points of rooms, and the fractions to the next; -1 without probes."""
    row = np.maximum(room, 0)
    place = np.clip((pos - lattice.origin[row]) / lattice.step[row], 0, lattice.count[row] - 1)
    low = np.minimum(place.astype(np.int64), lattice.count[row] - 2)
    _, ny, nz = np.moveaxis(lattice.count[row], 1, 0)
    cell = lattice.first[row] + (low[:, 0] * ny + low[:, 1]) * nz + low[:, 2]
    return np.where((room >= 0) & (lattice.first[row] >= 0), cell, -1), (place - low).astype(np.float32)


def is_facade(
    lattice: ProbeLattice, pos: Float[np.ndarray, "n 3"], normal: Float[np.ndarray, "n 3"], room: Int[np.ndarray, " n"]
) -> Bool[np.ndarray, " n"]:
    """Return whether points are on outer sides of walls: beyond the bounds of their room, facing away from it."""
    row = np.maximum(room, 0)
    low = lattice.origin[row] - FACADE_GAP
    high = lattice.origin[row] + lattice.step[row] * (lattice.count[row] - 1) + FACADE_GAP
    beyond = ((pos > high) & (normal > 0.5)) | ((pos < low) & (normal < -0.5))
    return np.any(beyond, axis=1)
