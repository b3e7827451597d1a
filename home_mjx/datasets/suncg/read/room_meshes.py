"""Meshes of rooms and grounds: from `room/` in SUNCG v1, else from the architecture file of v2."""

from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Int

from home_mjx.core.files import is_file, is_folder
from home_mjx.datasets.suncg.formats.json_value import JsonValue
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.errors import DatasetError, MissingFileError
from home_mjx.schema.house import Fallback, Mesh

MESH_SUFFIX = {"Floor": "f", "Ceiling": "c", "Wall": "w", "Ground": "f"}
HIDING_FLAG = {"Floor": "hideFloor", "Ceiling": "hideCeiling", "Wall": "hideWalls", "Ground": "hideFloor"}


def read_part(node: JsonValue, kind: str, node_id: str, reading: ReaderState) -> Mesh | None:
    """Read a mesh of a room or ground [m, Y up]; None if it is hidden or, with a note, missing.

    With fallbacks enabled, missing or broken meshes are recorded in `reading.missing_parts`.

    Args:
        node: Node of the room or ground.
        kind: `Floor`, `Ceiling`, `Wall` or `Ground`.
        node_id: Id of the node in the architecture file.
        reading: State of the reader.

    Raises:
        DatasetError: The house has neither a folder of meshes nor an architecture file, or one of them is broken.
    """
    if node.member(HIDING_FLAG[kind]).flag():
        return None
    stem = node.member("modelId").name() + MESH_SUFFIX[kind]
    if reading.tolerant:
        return _found_or_missing(node, kind, node_id, stem, reading)
    path = reading.assets.room_path(reading.house_id, stem)
    if is_file(path):
        return reading.cached(f"room/{stem}", _mesh, path, reading)
    return _built(node, kind, node_id, stem, reading)


def _found_or_missing(node: JsonValue, kind: str, node_id: str, stem: str, reading: ReaderState) -> Mesh | None:
    """Read the mesh's file, else the architecture file's; if both fail, record it in `missing_parts` and return None.

    The second is recorded in `fallbacks` if the house has a folder of meshes. Errors are recorded, not raised.
    """
    path, reason = reading.assets.room_path(reading.house_id, stem), ""
    try:
        if is_file(path):
            return reading.cached(f"room/{stem}", _mesh, path, reading)
    except DatasetError as error:
        reason = error.message
    try:
        architecture = reading.architecture
        mesh = reading.cached(f"{kind}#{node_id}", architecture.mesh, kind, node_id) if architecture else None
    except DatasetError as error:
        mesh, reason = None, reason or error.message
    if mesh is None:
        reading.missing_parts[node.element, kind] = reason
    elif is_folder(path.parent):  # only v1 has this folder; in v2 the architecture file is the regular source
        reading.fallbacks.append(Fallback("room mesh", stem, node.element, "the architecture file's", reason))
    return mesh


def _mesh(path: Path, reading: ReaderState) -> Mesh:
    """Read an OBJ of `room/`, scaled to metres; faces of walls get the number of their wall as `part`."""
    mesh = reading.assets.mesh(path)
    mesh = replace(mesh, part=_wall_of_faces(mesh)) if path.stem.endswith(MESH_SUFFIX["Wall"]) else mesh
    return replace(mesh, vertices=mesh.vertices * reading.scale) if reading.scale != 1 else mesh


def _wall_of_faces(mesh: Mesh) -> Int[np.ndarray, " f"]:
    """Return the number of the wall of each face, by first occurrence in the group names; -1 without a group.

    The inner and outer layer, WallInside#0_1_3 and WallOutside#0_1_3, are one wall.
    """
    numbers = [name.rpartition("#")[2] for name in mesh.groups]
    order = {number: i for i, number in enumerate(dict.fromkeys(numbers))}
    return np.array([*(order[number] for number in numbers), -1])[mesh.group]


def _built(node: JsonValue, kind: str, node_id: str, stem: str, reading: ReaderState) -> Mesh | None:
    """Build a mesh by the architecture file; None, with a note, if that has none. Errors as in `read_part`."""
    folder, architecture = reading.assets.room_path(reading.house_id, stem).parent, reading.architecture
    mesh = reading.cached(f"{kind}#{node_id}", architecture.mesh, kind, node_id) if architecture else None
    if mesh is None and architecture is None and not is_folder(folder):
        hint = (
            f"SUNCG v2 comes without room meshes: fetch them with `download_suncg.py -v v1 -t room`, "
            f"or put wall/{reading.house_id}/{reading.house_id}.arch.json into the dataset."
        )
        raise node.error(f"house has no folder of room meshes {folder}", hint, MissingFileError)
    if mesh is None:
        reading.note(node.member("modelId"), "missing-part", f"mesh {stem}.obj is missing: not shown")
    return mesh
