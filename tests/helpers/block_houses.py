"""Objects made of boxes in one room of 6 by 6 m, for tests of how things stand to one another."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.scene_compile.architecture.rooms import HouseFrame
from home_mjx.scene_compile.objects.placed_objects import PlacedObject, place_objects
from home_mjx.schema.compiled import RoomTable
from home_mjx.schema.house import BoxNode, House, Level, Metadata, ModelInfo

FLOOR, CEILING = 0.05, 2.69  # [m]
ROOM = RoomTable(
    type=np.array([-1], np.int32),
    level=np.array([0], np.int32),
    polygon=(np.array([[-3.0, -3], [3, -3], [3, 3], [-3, 3]]),),
    floor=np.array([FLOOR]),
    ceiling=np.array([CEILING]),
    labels=np.array([0], np.int32),
)


def block(low: tuple, high: tuple, category: str = "toy", yaw: float = 0.0) -> tuple[BoxNode, ModelInfo]:
    """A box between two corners in the world [m], before it is turned about its middle, and what it is to be."""
    (x, y, z), (a, b, c) = np.add(low, high) / 2, np.subtract(high, low)
    transform = np.eye(4)
    transform[:3, :3] = [[np.cos(yaw), 0, np.sin(yaw)], [0, 1, 0], [-np.sin(yaw), 0, np.cos(yaw)]]
    transform[:3, 3] = x, z, -y  # Y up
    node = BoxNode("", 0, "", None, dimensions=np.array([a, c, b]), transform=transform)
    return node, ModelInfo(category, category, category)


def place(blocks: list[tuple[BoxNode, ModelInfo]]) -> list[PlacedObject]:
    """Objects with ids 0, 1, … in the room."""
    boxes = tuple(replace(node, index=i, id=f"0_{i}") for i, (node, _) in enumerate(blocks))
    level = Level("0", 0, (), (), boxes, ())
    house = House("house", "suncg@1.0.0", Path("house.json"), (level,), {})
    placed = [replace(o, room=0) for o in place_objects(HouseFrame(house, np.zeros(3), NO_ROOMS), Metadata({}))]
    return [replace(o, info=info) for o, (_, info) in zip(placed, blocks, strict=True)]


NO_ROOMS = RoomTable(np.zeros(0, np.int32), np.zeros(0, np.int32), (), np.zeros(0), np.zeros(0), np.zeros(0, np.int32))
