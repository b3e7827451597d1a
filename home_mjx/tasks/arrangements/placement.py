"""Sequential choice of a free candidate pose for each object."""

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy import ndimage

from home_mjx.geometry.boxes import BoxSet, concat_boxes, footprint, footprint_distance, make_boxes, penetration_depth
from home_mjx.tasks.arrangements.candidates import PlacementCandidates
from home_mjx.tasks.arrangements.house_layout import HouseLayout

MIN_HORIZONTAL_CLEARANCE = 0.01  # [m], minimum horizontal clearance between objects
TOUCH_TOLERANCE = 1e-3  # [m], vertical overlap up to which boxes only touch
MIN_PORTAL_DISTANCE = 0.5  # [m], minimum distance from an object on the floor to the centre of a portal


def choose_candidates(
    house: HouseLayout, places: PlacementCandidates, order: Int[np.ndarray, " t"]
) -> tuple[BoxSet, Bool[np.ndarray, " k"]]:
    """Choose the first suitable candidate of each object; return the boxes of all bodies and which of them have moved.

    Suitable is usable and clear of all boxes and door sweeps; on a floor, also as `_home_after_placement` requires.
    Bodies with indices `order` are moved in that order; those without a suitable candidate stay. New poses overlap no
    initial pose of another body, so each can be restored.
    """
    now, moved, home = house.bodies, np.zeros(len(house.bodies), bool), house.home_region
    for body in order.tolist():
        others = np.arange(len(now)) != body
        around = concat_boxes([house.static, house.bodies[others], now[others]])
        for n in np.flatnonzero(places.usable[body]):
            box = make_boxes(places.center[body, n], house.bodies.half[body], places.yaw[body, n])
            if not _is_free(house, box, around):
                continue
            left = home if house.on_furniture[body] else _home_after_placement(house, box, int(house.room[body]), home)
            if left is not None:
                rows = np.arange(len(now)) == body
                now = _move_box(now, rows, box)
                moved, home = moved | rows, left
                break
    return now, moved


def _move_box(boxes: BoxSet, rows: Bool[np.ndarray, " k"], box: BoxSet) -> BoxSet:
    """Return boxes whose masked rows have the centre and yaw of one `box`."""
    center, half = np.where(rows[:, None], box.center, boxes.center), boxes.half
    return BoxSet(center, half, np.where(rows, box.yaw, boxes.yaw))


def _is_free(house: HouseLayout, box: BoxSet, around: BoxSet) -> bool:
    """Return whether one box has `MIN_HORIZONTAL_CLEARANCE` from boxes and door sweeps that overlap it in height."""
    meets = (around.bottom < box.top[0] - TOUCH_TOLERANCE) & (around.top > box.bottom[0] + TOUCH_TOLERANCE)
    if (penetration_depth(box, around[meets]) > -MIN_HORIZONTAL_CLEARANCE).any():
        return False
    pivot, reach, low, high = np.split(house.door_sweeps, [2, 3, 4], axis=1)
    away = footprint_distance(box, pivot[None])[0] > reach[:, 0] + MIN_HORIZONTAL_CLEARANCE
    return bool((away | (low[:, 0] > box.top[0]) | (high[:, 0] < box.bottom[0])).all())


def _home_after_placement(
    house: HouseLayout, box: BoxSet, room: int, home: Bool[np.ndarray, "l ny nx"]
) -> Bool[np.ndarray, "l ny nx"] | None:
    """Return the home region `home` less cells within `agent_clearance` of one box.

    None if the box leaves its room, is close to a portal or goal, or splits the region into more parts. Close is within
    `MIN_PORTAL_DISTANCE` of a portal, `agent_clearance` of a goal.
    """
    level = house.level_of(room)
    if (house.room_at(footprint(box, 0), level) != room).any():
        return None
    if (_distance_to_points(box, house.portals) < MIN_PORTAL_DISTANCE).any() or (
        _distance_to_points(box, house.goals) < house.agent_clearance
    ).any():
        return None
    centres = (np.stack(np.meshgrid(*map(np.arange, home.shape[:0:-1])), axis=-1) + 0.5) * house.cell + house.origin
    left = home[level] & (footprint_distance(box, centres[None])[0] >= house.agent_clearance)
    if _num_components(left) > _num_components(home[level]):
        return None
    return np.where(np.arange(len(home))[:, None, None] == level, left, home)


def _num_components(cells: Bool[np.ndarray, "ny nx"]) -> int:
    """Return the number of 4-connected components of a mask."""
    labels = np.zeros(cells.shape, np.int32)
    ndimage.label(cells, output=labels)
    return int(labels.max())


def _distance_to_points(box: BoxSet, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n"]:
    """Compute horizontal distances from a box to points [m]; inf for points 1 m or more above or below its bottom."""
    near = abs(points[:, 2] - box.bottom[0]) < 1.0
    return np.where(near, footprint_distance(box, points[None, :, :2])[0], np.inf)
