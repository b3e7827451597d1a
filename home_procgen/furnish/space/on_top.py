"""Placement of objects on other objects."""

from collections.abc import Iterable

import numpy as np

from home_procgen.floor_plan.placed import PlacedFurniture
from home_procgen.furnish.space.occupied import hull
from home_procgen.furnish.space.room import Room
from home_procgen.furnish.space.spots import place
from home_procgen.furnish.space.tops import Top, carries, tops_of
from home_procgen.furnish.space.turned import askew

TRIES = 10
BURNERS = (0.85, 1.02)  # [m], range of the height of burners
CASUAL = 0.35  # [rad], standard deviation of the angle of small objects


def on_top(
    room: Room, anchor: PlacedFurniture, kind: str | PlacedFurniture, straight: bool = False, middle: bool = False
) -> PlacedFurniture | None:
    """Place an object on a level surface of another; None if it does not fit.

    Args:
        room: The room of both.
        anchor: The supporting object.
        kind: The object, or its kind.
        straight: Face as the anchor faces, at its back.
        middle: Try the middle of the surface first.
    """
    item = room.object(kind) if isinstance(kind, str) else kind
    for top in tops_of(anchor.model.id)[:2]:
        if placed := _on(room, anchor, top, item, straight, middle):
            return placed
    return None


def _on(
    room: Room, anchor: PlacedFurniture, top: Top, item: PlacedFurniture, straight: bool, middle: bool
) -> PlacedFurniture | None:
    scale = np.array([anchor.scale[0], anchor.scale[2]])
    low, high = top.low * scale, top.high * scale
    own = item.size[[0, 2]] / 2
    slack = np.maximum((high - low) / 2 - 0.8 * own, 0.0)
    for k in range(TRIES):
        # equals `rng.uniform(-slack, slack)`, which takes several times as long for two numbers
        shift = (2 * slack * room.rng.random(2) - slack) * (not (middle and k == 0))
        right, front = ((low + high) / 2 + shift).tolist()
        if straight and not middle:
            front = float(min(low[1] + own[1] + 0.02, (low + high)[1] / 2))
        x, z = anchor.beside(-right if anchor.mirrored else right, front)
        spot = item.at(x, anchor.position[1] + top.height * anchor.scale[1], z, anchor.quarter)
        spot = spot if straight else askew(spot, float(room.rng.normal(0, CASUAL)))
        if room.solid.meets(hull(spot)):  # the most frequent failure, and the cheaper test
            continue
        if carries(anchor, top, spot) and place(room, spot, views=False):
            return spot
    return None


def at(
    room: Room, anchor: PlacedFurniture, kind: str | PlacedFurniture, x: float, z: float, angle: float = 0.0
) -> PlacedFurniture | None:
    """Place an object on another at a point (x, z) [m], its front towards (sin angle, cos angle); None if it fails."""
    item = room.object(kind) if isinstance(kind, str) else kind
    for top in tops_of(anchor.model.id)[:1]:
        spot = askew(item.at(x, anchor.position[1] + top.height * anchor.scale[1], z), angle)
        if carries(anchor, top, spot) and place(room, spot, views=False):
            return spot
    return None


def on_burner(room: Room, stove: PlacedFurniture, kind: str) -> PlacedFurniture | None:
    """Place a pan or a kettle on a burner of a stove; None if none is free."""
    parts = stove.model.parts
    size = np.ptp(parts, axis=1)
    high = (parts[:, 0, 1] > BURNERS[0]) & (parts[:, 1, 1] < BURNERS[1]) & (size[:, [0, 2]] > 0.1).all(axis=1)
    burners = parts[high & (size[:, [0, 2]] < 0.35).all(axis=1)]
    item = room.object(kind)
    for part in room.rng.permutation(burners):
        x, z = stove.beside(float(part[:, 0].mean()), float(part[:, 2].mean()))
        spot = askew(item.at(x, stove.position[1] + float(part[1, 1]), z), float(room.rng.uniform(-np.pi, np.pi)))
        if place(room, spot, views=False):
            return spot
    return None


def some(room: Room, anchor: PlacedFurniture | None, kinds: Iterable[tuple[str, float]], most: int = 5) -> None:
    """Place at most `most` objects on another, in random order, each kind with its probability."""
    if anchor is None:
        return
    pairs, left = list(kinds), most
    for index in room.rng.permutation(len(pairs)).tolist():
        kind, odds = pairs[index]
        if left and room.clutter(odds) and on_top(room, anchor, kind):
            left -= 1
