"""Where an agent can stand on a level: its grid, rooms and free cells."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.core.checks import check_flag, check_number
from home_mjx.geometry.boxes import BoxSet, footprint_distance
from home_mjx.geometry.polygons import inside_polygon, smallest_room
from home_mjx.scene_compile.objects.stairs import Stairs
from home_mjx.schema.compiled import Rooms


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
        climb: Whether agents take stairs: then starts and goals lie on all levels that stairs join; otherwise stairs
            are obstacles, and starts and goals lie on the ground floor.
    """

    cell: float = 0.1
    agent_radius: float = 0.1
    agent_height: float = 1.6
    margin: float = 0.05
    step: float = 0.03
    num_starts: int = 256
    num_goals: int = 32
    climb: bool = True

    def __post_init__(self) -> None:
        check_number("cell", self.cell, 0.01, 10)
        for name in ("agent_radius", "agent_height", "margin", "step"):
            check_number(name, getattr(self, name), 0)
        for name in ("num_starts", "num_goals"):
            check_number(name, getattr(self, name), 1, whole=True)
        check_flag("climb", self.climb)


@dataclass(frozen=True)
class FreeSpace:
    """The grid of one level before anything is drawn on it; all levels of a house have the same extent."""

    level: int
    origin: Float[np.ndarray, "2"]  # [m], corner of cell (0, 0)
    x: Float[np.ndarray, " nx"]  # [m], of cell centres
    y: Float[np.ndarray, " ny"]
    room: Int[np.ndarray, "ny nx"]
    standable: Bool[np.ndarray, "ny nx"]
    narrow: Bool[np.ndarray, "ny nx"]  # where its axis may be without the margin
    enterable: Bool[np.ndarray, "ny nx"]  # also where things stand that can be moved
    height: Float[np.ndarray, "ny nx"]  # [m], of the floor or ramp in a room; anything elsewhere
    on_ramp: Bool[np.ndarray, "ny nx"]

    @cached_property
    def free(self) -> Bool[np.ndarray, "ny nx"]:
        """The largest connected region of it."""
        labels = np.zeros(self.standable.shape, np.int32)
        ndimage.label(self.standable, output=labels)
        sizes = np.bincount(labels.ravel())
        sizes[0] = 0
        return self.standable & (labels == sizes.argmax())


def free_space(
    rooms: Rooms,
    obstacles: BoxSet,
    passages: Sequence[Float[np.ndarray, "4 2"]] = (),
    options: NavigationOptions = NavigationOptions(),
    level: int | None = None,
    upstairs: Sequence[Stairs] = (),
    downstairs: Sequence[Stairs] = (),
    fixed: BoxSet | None = None,
) -> FreeSpace:
    """Rooms of a level, and where in them an agent can stand.

    Args:
        rooms: Outlines and floors.
        obstacles: Upright boxes [m].
        passages: Footprints of doorways, interior as well where rooms leave a gap between them [m].
        options: Sizes.
        level: Level index; None for the lowest that has rooms.
        upstairs: Stairs that begin here.
        downstairs: Stairs that end here.
        fixed: Obstacles that cannot be moved; None: none can.
    """
    level = int(rooms.level.min()) if level is None else level
    here = np.flatnonzero(rooms.level == level)
    origin, x, y = _grid(rooms.polygon, options.cell)
    treads = [top for stairs in downstairs for top in stairs.top]
    room = _label_rooms(rooms, here, [*passages, *treads], x, y)
    height, on_ramp, owned = rooms.floor[room], np.zeros(room.shape, bool), np.zeros(room.shape, bool)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    for stairs, end, here in _shares(upstairs, downstairs, points, options.cell):
        # Under the head of stairs that others come out of there is a floor, or the other stairs.
        over = here if stairs.stacked and end == 0 else stairs.contains(points)
        mine = here | (over & ~owned)
        room, height = np.where(mine, stairs.room[end], room), np.where(mine, stairs.surface(points), height)
        on_ramp, owned = on_ramp | over, owned | here
    reach = options.agent_radius + options.margin
    heights = options.step, options.agent_height
    away = clearance(obstacles, height, x, y, heights, reach)
    inside, sure = (room >= 0) & (owned | ~on_ramp), away >= reach
    # An agent's axis may be beside the cell's centre.
    near = max(options.agent_radius - options.cell / 2, 0)
    narrow = inside & (sure | (away > near))
    enterable = (
        narrow | (inside & (clearance(fixed, height, x, y, heights, reach) > near)) if fixed is not None else narrow
    )
    return FreeSpace(level, origin, x, y, room.astype(np.int16), inside & sure, narrow, enterable, height, on_ramp)


def _shares(
    upstairs: Sequence[Stairs], downstairs: Sequence[Stairs], points: Float[np.ndarray, "ny nx 2"], cell: float
) -> Iterator[tuple[Stairs, int, Bool[np.ndarray, "ny nx"]]]:
    """Stairs of a level, the end at which they meet it, and which cells over them belong to it.

    Both levels have the cells around the split, where one goes on in the other. Where stairs come out under others,
    cells have one surface only: the lower one up to the split, and beyond a gap the upper one, which the next level
    has that much farther down.
    """
    under = any(stairs.stacked for stairs in upstairs)
    below = [
        (stairs, 1, stairs.reaches(points, 1, (0.0 if under else 3.5 if stairs.stacked else 1.5) * cell))
        for stairs in downstairs
    ]
    taken = np.any([here for _, _, here in below], axis=0) if below else np.zeros(points.shape[:2], bool)
    for stairs in upstairs:
        here = stairs.reaches(points, 0, 1.5 * cell)
        if stairs.stacked:
            here &= np.logical_not(ndimage.binary_dilation(taken, np.ones((3, 3))))
        yield stairs, 0, here
    yield from below


def _grid(
    polygons: Sequence[Float[np.ndarray, "_ 2"]], cell: float
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]]:
    """Corner of the grid and the coordinates of its cell centres."""
    points = np.concatenate(list(polygons))
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


def clearance(
    obstacles: BoxSet,
    floor: Float[np.ndarray, "ny nx"],
    x: Float[np.ndarray, " nx"],
    y: Float[np.ndarray, " ny"],
    heights: tuple[float, float],
    reach: float,
) -> Float[np.ndarray, "ny nx"]:
    """Distance from every cell's centre to the nearest obstacle at the height of an agent, as far as it matters [m].

    Args:
        obstacles: Upright boxes.
        floor: Height of the floor of each cell's own room [m]: rooms may lie at different heights, or lack a floor.
        x: Of the cells' centres [m].
        y: The same.
        heights: Above the floor, between which obstacles count [m].
        reach: Distances up to this are exact [m], greater ones at least as great as this.
    """
    found = np.full((len(y), len(x)), np.inf)
    low, high = obstacles.bottom, obstacles.top
    for i in np.flatnonzero((high > floor.min() + heights[0]) & (low < floor.max() + heights[1])).tolist():
        radius = np.hypot(*obstacles.half[i, :2]) + reach
        columns = np.flatnonzero(abs(x - obstacles.center[i, 0]) <= radius)
        rows = np.flatnonzero(abs(y - obstacles.center[i, 1]) <= radius)
        if len(columns) and len(rows):
            window = np.ix_(rows, columns)
            points = np.stack(np.meshgrid(x[columns], y[rows]), axis=-1)
            near = footprint_distance(obstacles, i, points)
            met = (high[i] > floor[window] + heights[0]) & (low[i] < floor[window] + heights[1])
            found[window] = np.minimum(found[window], np.where(met, near, np.inf))
    return found
