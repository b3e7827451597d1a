"""Turns the design of a house into the record that the writer and the compiler take."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from home_mjx.datasets.seeds import house_id
from home_mjx.datasets.suncg.formats.variants import variant_key
from home_mjx.schema.house import House, Level, Mesh, ObjectNode, RoomNode
from home_procgen.floor_plan.placed import PlacedModel
from home_procgen.floor_plan.walls import room_meshes
from home_procgen.v1.design import Design, draw_design


def build_house(seed: int) -> House:
    """The house of a seed, with paths relative to the dataset root.

    Example:
        >>> build_house(7).levels[0].rooms[0].types
        ('Living_Room',)
    """
    return to_house(house_id(seed), draw_design(seed))


def to_house(name: str, design: Design) -> House:
    """A design as a house of one level: rooms first, then everything that has a model.

    Args:
        name: Id of the house.
        design: What it consists of.
    """
    count = len(design.plan.rooms)
    rooms = tuple(_room(design, index, Path("room") / name) for index in range(count))
    objects = tuple(furniture_object(placed, index) for index, (placed, _) in enumerate(design.objects, count))
    level = Level(id="0", index=0, rooms=rooms, objects=objects, boxes=(), grounds=())
    models = used_models([placed for placed, _ in design.objects])
    return House(name, "suncg@1.0.0", Path("house") / name / "house.json", (level,), models)


def _room(design: Design, index: int, folder: Path) -> RoomNode:
    plan, count = design.plan, len(design.plan.rooms)
    openings = [opening.object for opening in plan.openings]
    floor, ceiling, walls = room_meshes(folder, index, plan.rooms[index], plan.height, openings, design.surfaces[index])
    return RoomNode(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=f"fr_0rm_{index}",
        types=(plan.rooms[index].type,),
        members=tuple(node for node, (_, owner) in enumerate(design.objects, count) if owner == index),
        floor=floor,
        ceiling=ceiling,
        walls=walls,
    )


def furniture_object(placed: PlacedModel, index: int) -> ObjectNode:
    """The node of a piece of furniture on the lowest level."""
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = placed.linear, placed.position
    return ObjectNode(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=placed.model.id,
        model_key=variant_key(placed.model.id, int(placed.closed)),
        transform=transform,
        materials=placed.materials,
    )


def used_models(objects: Sequence[PlacedModel]) -> Mapping[str, Mesh]:
    """Every mesh that the objects show, and the base of each."""
    meshes = {placed.model.id: placed.model.mesh for placed in objects}
    closed = {variant_key(p.model.id, 1): p.model.closed for p in objects if p.closed and p.model.closed is not None}
    return meshes | closed
