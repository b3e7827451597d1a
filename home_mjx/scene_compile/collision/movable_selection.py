"""Selection of the movable objects: portable categories that rest freely on a floor or on other objects."""

from collections.abc import Mapping, Sequence

from home_mjx.geometry.boxes import BoxSet, concat_boxes
from home_mjx.scene_compile.collision.movables import MovableCandidate, MovableOptions, is_movable
from home_mjx.scene_compile.collision.support_placement import (
    find_loads,
    find_support,
    place_on_supports,
    sort_carriers_first,
)
from home_mjx.scene_compile.objects.masses import object_mass
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import RoomTable


def select_movables(
    objects: Sequence[PlacedObject],
    static: Mapping[int, BoxSet],
    fixed: BoxSet,
    rooms: RoomTable,
    options: MovableOptions,
) -> tuple[list[MovableCandidate], list[int], int]:
    """Select the objects that become bodies.

    An object that carries others is a body only if all of its loads are bodies, so that nothing is left in the air.

    Args:
        objects: All objects of the house.
        static: Boxes of each object while it is fixed, by object id.
        fixed: Boxes that never move, whichever objects are selected.
        rooms: Floor heights.
        options: Limits.

    Returns:
        The selected objects, lightest first; ids of supported candidates that are not free to move; number of
        free candidates beyond `max_bodies`.
    """
    loads = find_loads(objects, options.max_support_gap)
    everything = concat_boxes([fixed, *static.values()])
    free = [_candidate(o, rooms, options) for o in objects if is_movable(o, options)]
    resting = [
        c for c in free if c.floor is not None or find_support(c.box, everything, options.max_support_gap) is not None
    ]
    candidates = sorted(resting, key=lambda c: (c.mass, c.item.object_id))
    standing = place_on_supports(candidates, loads, static, fixed, options)
    ids = set(_lightest(standing, loads, options.max_bodies))
    # The remaining objects are obstacles with their own boxes, which may be slightly larger.
    chosen = place_on_supports([c for c in candidates if c.item.object_id in ids], loads, static, fixed, options)
    free_ids = {c.item.object_id for c in standing}
    stuck = [c.item.object_id for c in candidates if c.item.object_id not in free_ids]
    return sorted(chosen, key=lambda c: (c.mass, c.item.object_id)), stuck, len(standing) - len(ids)


def _candidate(item: PlacedObject, rooms: RoomTable, options: MovableOptions) -> MovableCandidate:
    """Return an object with its box, mass, and the height of its room's floor, which is None if it is not on it."""
    floor = float(rooms.floor[item.room])
    on_floor = bool(abs(item.box.bottom[0] - floor) <= options.max_support_gap)
    return MovableCandidate(item, item.box, object_mass(item), floor if on_floor else None)


def _lightest(standing: Sequence[MovableCandidate], loads: Mapping[int, Sequence[int]], most: int) -> list[int]:
    """Return the ids of at most `most` objects, lightest first.

    An object sorts by the heaviest of itself and its loads, so all of its loads are included as well.
    """
    mass: dict[int, float] = {}
    for c in reversed(sort_carriers_first(standing, loads)):
        own = c.item.object_id
        mass[own] = max([c.mass, *(mass.get(i, 0.0) for i in loads.get(own, ()))])
    # Sorting is stable, and loads precede their carriers in the reversed order.
    return sorted(mass, key=lambda i: mass[i])[:most]
