"""Stacking of levels: each is built on the ground, then lifted to its height."""

from collections.abc import Sequence
from dataclasses import replace
from typing import TypeVar

import numpy as np

from home_mjx.schema.house import BoxNode, Level, Mesh, ObjectNode, RoomNode

Placed = TypeVar("Placed", ObjectNode, BoxNode)


def stack_levels(levels: Sequence[Level], rise: float) -> tuple[Level, ...]:
    """Stack levels of `outline_house`, from below, and rename their nodes and meshes by level.

    Level i is moved up (+y) by i times `rise` [m]. Stated bounding boxes, grounds and other nodes stay as they are.

    Example:
        >>> from home_mjx.datasets import RoomOutline, outline_house
        >>> ground = outline_house("x", [RoomOutline("Hall", [(0, 0), (4, 0), (4, 3)])]).levels[0]
        >>> heights = [level.rooms[0].floor.vertices[:, 1].max() for level in stack_levels([ground, ground], 2.8)]
        >>> print(*(f"{height:.2f}" for height in heights))
        0.05 2.85
    """
    return tuple(_raised(level, number, rise * number) for number, level in enumerate(levels))


def _raised(level: Level, number: int, lift: float) -> Level:
    """Return a level as level `number`, moved up (+y) by `lift` [m], with ids, paths and mesh groups renamed.

    Only its rooms, objects and boxes change, except for their `bbox`.
    """
    return replace(
        level,
        id=str(number),
        index=number,
        rooms=tuple(_room(room, number, lift) for room in level.rooms),
        objects=tuple(_moved(node, number, lift) for node in level.objects),
        boxes=tuple(_moved(node, number, lift) for node in level.boxes),
    )


def _room(room: RoomNode, number: int, lift: float) -> RoomNode:
    """Return a room as one of level `number`, its meshes, but not its `bbox`, moved up (+y) by `lift` [m]."""
    floor, ceiling, walls = (_mesh(mesh, number, lift) for mesh in (room.floor, room.ceiling, room.walls))
    return replace(
        room,
        id=f"{number}_{room.index}",
        path=f"levels[{number}].nodes[{room.index}]",
        model_id=room.model_id.replace("fr_0rm", f"fr_{number}rm"),
        floor=floor,
        ceiling=ceiling,
        walls=walls,
    )


def _mesh(mesh: Mesh | None, number: int, lift: float) -> Mesh | None:
    """Return a mesh moved up (+y) by `lift` [m], path and groups renamed from level 0 to `number`; None for None."""
    if mesh is None:
        return None
    return replace(
        mesh,
        path=mesh.path.with_name(mesh.path.name.replace("fr_0rm", f"fr_{number}rm")),
        vertices=mesh.vertices + np.array([0.0, lift, 0.0]),
        groups=tuple(name.replace("#0_", f"#{number}_") for name in mesh.groups),
    )


def _moved(node: Placed, number: int, lift: float) -> Placed:
    """Return an object or box as one of level `number`, moved up (+y) by `lift` [m].

    Its `transform` is moved, its `bbox` is not.
    """
    transform = node.transform.copy()
    transform[1, 3] += lift
    return replace(node, id=f"{number}_{node.index}", path=f"levels[{number}].nodes[{node.index}]", transform=transform)
