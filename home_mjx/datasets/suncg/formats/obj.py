"""Reader of Wavefront OBJ files: positions, texture coordinates, materials and groups of triangles as a `Mesh`.

Lines are first grouped by keyword; material and group of a face then follow from line numbers.
"""

import re
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.files import read_text, resolve_below
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location
from home_mjx.datasets.suncg.formats.mtl import read_mtl
from home_mjx.datasets.suncg.formats.obj_faces import Rows, line_numbers, read_corners, smooth_normals, triangulate_fans
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup, escape_error
from home_mjx.errors import DatasetError, did_you_mean
from home_mjx.schema.house import Material, Mesh

MISSING_COLOR = (0.7, 0.7, 0.7)  # sRGB of faces with a missing material library
DEFAULT_MATERIAL = Material("default", (1.0, 1.0, 1.0), None, 1.0)  # material of faces above the first usemtl


def read_obj(path: Path, textures: TextureLookup) -> Mesh:
    """Read a mesh with its materials; polygons become triangle fans, including degenerate triangles.

    Args:
        path: The OBJ file.
        textures: Lookup of colour maps; all paths must be below its root.

    Raises:
        DatasetError: The file or its MTL is missing, or a line is broken: not a number, not finite, an index
            out of range, an unknown material, a path out of the dataset, or no face at all.
    """
    rows = _scan(read_text(path))
    if not rows["f"]:
        raise Location(path).error("mesh has no faces", "Export the model again or remove the nodes that use it.")
    vertices = _table(rows["v"], 3, path)
    uv = np.vstack([np.zeros(2), _table(rows["vt"], 2, path)])
    index, sides = read_corners(rows, path)
    corner, face = triangulate_fans(sides)
    materials, slot = _materials(rows, path, textures)
    groups, group = _groups(rows)
    return Mesh(
        path=path,
        vertices=vertices,
        faces=(index[corner, 0] - 1).astype(np.int32),
        uv=uv[index[corner, 1]].astype(np.float32),
        slot=slot[face],
        group=group[face],
        materials=materials,
        groups=groups,
        normal=smooth_normals(rows["vn"], index[corner, 2], vertices[index[corner, 0] - 1]),
    )


def _scan(text: str) -> dict[str, Rows]:
    rows: dict[str, Rows] = defaultdict(list)
    for number, line in enumerate(text.split("\n"), 1):
        words = line.split(None, 1)
        if words:
            rows[words[0]].append((number, words[1] if len(words) == 2 else ""))
    return rows


def _table(rows: Rows, width: int, path: Path) -> Float[np.ndarray, "n w"]:
    words = [word for _, rest in rows for word in rest.split(None, width)[:width]]
    try:
        table = np.array([float(word) for word in words]).reshape(len(rows), width)
    except ValueError:
        number, rest = next(row for row in rows if not _numeric(row[1], width))
        raise Location(path, f"line {number}").error(f"expected {width} numbers, got `{rest.strip()[:60]}`") from None
    usable = (abs(table) <= MAX_COORDINATE).all(axis=1)  # False for NaN
    if not usable.all():
        number, rest = rows[int(usable.argmin())]
        hint = f"Coordinates must be finite and below {MAX_COORDINATE:g}: export the model again."
        raise Location(path, f"line {number}").error(f"expected finite numbers, got `{rest.strip()[:60]}`", hint)
    return table


def _numeric(text: str, width: int) -> bool:
    try:
        return len([float(word) for word in text.split(None, width)[:width]]) == width
    except ValueError:
        return False


def _current(rows: Rows, faces: Rows) -> Int[np.ndarray, " f"]:
    """Return the index of the last of `rows` above each face; -1 for none."""
    return np.searchsorted(line_numbers(rows), line_numbers(faces)) - 1


def _materials(
    rows: dict[str, Rows], path: Path, textures: TextureLookup
) -> tuple[tuple[Material, ...], Int[np.ndarray, " f"]]:
    libraries: dict[Path, Location] = {}  # each library is read once, even if named repeatedly
    for row in rows["mtllib"]:
        libraries.setdefault(*_library(row, path, textures))
    materials = tuple(m for library, place in libraries.items() for m in _read_library(library, place, textures))
    if textures.tolerant:
        materials += missing_materials(rows["usemtl"], materials, next(iter(libraries), path.with_suffix(".mtl")).name)
    slots = {material.name: slot for slot, material in enumerate(materials)}
    used = [_slot(row, slots, path) for row in rows["usemtl"]]
    current = _current(rows["usemtl"], rows["f"])
    if (current < 0).any():
        materials += (DEFAULT_MATERIAL,)
    # Index -1, for faces above every usemtl, selects the plain material at the end of both.
    return materials, np.array([*used, len(materials) - 1], np.int32)[current]


def _read_library(library: Path, place: Location, textures: TextureLookup) -> tuple[Material, ...]:
    """Read the materials of a library; empty if it is missing or broken and the lookup is tolerant."""
    try:
        return read_mtl(library, textures, _remedy(place))
    except DatasetError:
        if not textures.tolerant:
            raise
        return ()


def missing_materials(used: Rows, known: Sequence[Material], library: str) -> tuple[Material, ...]:
    """Create grey materials for names without a definition, in SUNCG's order `material_0`, `material_1`, ...

    Args:
        used: Lines of `usemtl`.
        known: Materials of the libraries.
        library: Name of the library that should define them, with `.mtl`.
    """
    names = dict.fromkeys(name for _, rest in used if (name := rest.strip()))
    missing = names.keys() - {material.name for material in known}
    numbers = [int(name[9:]) for name in missing if re.fullmatch("material_[0-9]{1,3}", name)]
    slots = [f"material_{i}" for i in range(len(known), max(numbers, default=-1) + 1)]  # slots are positions
    named = [name for name in slots if name not in names or name in missing]
    others = [name for name in names if name in missing and name not in named]
    return tuple(Material(name, MISSING_COLOR, None, 1.0, missing_file=library) for name in (*named, *others))


def _library(row: tuple[int, str], path: Path, textures: TextureLookup) -> tuple[Path, Location]:
    place = Location(path, f"line {row[0]}")
    library = resolve_below(textures.root, path.parent, row[1].strip())
    if library is None:
        raise escape_error(row[1].strip(), place)
    return library, place


def _remedy(place: Location) -> str:
    return f"{place.file} needs it: fetch or write it again, or correct {place.element} there."


def _slot(row: tuple[int, str], slots: dict[str, int], path: Path) -> int:
    name = row[1].strip()
    if name not in slots:
        raise _unknown_material(name, slots, Location(path, f"line {row[0]}"))
    return slots[name]


def _unknown_material(name: str, slots: dict[str, int], place: Location) -> DatasetError:
    hint = did_you_mean(name, slots) if slots else "Add a `mtllib` line that names an MTL file."
    return place.error(f"material `{name[:60]}` is not in the material library", hint)


def _groups(rows: dict[str, Rows]) -> tuple[tuple[str, ...], Int[np.ndarray, " f"]]:
    marks = rows["o"] or rows["g"]
    names = [rest.strip() for _, rest in marks]
    position = {name: i for i, name in enumerate(dict.fromkeys(names))}
    number = np.array([*(position[name] for name in names), -1], np.int32)
    return tuple(position), number[_current(marks, rows["f"])]
