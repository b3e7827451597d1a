"""Rules on the OBJ and MTL files themselves: faces with holes, bent faces, statements that are not read."""

import math
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.core.files import is_file
from home_mjx.datasets.suncg.formats.mtl import MAX_SHININESS
from home_mjx.datasets.suncg.formats.obj import find_libraries, read_table, scan_obj
from home_mjx.datasets.suncg.formats.obj_faces import Rows, read_corners
from home_mjx.datasets.suncg.formats.statements import (
    MTL_IGNORED,
    MTL_READ,
    OBJ_IGNORED,
    OBJ_READ,
    bare_name,
    read_statement_lines,
    split_statements,
)
from home_mjx.datasets.suncg.validate.context import ValidationContext
from home_mjx.errors import DatasetError
from home_mjx.geometry.meshes import min_thickness
from home_mjx.schema.house import Mesh

MAX_BEND = 0.01  # maximum distance of corners from the plane of their face, as a fraction of its extent
MIN_THICKNESS = 1e-6  # [m], minimum thickness of a model that is not flat
HEADER_LENGTH = 400  # characters of an MTL in which exporters write their names
VALUES = {  # numeric properties of an MTL: spelling, values, maximum
    "kd": ("Kd", 3, 1.0),
    "ks": ("Ks", 3, 1.0),
    "d": ("d", 1, 1.0),
    "tr": ("Tr", 1, 1.0),
    "ns": ("Ns", 1, MAX_SHININESS),
}
COLOR_WIDTH = 6  # numbers of a vertex with a colour


def check_faces(subject: ValidationContext) -> None:
    """Report faces with holes, bent faces, statements that are not read, and models without thickness."""
    meshes = {mesh.path: mesh for mesh in subject.reading.results.values() if isinstance(mesh, Mesh)}
    for path in (path for path in meshes if path.suffix == ".obj" and is_file(path)):
        subject.reading.attempt(_check_file, subject, path)
    for mesh in subject.house.models.values():
        if min_thickness(mesh.vertices[mesh.faces]) < MIN_THICKNESS:
            message = "it has no thickness: it never moves, and its collision box has 0.2 mm"
            subject.report("flat-model", "", message, mesh.path)


def _check_file(subject: ValidationContext, path: Path) -> None:
    """Apply the rules to one OBJ and to the MTLs that it names."""
    rows = scan_obj(read_statement_lines(path, tolerant=subject.reading.tolerant), path)
    points = read_table(rows["v"], 3, path)
    index, sides = read_corners(rows, path)
    corners = points[index[:, 0] - 1]
    for line, rule, message in (*_odd_faces(corners, sides, rows["f"]), *_odd_statements(rows)):
        subject.report(rule, f"line {line}", message, path)
    for library in (library for library in find_libraries(rows["mtllib"], path, subject.reading.assets.textures)):
        _check_library(subject, library)


def _check_library(subject: ValidationContext, path: Path) -> None:
    """Report statements of an MTL that are not read, clamped values and ambiguous opacities."""
    try:
        text = read_statement_lines(path, tolerant=subject.reading.tolerant)
    except DatasetError:
        return  # reported by the reader
    for keyword, line in _unread_statements(text).items():
        subject.report("unread-statement", f"line {line}", f"`{keyword[:60]}` is not read", path)
    for keyword, line in _clamped_values(text).items():
        subject.report("clamped-value", f"line {line}", f"`{keyword}` is outside of its range: it is clamped", path)
    for line, message in _ambiguous_opacities(text):
        subject.report("ambiguous-opacity", f"line {line}", message, path)


def _unread_statements(text: str) -> dict[str, int]:
    """Return the first line of each statement of an MTL that is not read.

    A `map_d` of the material's `map_Kd` is no such statement, since the alpha of colour maps is read.
    """
    seen: dict[str, int] = {}
    block, color_maps, opacity_maps = 0, set(), []
    for line, keyword, rest in split_statements(text):
        block += keyword == "newmtl"
        if keyword == "map_kd":
            color_maps.add((block, _file_name(rest)))
        elif keyword == "map_d":
            opacity_maps.append((line, block, _file_name(rest)))
        elif keyword not in MTL_READ | MTL_IGNORED:
            seen.setdefault(keyword, line)
    other = [line for line, *place in opacity_maps if tuple(place) not in color_maps]
    return seen | ({"map_d": min(other)} if other else {})


def _file_name(text: str) -> str:
    """Return the last word of the arguments of a map without its folders, in lower case; "" without a word."""
    words = re.split(r"[\\/\s]+", bare_name(text).lower())
    return words[-1]


def _clamped_values(text: str) -> dict[str, int]:
    """Return the first line of each numeric property of an MTL with a value outside of its range, by its name (`Kd`).

    Words that are no numbers are ignored.
    """
    seen: dict[str, int] = {}
    for line, keyword, rest in split_statements(text):
        if keyword in VALUES:
            name, count, largest = VALUES[keyword]
            numbers = [
                _numeric_prefix(word) for word in re.sub("^-halo", "", rest, flags=re.IGNORECASE).split()[:count]
            ]
            if any(number < 0 or number > largest for number in numbers):
                seen.setdefault(name, line)
    return seen


def _ambiguous_opacities(text: str) -> Iterator[tuple[int, str]]:
    """Yield line and message of each `Tr` of a material without `d` whose meaning depends on the exporter.

    MeshLab before 2023 writes opacity as `Tr`, later versions transparency, under the same header.
    """
    is_meshlab = "meshlab" in text[:HEADER_LENGTH].lower()
    found: dict[int, str] = {}
    has_dissolve = False
    for line, keyword, rest in (*split_statements(text), (0, "newmtl", "")):
        if keyword == "newmtl":
            yield from () if has_dissolve else found.items()
            found, has_dissolve = {}, False
        has_dissolve |= keyword == "d"
        if keyword == "tr" and _numeric_prefix(rest) >= 1:
            found[line] = "`Tr 1` without `d` is read as opaque"
        elif keyword == "tr" and is_meshlab:
            found[line] = "`Tr` of MeshLab without `d` is read as transparency; before 2023 it was opacity"


def _numeric_prefix(text: str) -> float:
    """Return the first word as a number; NaN, which compares false, if it is none."""
    try:
        return float(text.split()[0])
    except (ValueError, IndexError):
        return math.nan


def _odd_statements(rows: dict[str, Rows]) -> Iterator[tuple[int, str, str]]:
    """Yield line, rule and message of the first statement of each kind that is not read."""
    for keyword in rows.keys() - OBJ_READ - OBJ_IGNORED:
        if rows[keyword]:
            yield rows[keyword][0][0], "unread-statement", f"`{keyword[:60]}` is not read"
    for line, rest in rows["v"]:
        if len(rest.partition("#")[0].split()) >= COLOR_WIDTH:
            yield line, "unread-statement", "colours of vertices are not read"
            return


def _odd_faces(
    corners: Float[np.ndarray, "c 3"], sides: Int[np.ndarray, " f"], rows: Rows
) -> Iterator[tuple[int, str, str]]:
    """Yield line, rule and message of the first face with a bridge and of the first bent one of more than four corners.

    The message counts all such faces. Bent quads are common in SUNCG, and their two triangles leave little doubt.
    """
    first = np.cumsum(sides) - sides
    odd: dict[str, list[int]] = {"bridged-face": [], "bent-face": []}
    for count in np.unique(sides[sides > 3]).tolist():
        faces = np.flatnonzero(sides == count)
        polygons = corners[first[faces][:, None] + np.arange(count)]
        odd["bridged-face"] += faces[_has_bridge(polygons)].tolist()
        odd["bent-face"] += faces[_is_bent(polygons)].tolist() if count > 4 else []
    messages = {
        "bridged-face": "of the faces visit a corner twice: cut along the bridge to their holes",
        "bent-face": "of the faces are bent: cut as seen along their mean normal",
    }
    for rule, found in odd.items():
        if found:
            yield rows[min(found)][0], rule, f"{len(found)} {messages[rule]}"


def _has_bridge(polygons: Float[np.ndarray, "m n 3"]) -> Bool[np.ndarray, " m"]:
    """Return which polygons return to one of their corners; corners repeated at once count as one."""
    repeated = (polygons == np.roll(polygons, 1, axis=1)).all(axis=2)
    found = _visits_twice(polygons)
    for row in np.flatnonzero(found & repeated.any(axis=1)).tolist():
        found[row] = _visits_twice(polygons[row][~repeated[row]][None])[0]
    return found


def _visits_twice(polygons: Float[np.ndarray, "m n 3"]) -> Bool[np.ndarray, " m"]:
    """Return which polygons have two equal corners."""
    order = np.lexsort(polygons.transpose(2, 0, 1), axis=1)
    ordered = np.take_along_axis(polygons, order[..., None], axis=1)
    return (np.diff(ordered, axis=1) == 0).all(axis=2).any(axis=1)


def _is_bent(polygons: Float[np.ndarray, "m n 3"]) -> Bool[np.ndarray, " m"]:
    """Return which polygons' corners spread by over `MAX_BEND` of the extent along the vector area."""
    away = polygons - polygons[:, :1]
    normal = np.cross(away[:, :-1], away[:, 1:]).sum(axis=1)
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.divide(normal, length, out=np.zeros_like(normal), where=length > 0)
    height = np.einsum("mni,mi->mn", away, normal)
    extent = np.sqrt((away**2).sum(axis=2).max(axis=1))
    return np.ptp(height, axis=1) > MAX_BEND * extent
