"""Where an agent can stand: free grids of all levels, regions, rooms, portals, starts, goals, geodesic distances."""

import hashlib
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int, UInt16
from scipy import ndimage

from home_mjx.core.checks import check_flag, check_number
from home_mjx.errors import DatasetError
from home_mjx.scene_compile.geometry.boxes import BoxSet, footprint_distance
from home_mjx.scene_compile.geometry.polygons import inside_polygon, smallest_room
from home_mjx.scene_compile.navigation.geodesic import distance_fields
from home_mjx.scene_compile.navigation.portals import find_portals, room_hops
from home_mjx.scene_compile.navigation.regions import label_regions
from home_mjx.scene_compile.navigation.stairs import Stairs, stair_links
from home_mjx.schema.compiled import FIELD_FAR, FIELD_UNIT, Navigation, Rooms

LEVEL_APART = 1000  # [cells], between levels where goals are spread


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
        climb: Whether agents take stairs: then starts and goals lie on all levels that stairs join. The physics has
            no upper floors yet, so by default they lie on the ground floor.
    """

    cell: float = 0.1
    agent_radius: float = 0.1
    agent_height: float = 1.6
    margin: float = 0.05
    step: float = 0.03
    num_starts: int = 256
    num_goals: int = 32
    climb: bool = False

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
) -> FreeSpace:
    """Rooms of a level, and where in them an agent can stand.

    Args:
        rooms: Outlines and floors.
        obstacles: Upright boxes [m].
        passages: Footprints of doorways, interior as well where rooms leave a gap between them [m].
        options: Sizes.
        level: Level index; None for the lowest that has rooms.
    """
    level = int(rooms.level.min()) if level is None else level
    here = np.flatnonzero(rooms.level == level)
    origin, x, y = _grid(rooms.polygon, options.cell)
    room = _label_rooms(rooms, here, passages, x, y)
    clearance = _clearance(obstacles, rooms.floor[room], x, y, options)
    standable = (room >= 0) & (clearance >= options.agent_radius + options.margin)
    return FreeSpace(level, origin, x, y, room.astype(np.int16), standable)


def build_navigation(
    house_id: str,
    rooms: Rooms,
    spaces: Sequence[FreeSpace],
    options: NavigationOptions = NavigationOptions(),
    doorways: Sequence[Sequence[Float[np.ndarray, "4 2"]]] = (),
    stairs: Sequence[Stairs] = (),
) -> Navigation:
    """Regions, portals, starts, goals and distance fields on the free space of a house.

    Args:
        house_id: Seeds the draw of starts and goals.
        rooms: For the heights of their floors.
        spaces: Where an agent can stand on each level that has rooms, the lowest first.
        options: Counts.
        doorways: Footprints of the doors of each level [m]; none by default.
        stairs: Flights between the levels.

    Raises:
        DatasetError: An agent can stand nowhere on the ground floor.
    """
    ground = spaces[0]
    standable, room = np.stack([s.standable for s in spaces]), np.stack([s.room for s in spaces])
    if not ground.standable.any():
        raise DatasetError(
            f"house {house_id} has no place where an agent of radius {options.agent_radius} m can stand",
            hint="Leave this house out, or use a smaller agent.",
        )
    centres = ground.x, ground.y
    links = stair_links(stairs, standable, centres)
    region, area = label_regions(standable, links if options.climb else (), options.cell)
    home = region == 0
    portals = find_portals(rooms, room, standable, centres, doorways or [[] for _ in spaces], links)
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(house_id.encode()).digest()[:8], "little"))
    goals = _spread_goals(home, room, options.num_goals, rng)
    cells = rng.permutation(np.argwhere(home))[np.arange(options.num_starts) % home.sum()]
    jitter = rng.uniform(-0.5, 0.5, (options.num_starts, 2)) * options.margin
    return Navigation(
        origin=ground.origin,
        cell=options.cell,
        agent_radius=float(options.agent_radius),
        agent_height=float(options.agent_height),
        level=np.array([s.level for s in spaces], np.int32),
        floor=np.array([rooms.floor[rooms.level == s.level].min() for s in spaces]),
        region=region,
        region_area=area,
        room=room,
        start=_place(ground, rooms, room, cells, jitter),
        goal=_place(ground, rooms, room, goals, np.zeros((len(goals), 2))),
        field=_stored(distance_fields(home, goals, options.cell, links)),
        portals=portals,
        room_hops=room_hops(portals, len(rooms.type)),
    )


def _stored(distance: Float[np.ndarray, "c g"]) -> UInt16[np.ndarray, "c g"]:
    """Distances [m] as they are kept; those beyond 163 m are kept as that."""
    steps = np.minimum(np.round(distance / FIELD_UNIT), FIELD_FAR - 1)
    return np.where(np.isfinite(distance), steps, FIELD_FAR).astype(np.uint16)


def _place(
    space: FreeSpace,
    rooms: Rooms,
    room: Int[np.ndarray, "l ny nx"],
    cells: Int[np.ndarray, "n 3"],
    shift: Float[np.ndarray, "n 2"],
) -> Float[np.ndarray, "n 3"]:
    """Cells as points in the world, on the floor of their room."""
    _, row, column = cells.T
    z = rooms.floor[room[tuple(cells.T)]]
    return np.stack([space.x[column] + shift[:, 0], space.y[row] + shift[:, 1], z], axis=-1)


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


def _spread_goals(
    free: Bool[np.ndarray, "l ny nx"], room: Int[np.ndarray, "l ny nx"], count: int, rng: np.random.Generator
) -> Int[np.ndarray, "g 3"]:
    """Cells of goals: the rooms in turn, in each the one of some random cells that is farthest from earlier goals."""
    order = rng.permutation(np.unique(room[free]))
    goals = np.empty((count, 3), np.int64)
    for g in range(count):
        cells = np.argwhere(free & (room == order[g % len(order)]))
        candidates = cells[rng.integers(len(cells), size=32)]
        gaps = np.linalg.norm((candidates[:, None] - goals[None, :g]) * [LEVEL_APART, 1, 1], axis=-1)
        goals[g] = candidates[gaps.min(axis=1, initial=np.inf).argmax()]
    return goals
