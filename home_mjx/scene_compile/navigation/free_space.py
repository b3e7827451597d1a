"""Free space of agents on a level: its grid, rooms and free cells."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.core.checks import check_flag, check_number
from home_mjx.errors import DatasetError
from home_mjx.geometry.boxes import BoxSet
from home_mjx.geometry.polygons import find_smallest_room, is_inside_polygon
from home_mjx.scene_compile.navigation.clearance import compute_clearance
from home_mjx.scene_compile.navigation.regions import label_regions
from home_mjx.scene_compile.objects.stairs import Staircase
from home_mjx.schema.agent import AGENT_MARGIN
from home_mjx.schema.compiled import RoomTable

NO_SPACE_HINTS = {
    "floor": "Ensure that every room has a floor whose faces point up.",
    "walls": "Put every wall in a mesh group of its own: `home-mjx inspect --validate` finds walls that are too thick.",
    "furniture": "Remove furniture, use a smaller agent, or leave this house out.",
}


@dataclass(frozen=True)
class NavigationOptions:
    """Options of free space and sampling.

    Attributes:
        cell: Edge of a grid cell [m].
        agent_radius: Radius of the agent [m].
        agent_height: Height of the agent [m].
        margin: Clearance beyond the radius [m]; starts are jittered by up to half of it from their cell's centre.
        max_step_height: Obstacles that end lower above the floor are ignored [m].
        num_starts: Number of sampled start points.
        num_goals: Number of goals, each with a distance field.
        use_stairs: If True, agents use stairs, and starts and goals are on all levels that stairs join. If False,
            stairs are obstacles, and starts and goals are on the ground floor.

    Raises:
        ConfigError: A value is out of range.
    """

    cell: float = 0.1
    agent_radius: float = 0.1
    agent_height: float = 1.6
    margin: float = AGENT_MARGIN
    max_step_height: float = 0.03
    num_starts: int = 256
    num_goals: int = 32
    use_stairs: bool = True

    def __post_init__(self) -> None:
        check_number("cell", self.cell, 0.01, 10)
        for name in ("agent_radius", "agent_height", "margin", "max_step_height"):
            check_number(name, getattr(self, name), 0)
        for name in ("num_starts", "num_goals"):
            check_number(name, getattr(self, name), 1, integer=True)
        check_flag("use_stairs", self.use_stairs)


@dataclass(frozen=True)
class FreeSpace:
    """Grid of one level without sampled points; all levels of a house have the same extent."""

    level: int
    origin: Float[np.ndarray, "2"]  # [m], corner of cell (0, 0)
    x: Float[np.ndarray, " nx"]  # [m], cell centres
    y: Float[np.ndarray, " ny"]
    room: Int[np.ndarray, "ny nx"]
    standable: Bool[np.ndarray, "ny nx"]
    standable_without_margin: Bool[np.ndarray, "ny nx"]  # cells that the agent's axis can enter without the margin
    standable_without_movables: Bool[np.ndarray, "ny nx"]  # the same if movable objects are absent
    height: Float[np.ndarray, "ny nx"]  # [m], floor or ramp height in a room; undefined elsewhere
    on_ramp: Bool[np.ndarray, "ny nx"]

    @cached_property
    def free(self) -> Bool[np.ndarray, "ny nx"]:
        """Mask of the largest connected region of standable cells."""
        cell = float(self.x[1] - self.x[0]) if len(self.x) > 1 else 1.0
        return label_regions(self.standable[None], (), cell, self.height[None])[0][0] == 0


def find_free_space(
    rooms: RoomTable,
    obstacles: BoxSet,
    passages: Sequence[Float[np.ndarray, "4 2"]] = (),
    options: NavigationOptions = NavigationOptions(),
    level: int | None = None,
    upstairs: Sequence[Staircase] = (),
    downstairs: Sequence[Staircase] = (),
    fixed: BoxSet | None = None,
) -> FreeSpace:
    """Compute the grid of a level: rooms, heights, ramps, and cells that are standable with and without the margin.

    A standable cell is in a room, and its centre is at least radius + margin from obstacles at the agent's heights.
    Without the margin, it is more than the radius less half a cell from them. Cells of stairs that
    belong to another level are not standable.

    Args:
        rooms: Outlines and floors.
        obstacles: Upright boxes [m].
        passages: Footprints of doorways between rooms, which count as indoors if the rooms leave a gap [m].
        options: Sizes.
        level: Level index; None: the lowest that has rooms.
        upstairs: Stairs that begin on this level.
        downstairs: Stairs that end on this level.
        fixed: Obstacles that cannot be moved; None: all obstacles are fixed.
    """
    level = int(rooms.level.min()) if level is None else level
    here = np.flatnonzero(rooms.level == level)
    origin, x, y = _grid(rooms.polygon, options.cell)
    treads = [top for stairs in downstairs for top in stairs.top_tread]
    room = _label_rooms(rooms, here, [*passages, *treads], x, y)
    height, on_ramp, owned = rooms.floor[room], np.zeros(room.shape, bool), np.zeros(room.shape, bool)
    points = np.stack(np.meshgrid(x, y), axis=-1)
    for stairs, end, here in _assign_stair_cells(upstairs, downstairs, points, options.cell):
        # If other stairs exit under the head of these stairs, the area below is floor or belongs to the other stairs.
        over = stairs.contains(points) if end else here if stairs.stacked else stairs.blocks_floor(points)
        mine = here | (over & ~owned)
        room, height = np.where(mine, stairs.room[end], room), np.where(mine, stairs.surface(points), height)
        on_ramp, owned = on_ramp | over, owned | here
    reach = options.agent_radius + options.margin
    heights = options.max_step_height, options.agent_height
    away = compute_clearance(obstacles, height, x, y, heights, reach)
    inside, sure = (room >= 0) & (owned | ~on_ramp), away >= reach
    # An agent's axis may be up to half a cell from the cell's centre.
    near = max(options.agent_radius - options.cell / 2, 0)
    narrow = inside & (sure | (away > near))
    enterable = (
        narrow | (inside & (compute_clearance(fixed, height, x, y, heights, reach) > near))
        if fixed is not None
        else narrow
    )
    return FreeSpace(level, origin, x, y, room.astype(np.int16), inside & sure, narrow, enterable, height, on_ramp)


def _assign_stair_cells(
    upstairs: Sequence[Staircase], downstairs: Sequence[Staircase], points: Float[np.ndarray, "ny nx 2"], cell: float
) -> Iterator[tuple[Staircase, int, Bool[np.ndarray, "ny nx"]]]:
    """Yield the stairs of a level, those up first, each with its end there (0 foot, 1 head) and its cells there.

    Both levels include the cells around the split between their grids. If stairs exit under others, each cell has only
    one surface: the lower one up to the split and, beyond a gap, the upper one. The next level then includes more of
    the upper stairs. The same holds for stairs that agents can walk under.
    """
    under = any(stairs.stacked for stairs in upstairs)
    below = [
        (
            stairs,
            1,
            stairs.belongs_to_level(
                points, 1, (0.0 if under else 3.5 if stairs.stacked or stairs.is_open else 1.5) * cell
            ),
        )
        for stairs in downstairs
    ]
    taken = np.any([here for _, _, here in below], axis=0) if below else np.zeros(points.shape[:2], bool)
    for stairs in upstairs:
        here = stairs.belongs_to_level(points, 0, 0.0 if stairs.is_open else 1.5 * cell)
        if stairs.stacked:
            here &= np.logical_not(ndimage.binary_dilation(taken, np.ones((3, 3))))
        yield stairs, 0, here
    yield from below


def _grid(
    polygons: Sequence[Float[np.ndarray, "_ 2"]], cell: float
) -> tuple[Float[np.ndarray, "2"], Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]]:
    """Return the minimum corner of a grid around polygons, a multiple of `cell`, and x and y of cell centres [m]."""
    points = np.concatenate(list(polygons))
    origin = np.floor(points.min(axis=0) / cell) * cell
    nx, ny = np.ceil((points.max(axis=0) - origin) / cell).astype(int)
    return origin, origin[0] + (np.arange(nx) + 0.5) * cell, origin[1] + (np.arange(ny) + 0.5) * cell


def _label_rooms(
    rooms: RoomTable,
    ground: Int[np.ndarray, " r"],
    passages: Sequence[Float[np.ndarray, "4 2"]],
    x: Float[np.ndarray, " nx"],
    y: Float[np.ndarray, " ny"],
) -> Int[np.ndarray, "ny nx"]:
    """Return the room of each cell centre, the nearest room in `passages`; -1 elsewhere."""
    points = np.stack(np.meshgrid(x, y), axis=-1)
    room = find_smallest_room(rooms, ground, points)
    gap = np.zeros(room.shape, bool)
    for passage in passages:
        gap |= is_inside_polygon(passage, points)
    nearest = np.asarray(ndimage.distance_transform_edt(room < 0, return_distances=False, return_indices=True))
    return np.where(gap, room[nearest[0], nearest[1]], room)


def no_free_space_error(between_walls: FreeSpace, options: NavigationOptions) -> DatasetError:
    """Return, without raising it, an error with the area of the floor and the areas that walls and furniture take.

    An area counts as taken if the axis of an agent would be too close to an obstacle.

    Args:
        between_walls: Free space with walls as the only obstacles.
        options: Sizes of the agent and of a cell.
    """
    floor, furniture = (float(m.sum()) * options.cell**2 for m in (between_walls.room >= 0, between_walls.standable))
    walls = floor - furniture
    return DatasetError(
        f"house has no place where an agent of radius {options.agent_radius} m can stand: of {floor:.1f} m² "
        f"of floor, walls take {walls:.1f} m², furniture and doors {furniture:.1f} m²",
        hint=NO_SPACE_HINTS["floor" if not floor else "walls" if walls > furniture else "furniture"],
    )
