"""Reader of Wavefront MTL files: names, diffuse colours, opacities and colour maps."""

import math
from pathlib import Path

from home_mjx.core.files import read_text
from home_mjx.datasets.suncg.formats.json_value import Location
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.schema.house import Material

MAX_SHININESS = 1000.0  # maximum of the MTL format


def read_mtl(path: Path, textures: TextureLookup, hint: str | None = None) -> tuple[Material, ...]:
    """Read the materials of an MTL in file order, which is the order of SUNCG's material slots.

    The default material is white and opaque.

    Args:
        path: The MTL file.
        textures: Lookup of colour maps.
        hint: Remedy if the file is missing.

    Raises:
        DatasetError: The file is missing, or one of its lines is broken.
    """
    blocks: dict[str, dict] = {}
    block: dict | None = None
    for number, line in enumerate(read_text(path, hint).split("\n"), 1):
        keyword, _, rest = line.strip().replace("\t", " ").partition(" ")
        place = Location(path, f"line {number}")
        if keyword == "newmtl":
            block = blocks[_new_name(rest.strip(), blocks, place)] = {"diffuse": (1.0, 1.0, 1.0), "opacity": 1.0}
        elif keyword in _PROPERTIES:
            if block is None:
                raise place.error(f"`{keyword}` before the first `newmtl`")
            block.update(_PROPERTIES[keyword](rest.strip(), textures, place))
    return tuple(Material(name, **block) for name, block in blocks.items())


def _new_name(name: str, known: dict, place: Location) -> str:
    if not name:
        raise place.error("`newmtl` without a name")
    if name in known:
        raise place.error(f"material `{name[:60]}` is defined twice", "Give each material its own name.")
    return name


def _numbers(text: str, count: int, place: Location, largest: float = 1.0) -> list[float]:
    words = text.split()[:count]
    try:
        numbers = [float(word) for word in words]
    except ValueError:
        numbers = []
    if len(numbers) != count or not all(map(math.isfinite, numbers)):
        raise place.error(f"expected {count} finite number(s), got `{text[:60]}`")
    return [min(max(x, 0.0), largest) for x in numbers]


def _diffuse(text: str, _: TextureLookup, place: Location) -> dict:
    red, green, blue = _numbers(text, 3, place)
    return {"diffuse": (red, green, blue)}


def _opacity(text: str, _: TextureLookup, place: Location) -> dict:
    return {"opacity": _numbers(text, 1, place)[0]}


def _transparency(text: str, _: TextureLookup, place: Location) -> dict:
    return {"opacity": 1.0 - _numbers(text, 1, place)[0]}


def _specular(text: str, _: TextureLookup, place: Location) -> dict:
    red, green, blue = _numbers(text, 3, place)
    return {"specular": (red, green, blue)}


def _shininess(text: str, _: TextureLookup, place: Location) -> dict:
    return {"shininess": _numbers(text, 1, place, MAX_SHININESS)[0]}


def _color_map(text: str, textures: TextureLookup, place: Location) -> dict:
    if not text or text.startswith("-"):
        raise place.error(f"expected a file name, got `{text[:60]}`", "Options of map_Kd are not supported.")
    name = Path(text.replace("\\", "/")).stem
    return textures.material_fields(name, lambda: textures.find_color_map(text, place.file.parent, place))


_PROPERTIES = {
    "Kd": _diffuse,
    "d": _opacity,
    "Tr": _transparency,
    "Ks": _specular,
    "Ns": _shininess,
    "map_Kd": _color_map,
}
