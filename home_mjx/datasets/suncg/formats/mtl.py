"""Reader of Wavefront MTL files: names, diffuse colours, opacities and colour maps."""

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.formats.map_options import PlacedMap, read_color_map
from home_mjx.datasets.suncg.formats.statements import read_statement_lines, split_statements
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Material

MAX_SHININESS = 1000.0  # maximum of the MTL format
MISSING_COLOR = (0.7, 0.7, 0.7)  # sRGB of faces whose colour is unknown
REPEATED_MAP = PlacedMap()


@dataclass(frozen=True)
class LibraryMaterial:
    """One `newmtl` of an MTL.

    Attributes:
        material: The material.
        color_map: Placement of its colour map.
    """

    material: Material
    color_map: PlacedMap = REPEATED_MAP


def read_mtl(path: Path, textures: TextureLookup) -> tuple[Material, ...]:
    """Read the materials of an MTL in file order, which is the order of SUNCG's material slots.

    The default material is white and opaque. `Tr` is 1 - `d`; a `Tr` equal to the `d` above it is taken for `d`, and a
    `Tr 1` without a `d` above it is opaque: MeshLab before 2023, OpenMVS and others write it so. Arguments and errors
    are those of `read_library`.
    """
    return tuple(entry.material for entry in read_library(path, textures))


def read_library(path: Path, textures: TextureLookup, hint: str | None = None) -> tuple[LibraryMaterial, ...]:
    """Read the materials of an MTL with the placement of their colour maps.

    If the lookup is tolerant, a broken line changes its own material only: the line is skipped, a lost colour is grey,
    and `Material.missing_file` names the library. A broken `newmtl` is skipped with the lines below it. `hint` is the
    remedy if the file is missing.

    Raises:
        DatasetError: The file is missing, or one of its lines is broken.
    """
    blocks: dict[str, dict] = {}
    block: dict | None = None
    for number, keyword, rest in split_statements(read_statement_lines(path, hint, textures.tolerant)):
        place = Location(path, f"line {number}")
        try:
            if keyword == "newmtl":
                block = None
                block = blocks[_new_name(rest.strip(), blocks, place)] = {"diffuse": (1.0, 1.0, 1.0), "opacity": 1.0}
            elif keyword in _PROPERTIES:
                if block is None:
                    raise place.error(f"`{_SPELLING[keyword]}` before the first `newmtl`")
                block.update(_PROPERTIES[keyword](rest.strip(), textures, place, block))
        except DatasetError:
            if not textures.tolerant:
                raise
            if block is not None:
                block |= {"missing_file": path.name} | ({"diffuse": MISSING_COLOR} if keyword == "kd" else {})
    return tuple(_entry(name, block) for name, block in blocks.items())


def _entry(name: str, block: Mapping[str, Any]) -> LibraryMaterial:
    """Convert the values read for a `newmtl` to a material and its map's placement."""
    fields = {key: value for key, value in block.items() if key not in ("dissolve", "color_map")}
    return LibraryMaterial(Material(name, **fields), block.get("color_map", REPEATED_MAP))


def _new_name(name: str, known: dict, place: Location) -> str:
    """Return the name of a `newmtl`; raise `DatasetError` if it is empty or in `known`."""
    if not name:
        raise place.error("`newmtl` without a name")
    if name in known:
        raise place.error(f"material `{name[:60]}` is defined twice", "Give each material its own name.")
    return name


def _numbers(text: str, count: int, place: Location, largest: float = 1.0) -> list[float]:
    """Return the first `count` numbers, clipped to 0..`largest`; raise `DatasetError` unless all are finite."""
    words = text.split()[:count]
    try:
        numbers = [float(word) for word in words if word.isascii() and "_" not in word]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise place.error(f"expected {count} finite number(s), got `{text[:60]}`")
    return [min(max(x, 0.0), largest) for x in numbers]


def _color(text: str, place: Location) -> tuple[float, float, float]:
    """Return an sRGB colour, clipped to 0..1, from its first three numbers; one number is a grey.

    Raise `DatasetError` for two or no numbers, and for broken ones. A comment is ignored.
    """
    words = text.partition("#")[0].split()
    red, green, blue = _numbers(text, 3, place) if len(words) != 1 else _numbers(text, 1, place) * 3
    return red, green, blue


def _diffuse(text: str, _: TextureLookup, place: Location, __: dict) -> dict:
    """Read `Kd`, an sRGB colour clipped to 0..1."""
    return {"diffuse": _color(text, place)}


def _opacity(text: str, _: TextureLookup, place: Location, __: dict) -> dict:
    """Read `d` as opacity, clipped to 0..1, and record it as `dissolve` for a `Tr` below."""
    opacity = _numbers(re.sub("^-halo", "", text, flags=re.IGNORECASE), 1, place)[0]
    return {"opacity": opacity, "dissolve": opacity}


def _transparency(text: str, _: TextureLookup, place: Location, block: dict) -> dict:
    """Read opacity from `Tr`, clipped to 0..1: 1 - `Tr`, with the exceptions in `read_mtl`."""
    value = _numbers(text, 1, place)[0]
    return {"opacity": value if value == block.get("dissolve", 1.0) else 1.0 - value}


def _specular(text: str, _: TextureLookup, place: Location, __: dict) -> dict:
    """Read `Ks`, clipped to 0..1."""
    return {"specular": _color(text, place)}


def _shininess(text: str, _: TextureLookup, place: Location, __: dict) -> dict:
    """Read `Ns`, clipped to 0..`MAX_SHININESS`."""
    return {"shininess": _numbers(text, 1, place, MAX_SHININESS)[0]}


def _color_map(text: str, textures: TextureLookup, place: Location, _: dict) -> dict:
    """Read `map_Kd`: the texture, or its name as missing, and its placement as `color_map`."""
    placed = read_color_map(text, place, lambda name: textures.has_file(name, place.file.parent))
    name = Path(placed.file.replace("\\", "/")).stem
    found = textures.material_fields(name, lambda: textures.find_color_map(placed.file, place.file.parent, place))
    return {**found, "color_map": placed}


_PROPERTIES = {
    "kd": _diffuse,
    "d": _opacity,
    "tr": _transparency,
    "ks": _specular,
    "ns": _shininess,
    "map_kd": _color_map,
}
_SPELLING = {"kd": "Kd", "d": "d", "tr": "Tr", "ks": "Ks", "ns": "Ns", "map_kd": "map_Kd"}
