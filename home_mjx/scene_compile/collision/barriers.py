"""Invisible boxes that keep agents inside the rooms, wherever no wall, window or shut door closes a gap."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.geometry.box_fit import narrowest_box
from home_mjx.geometry.boxes import BoxSet, concat_boxes, empty_boxes, make_boxes
from home_mjx.geometry.polygons import find_smallest_room, is_inside_polygon
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.navigation.clearance import compute_clearance
from home_mjx.schema.compiled import RoomTable

GRID_CELL = 0.05  # [m], grid cell used to find gaps
MAX_GRID_CELLS = 1 << 22  # maximum number of grid cells; houses larger than about 100 m x 100 m use coarser cells
GRID_MARGIN = 1.0  # [m], margin of the grid around the rooms
# [m], cells with a smaller distance to boxes are closed. The axis of an agent of radius 0.1 m that is pressed 3 cm into
# boxes keeps 7 cm from them, and half of the diagonal of a cell from its centre.
MIN_PASSAGE_CLEARANCE = 0.035
MIN_ROOM_CLEARANCE = 0.1  # [m], connected parts of rooms without a cell of this clearance are ignored
MIN_OBSTACLE_TOP = 0.5  # [m] above the floor; boxes that end lower do not block agents
MAX_OBSTACLE_BOTTOM = 1.5  # [m] above the floor; boxes that begin higher do not block agents
INDOOR_GAP_RADIUS = 0.2  # [m], gaps between rooms of less than twice this width count as indoors
MIN_OUTDOOR_DISTANCE = 0.3  # [m], outdoor parts that stay within this distance of rooms are dead ends and ignored
BARRIER_CELLS = 2  # [cells], thickness of a barrier
MAX_HALF_THICKNESS = 0.1  # [m], maximum half thickness of a box; thicker ones follow a bend and are cut
MIN_BARRIER_HEIGHT = 2.0  # [m], minimum height of barriers above the highest floor
FENCE_DISTANCE, FENCE_HALF_THICKNESS = 2.0, 0.05  # [m], distance of the fence from the rooms, and half its thickness


def find_barriers(
    rooms: RoomTable, level: int, static: BoxSet, passages: Sequence[Float[np.ndarray, "4 2"]], max_length: float
) -> BoxSet:
    """Return boxes that close every gap between a level's rooms and the outdoors; empty without outlines of rooms.

    On a fine grid, the outdoors are the cells from which an agent could walk to a point far outside all rooms. Outdoor
    cells next to room cells are filled, regardless of cause: open outer doors, arches, garages or missing walls.
    Boxes reach from the lowest floor of the level to its highest ceiling, and `MIN_BARRIER_HEIGHT` above its highest
    floor at least.

    Args:
        rooms: Outlines and heights.
        level: Level index.
        static: Boxes that do not move, including shut doors.
        passages: Footprints of ways between rooms, and of stairs [m]; these are indoors.
        max_length: Maximum length of a barrier [m].
    """
    here = np.flatnonzero(rooms.level == level)
    points = np.concatenate([rooms.polygon[r] for r in here])
    if not len(points):
        return empty_boxes()
    low, high = points.min(axis=0) - GRID_MARGIN, points.max(axis=0) + GRID_MARGIN
    cell = max(GRID_CELL, float(np.sqrt((high - low).prod() / MAX_GRID_CELLS)))
    x, y = (np.arange(a + cell / 2, b, cell) for a, b in zip(low, high, strict=True))
    place = np.stack(np.meshgrid(x, y), axis=-1)
    room = find_smallest_room(rooms, here, place)
    nearest = np.asarray(ndimage.distance_transform_edt(room < 0, return_distances=False, return_indices=True))
    floor = rooms.floor[room[nearest[0], nearest[1]]]
    space = compute_clearance(static, floor, x, y, (MIN_OBSTACLE_TOP, MAX_OBSTACLE_BOTTOM), MIN_ROOM_CLEARANCE)
    free = space > MIN_PASSAGE_CLEARANCE
    indoors = _indoors(room >= 0, cell) | np.any([is_inside_polygon(p, place) for p in passages], axis=0)
    inside = _parts_with(free & indoors, (room >= 0) & (space > MIN_ROOM_CLEARANCE))
    outside = _parts_with(free & ~indoors, _distance(indoors, cell) > MIN_OUTDOOR_DISTANCE)
    gaps = outside & ndimage.binary_dilation(inside, np.ones((3, 3)), BARRIER_CELLS, mask=inside | outside)
    bottom, top = rooms.floor[here].min(), max(rooms.floor[here].max() + MIN_BARRIER_HEIGHT, rooms.ceiling[here].max())
    part = _parts(gaps)
    corners = cell / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    bands = [place[part == i][:, None] + corners for i in range(1, part.max() + 1)]
    return concat_boxes(_boxes(band, (float(bottom), float(top)), max_length) for band in bands)


def _indoors(room: Bool[np.ndarray, "ny nx"], cell: float) -> Bool[np.ndarray, "ny nx"]:
    """Return the cells of rooms and of gaps narrower than twice `INDOOR_GAP_RADIUS`; `cell` is the cell size [m]."""
    grown = _distance(room, cell) <= INDOOR_GAP_RADIUS
    return room | (_distance(~grown, cell) > INDOOR_GAP_RADIUS)


def _distance(cells: Bool[np.ndarray, "ny nx"], cell: float) -> Float[np.ndarray, "ny nx"]:
    """Return the distance of every cell to the nearest selected cell, centre to centre [m]; 0 at selected cells.

    `cell` is the edge of a cell [m].
    """
    return np.asarray(ndimage.distance_transform_edt(~cells)) * cell


def _parts_with(cells: Bool[np.ndarray, "ny nx"], wanted: Bool[np.ndarray, "ny nx"]) -> Bool[np.ndarray, "ny nx"]:
    """Return the cells of those 8-connected parts of `cells` that contain a wanted cell."""
    part = _parts(cells)
    return cells & np.isin(part, part[cells & wanted])


def _parts(cells: Bool[np.ndarray, "ny nx"]) -> Int[np.ndarray, "ny nx"]:
    """Return the number of the 8-connected part of each selected cell, from 1; 0 at other cells."""
    part = np.zeros(cells.shape, np.int32)
    ndimage.label(cells, np.ones((3, 3)), output=part)
    return part


def _boxes(band: Float[np.ndarray, "n 4 2"], heights: tuple[float, float], longest: float) -> BoxSet:
    """Cover cells with thin upright boxes of any yaw; a curved band is cut into straight pieces.

    `band` has the corners of the cells, `heights` bottom and top, and `longest` is the maximum length of a box [m].
    """
    corners = band.reshape(-1, 2)
    box = narrowest_box(np.concatenate([np.c_[corners, np.full(len(corners), z)] for z in heights]))
    long = int(box.half[0, 1] > box.half[0, 0])
    if len(band) == 1 or (box.half[0, 1 - long] <= MAX_HALF_THICKNESS and 2 * box.half[0, long] <= longest):
        return box
    along = (band.mean(axis=1) - box.center[0, :2]) @ yaw_matrix(float(box.yaw[0]))[:2, long]
    pieces = max(2, int(np.ceil(2 * box.half[0, long] / longest)))
    piece = np.digitize(along, box.half[0, long] * np.linspace(-1, 1, pieces + 1)[1:-1])
    return concat_boxes(_boxes(band[piece == i], heights, longest) for i in np.unique(piece))


def lot_bounds(rooms: RoomTable) -> Float[np.ndarray, "2 2"]:
    """Return the minimum and maximum (x, y) [m] of the fence: `FENCE_DISTANCE` beyond the outlines of all rooms."""
    points = np.concatenate(rooms.polygon)
    return np.stack([points.min(axis=0) - FENCE_DISTANCE, points.max(axis=0) + FENCE_DISTANCE])


def is_within_lot(box: Float[np.ndarray, "2 3"], rooms: RoomTable) -> bool:
    """Return whether a box (minimum and maximum corner [m]) overlaps the volume inside the fence, or that below it.

    Agents cannot touch anything else, such as neighbouring houses or the roof.
    """
    (low, high), ((x0, y0), (x1, y1)) = box, lot_bounds(rooms)
    top = max(rooms.floor.max() + MIN_BARRIER_HEIGHT, rooms.ceiling.max())
    return bool(low[0] < x1 and low[1] < y1 and high[0] > x0 and high[1] > y0 and low[2] < top)


def build_fence(rooms: RoomTable) -> BoxSet:
    """Return four thin boxes along `lot_bounds`, from the lowest floor to the highest ceiling.

    They end at least `MIN_BARRIER_HEIGHT` above the highest floor, and stop all that passes the barriers.
    """
    low, high = lot_bounds(rooms)
    (x, y), (w, d) = (low + high) / 2, (high - low) / 2
    bottom, top = rooms.floor.min(), max(rooms.floor.max() + MIN_BARRIER_HEIGHT, rooms.ceiling.max())
    z, h = (bottom + top) / 2, (top - bottom) / 2
    center = [[low[0], y, z], [high[0], y, z], [x, low[1], z], [x, high[1], z]]
    half = [
        [FENCE_HALF_THICKNESS, d, h],
        [FENCE_HALF_THICKNESS, d, h],
        [w, FENCE_HALF_THICKNESS, h],
        [w, FENCE_HALF_THICKNESS, h],
    ]
    return make_boxes(center, half)
