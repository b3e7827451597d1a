"""Placement of objects on other objects."""

from collections.abc import Iterable

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel, yaw_by
from home_procgen.furnish.space.collision_boxes import collision_boxes
from home_procgen.furnish.space.floor_placement import place_object
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.support_surfaces import SupportSurface, can_support, find_support_surfaces

MAX_TOP_ATTEMPTS = 10
BURNER_HEIGHTS = (0.85, 1.02)  # [m], range of the height of burners
ANGLE_STD = 0.35  # [rad], standard deviation of the angle of small objects


def place_on_top(
    room: RoomSpace,
    anchor: PlacedModel,
    kind: str | PlacedModel,
    straight: bool = False,
    middle: bool = False,
    surfaces: slice = slice(2),
    attempts: int = MAX_TOP_ATTEMPTS,
) -> PlacedModel | None:
    """Place an object on one of the largest level surfaces of another; None if it does not fit.

    Args:
        room: The room of both.
        anchor: The supporting object.
        kind: The object, or its kind.
        straight: Face as the anchor faces, at its back unless `middle`; else turn a little at random.
        middle: Try the middle of the surface first.
        surfaces: Surfaces to try, in descending order of area.
        attempts: Places to try on each.
    """
    item = room.draw_object(kind) if isinstance(kind, str) else kind
    for top in find_support_surfaces(anchor.model.id)[surfaces]:
        if placed := _place_on_surface(room, anchor, top, item, straight, middle, attempts):
            return placed
    return None


def _place_on_surface(
    room: RoomSpace,
    anchor: PlacedModel,
    top: SupportSurface,
    item: PlacedModel,
    straight: bool,
    middle: bool,
    attempts: int,
) -> PlacedModel | None:
    scale = np.array([anchor.scale[0], anchor.scale[2]])
    low, high = top.low * scale, top.high * scale
    own = item.size[[0, 2]] / 2
    slack = np.maximum((high - low) / 2 - 0.8 * own, 0.0)
    turned = item.moved_to(0.0, 0.0, 0.0, anchor.quarter)
    turned = turned if straight else yaw_by(turned, float(room.rng.normal(0, ANGLE_STD)))
    boxes, y = collision_boxes(turned), anchor.position[1] + top.height * anchor.scale[1]
    for k in range(attempts):
        # equals `rng.uniform(-slack, slack)`, which takes several times as long for two numbers
        shift = (2 * slack * room.rng.random(2) - slack) * (not (middle and k == 0))
        right, front = ((low + high) / 2 + shift).tolist()
        if straight and not middle:
            front = float(min(low[1] + own[1] + 0.02, (low + high)[1] / 2))
        x, z = anchor.local_point(-right if anchor.mirrored else right, front)
        if room.solid.overlaps_any(np.add(boxes, (x, y, z))):  # the most frequent failure, and the cheaper test
            continue
        spot = turned.moved_to(x, y, z, turned.quarter)
        if can_support(anchor, top, spot) and place_object(room, spot, views=False):
            return spot
    return None


def place_on_top_at(
    room: RoomSpace, anchor: PlacedModel, kind: str | PlacedModel, x: float, z: float, angle: float = 0.0
) -> PlacedModel | None:
    """Place an object on the largest surface of another at (x, z) [m], turned by `angle` [rad]; None if it fails."""
    item = room.draw_object(kind) if isinstance(kind, str) else kind
    for top in find_support_surfaces(anchor.model.id)[:1]:
        spot = yaw_by(item.moved_to(x, anchor.position[1] + top.height * anchor.scale[1], z), angle)
        if can_support(anchor, top, spot) and place_object(room, spot, views=False):
            return spot
    return None


def place_on_burner(room: RoomSpace, stove: PlacedModel, kind: str) -> PlacedModel | None:
    """Place a pan or a kettle on a burner of a stove; None if none is free."""
    parts = stove.model.parts
    size = np.ptp(parts, axis=1)
    high = (
        (parts[:, 0, 1] > BURNER_HEIGHTS[0])
        & (parts[:, 1, 1] < BURNER_HEIGHTS[1])
        & (size[:, [0, 2]] > 0.1).all(axis=1)
    )
    burners = parts[high & (size[:, [0, 2]] < 0.35).all(axis=1)]
    item = room.draw_object(kind)
    for part in room.rng.permutation(burners):
        x, z = stove.local_point(float(part[:, 0].mean()), float(part[:, 2].mean()))
        spot = yaw_by(
            item.moved_to(x, stove.position[1] + float(part[1, 1]), z), float(room.rng.uniform(-np.pi, np.pi))
        )
        if place_object(room, spot, views=False):
            return spot
    return None


def place_several_on_top(
    room: RoomSpace, anchor: PlacedModel | None, kinds: Iterable[tuple[str, float]], max_objects: int = 5
) -> None:
    """Place at most `max_objects` objects on another, each kind with its probability times clutter; none on None."""
    if anchor is None:
        return
    pairs, left = list(kinds), max_objects
    for index in room.rng.permutation(len(pairs)).tolist():
        kind, odds = pairs[index]
        if left and room.draw_clutter(odds) and place_on_top(room, anchor, kind):
            left -= 1
