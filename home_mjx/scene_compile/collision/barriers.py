"""Invisible boxes that keep agents in the rooms of a house, where no wall, window or shut door does."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from home_mjx.scene_compile.geometry.box_fit import narrowest_box
from home_mjx.scene_compile.geometry.boxes import BoxSet, box_set, join, no_boxes
from home_mjx.scene_compile.geometry.polygons import inside_polygon, smallest_room
from home_mjx.scene_compile.navigation.free_space import clearance
from home_mjx.schema.compiled import Rooms

CELL = 0.05  # [m], of the grid on which gaps are found
AROUND = 1.0  # [m], of the grid beyond the rooms
# [m]: a gap counts if the axis of an agent comes through it that keeps so far from boxes: an agent of radius 0.1 m
# that is pressed 3 cm into them, at the centres of the cells that it passes.
PASSES = 0.035
STANDS = 0.1  # [m]: only those parts of rooms count in which there is so much space around a place
CLIMBS = 0.5  # [m] above the floor: what ends lower keeps nobody in
REACHES = 1.5  # [m]: nor does what begins higher
BETWEEN = 0.2  # [m]: rooms that are less than twice this apart have no outdoors between them
POCKET = 0.3  # [m]: a place that is nowhere farther than this from a room leads nowhere
BAND = 2  # [cells], thickness of a barrier
THIN = 0.1  # [m], half of the most that a barrier may be thick where it bends
HEIGHT = 2.0  # [m] above the highest floor, at least
FENCE_AWAY, FENCE_HALF = 2.0, 0.05  # [m], from the rooms, and half its thickness


def find_barriers(
    rooms: Rooms, level: int, static: BoxSet, passages: Sequence[Float[np.ndarray, "4 2"]], longest: float
) -> BoxSet:
    """Boxes that close every gap between a level's rooms and the outdoors.

    On a fine grid, outdoors is where an agent could walk to from far outside all rooms. Its cells beside those of
    rooms are filled, whatever they belong to: open outer doors, arches, garages, missing walls.

    Args:
        rooms: Outlines and heights.
        level: Level index.
        static: Boxes that stay where they are, shut doors among them.
        passages: Footprints of ways between rooms, and of stairs [m]: these are indoors.
        longest: Most length of a barrier [m].
    """
    here = np.flatnonzero(rooms.level == level)
    points = np.concatenate([rooms.polygon[r] for r in here])
    if not len(points):
        return no_boxes()
    low, high = points.min(axis=0) - AROUND, points.max(axis=0) + AROUND
    x, y = (np.arange(a + CELL / 2, b, CELL) for a, b in zip(low, high, strict=True))
    place = np.stack(np.meshgrid(x, y), axis=-1)
    room = smallest_room(rooms, here, place)
    rows, columns = ndimage.distance_transform_edt(room < 0, return_distances=False, return_indices=True)
    floor = rooms.floor[room[rows, columns]]
    space = clearance(static, floor, x, y, (CLIMBS, REACHES), STANDS)
    free = space > PASSES
    indoors = _indoors(room >= 0, [inside_polygon(p, place) for p in passages])
    inside = _parts_with(free & indoors, (room >= 0) & (space > STANDS))
    away = np.asarray(ndimage.distance_transform_edt(~indoors)) * CELL
    outside = _parts_with(free & ~indoors, away > POCKET)
    gaps = outside & ndimage.binary_dilation(inside, np.ones((3, 3)), BAND, mask=inside | outside)
    bottom, top = rooms.floor[here].min(), max(rooms.floor[here].max() + HEIGHT, rooms.ceiling[here].max())
    labels, count = ndimage.label(gaps, np.ones((3, 3)))
    return join(_boxes(place[labels == i], (float(bottom), float(top)), longest) for i in range(1, count + 1))


def _indoors(
    room: Bool[np.ndarray, "ny nx"], passages: Sequence[Bool[np.ndarray, "ny nx"]]
) -> Bool[np.ndarray, "ny nx"]:
    """Rooms, what lies between them, and ways."""
    apart = ndimage.distance_transform_edt(~room)
    grown = np.asarray(apart) * CELL <= BETWEEN
    closed = np.asarray(ndimage.distance_transform_edt(grown)) * CELL > BETWEEN
    return np.any([room, closed, *passages], axis=0)


def _parts_with(cells: Bool[np.ndarray, "ny nx"], wanted: Bool[np.ndarray, "ny nx"]) -> Bool[np.ndarray, "ny nx"]:
    """The connected parts of some cells that hold a wanted one."""
    labels, _ = ndimage.label(cells, np.ones((3, 3)))
    return cells & np.isin(labels, labels[cells & wanted])


def _boxes(cells: Float[np.ndarray, "n 2"], heights: tuple[float, float], longest: float) -> BoxSet:
    """Thin upright boxes, in any direction, that together hold some cells; a bent band is cut into straight ones."""
    corners = cells[:, None] + CELL / 2 * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    box = narrowest_box(np.concatenate([np.c_[corners.reshape(-1, 2), np.full(4 * len(cells), z)] for z in heights]))
    long = int(box.half[0, 1] > box.half[0, 0])
    if len(cells) == 1 or (box.half[0, 1 - long] <= THIN and 2 * box.half[0, long] <= longest):
        return box
    axis = np.array(
        [np.cos(box.yaw[0]), np.sin(box.yaw[0])] if long == 0 else [-np.sin(box.yaw[0]), np.cos(box.yaw[0])]
    )
    first = cells @ axis <= np.median(cells @ axis)
    if first.all():
        first = cells @ axis < np.median(cells @ axis)
    return join([_boxes(cells[first], heights, longest), _boxes(cells[~first], heights, longest)])


def fence(rooms: Rooms) -> BoxSet:
    """Four boxes around all rooms: what gets out in spite of all stays on the lot.

    Args:
        rooms: Outlines and heights.
    """
    points = np.concatenate(rooms.polygon)
    low, high = points.min(axis=0) - FENCE_AWAY, points.max(axis=0) + FENCE_AWAY
    (x, y), (w, d) = (low + high) / 2, (high - low) / 2
    bottom, top = rooms.floor.min(), max(rooms.floor.max() + HEIGHT, rooms.ceiling.max())
    z, h = (bottom + top) / 2, (top - bottom) / 2
    center = [[low[0], y, z], [high[0], y, z], [x, low[1], z], [x, high[1], z]]
    half = [[FENCE_HALF, d, h], [FENCE_HALF, d, h], [w, FENCE_HALF, h], [w, FENCE_HALF, h]]
    return box_set(center, half)
