"""Semantic descriptors of Habitat: classes by id, regions as rooms, and HSSD's table of objects."""

import csv
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path

import numpy as np

from home_mjx.core.files import is_file, read_text
from home_mjx.datasets.gltf.categories import find_category
from home_mjx.datasets.gltf.layout.room_file import StatedRoom
from home_mjx.datasets.gltf.layout.room_search import is_outline
from home_mjx.datasets.gltf.layout.storey_search import MIN_STOREY_HEIGHT
from home_mjx.datasets.procthor.surfaces import room_type
from home_mjx.datasets.suncg.formats.json_value import JsonValue, Location
from home_mjx.datasets.taxonomy import UNKNOWN, plain_word, vocabulary
from home_mjx.schema.categories import ROOM_TYPES
from home_mjx.schema.house import Problem

SOURCES = ("hssd", "replicacad", "mpcat40")  # tables of words, tried in this order
OBJECT_TABLE = Path("semantics") / "objects.csv"  # of HSSD, below the root
TABLE_WORDS = ("main_category", "wnsynsetkey", "main_wnsynsetkey", "name")  # columns with words, tried in this order
MAX_TABLE_BYTES = 1 << 26  # [bytes]
MIN_HEIGHT, MAX_HEIGHT = 0.5, 20.0  # [m], of regions


@dataclass(frozen=True)
class SemanticDescriptor:
    """Content of a semantic descriptor.

    Attributes:
        classes: Word of each semantic id.
        rooms: Regions.
        problems: Regions that are not used.
    """

    classes: Mapping[int, str] = field(default_factory=dict)
    rooms: tuple[StatedRoom, ...] = ()
    problems: tuple[Problem, ...] = ()


def read_descriptor(document: JsonValue) -> SemanticDescriptor:
    """Read a semantic descriptor in JSON: `classes` and `region_annotations`, both optional.

    Raises:
        DatasetError: A value has another type, or a number is not finite.
    """
    classes, regions = document.member("classes"), document.member("region_annotations")
    words = {}
    for value in classes.entries() if classes.has_value else ():
        words[value.member("id").integer()] = value.member("name").text()[:100]
    found, problems = [], []
    for value in regions.entries() if regions.has_value else ():
        room = _region(value)
        if room is None:
            problems.append(Problem(value.element, "outline of the region has no area or crosses itself: not used"))
        else:
            found.append(room)
    return SemanticDescriptor(words, stack_rooms(found), tuple(problems))


def _region(value: JsonValue) -> StatedRoom | None:
    """Read one region; None if its outline is no polygon."""
    corners = np.array([point.vector(3)[[0, 2]] for point in value.member("poly_loop").entries()]).reshape(-1, 2)
    label, low, height = (value.member(key) for key in ("label", "floor_height", "extrusion_height"))
    floor = low.coordinate() if low.has_value else None
    size = float(np.clip(height.coordinate(), MIN_HEIGHT, MAX_HEIGHT)) if height.has_value else None
    if not is_outline(corners):
        return None
    ceiling = floor + size if floor is not None and size is not None else None
    return StatedRoom(corners, region_type(label.text()) if label.has_value else "", 0, floor, ceiling)


def region_type(label: str) -> str:
    """Return the type of a room of a region's label: the type itself in any spelling, else by words; "" if unknown.

    Example:
        >>> region_type("child room"), region_type("entryway/foyer/lobby"), region_type("void")
        ('Child_Room', 'Entryway', '')
    """
    word = plain_word(label)
    return next((name for name in ROOM_TYPES if plain_word(name) == word), "") or room_type(label)


def stack_rooms(rooms: Iterable[StatedRoom]) -> tuple[StatedRoom, ...]:
    """Return rooms with their storeys, which are at least `MIN_STOREY_HEIGHT` apart, from below."""
    found, level, base = [], 0, None
    for room in sorted(rooms, key=lambda room: room.floor if room.floor is not None else 0.0):
        height = room.floor if room.floor is not None else 0.0
        if base is None or height >= base + MIN_STOREY_HEIGHT:
            level, base = level + (base is not None), height
        found.append(StatedRoom(room.corners, room.type, level, room.floor, room.ceiling))
    return tuple(found)


def read_object_table(root: Path) -> Mapping[str, tuple[str, ...]]:
    """Return the words for each model of HSSD by its id; empty without the table.

    Raises:
        DatasetError: The table is not CSV.
    """
    path = root / OBJECT_TABLE
    if not is_file(path):
        return {}
    try:
        rows = list(csv.DictReader(read_text(path, max_bytes=MAX_TABLE_BYTES).splitlines()))
    except csv.Error as error:
        raise Location(path).error(f"not a table: {error}") from None
    return {row["id"]: tuple(filter(None, (_word(row.get(key)) for key in TABLE_WORDS))) for row in rows if "id" in row}


def _word(text: str | None) -> str:
    """Return a word of the table; of a synset such as `arm_chair.n.01` its lemma."""
    return (text or "").split(".")[0].strip()[:100]


@cache
def fine_of_word(text: str) -> str:
    """Return the fine category of a word of HSSD, ReplicaCAD or mpcat40, or of words in a name; `unknown` if none is.

    Example:
        >>> fine_of_word("base_cabinet"), fine_of_word("potted_plant"), fine_of_word("chestOfDrawers_01")
        ('kitchen_cabinet', 'plant', 'dresser')
    """
    word = plain_word(text)
    found = (vocabulary(source)[word] for source in SOURCES if word in vocabulary(source))
    return next(found, "") or find_category(text) or UNKNOWN
