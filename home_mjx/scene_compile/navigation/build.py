"""Navigation data of a house from the free space of its levels: regions, portals, starts, goals, geodesic distances."""

import hashlib
from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int, UInt16

from home_mjx.geometry.boxes import BoxSet
from home_mjx.geometry.extrapolation import extrapolate_fields, nearest_cell_numbers, passable_cells
from home_mjx.geometry.geodesic import GridLink, distance_fields, has_clear_diagonals
from home_mjx.scene_compile.navigation.clearance import compute_clearance
from home_mjx.scene_compile.navigation.free_space import FreeSpace, NavigationOptions
from home_mjx.scene_compile.navigation.portals import find_portals, room_hops
from home_mjx.scene_compile.navigation.reach import find_unreachable_storeys
from home_mjx.scene_compile.navigation.regions import label_regions, stair_links
from home_mjx.scene_compile.objects.doorways import Doorway
from home_mjx.scene_compile.objects.stairs import Staircase
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE, ExtrapolatedCells, HouseNavigation, RoomTable

DEFAULT_OPTIONS = NavigationOptions()
LEVEL_DISTANCE = 1000  # [cells], distance between adjacent levels when goals are spread


def build_navigation(
    house_id: str,
    rooms: RoomTable,
    spaces: Sequence[FreeSpace],
    options: NavigationOptions = DEFAULT_OPTIONS,
    doorways: Sequence[Sequence[Doorway]] = (),
    stairs: Sequence[Staircase] = (),
    leaves: Sequence[BoxSet] = (),
    open_leaves: Sequence[BoxSet] = (),
) -> HouseNavigation:
    """Compute regions, portals, starts, goals and distance fields on the free space of a house.

    Starts and goals are in the home region and never on ramps. Fields are extrapolated to reachable cells around it.

    Args:
        house_id: Seeds the sampling of starts and goals.
        rooms: Floor heights.
        spaces: Free space of each level that has rooms, lowest first; some must have standable cells off ramps.
        options: Counts and sizes.
        doorways: Doorways of each level; empty: none.
        stairs: Stairs between the levels that agents use.
        leaves: Boxes on each level of all leaf positions. Starts and goals avoid them, but paths lead through.
        open_leaves: Boxes on each level of leaves of open doors. Starts and goals avoid cells that these cut off from
            most of the house. An agent that pushes the leaf away might shut the door for good. Like `leaves`, they are
            ignored if starts and goals would have no cell left.
    """
    ground = spaces[0]
    standable, room = np.stack([s.standable for s in spaces]), np.stack([s.room for s in spaces])
    centres = ground.x, ground.y
    height, on_ramp = np.stack([s.height for s in spaces]), np.stack([s.on_ramp for s in spaces])
    ways = stair_links(stairs, standable, height, centres)
    links = [link for way in ways for link in way]
    region, area = label_regions(standable, links, options.cell, height, on_ramp)
    home = region == 0
    reach = options.agent_radius + options.margin
    climbed = [(s, max(s.width - 2 * reach, options.cell) if way else 0.0) for s, way in zip(stairs, ways, strict=True)]
    portals = find_portals(rooms, room, standable, height, centres, doorways or [[] for _ in spaces], climbed)
    rng = np.random.default_rng(int.from_bytes(hashlib.sha256(house_id.encode()).digest()[:8], "little"))
    floor = home & ~on_ramp
    for lost in find_unreachable_storeys(spaces, region, stairs, options.cell):
        floor[lost.storey] = False  # a landing at the head of stairs, whose room would have as many goals as others
    drawn = floor & ~_cut_off_cells(home, links, spaces, rooms, open_leaves, options)
    drawn = drawn if drawn.any() else floor
    clear = _clear_of_leaves(drawn, spaces, rooms, leaves, options, options.agent_radius + options.margin)
    drawn = clear if clear.any() else drawn
    goals = _spread_goals(drawn, room, options.num_goals, rng)
    cells = rng.permutation(np.argwhere(drawn))[np.arange(options.num_starts) % drawn.sum()]
    jitter = rng.uniform(-0.5, 0.5, (options.num_starts, 2)) * options.margin
    field = distance_fields(home, goals, options.cell, links, height, _passable(spaces, home, options))
    return HouseNavigation(
        origin=ground.origin,
        cell=options.cell,
        agent_radius=float(options.agent_radius),
        agent_height=float(options.agent_height),
        level=np.array([s.level for s in spaces], np.int32),
        floor=np.array([rooms.floor[rooms.level == s.level].min() for s in spaces]),
        region=region,
        region_area=area,
        room=room,
        height=height[home],
        start=_place(ground, rooms, room, cells, jitter),
        goal=_place(ground, rooms, room, goals, np.zeros((len(goals), 2))),
        field=_quantize_distances(field),
        extrapolated=_fringe(spaces, home, field, options.cell),
        portals=portals,
        room_hops=room_hops(portals, len(rooms.type)),
    )


def _clear_of_leaves(
    drawn: Bool[np.ndarray, "l ny nx"],
    spaces: Sequence[FreeSpace],
    rooms: RoomTable,
    leaves: Sequence[BoxSet],
    options: NavigationOptions,
    reach: float,
) -> Bool[np.ndarray, "l ny nx"]:
    """Return the drawn cells at least `reach` [m] from all leaf positions at an agent's height.

    Levels beyond the length of `leaves` stay unchanged.
    """
    found, heights = drawn.copy(), (options.max_step_height, options.agent_height)
    for cells, space, boxes in zip(found, spaces, leaves, strict=False):
        cells &= compute_clearance(boxes, rooms.floor[space.room], space.x, space.y, heights, reach) >= reach
    return found


def _cut_off_cells(
    home: Bool[np.ndarray, "l ny nx"],
    links: Sequence[GridLink],
    spaces: Sequence[FreeSpace],
    rooms: RoomTable,
    leaves: Sequence[BoxSet],
    options: NavigationOptions,
) -> Bool[np.ndarray, "l ny nx"]:
    """Return the home cells where an agent touches a leaf of an open door, or that leaves cut off from the main part.

    The main part is the home region of `label_regions` without the touched cells. Return none if all are touched.
    """
    free = _clear_of_leaves(home, spaces, rooms, leaves, options, options.agent_radius)
    region, _ = label_regions(free, links, options.cell, np.stack([s.height for s in spaces]))
    return home & (region != 0) if free.any() else np.zeros_like(home)


def _passable(
    spaces: Sequence[FreeSpace], home: Bool[np.ndarray, "l ny nx"], options: NavigationOptions
) -> Bool[np.ndarray, "l ny nx"] | None:
    """Return the cells at the corners of diagonal steps: `passable_cells` if these are safe, else None (home cells)."""
    if not has_clear_diagonals(options.cell, options.agent_radius):
        return None
    bare, standable = (np.stack([getattr(s, f"standable{end}") for s in spaces]) for end in ("_without_margin", ""))
    room, height = np.stack([s.room for s in spaces]), np.stack([s.height for s in spaces])
    return passable_cells(home, bare, standable, room, height, options.cell)


def _fringe(
    spaces: Sequence[FreeSpace], home: Bool[np.ndarray, "l ny nx"], field: Float[np.ndarray, "c g"], cell: float
) -> ExtrapolatedCells:
    """Return the reachable cells outside the home region, and the nearest numbered cell of every cell of the grids.

    Numbers count the home cells, then these. `field` has the distances from each home cell to each goal [m].
    """
    grids = ("standable_without_margin", "standable_without_movables", "standable", "room", "height")
    *around, standable, room, height = (np.stack([getattr(s, name) for s in spaces]) for name in grids)
    parts = extrapolate_fields(home, around, standable, room, height, field, cell)
    place, distance = (np.concatenate(part) for part in zip(*parts, strict=True))
    number = np.where(home, np.cumsum(home).reshape(home.shape) - 1, -1)
    number[tuple(place.T)] = len(field) + np.arange(len(place))
    nearest = nearest_cell_numbers(number, room).astype(np.int32)
    return ExtrapolatedCells(
        len(parts[0][0]), place.astype(np.int16), height[tuple(place.T)], _quantize_distances(distance), nearest
    )


def _quantize_distances(distance: Float[np.ndarray, "c g"]) -> UInt16[np.ndarray, "c g"]:
    """Return distances [m] in steps of `FIELD_UNIT`, rounded to the nearest; `FIELD_UNREACHABLE` for infinite ones.

    Finite ones are clipped at `FIELD_UNREACHABLE - 1` steps, 163.835 m.
    """
    steps = np.minimum(np.round(distance / FIELD_UNIT), FIELD_UNREACHABLE - 1)
    return np.where(np.isfinite(distance), steps, FIELD_UNREACHABLE).astype(np.uint16)


def _place(
    space: FreeSpace,
    rooms: RoomTable,
    room: Int[np.ndarray, "l ny nx"],
    cells: Int[np.ndarray, "n 3"],
    shift: Float[np.ndarray, "n 2"],
) -> Float[np.ndarray, "n 3"]:
    """Return world points on the floor of the rooms of cells (level, row, column), moved by `shift` in x and y [m]."""
    _, row, column = cells.T
    z = rooms.floor[room[tuple(cells.T)]]
    return np.stack([space.x[column] + shift[:, 0], space.y[row] + shift[:, 1], z], axis=-1)


def _spread_goals(
    free: Bool[np.ndarray, "l ny nx"], room: Int[np.ndarray, "l ny nx"], count: int, rng: np.random.Generator
) -> Int[np.ndarray, "g 3"]:
    """Sample goal cells (level, row, column), rooms in turn: each the farthest of 32 candidates from earlier goals.

    The order of the rooms is random. There must be a free cell; the same one may be several goals.
    """
    order = rng.permutation(np.unique(room[free]))
    goals = np.empty((count, 3), np.int64)
    for g in range(count):
        cells = np.argwhere(free & (room == order[g % len(order)]))
        candidates = cells[rng.integers(len(cells), size=32)]
        gaps = np.linalg.norm((candidates[:, None] - goals[None, :g]) * [LEVEL_DISTANCE, 1, 1], axis=-1)
        goals[g] = candidates[gaps.min(axis=1, initial=np.inf).argmax()]
    return goals
