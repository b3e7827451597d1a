"""The house of the story: a living room, and a hall two storeys high with stairs up to a loft."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from examples.story.furniture import EAST, EDGE, HALL_WALL, LOWER, SOUTH, UPPER, WEST, Piece, models
from examples.story.stairs import RISE
from home_mjx.datasets.outlines import SLAB_THICKNESS, Point, RoomOutline, WallOpening, outline_house
from home_mjx.datasets.storeys import stack_levels
from home_mjx.datasets.suncg.write.house import write_house, write_library
from home_mjx.schema.house import House, Level
from home_procgen.dataset_writer import library_model
from home_procgen.floor_plan.placed_model import furniture_object, used_models
from home_procgen.primitives.palette import plain, textured
from home_procgen.primitives.textures import BASE_RECIPES, base_texture

HOUSE_ID = "story"


def rectangle(start: float, end: float) -> Sequence[Point]:
    """Corners of the whole depth of the house between two lines across it [m]."""
    return [(start, 0.0), (end, 0.0), (end, SOUTH), (start, SOUTH)]


CEILING = RISE - SLAB_THICKNESS  # [m]: a ceiling and the floor above it are one slab
WARM, COOL, WHITE = textured("wallp_0", "#f0dfd3"), textured("wallp_0", "#e6ebdf"), plain("#fafaf7")
PARQUET, PLANKS = textured("prkt_1"), textured("prkt_3")
LIVING = RoomOutline("Living_Room", rectangle(WEST, HALL_WALL), PARQUET, WARM, WHITE)
HALL = RoomOutline("Hallway", rectangle(HALL_WALL, EAST), PARQUET, COOL, WHITE)
LOFT = RoomOutline("Office", rectangle(HALL_WALL, EAST), PLANKS, COOL, WHITE)


def story_house() -> House:
    """The house, as a record that can be written.

    Example:
        >>> [len(level.rooms) for level in story_house().levels]
        [2, 1]
    """
    indoors = rectangle(EDGE, EAST)  # where the loft is
    lower = _level([LIVING, HALL], [LIVING, HALL], [LIVING, replace(HALL, corners=indoors)], LOWER, 0.0)
    upper = _level([LOFT], [replace(LOFT, corners=indoors)], [LOFT], UPPER, RISE)
    levels = stack_levels([lower, upper], RISE)
    placed = [piece.placed() for piece in (*LOWER, *UPPER)]
    return House(HOUSE_ID, "suncg@1.0.0", Path("house") / HOUSE_ID / "house.json", levels, used_models(placed))


def write_story_house(root: Path) -> None:
    """Writes a dataset of this house alone.

    Args:
        root: Its root.

    Raises:
        DatasetError: It cannot be written.
    """
    house = story_house()
    used = {node.model_id for level in house.levels for node in level.objects}
    library = [library_model(model) for key, model in models().items() if key in used]
    write_library(root, library, {name: base_texture(name) for name in BASE_RECIPES})
    write_house(root, house)


def _level(
    walls: Sequence[RoomOutline],
    floors: Sequence[RoomOutline],
    ceilings: Sequence[RoomOutline],
    pieces: Sequence[Piece],
    base: float,
) -> Level:
    """A level on the ground, whose floors and ceilings may end where the hall is open."""
    placed = [piece.placed() for piece in pieces]
    openings = list(_openings(base))
    full, floor, ceiling = (
        outline_house(HOUSE_ID, rooms, openings, height=height).levels[0]
        for rooms, height in ((walls, RISE), (floors, RISE), (ceilings, CEILING))
    )
    rooms = tuple(
        replace(room, floor=below.floor, ceiling=above.ceiling)
        for room, below, above in zip(full.rooms, floor.rooms, ceiling.rooms, strict=True)
    )
    objects = tuple(furniture_object(item, index) for index, item in enumerate(placed, len(rooms)))
    return replace(full, rooms=rooms, objects=objects)


def _openings(base: float) -> Iterator[WallOpening]:
    """Return the holes of doors and windows in the walls that begin at a height above the ground floor [m]."""
    lifted = [(piece.placed(), 0.0) for piece in LOWER] + [(piece.placed(), RISE) for piece in UPPER]
    for item, lift in lifted:
        low, high = item.box[:, 1] + lift - base
        if item.model.fine in ("door", "window") and 0 <= low < RISE:
            along = 0 if item.quarter % 2 == 0 else 2
            ends = np.array([item.position, item.position])
            ends[:, along] = item.box[:, along]
            (x0, _, z0), (x1, _, z1) = ends.tolist()
            yield WallOpening((x0, z0), (x1, z1), float(low), float(high))
