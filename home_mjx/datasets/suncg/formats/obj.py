"""Reader of Wavefront OBJ files: positions, texture coordinates, materials and groups of triangles as a `Mesh`.

Lines are first grouped by keyword; material and group of a face then follow from line numbers.
"""

import re
from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.core.files import resolve_below
from home_mjx.datasets.kept_results import kept_result
from home_mjx.datasets.suncg.formats.json_value import MAX_COORDINATE, Location
from home_mjx.datasets.suncg.formats.mtl import MISSING_COLOR, LibraryMaterial, read_library
from home_mjx.datasets.suncg.formats.obj_faces import Rows, line_numbers, read_corners, smooth_normals, split_faces
from home_mjx.datasets.suncg.formats.statements import (
    OBJ_GEOMETRY,
    bare_name,
    read_statement_lines,
    split_library_names,
    split_statements,
)
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup, escape_error
from home_mjx.errors import DatasetError, did_you_mean
from home_mjx.schema.house import Material, Mesh

DEFAULT_MATERIAL = Material("default", (1.0, 1.0, 1.0), None, 1.0)  # material of faces above the first usemtl


def read_obj(path: Path, textures: TextureLookup) -> Mesh:
    """Read a mesh with its materials; polygons become triangles as in `geometry.faces.triangulate_faces`.

    Points, lines, free-form curves, smoothing groups and colours of vertices are skipped. All paths must be below the
    root of `textures`.

    Raises:
        DatasetError: The file or its MTL is missing, or a line is broken: not a number, not finite, an index
            out of range, an unknown material, a path out of the dataset, a polygon that crosses itself, a free-form
            surface, or no face at all. If `textures` is tolerant, a missing or broken MTL, unknown materials and
            crossing polygons are accepted.
    """
    return _mesh(_shape(read_statement_lines(path, tolerant=textures.tolerant), path, textures), path, textures)


def read_library_obj(path: Path, textures: TextureLookup) -> Mesh:
    """Read a mesh as `read_obj` does, but keep its parsed text by `kept_result`, since many houses use it."""
    text = read_statement_lines(path, tolerant=textures.tolerant)
    inputs = b"%d" % textures.tolerant + text.encode()
    return _mesh(kept_result(ObjShape, inputs, lambda: _shape(text, path, textures)), path, textures)


@dataclass(frozen=True)
class ObjShape:
    """Content of an OBJ that follows from its text alone.

    Attributes:
        vertices: Corners [m].
        faces: Indices into the vertices.
        uv: Texture coordinates of the corners as in the file; 0 where it has none.
        normal: Unit normals of the corners; empty if the file lacks normals or all are flat.
        use: Index of the `usemtl` of each face; -1 for none.
        group: Index of the group of each face; -1 for none.
        groups: Names of the groups.
        names: Arguments of each `usemtl`.
        name_lines: Line numbers of `names`.
        libraries: Arguments of each `mtllib`.
        library_lines: Line numbers of `libraries`.
    """

    vertices: Float[np.ndarray, "v 3"]
    faces: Int[np.ndarray, "f 3"]
    uv: Float[np.ndarray, "f 3 2"]
    normal: Float[np.ndarray, "n 3 3"]
    use: Int[np.ndarray, " f"]
    group: Int[np.ndarray, " f"]
    groups: tuple[str, ...]
    names: tuple[str, ...]
    name_lines: tuple[int, ...]
    libraries: tuple[str, ...]
    library_lines: tuple[int, ...]


def _shape(text: str, path: Path, textures: TextureLookup) -> ObjShape:
    """Parse the text of an OBJ to triangles without its MTL; raise those errors of `read_obj` that need none."""
    rows = scan_obj(text, path)
    if not rows["f"]:
        raise Location(path).error("mesh has no faces", "Export the model again or remove the nodes that use it.")
    vertices = read_table(rows["v"], 3, path)
    uv = np.vstack([np.zeros(2), read_table(rows["vt"], 2, path)])
    index, sides = read_corners(rows, path)
    corner, face = split_faces(vertices[index[:, 0] - 1], sides, rows["f"], path, textures.tolerant)
    groups, group = _groups(rows)
    normal = smooth_normals(rows["vn"], index[corner, 2], vertices[index[corner, 0] - 1])
    return ObjShape(
        vertices=vertices,
        faces=(index[corner, 0] - 1).astype(np.int32),
        uv=uv[index[corner, 1]],
        normal=np.zeros((0, 3, 3)) if normal is None else normal,
        use=_current(rows["usemtl"], rows["f"])[face].astype(np.int32),
        group=group[face],
        groups=groups,
        names=tuple(rest for _, rest in rows["usemtl"]),
        name_lines=tuple(line for line, _ in rows["usemtl"]),
        libraries=tuple(rest for _, rest in rows["mtllib"]),
        library_lines=tuple(line for line, _ in rows["mtllib"]),
    )


def _mesh(shape: ObjShape, path: Path, textures: TextureLookup) -> Mesh:
    """Read the materials of a shape and return its mesh; raise the errors of `read_obj` that concern them."""
    entries, slot = _materials(shape, path, textures)
    return Mesh(
        path=path,
        vertices=shape.vertices,
        faces=shape.faces,
        uv=_place_maps(shape.uv.copy(), slot, entries, path).astype(np.float32),
        slot=slot,
        group=shape.group,
        materials=tuple(entry.material for entry in entries),
        groups=shape.groups,
        normal=shape.normal if len(shape.normal) else None,
    )


def scan_obj(text: str, path: Path) -> dict[str, Rows]:
    """Return the statements of an OBJ by lower-case keyword, as (line number, arguments); `fo` counts as `f`.

    Raises:
        DatasetError: A statement describes a surface that is not read.
    """
    rows: dict[str, Rows] = defaultdict(list)
    if "\\" in text or "\r" in text:
        for number, keyword, rest in split_statements(text):
            rows[keyword].append((number, rest))
    else:
        _scan_plain(text, rows)
    for keyword in OBJ_GEOMETRY.keys() & rows.keys():
        hint = "Convert the model to polygons in the program that wrote it."
        place = Location(path, f"line {rows[keyword][0][0]}")
        raise place.error(f"`{keyword}` is {OBJ_GEOMETRY[keyword]}, which is not read", hint)
    if rows["fo"]:  # the same statement in older files
        rows["f"] = sorted(rows["f"] + rows["fo"])
    return rows


def _scan_plain(text: str, rows: dict[str, Rows]) -> None:
    """Add the statements of a text without backslashes and carriage returns to `rows`, in place.

    Lines with a keyword of numbers and one space are not split further, which is fast.
    """
    numeric = {keyword: rows[keyword] for keyword in ("v", "vt", "vn", "f")}
    for number, line in enumerate(text.split("\n"), 1):
        keyword, _, rest = line.partition(" ")
        if keyword in numeric and rest:
            numeric[keyword].append((number, rest))
        elif line:
            for _, word, words in split_statements(line):
                rows[word].append((number, words))


def _place_maps(
    uv: Float[np.ndarray, "t 3 2"], slot: Int[np.ndarray, " t"], entries: Sequence[LibraryMaterial], path: Path
) -> Float[np.ndarray, "t 3 2"]:
    """Apply scale and offset of the materials' colour maps to `uv`, in place, and return it.

    Raise `DatasetError` if a map is clamped and its faces reach beyond the image.
    """
    for number, entry in enumerate(entries):
        placed, own = entry.color_map, slot == number
        try:
            if placed.is_clamped or placed.scale != (1, 1) or placed.offset != (0, 0):
                uv[own] = placed.place(uv[own])
        except ValueError as error:
            place = Location(path, f"material `{entry.material.name[:60]}`")
            raise place.error(str(error), "Remove the option, or repeat the image.") from None
    return uv


def read_table(rows: Rows, width: int, path: Path) -> Float[np.ndarray, "n w"]:
    """Return the first `width` numbers of each row; further words are ignored.

    Raises:
        DatasetError: A number is missing, not finite or beyond `MAX_COORDINATE`.
    """
    words = [word for _, rest in rows for word in rest.split(None, width)[:width]]
    try:
        if any("_" in rest or not rest.isascii() for _, rest in rows) and not _is_plain(words):
            raise ValueError
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


def _is_plain(words: Sequence[str]) -> bool:
    """Return whether words are ASCII without `_`: Python's `float` also reads `1_0` and other digits."""
    text = " ".join(words)
    return text.isascii() and "_" not in text


def _numeric(text: str, width: int) -> bool:
    """Return whether a text begins with `width` numbers."""
    words = text.split(None, width)[:width]
    try:
        return _is_plain(words) and len([float(word) for word in words]) == width
    except ValueError:
        return False


def _current(rows: Rows, faces: Rows) -> Int[np.ndarray, " f"]:
    """Return the index of the last of `rows` above each face; -1 for none."""
    return np.searchsorted(line_numbers(rows), line_numbers(faces)) - 1


def _materials(
    shape: ObjShape, path: Path, textures: TextureLookup
) -> tuple[tuple[LibraryMaterial, ...], Int[np.ndarray, " f"]]:
    """Return the materials of a shape's libraries, in slot order, and the slot of each face.

    If the lookup is tolerant, undefined names get grey materials. `DEFAULT_MATERIAL` is last if a face needs it.
    """
    used_names = list(zip(shape.name_lines, shape.names, strict=True))
    libraries = find_libraries(list(zip(shape.library_lines, shape.libraries, strict=True)), path, textures)
    entries = tuple(m for library, place in libraries.items() for m in _read_library(library, place, textures))
    if textures.tolerant:
        name = next(iter(libraries), path.with_suffix(".mtl")).name
        known = [entry.material for entry in entries]
        entries += tuple(map(LibraryMaterial, missing_materials(used_names, known, name)))
    slots = _slots([entry.material.name for entry in entries])
    used = [-1 if textures.tolerant and not row[1].strip() else _slot(row, slots, path) for row in used_names]
    slot = np.array([*used, -1], np.int32)[shape.use]
    if (slot < 0).any():
        entries += (LibraryMaterial(DEFAULT_MATERIAL),)
    # Faces above every usemtl, and behind one without a name, have the plain material at the end.
    return entries, np.where(slot < 0, np.int32(len(entries) - 1), slot)


def _slots(names: Sequence[str]) -> Mapping[str, int]:
    """Map each name, and it without comment and quotes, to its position in `names`.

    Whole names take precedence over shortened ones, then earlier names over later ones.
    """
    slots: dict[str, int] = {}
    for name, slot in (*((n, i) for i, n in enumerate(names)), *((bare_name(n), i) for i, n in enumerate(names))):
        slots.setdefault(name, slot)
    return slots


def _read_library(library: Path, place: Location, textures: TextureLookup) -> tuple[LibraryMaterial, ...]:
    """Read the materials of a library; empty if it is missing or unreadable and the lookup is tolerant."""
    try:
        return read_library(library, textures, _remedy(place))
    except DatasetError:
        if not textures.tolerant:
            raise
        return ()


def missing_materials(used: Rows, known: Sequence[Material], library: str) -> tuple[Material, ...]:
    """Create grey materials for the names of `used` (rows of `usemtl`) that no material in `known` has.

    They continue SUNCG's order `material_0`, `material_1`, ..., where slots are positions, so unused numbers below the
    highest are filled. Other names follow. Each records `library`, with `.mtl`, as its missing file.
    """
    defined = _slots([material.name for material in known])
    names = dict.fromkeys(name for _, rest in used if (name := rest.strip()))
    missing = {name for name in names if name not in defined and bare_name(name) not in defined}
    numbers = [int(name[9:]) for name in missing if re.fullmatch("material_[0-9]{1,3}", name)]
    slots = [f"material_{i}" for i in range(len(known), max(numbers, default=-1) + 1)]  # slots are positions
    named = [name for name in slots if name not in names or name in missing]
    others = [name for name in names if name in missing and name not in named]
    return tuple(Material(name, MISSING_COLOR, None, 1.0, missing_file=library) for name in (*named, *others))


def find_libraries(rows: Rows, path: Path, textures: TextureLookup) -> dict[Path, Location]:
    """Return the material libraries that `mtllib` rows name, with the first line of each, in file order.

    They may not exist. Errors are those of `read_obj`.
    """
    libraries: dict[Path, Location] = {}
    for row in rows:
        for library, place in _libraries(row, path, textures):
            libraries.setdefault(library, place)
    return libraries


def _libraries(row: tuple[int, str], path: Path, textures: TextureLookup) -> list[tuple[Path, Location]]:
    """Return path and line of each file that a `mtllib` row names; they may not exist.

    The whole text is one name if that file exists. Otherwise its words are names if all these files exist, else it is
    split by `split_library_names`.

    Raises:
        DatasetError: A path leads out of the dataset, or there is no name and the lookup is not tolerant.
    """
    place, text = Location(path, f"line {row[0]}"), row[1].strip()
    if not text:
        if textures.tolerant:
            return []
        raise place.error("`mtllib` without a file name")
    names = [text]
    if not textures.has_file(text, path.parent):
        names = split_library_names(text)
        words = text.split()
        if len(words) > 1 and all(textures.has_file(word, path.parent) for word in words):
            names = words
    found = [(name, resolve_below(textures.root, path.parent, name)) for name in names]
    for name, library in found:
        if library is None:
            raise escape_error(name, place)
    return [(library, place) for _, library in found if library is not None]


def _remedy(place: Location) -> str:
    """Return a hint for a missing library, given the `mtllib` line that names it."""
    return f"{place.file} needs it: fetch or write it again, or correct {place.element} there."


def _slot(row: tuple[int, str], slots: Mapping[str, int], path: Path) -> int:
    """Return the slot of the material that a `usemtl` row names; raise `DatasetError` if it is unknown or empty."""
    name = row[1].strip()
    if not name:
        raise Location(path, f"line {row[0]}").error("`usemtl` without a name")
    slot = slots.get(name, slots.get(bare_name(name)))
    if slot is None:
        raise _unknown_material(name, slots, Location(path, f"line {row[0]}"))
    return slot


def _unknown_material(name: str, slots: Mapping[str, int], place: Location) -> DatasetError:
    """Return, without raising it, the error for a `usemtl` name that no library has."""
    hint = did_you_mean(name, slots) if slots else "Add a `mtllib` line that names an MTL file."
    return place.error(f"material `{name[:60]}` is not in the material library", hint)


def _groups(rows: dict[str, Rows]) -> tuple[tuple[str, ...], Int[np.ndarray, " f"]]:
    """Return the distinct names of `o` statements, or of `g` without any `o`, and each face's index into them.

    Names are in order of first appearance, so statements of one name are one group. Faces above all have -1.
    """
    marks = rows["o"] or rows["g"]
    names = [rest.strip() for _, rest in marks]
    position = {name: i for i, name in enumerate(dict.fromkeys(names))}
    number = np.array([*(position[name] for name in names), -1], np.int32)
    return tuple(position), number[_current(marks, rows["f"])]
