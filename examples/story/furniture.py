"""Furniture of the story's house and its positions: a row per object, in metres."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache

from examples.story.stairs import FAMILIES, LENGTH, RISE, WIDTH
from home_mjx.datasets.outlines import SLAB_THICKNESS
from home_mjx.schema.house import Material
from home_procgen.floor_plan.openings import DOOR_Y, SILL_Y
from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.primitives.family import FurnitureModel
from home_procgen.primitives.palette import plain, textured
from home_procgen.v1.furniture import library

WEST, HALL_WALL, EDGE, EAST, SOUTH = 0.0, 4.6, 9.24, 12.6, 6.0  # [m]: lines of walls, and of the loft's edge
FACES_SOUTH, FACES_EAST, FACES_NORTH, FACES_WEST = range(4)  # quarter turns
TABLE, SIDEBOARD, LAMP = 0.75, 0.85, 0.45  # [m], heights
# Materials by the name of a slot; others keep their own.
LOOKS = {
    "wood": textured("wood_3"),
    "wood_1": textured("wood_1"),
    "upholstery": textured("textile_2"),
    "upholstery_1": textured("textile_4"),
    "carpet": textured("textile_4"),
    "carpet_1": textured("textile_2"),
    "shade": plain("#f4e6c4"),
    "ceramic": plain("#3f6f78"),
}


@dataclass(frozen=True)
class Piece:
    """One object: the name of its model, where the middle of its underside is, and how it is turned."""

    model: str
    x: float
    z: float
    quarter: int = FACES_SOUTH
    y: float = 0.0  # above the floor
    mirrored: bool = False
    closed: bool = False

    def placed(self) -> PlacedModel:
        """The object on the lowest level."""
        model = models()[f"gen_{self.model}"]
        materials = tuple(LOOKS.get(slot, Material(slot)) for slot in model.slots)
        thing = PlacedModel(model, (0.0, 0.0, 0.0), 0, (1.0, 1.0, 1.0), self.mirrored, self.closed, materials)
        return thing.moved_to(self.x, self.y + SLAB_THICKNESS, self.z, self.quarter)


DOOR, SILL = DOOR_Y - SLAB_THICKNESS, SILL_Y - SLAB_THICKNESS
LOWER = (
    Piece("door_1", HALL_WALL, 4.4, FACES_WEST, DOOR, mirrored=True),
    Piece("door_2", 5.6, SOUTH, FACES_SOUTH, DOOR, closed=True),
    Piece("window_4", 7.0, SOUTH, FACES_NORTH, SILL),
    Piece("window_4", 7.0, SOUTH, FACES_NORTH, SILL + RISE),  # over the open part of the hall
    Piece("window_4", HALL_WALL, 3.0, FACES_EAST, SILL + RISE),
    Piece("pendant_1", 7.0, 3.0, y=2 * RISE - 0.7),
    Piece("window_4", 10.9, SOUTH, FACES_NORTH, SILL),
    Piece("window_4", 2.2, SOUTH, FACES_NORTH, SILL),
    Piece("window_3", WEST, 4.4, FACES_EAST, SILL),
    Piece("window_3", EAST, 3.0, FACES_WEST, SILL),
    Piece("sofa_2", 0.56, 2.5, FACES_EAST),
    Piece("rug_2", 1.7, 2.5, FACES_EAST),
    Piece("coffee_table_1", 1.75, 2.5, FACES_EAST),
    Piece("vase_2", 1.75, 2.4, y=0.44),
    Piece("tv_stand_1", 4.32, 2.0, FACES_WEST),
    Piece("television_2", 4.32, 2.0, FACES_WEST, 0.5),
    Piece("bookshelf_3", 2.3, 0.24),
    Piece("floor_lamp_1", 0.4, 1.0),
    Piece("picture_1", WEST + 0.07, 2.5, FACES_EAST, 1.35),
    Piece("ceiling_lamp_1", 2.3, 3.0, y=2.58),
    Piece("stairs_1", EDGE - LENGTH, 0.1 + WIDTH / 2),
    Piece("banister_1", EDGE - LENGTH, 0.1 + WIDTH - 0.03),
    Piece("dining_table_2", 10.9, 3.0, FACES_EAST),
    *(Piece("chair_2", 10.9 + side * 0.78, 3.0 + end, 2 + side) for side in (-1, 1) for end in (-0.4, 0.4)),
    Piece("vase_1", 10.9, 3.0, y=TABLE),
    Piece("rug_2", 7.4, 3.6),
    Piece("speaker_1", 8.7, 5.78, FACES_NORTH),
    Piece("bench_2", 7.1, 5.7, FACES_NORTH),
    Piece("coat_stand_1", 4.95, 5.6),
    Piece("picture_2", EAST - 0.07, 1.2, FACES_WEST, 1.35),
    Piece("ceiling_lamp_1", 10.9, 3.0, y=2.58),
)
UPPER = (
    Piece("window_4", 10.9, SOUTH, FACES_NORTH, SILL),
    Piece("window_3", EAST, 3.3, FACES_WEST, SILL),
    Piece("railing_1", EDGE - 0.025, 3.55, FACES_EAST),
    Piece("dresser_1", 12.3, 1.3, FACES_WEST),
    Piece("table_lamp_1", 12.28, 1.3, FACES_WEST, SIDEBOARD),
    Piece("picture_3", EAST - 0.07, 1.3, FACES_WEST, 1.6),
    Piece("bookshelf_3", 11.1, 0.24),
    Piece("rug_1", 11.4, 4.6, FACES_EAST),
    Piece("dining_table_1", 11.4, 4.7, FACES_EAST),
    Piece("chair_2", 12.1, 4.7, FACES_WEST),
    Piece("armchair_2", 9.9, 5.35, FACES_EAST),
    Piece("floor_lamp_2", 12.25, 5.7),
    Piece("ceiling_lamp_1", 11.0, 2.6, y=2.58),
)


@cache
def models() -> dict[str, FurnitureModel]:
    """The models of the library, and those of stairs and railings, by id."""
    return {**library(), **{model.id: model for model in _own()}}


def _own() -> Iterator[FurnitureModel]:
    for family in FAMILIES:
        yield from family.models()
