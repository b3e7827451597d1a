"""Doorways: footprints of doors and arches, and the rooms that they join."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import count

import numpy as np
from jaxtyping import Float

from home_mjx.geometry.polygons import find_smallest_room
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import RoomTable

PORTAL_CATEGORIES = ("door", "garage_door", "arch")
DOORWAY_HALF_DEPTH = 0.15  # [m], depth of a doorway on either side of its wall's middle plane
ROOM_PROBE_DISTANCE = 0.35  # [m], distance from the middle of a doorway to the test points for rooms on either side
MAX_LEAVES = 2  # maximum number of leaves of one doorway


@dataclass(frozen=True)
class Doorway:
    """A door or an arch as a way from room to room.

    Attributes:
        footprint: As wide as the door, `DOORWAY_HALF_DEPTH` to both sides of its wall; the first edge is along the
            wall [m].
        level: Level index.
        room: Room on either side; -1 outdoors.
        leaf: Rows of the house's Doors, the largest leaves first; -1 if none.
    """

    footprint: Float[np.ndarray, "4 2"]
    level: int
    room: tuple[int, int]
    leaf: tuple[int, int] = (-1, -1)

    @property
    def leads_outdoors(self) -> bool:
        """True if at least one side has no room."""
        return min(self.room) < 0


def find_doorways(objects: Sequence[PlacedObject], rooms: RoomTable) -> list[Doorway]:
    """Return the doorways of all levels: one per door, garage door or arch, in the order of `objects`.

    Args:
        objects: All objects of the house; rows of its Doors are their `leaves`, in this order.
        rooms: Outlines.
    """
    rows, found = count(), []
    for item in objects:
        leaves = sorted([(-float(leaf.box.half[0].prod()), next(rows)) for leaf in item.leaves])
        if item.info.coarse in PORTAL_CATEGORIES:
            leaf = [row for _, row in leaves[:MAX_LEAVES]] + [-1] * MAX_LEAVES
            found.append(replace(_doorway(item, rooms), leaf=(leaf[0], leaf[1])))
    return found


def shut_outer_doors(objects: Sequence[PlacedObject], rooms: RoomTable) -> list[PlacedObject]:
    """Return the objects, with all doors to the outdoors that have movable leaves shut for good (`is_shut`)."""
    doors = {o.instance for o in objects if o.leaf_parts and o.info.coarse in PORTAL_CATEGORIES}
    shut = {o.instance for o in objects if o.instance in doors and _doorway(o, rooms).leads_outdoors}
    return [replace(o, is_shut=True) if o.instance in shut else o for o in objects]


def _doorway(item: PlacedObject, rooms: RoomTable) -> Doorway:
    """Return the doorway of a door or arch, `leaf` not yet set; its first room is on the -y side of the object."""
    along, across = np.array([[np.cos(item.yaw), np.sin(item.yaw)], [-np.sin(item.yaw), np.cos(item.yaw)]])
    points = item.triangles.reshape(-1, 3)[:, :2] @ along
    middle = item.pose[:2, 3] @ across
    ends = np.array([points.min(), points.max()])
    corners = (
        ends[[0, 1, 1, 0], None] * along + (middle + DOORWAY_HALF_DEPTH * np.array([-1, -1, 1, 1]))[:, None] * across
    )
    beside = ends.mean() * along + (middle + ROOM_PROBE_DISTANCE * np.array([[-1], [1]])) * across
    first, second = find_smallest_room(rooms, np.flatnonzero(rooms.level == item.level), beside).tolist()
    return Doorway(corners, item.level, (first, second))
