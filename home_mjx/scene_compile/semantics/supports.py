"""Supports of objects: the floor, a wall, the ceiling, or another object that carries or contains it."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from home_mjx.geometry.boxes import BoxSet, concat_boxes, footprint_distance
from home_mjx.geometry.polygons import boundary_edges
from home_mjx.geometry.rotations import yaw_matrix
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import RoomTable

MAX_CONTACT_GAP = 0.05  # [m], maximum gap or penetration of a contact; SUNCG's furniture hovers or sinks by this much
SOLE_HEIGHT = 0.02  # [m], points up to this above the lowest one touch the support
MIN_SUPPORT_SHARE = 0.5  # minimum share of these points that the supporting object carries
MAX_SOLE_POINTS = 64  # maximum number of these points
MAX_SUPPORTERS = 32  # maximum number of tested supporters, by decreasing overlap in the plan
MAX_WALL_DISTANCE = 0.12  # [m], from an object at a wall to the room's outline, which is inside the wall
MAX_HUNG_DISTANCE = 0.15  # [m], the same without another support: pictures and lamps hang up to 5.5 cm off the wall
MAX_CEILING_DISTANCE = 0.1  # [m], maximum distance from an object's top to the ceiling that it hangs from
OUTLINE_STEP = 0.1  # [m], distance between sample points of a room's outline
MAX_STEPS = 1_000  # maximum number of these points per edge
MIN_INSIDE_SHARE = 0.9  # minimum share of an object's box inside the box of its container

# OPENINGS are in or in front of the wall, even if they reach the floor. WALL_HUNG objects are on the wall, even if
# something is below.
WALL_OPENINGS = {"arch", "curtain", "door", "garage_door", "window"}
WALL_HUNG = {"air_conditioner", "hanging_kitchen_cabinet", "mirror", "picture_frame", "whiteboard"}
CEILING_HUNG = {"ceiling_fan", "chandelier"}
CONTAINERS = {
    *("bathtub", "cart", "dresser", "fireplace", "hanging_kitchen_cabinet", "kitchen_appliance", "kitchen_cabinet"),
    *("kitchen_set", "mailbox", "pool", "safe", "shelving", "shoes_cabinet", "shower", "sink", "storage_bench"),
    *("trash_can", "tv_stand", "vase", "vehicle", "wardrobe_cabinet"),
}


@dataclass(frozen=True)
class Support:
    """Support of one object."""

    kind: str = ""  # one of SUPPORTS; "" if none
    supporter: int = -1  # object id of the object that it is on
    container: int = -1  # object id of the container that it is in


def find_supports(objects: Sequence[PlacedObject], rooms: RoomTable) -> list[Support]:
    """Return the support of each object, in order, by the rules of `_support`."""
    boxes = concat_boxes(o.box for o in objects)
    limits = np.array([o.limits for o in objects]).reshape(-1, 2, 3)
    outlines = {level: _outline_points(rooms, level) for level in {o.level for o in objects}}
    return [_support(i, objects, boxes, limits, rooms, outlines[o.level]) for i, o in enumerate(objects)]


def _support(
    index: int,
    objects: Sequence[PlacedObject],
    boxes: BoxSet,
    limits: Float[np.ndarray, "o 2 3"],
    rooms: RoomTable,
    outline: Float[np.ndarray, "p 2"],
) -> Support:
    """Return the support of object `index`; `outline` has plan points along the room outlines of its level.

    Rules in order: wall opening, hung on a wall, another object, floor, ceiling, wall; kind "" if none holds. An object
    in a container that no other object carries is on the container.
    """
    item = objects[index]
    if item.info.coarse in WALL_OPENINGS:
        return Support("wall")
    low, high = limits[index, :, 2]
    floor, ceiling = _heights(item, rooms)
    on_floor = bool(low < floor + MAX_CONTACT_GAP)
    off_wall = float(footprint_distance(boxes[[index]], outline[None]).min(initial=np.inf))
    at_wall = off_wall < MAX_WALL_DISTANCE
    if item.info.coarse in WALL_HUNG and off_wall < MAX_HUNG_DISTANCE and not on_floor:
        return Support("wall")
    bearer, container = _supporter(index, objects, limits), _container(index, objects, boxes, limits)
    if bearer >= 0 or container >= 0:
        held = objects[bearer if bearer >= 0 else container].object_id
        return Support("object", held, objects[container].object_id if container >= 0 else -1)
    if on_floor:
        return Support("floor")
    if high > ceiling - MAX_CEILING_DISTANCE and (item.info.fine in CEILING_HUNG or not at_wall):
        return Support("ceiling")
    return Support("wall" if off_wall < MAX_HUNG_DISTANCE else "")


def _heights(item: PlacedObject, rooms: RoomTable) -> tuple[float, float]:
    """Return the floor and ceiling of an object's room [m].

    Outdoors, the floor is the lowest one of its level, or 0 if the level has no rooms, and the ceiling is infinity.
    """
    if item.room >= 0:
        return float(rooms.floor[item.room]), float(rooms.ceiling[item.room])
    floors = rooms.floor[rooms.level == item.level]
    return float(floors.min(initial=np.inf)) if len(floors) else 0.0, np.inf


def _outline_points(rooms: RoomTable, level: int) -> Float[np.ndarray, "p 2"]:
    """Return plan points along the room outlines of a level, at most `OUTLINE_STEP` apart on short edges [m]."""
    points = [np.zeros((0, 2))]
    for polygon in (p for p, at in zip(rooms.polygon, rooms.level, strict=True) if at == level):
        for a, b in boundary_edges(polygon):
            count = int(np.ceil(min(np.linalg.norm(b - a) / OUTLINE_STEP, MAX_STEPS))) + 1
            points.append(a + np.linspace(0, 1, count)[:, None] * (b - a))
    return np.concatenate(points)


def _supporter(index: int, objects: Sequence[PlacedObject], limits: Float[np.ndarray, "o 2 3"]) -> int:
    """Return the index of the object under most of the lowest points of `index`; -1 below `MIN_SUPPORT_SHARE`.

    Of equal ones, the first counts. Only the `MAX_SUPPORTERS` with most overlap in the plan are tested.
    """
    low, high = limits[index]
    near = ((limits[:, 0, :2] < high[:2]) & (limits[:, 1, :2] > low[:2])).all(axis=1)
    near &= (limits[:, 0, 2] < low[2] + MAX_CONTACT_GAP) & (limits[:, 1, 2] > low[2] - MAX_CONTACT_GAP)
    near[index] = False
    if not near.any():
        return -1
    points = _soles(objects[index])
    common = np.minimum(limits[:, 1, :2], high[:2]) - np.maximum(limits[:, 0, :2], low[:2])
    order = np.argsort(-common.prod(axis=1), kind="stable")
    below = order[near[order]][:MAX_SUPPORTERS].tolist()
    borne = {i: _is_carried(points, objects[i], float(high[2])).mean() for i in sorted(below)}
    best = max(borne, key=lambda i: borne[i])
    return best if borne[best] >= MIN_SUPPORT_SHARE else -1


def _soles(item: PlacedObject) -> Float[np.ndarray, "p 3"]:
    """Return up to `MAX_SOLE_POINTS` world corners of an object within `SOLE_HEIGHT` of its lowest one [m]."""
    points = item.triangles.reshape(-1, 3)
    points = np.unique(points[points[:, 2] < points[:, 2].min() + SOLE_HEIGHT].round(4), axis=0)
    return points[np.linspace(0, len(points) - 1, min(len(points), MAX_SOLE_POINTS)).astype(int)]


def _is_carried(points: Float[np.ndarray, "p 3"], below: PlacedObject, top: float) -> Bool[np.ndarray, " p"]:
    """Return for each point whether `below` has an upper side within `MAX_CONTACT_GAP` of its z, under `top` [m]."""
    triangles = below.upper_triangles
    level = points[:, 2].min()
    near = (triangles[:, :, 2].min(axis=1) < level + SOLE_HEIGHT + MAX_CONTACT_GAP) & (
        triangles[:, :, 2].max(axis=1) > level - MAX_CONTACT_GAP
    )
    a, b, c = triangles[near].transpose(1, 0, 2)
    weight = _barycentric(points[:, None, :2], a[:, :2], b[:, :2], c[:, :2])
    height = np.sum(weight * np.stack([a[:, 2], b[:, 2], c[:, 2]], axis=-1), axis=-1)
    found = (weight >= -1e-6).all(axis=-1) & (abs(height - points[:, None, 2]) <= MAX_CONTACT_GAP) & (height < top)
    return found.any(axis=1)


def _barycentric(
    point: Float[np.ndarray, "p 1 2"],
    a: Float[np.ndarray, "t 2"],
    b: Float[np.ndarray, "t 2"],
    c: Float[np.ndarray, "t 2"],
) -> Float[np.ndarray, "p t 3"]:
    """Return the barycentric weights (of a, b, c) of plan points in triangles; some are negative outside."""
    u, v, w = b - a, c - a, point - a
    whole = u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0]
    second = (w[..., 0] * v[:, 1] - w[..., 1] * v[:, 0]) / whole
    third = (u[:, 0] * w[..., 1] - u[:, 1] * w[..., 0]) / whole
    return np.stack([1 - second - third, second, third], axis=-1)


def _container(index: int, objects: Sequence[PlacedObject], boxes: BoxSet, limits: Float[np.ndarray, "o 2 3"]) -> int:
    """Return the index of the smallest of `CONTAINERS` around at least `MIN_INSIDE_SHARE` of a box; -1 if none.

    It is larger than the box `index`, and the bounds of its surface contain the centre of that.
    """
    middle, volume = boxes.center[index], boxes.half.prod(axis=1)
    around = (limits[:, 0] <= middle).all(axis=1) & (limits[:, 1] >= middle).all(axis=1) & (volume > volume[index])
    holding = [
        i
        for i in np.flatnonzero(around).tolist()
        if objects[i].info.coarse in CONTAINERS and _inside_share(boxes, index, i) >= MIN_INSIDE_SHARE
    ]
    return min(holding, key=lambda i: volume[i], default=-1)


def _inside_share(boxes: BoxSet, inner: int, outer: int) -> float:
    """Return the volume share of box `inner` that is inside box `outer`, by its extents along the sides of `outer`."""
    turn = yaw_matrix(boxes.yaw[outer] - boxes.yaw[inner])
    half = abs(turn) @ boxes.half[inner]
    middle = yaw_matrix(boxes.yaw[outer]).T @ (boxes.center[inner] - boxes.center[outer])
    overlap = np.minimum(middle + half, boxes.half[outer]) - np.maximum(middle - half, -boxes.half[outer])
    return float((np.maximum(overlap, 0) / np.maximum(2 * half, 1e-9)).prod())
