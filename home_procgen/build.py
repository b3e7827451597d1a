"""Conversion of a home's design to the `House` record that the SUNCG writer and the compiler take."""

import itertools
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from home_mjx.datasets.storeys import stack_levels
from home_mjx.schema.house import House, Level, Mesh, RoomNode
from home_procgen.design import HomeDesign, draw_design
from home_procgen.floor_plan.placed_model import furniture_object, used_models
from home_procgen.meshes import build_room_meshes
from home_procgen.outside import Surroundings, draw_surroundings
from home_procgen.outside.neighbours import build_block_node
from home_procgen.outside.surroundings import build_ground_node
from home_procgen.presets import HOME_VARIANT, PRESETS, Variant
from home_procgen.primitives.detail import DETAILS


def build_home(seed: int, variant: Variant = HOME_VARIANT) -> House:
    """Return the home of a seed, with paths relative to the dataset root.

    Args:
        seed: Any non-negative integer.
        variant: Preset of the home, and level of detail of its models.

    Example:
        >>> len(build_home(7).levels[0].rooms) >= 3
        True
    """
    preset = PRESETS[variant.preset]
    design, outside = draw_design(seed, preset=preset), None
    if not preset.is_plain:
        outside = draw_surroundings(seed, design.plan, design.surfaces[0][0].outside)
    return to_house(variant.house_id(seed), design, outside, variant.detail)


def to_house(name: str, design: HomeDesign, outside: Surroundings | None = None, detail: str = DETAILS[0]) -> House:
    """Convert a design to a house record. Nodes of a level: rooms, then objects, then the surroundings.

    Args:
        name: Id of the house.
        design: Plan, surfaces and objects of the home.
        outside: Surroundings of the home; None for none.
        detail: Level of detail of the models. Places of objects are those of full detail.
    """
    folder = Path("room") / name
    flat = [_level(design, number, folder) for number in range(len(design.plan.levels))]
    placed = [placed for objects in design.objects for placed, _ in objects]
    if outside is not None:
        flat[0] = _append_surroundings(flat[0], outside, folder)
        placed += outside.objects
    levels = stack_levels(flat, design.plan.height)
    models: Mapping[str, Mesh] = used_models(placed, detail)
    return House(name, "suncg@1.0.0", Path("house") / name / "house.json", levels, models)


def _append_surroundings(level: Level, outside: Surroundings, folder: Path) -> Level:
    """Append the surroundings to the lowest level as its last nodes, so that earlier nodes keep their numbers."""
    number = itertools.count(len(level.rooms) + len(level.objects))
    return replace(
        level,
        objects=(*level.objects, *(furniture_object(placed, next(number)) for placed in outside.objects)),
        boxes=tuple(build_block_node(block, next(number)) for block in outside.blocks),
        grounds=tuple(build_ground_node(patch, next(number), folder) for patch in outside.grounds),
    )


def _level(design: HomeDesign, number: int, folder: Path) -> Level:
    """Return a level at ground height, before `stack_levels` raises it."""
    count = len(design.plan.levels[number].rooms)
    rooms = tuple(_room(design, number, index, folder) for index in range(count))
    objects = tuple(furniture_object(placed, i) for i, (placed, _) in enumerate(design.objects[number], count))
    return Level(id="0", index=0, rooms=rooms, objects=objects, boxes=(), grounds=())


def _room(design: HomeDesign, number: int, index: int, folder: Path) -> RoomNode:
    plan, storey = design.plan.levels[number], design.plan.storeys[number]
    openings = [opening.object for opening in plan.openings]
    opened = index == 0 and storey.stairs_down is not None, index == 0 and storey.stairs_up is not None
    stem = folder / f"fr_0rm_{index}"
    floor, ceiling, walls = build_room_meshes(
        stem, plan.rooms[index], plan.height, openings, design.surfaces[number][index], *opened
    )
    owned = enumerate(design.objects[number], len(plan.rooms))
    return RoomNode(
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
