"""Makes one house from its seed."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from home_mjx.scene_compile.generate.furnish import furnish
from home_mjx.scene_compile.generate.openings import WET, HousePlan, draw_plan
from home_mjx.scene_compile.generate.palette import (
    CEILINGS,
    DRY_WALLS,
    FACADES,
    SOFT_FLOORS,
    WET_FLOORS,
    WET_WALLS,
    WOODEN_FLOORS,
    choose,
)
from home_mjx.scene_compile.generate.placed import Placed
from home_mjx.scene_compile.generate.style import Style
from home_mjx.scene_compile.generate.walls import Surfaces, room_meshes
from home_mjx.scene_compile.house import House, Level, Material, Mesh, Object, Room

# "home" in hexadecimal: SUNCG's ids are hashes, so one of its 45,622 begins so with probability 1e-5.
ID_PREFIX = "686f6d65"
_FLOORS = {"Bathroom": WET_FLOORS, "Toilet": WET_FLOORS, "Kitchen": WET_FLOORS, "Living_Room": WOODEN_FLOORS}


def house_id(seed: int) -> str:
    """The id of a seed's house: 32 hexadecimal digits.

    Example:
        >>> house_id(0)
        '686f6d65c5e2f5ae3f5b8f2d6a3b3ad5'
    """
    return ID_PREFIX + hashlib.sha256(f"home_mjx house {seed}".encode()).hexdigest()[:24]


def build_house(seed: int) -> House:
    """The house of a seed, with paths relative to the dataset root.

    Example:
        >>> house = build_house(7)
        >>> house.levels[0].rooms[0].types
        ('Living_Room',)
    """
    rng = np.random.default_rng(seed)
    furniture = None
    while furniture is None:
        plan, style = draw_plan(rng), Style.draw(rng)
        furniture = furnish(plan, style)
    objects = _objects(plan, furniture, style)
    members = [[i for i, (_, room) in enumerate(objects, len(plan.rooms)) if room == r] for r in range(len(plan.rooms))]
    name = house_id(seed)
    rooms = _rooms(plan, members, Path("room") / name, rng)
    nodes = tuple(_object(placed, i) for i, (placed, _) in enumerate(objects, len(rooms)))
    level = Level(id="0", index=0, rooms=rooms, objects=nodes, boxes=(), grounds=())
    models = _models([placed for placed, _ in objects])
    return House(name, "suncg@1.0.0", Path("house") / name / "house.json", (level,), models)


def _objects(plan: HousePlan, furniture: Sequence[Sequence[Placed]], style: Style) -> list[tuple[Placed, int]]:
    """Everything that has a model, with the room that owns it: openings first."""
    doors = style.dress(next(o.placed.model for o in plan.openings if o.is_door))
    windows = style.dress(next(o.placed.model for o in plan.openings if not o.is_door))
    openings = [(replace(o.placed, materials=doors if o.is_door else windows), o.rooms[0]) for o in plan.openings]
    return [*openings, *((placed, room) for room, items in enumerate(furniture) for placed in items)]


def _object(placed: Placed, index: int) -> Object:
    transform = np.eye(4)
    transform[:3, :3], transform[:3, 3] = placed.linear, placed.position
    return Object(
        id=f"0_{index}",
        index=index,
        path=f"levels[0].nodes[{index}]",
        bbox=None,
        model_id=placed.model.id,
        state=1 if placed.closed else None,
        transform=transform,
        materials=placed.materials,
    )


def _rooms(
    plan: HousePlan, members: Sequence[Sequence[int]], folder: Path, rng: np.random.Generator
) -> tuple[Room, ...]:
    openings = [opening.placed for opening in plan.openings]
    facade, ceiling = choose(FACADES, rng), choose(CEILINGS, rng)
    rooms = []
    for index, room in enumerate(plan.rooms):
        surfaces = _surfaces(room.type, ceiling, facade, rng)
        floor, top, walls = room_meshes(folder, index, room, plan.height, openings, surfaces)
        rooms.append(
            Room(
                id=f"0_{index}",
                index=index,
                path=f"levels[0].nodes[{index}]",
                bbox=None,
                model_id=f"fr_0rm_{index}",
                types=(room.type,),
                members=tuple(members[index]),
                floor=floor,
                ceiling=top,
                walls=walls,
            )
        )
    return tuple(rooms)


def _surfaces(kind: str, ceiling: Material, facade: Material, rng: np.random.Generator) -> Surfaces:
    floors, walls = _FLOORS.get(kind, SOFT_FLOORS), WET_WALLS if kind in WET else DRY_WALLS
    return Surfaces(choose(floors, rng), ceiling, choose(walls, rng), facade)


def _models(objects: Sequence[Placed]) -> Mapping[str, Mesh]:
    """Every mesh that the objects need, and the base of each."""
    meshes = {placed.model.id: placed.model.mesh for placed in objects}
    closed = {f"{p.model.id}_0": p.model.closed for p in objects if p.closed and p.model.closed is not None}
    return meshes | closed
