"""Where an agent can stand on the ground floor: free grid, rooms, starts, goals and geodesic distances."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.errors import DatasetError
from home_mjx.scene_compile.boxes import BoxSet, footprint_distance
from home_mjx.scene_compile.compiled import Navigation, Rooms
from home_mjx.scene_compile.geodesic import distance_fields
from home_mjx.scene_compile.plan import inside_polygon, smallest_room


@dataclass(frozen=True)
class NavigationOptions:
    """How free space is found.

    Attributes:
        cell: Edge of a grid cell [m].
        agent_radius: [m].
        agent_height: [m].
        margin: Clearance beyond the radius [m]: starts are drawn up to half of it from their cell's centre.
        step: Obstacles lower than this above the floor do not count [m].
        num_starts: Start points drawn.
        num_goals: Goals, each with a distance field.
    """

    cell: float = 0.1
    agent_radius: float = 0.1
    agent_height: float = 1.6
    margin: float = 0.05
    step: float = 0.03
    num_starts: int = 256
    num_goals: int = 8


@dataclass(frozen=True)
class FreeSpace:
    """The grid before anything is drawn on it."""

    origin: Float[np.ndarray, "2"]  # [m], corner of cell (0, 0)
    x: Float[np.ndarray, " nx"]  # [m], of cell centres
    y: Float[np.ndarray, " ny"]
    room: Int[np.ndarray, "ny nx"]
    free: Bool[np.ndarray, "ny nx"]


def free_space(
    rooms: Rooms,
    obstacles: BoxSet,
    passages: Sequence[Float[np.ndarray, "4 2"]] = (),
    options: NavigationOptions = NavigationOptions(),
) -> FreeSpace:
    """Rooms and the largest connected free region of a house's ground floor.

    Args:
        rooms: Outlines and floors; those of the lowest level count.
        obstacles: Upright boxes [m].
        passages: Footprints of doorways, interior as well where rooms leave a gap between them [m].
        options: Sizes.
    """
    ground = np.flatnonzero(rooms.level == rooms.level.min())
    origin, x, y = _grid([rooms.polygon[r] for r in ground], options.cell)
    room = _label_rooms(rooms, ground, passages, x, y)
    clearance = _clearance(obstacles, rooms.floor[room], x, y, options)
    free = _largest_region((room >= 0) & (clearance >= options.agent_radius + options.margin))
    return FreeSpace(origin, x, y, room, free)


def build_navigation(
    house_id: str, rooms: Rooms, space: FreeSpace, options: NavigationOptions = NavigationOptions()
) -> Navigation:
    """Starts, goals and distance fields on the free space of a house.

    Args:
        house_id: Seeds the draw of starts and goals.
        rooms: For the heights of their floors.
        space: Where an agent can stand.
        options: Counts.

    Raises:
        DatasetError: An agent can stand nowhere in the house.
    """
    free, room = space.free, space.room
    if not free.any():
        raise DatasetError(
            f"house {house_id} has no place where an agent of radius {options.agent_radius} m can stand",
            hint="Leave this house out, or use a smaller agent.",
        )
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(house_id.encode()).digest()[:8], "little"))
    goals = _spread_goals(free, room, options.num_goals, rng)
    cells = rng.permutation(np.argwhere(free))[np.arange(options.num_starts) % free.sum()]
    jitter = rng.uniform(-0.5, 0.5, (options.num_starts, 2)) * options.margin
    return Navigation(
        origin=space.origin,
        cell=options.cell,
        free=free,
        room=room,
        start=_place(space, rooms, cells, jitter),
        goal=_place(space, rooms, goals, np.zeros((len(goals), 2))),
        field=distance_fields(free, goals, options.cell).astype(np.float32),
    )


def _place(
    space: FreeSpace, rooms: Rooms, cells: Int[np.ndarray, "n 2"], shift: Float[np.ndarray, "n 2"]
) -> Float[np.ndarray, "n 3"]:
    """Cells as points in the world, on the floor of their room."""
    row, column = cells.T
    z = rooms.floor[space.room[row, column]]
    return np.stack([space.x[column] + shift[:, 0], space.y[row] + shift[:, 1], z], axis=-1)


def _grid(
    polygons: Sequence[Float[np.ndarray, "_ 2"]], cell: float
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]]:
    """Corner of the grid and the coordinates of its cell centres."""
    points = np.concatenate(polygons)
    origin = np.floor(points.min(axis=0) / cell) * cell
    nx, ny = np.ceil((points.max(axis=0) - origin) / cell).astype(int)
    return origin, origin[0] + (np.arange(nx) + 0.5) * cell, origin[1] + (np.arange(ny) + 0.5) * cell


def _label_rooms(
    rooms: Rooms,
    ground: Int[np.ndarray, " r"],
    passages: Sequence[Float[np.ndarray, "4 2"]],
    x: Float[np.ndarray, " nx"],
    y: Float[np.ndarray, " ny"],
) -> Int[np.ndarray, "ny nx"]:
    points = np.stack(np.meshgrid(x, y), axis=-1)
    room = smallest_room(rooms, ground, points)
    gap = np.zeros(room.shape, bool)
    for passage in passages:
        gap |= inside_polygon(passage, points)
    nearest = np.asarray(ndimage.distance_transform_edt(room < 0, return_distances=False, return_indices=True))
    return np.where(gap, room[nearest[0], nearest[1]], room)


def _clearance(
    obstacles: BoxSet,
    floor: Float[np.ndarray, "ny nx"],
    x: Float[np.ndarray, " nx"],
    y: Float[np.ndarray, " ny"],
    options: NavigationOptions,
) -> Float[np.ndarray, "ny nx"]:
    """Distance from every cell's centre to the nearest obstacle at the height of an agent, as far as it matters [m].

    An agent is as high as the floor of the cell's own room: rooms may lie at different heights, or lack a floor.
    """
    reach = options.agent_radius + options.margin
    clearance = np.full((len(y), len(x)), np.inf)
    low, high = obstacles.bottom, obstacles.top
    for i in np.flatnonzero((high > floor.min() + options.step) & (low < floor.max() + options.agent_height)).tolist():
        radius = np.hypot(*obstacles.half[i, :2]) + reach
        columns = np.flatnonzero(abs(x - obstacles.center[i, 0]) <= radius)
        rows = np.flatnonzero(abs(y - obstacles.center[i, 1]) <= radius)
        if len(columns) and len(rows):
            window = np.ix_(rows, columns)
            points = np.stack(np.meshgrid(x[columns], y[rows]), axis=-1)
            near = footprint_distance(obstacles, i, points)
            met = (high[i] > floor[window] + options.step) & (low[i] < floor[window] + options.agent_height)
            clearance[window] = np.minimum(clearance[window], np.where(met, near, np.inf))
    return clearance


def _largest_region(free: Bool[np.ndarray, "ny nx"]) -> Bool[np.ndarray, "ny nx"]:
    labels = np.zeros(free.shape, np.int32)
    ndimage.label(free, output=labels)
    sizes = np.bincount(labels.ravel())
    sizes[0] = 0
    return free & (labels == sizes.argmax())


def _spread_goals(
    free: Bool[np.ndarray, "ny nx"], room: Int[np.ndarray, "ny nx"], count: int, rng: np.random.Generator
) -> Int[np.ndarray, "g 2"]:
    """Cells of goals: the rooms in turn, in each the one of some random cells that is farthest from earlier goals."""
    order = rng.permutation(np.unique(room[free]))
    goals = np.empty((count, 2), np.int64)
    for g in range(count):
        cells = np.argwhere(free & (room == order[g % len(order)]))
        candidates = cells[rng.integers(len(cells), size=32)]
        gaps = np.linalg.norm(candidates[:, None] - goals[None, :g], axis=-1)
        goals[g] = candidates[gaps.min(axis=1, initial=np.inf).argmax()]
    return goals
