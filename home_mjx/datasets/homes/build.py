"""Turns the design of a home into the record that the writer and the compiler take."""

from collections.abc import Mapping
from pathlib import Path

from home_mjx.datasets.homes.design import HomeDesign, draw_design
from home_mjx.datasets.homes.meshes import room_parts
from home_mjx.datasets.procedural.build import furniture_object, used_models
from home_mjx.datasets.seeds import house_id
from home_mjx.datasets.storeys import stack_levels
from home_mjx.schema.house import House, Level, Mesh, Room


def build_home(seed: int) -> House:
    """The home of a seed, with paths relative to the dataset root.

    Example:
        >>> len(build_home(7).levels[0].rooms) >= 3
        True
    """
    return to_house(house_id(seed), draw_design(seed))


def to_house(name: str, design: HomeDesign) -> House:
    """A design as a house: on every level rooms first, then everything that has a model.

    Args:
        name: Id of the house.
        design: What it consists of.
    """
    flat = [_level(design, number, Path("room") / name) for number in range(len(design.plan.levels))]
    levels = stack_levels(flat, design.plan.height)
    models: Mapping[str, Mesh] = used_models([placed for objects in design.objects for placed, _ in objects])
    return House(name, "suncg@1.0.0", Path("house") / name / "house.json", levels, models)


def _level(design: HomeDesign, number: int, folder: Path) -> Level:
    """A level on the ground, before it is lifted to its place."""
    count = len(design.plan.levels[number].rooms)
    rooms = tuple(_room(design, number, index, folder) for index in range(count))
    objects = tuple(furniture_object(placed, i) for i, (placed, _) in enumerate(design.objects[number], count))
    return Level(id="0", index=0, rooms=rooms, objects=objects, boxes=(), grounds=())


def _room(design: HomeDesign, number: int, index: int, folder: Path) -> Room:
    plan, storey = design.plan.levels[number], design.plan.storeys[number]
    openings = [opening.placed for opening in plan.openings]
    opened = index == 0 and storey.well is not None, index == 0 and storey.stairs is not None
    stem = folder / f"fr_0rm_{index}"
    floor, ceiling, walls = room_parts(
        stem, plan.rooms[index], plan.height, openings, design.surfaces[number][index], *opened
    )
    owned = enumerate(design.objects[number], len(plan.rooms))
    return Room(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=stem.name,
        types=(plan.rooms[index].type,),
        members=tuple(node for node, (_, owner) in owned if owner == index),
        floor=floor,
        ceiling=ceiling,
        walls=walls,
    )
