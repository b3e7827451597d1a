"""Houses of several levels: rooms from outlines, one storey above the other, and straight stairs between them."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from cuboids import cuboid

from home_mjx.datasets.outlines import Opening, RoomOutline, outline_house
from home_mjx.datasets.storeys import stack_levels
from home_mjx.schema.house import Box, House, Level, Mesh, Metadata, ModelInfo, Object

UP = 2.8  # [m], from floor to floor
FLOOR = 0.05  # [m], height of the ground floor
METADATA = Metadata({"stairs": ModelInfo("stairs", "stairs", "stairs", "floor")})


@dataclass(frozen=True)
class Storey:
    """One level, in the plan (x, z) of the file."""

    rooms: Sequence[RoomOutline]
    openings: Sequence[Opening] = ()
    boxes: Sequence[Box] = ()


@dataclass(frozen=True)
class Stairs:
    """A straight flight from the level with the given index.

    Attributes:
        foot: (x, z) of the middle of its first edge [m].
        heading: Direction of the way up, from +x towards -z [rad].
        steps: Number of treads; the last is as high as the upper floor.
        run: Depth of a tread [m].
        width: [m].
        level: On which it begins.
    """

    foot: tuple[float, float]
    heading: float = 0.0
    steps: int = 14
    run: float = 0.25
    width: float = 0.9
    level: int = 0


def stacked(storeys: Sequence[Storey], stairs: Sequence[Stairs] = (), house_id: str = "stacked") -> House:
    """The storeys one above the other; compile it with `METADATA`."""
    levels = [_level(storey, [s for s in stairs if s.level == i]) for i, storey in enumerate(storeys)]
    house = outline_house(house_id, storeys[0].rooms)
    models = {f"stairs_{s.steps}_{s.run}_{s.width}": _flight(s) for s in stairs}
    return replace(house, levels=stack_levels(levels, UP), models=models)


def metadata_of(house: House) -> Metadata:
    return Metadata({key: replace(METADATA.models["stairs"], model_id=key) for key in house.models})


def _level(storey: Storey, stairs: Sequence[Stairs]) -> Level:
    (plain,) = outline_house("x", storey.rooms, storey.openings, storey.boxes, UP - 0.1).levels
    first = len(plain.rooms) + len(plain.boxes)
    return replace(plain, objects=tuple(_object(s, first + i) for i, s in enumerate(stairs)))


def _object(stairs: Stairs, index: int) -> Object:
    c, s = np.cos(stairs.heading), np.sin(stairs.heading)
    transform = np.array([[c, 0, s, stairs.foot[0]], [0, 1, 0, FLOOR], [-s, 0, c, stairs.foot[1]], [0, 0, 0, 1.0]])
    key = f"stairs_{stairs.steps}_{stairs.run}_{stairs.width}"
    return Object(f"0_{index}", index, f"levels[0].nodes[{index}]", None, key, None, transform)


def _flight(stairs: Stairs) -> Mesh:
    """Treads on solid blocks along +x, Y up."""
    rise, half = UP / stairs.steps, stairs.width / 2
    blocks = [
        cuboid((stairs.run * i, -half, 0), (stairs.run * (i + 1), half, rise * (i + 1))) for i in range(stairs.steps)
    ]
    triangles = np.concatenate(blocks)[..., [0, 2, 1]] * [1, 1, -1]
    faces = np.arange(3 * len(triangles)).reshape(-1, 3)
    zeros = np.zeros(len(faces), np.int32)
    material = outline_house("x", [RoomOutline("Room", [(0, 0), (1, 0), (1, 1)])]).levels[0].rooms[0].floor
    assert material is not None
    return Mesh(
        material.path, triangles.reshape(-1, 3), faces, np.zeros((*faces.shape, 2)), zeros, zeros, material.materials
    )
