"""Turns the design of a house into the record that the writer and the compiler take."""

from pathlib import Path

from home_mjx.datasets.seeds import house_id
from home_mjx.schema.house import House, Level, RoomNode
from home_procgen.floor_plan.placed_model import furniture_object, used_models
from home_procgen.v1.design import Design, draw_design
from home_procgen.v1.meshes import room_meshes


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
