"""Writer of houses and model libraries in SUNCG v1's on-disk format, each folder atomically.

It accepts the records of the reader, so any `House` can be written.
"""

import hashlib
import json
import logging
import os
import shutil
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, UInt8

from home_mjx.core.files import read_bytes, read_text, write_atomically
from home_mjx.core.images import decode_image, encode_png
from home_mjx.datasets.suncg.formats.variants import state_of
from home_mjx.datasets.suncg.read.joints import JOINTS
from home_mjx.datasets.suncg.write.metadata import LibraryModel, categories_csv, joints_csv, lights_json, sizes_csv
from home_mjx.datasets.suncg.write.obj import mtl_text, obj_text
from home_mjx.errors import DatasetError
from home_mjx.schema.house import BoxNode, GroundNode, House, Level, Material, Mesh, Node, ObjectNode, RoomNode

DIGESTS = "sha256.json"  # digests of the files of a house's folder
JOINTS_DIGEST = "joints.sha256.json"  # separate, so that datasets written before joints existed stay valid
PARTIAL_PREFIX = ".partial-"  # prefix of incomplete folders

log = logging.getLogger(__name__)

Bounds = Float[np.ndarray, "2 3"]
_BOX_CORNERS = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])


def write_house(root: Path, house: House) -> None:
    """Write `house/<id>/` and `room/<id>/` below a dataset root; an existing house is kept.

    Bounding boxes are computed from the geometry by SUNCG's rules: an object's from its base model in any state, a
    room's from its architecture and its members. Meshes are named by the stem of their `path`, which must be unique.

    Args:
        root: Dataset root; its library must contain the models and textures of the house.
        house: House to write. For an object in another state, `models` should also contain the base model; otherwise
            the object keeps its original bounding box.

    Raises:
        DatasetError: The folders cannot be written.
    """
    rooms = {f"{mesh.path.stem}": mesh for level in house.levels for mesh in _architecture(level)}
    files = {
        name: text
        for stem, mesh in rooms.items()
        for name, text in ((f"{stem}.obj", obj_text(mesh, f"{stem}.mtl")), (f"{stem}.mtl", mtl_text(mesh.materials)))
    }
    document = json.dumps(house_document(house), separators=(",", ":"))
    digests = {f"room/{name}": _digest(text) for name, text in files.items()} | {"house.json": _digest(document)}
    # house.json last: readers list houses by it, so a house never appears without its rooms.
    _write_folder(root, Path("room") / house.id, files)
    _write_folder(root, Path("house") / house.id, {"house.json": document, DIGESTS: json.dumps(digests)})


def is_house_complete(root: Path, house_id: str) -> bool:
    """Return whether all files of a house exist and are as written, by their digests.

    Without digests, as in former versions, return whether its `house.json` is JSON and its folder of rooms exists.
    """
    folder, rooms = root / "house" / house_id, root / "room" / house_id
    try:
        if not (folder / DIGESTS).is_file():
            json.loads(read_text(folder / "house.json"))
            return rooms.is_dir()
        digests: dict[str, str] = json.loads(read_text(folder / DIGESTS))
        places = {name: rooms / name[5:] if name.startswith("room/") else folder / name for name in digests}
        return all(_digest(read_text(path)) == digests[name] for name, path in places.items())
    except (DatasetError, ValueError, TypeError, AttributeError, RecursionError):
        return False


def _digest(text: str) -> str:
    """Return the hexadecimal SHA-256 of a text in UTF-8."""
    return hashlib.sha256(text.encode()).hexdigest()


def write_library(
    root: Path, models: Sequence[LibraryModel], textures: Mapping[str, UInt8[np.ndarray, "h w 3"]]
) -> None:
    """Write `object/`, `texture/` and, last, `metadata/` below a dataset root; files that differ are rewritten.

    There is a `joints.csv` only if a model has joints. Tables and digests of a former library do not stay; models and
    textures that the new tables do not list do.

    Args:
        root: Dataset root.
        models: The models, in the order of their rows in the tables.
        textures: sRGB images by name without extension, row 0 at the top.

    Raises:
        DatasetError: The folders cannot be written.
    """
    for model in models:
        write_model(root, model)
    write_textures(root, textures)
    is_jointed = any(model.joints for model in models)
    _remove_files(root / "metadata", (DIGESTS,) if is_jointed else (DIGESTS, JOINTS, JOINTS_DIGEST))
    write_tables(root, models)
    if is_jointed:
        write_joints(root, models)


def write_model(root: Path, model: LibraryModel, digests: bool = False) -> None:
    """Write one model's folder below a dataset root; with `digests`, also digests of its files.

    Files that differ are rewritten. Variants use the MTL of the base mesh, so only its materials are written.

    Raises:
        DatasetError: The folder cannot be written.
    """
    key = model.info.model_id
    meshes = {key: model.mesh, **model.variants}
    files = {f"{stem}.obj": obj_text(mesh, f"{key}.mtl") for stem, mesh in meshes.items()}
    files |= {f"{key}.mtl": mtl_text(model.mesh.materials)}
    _write_folder(root, Path("object") / key, {**files, **(_digests(files) if digests else {})}, mend=True)


def write_textures(root: Path, textures: Mapping[str, UInt8[np.ndarray, "h w 3"]]) -> None:
    """Write sRGB images (row 0 at the top) as `texture/<name>.png` below a root; rewrite those that differ.

    Other files of the folder are kept.

    Raises:
        DatasetError: The folder cannot be written.
    """
    _write_folder(root, Path("texture"), {})  # processes may write different textures at the same time
    _write_folder(root, Path("texture"), {f"{name}.png": image for name, image in textures.items()}, mend=True)


def write_tables(root: Path, models: Sequence[LibraryModel]) -> None:
    """Write the metadata tables of models, in this order, below a dataset root; rewrite files that differ.

    The table of joints is not among them, see `write_joints`.

    Raises:
        DatasetError: The folder cannot be written.
    """
    _write_folder(root, Path("metadata"), format_tables(models), mend=True)


def format_tables(models: Sequence[LibraryModel]) -> dict[str, str]:
    """Return the texts of the tables of models, without joints, by file name."""
    return {
        "ModelCategoryMapping.csv": categories_csv(models),
        "models.csv": sizes_csv(models),
        "suncgModelLights.json": lights_json(models),
    }


def write_joints(root: Path, models: Sequence[LibraryModel]) -> None:
    """Write `metadata/joints.csv`, the movable parts of models, in this order, below a root, with its digest.

    Raises:
        DatasetError: The folder cannot be written.
    """
    _write_joint_table(root, joints_csv(models))


def write_table_texts(root: Path, tables: Mapping[str, str]) -> None:
    """Write metadata tables (texts by file name) and their digests below a root; rewrite files that differ.

    `tables` must include `joints.csv`, which has a file of digests of its own.

    Raises:
        DatasetError: The folder cannot be written.
    """
    others = {name: text for name, text in tables.items() if name != JOINTS}
    _write_folder(root, Path("metadata"), {**others, **_digests(others)}, mend=True)
    _write_joint_table(root, tables[JOINTS])


def _write_joint_table(root: Path, table: str) -> None:
    """Write the text of `joints.csv` and its digest."""
    digest = json.dumps({JOINTS: _digest(table)})
    _write_folder(root, Path("metadata"), {JOINTS: table, JOINTS_DIGEST: digest}, mend=True)


def _digests(files: Mapping[str, str]) -> dict[str, str]:
    """Return the file of digests for texts by file name, as {name: content}."""
    return {DIGESTS: json.dumps({name: _digest(text) for name, text in files.items()})}


def is_folder_complete(folder: Path, digests_name: str = DIGESTS) -> bool:
    """Return whether all files listed in a folder's digests are as written; False without digests."""
    try:
        digests: dict[str, str] = json.loads(read_text(folder / digests_name))
        return all(_digest(read_text(folder / name)) == digest for name, digest in digests.items())
    except (DatasetError, ValueError, TypeError, AttributeError, RecursionError):
        return False


def _write_folder(
    root: Path, folder: Path, files: Mapping[str, str | UInt8[np.ndarray, "h w 3"]], mend: bool = False
) -> None:
    """Fill a temporary folder and rename it, so that `folder` appears complete; raise `DatasetError` if that fails.

    An existing folder is kept as it is; with `mend`, its missing or different `files` are written one by one.
    """
    target = root / folder
    try:
        if target.is_dir():
            for name, content in files.items() if mend else ():
                _mend(target / name, content)
            return
        target.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=PARTIAL_PREFIX, dir=root))
        try:
            for name, content in files.items():
                _write_file(temporary / name, content)
            temporary.chmod(0o755)  # mkdtemp creates private folders
            _rename(temporary, target)
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    except OSError as error:
        hint = "Choose a folder that you may write to, with enough space."
        raise DatasetError(f"cannot write {folder}: {error.strerror}", file=root, hint=hint) from None


def _remove_files(folder: Path, names: Iterable[str]) -> None:
    """Remove those files of a folder that exist; raise `DatasetError` if that fails."""
    try:
        for name in names:
            (folder / name).unlink(missing_ok=True)
    except OSError as error:
        hint = "Choose a folder that you may write to."
        raise DatasetError(f"cannot remove {name}: {error.strerror}", file=folder, hint=hint) from None


def _mend(path: Path, content: str | UInt8[np.ndarray, "h w 3"]) -> None:
    """Write a file atomically, since others may be reading it, unless it has this text or, decoded, this image."""
    is_old = path.exists()  # before it is read: a file that another process creates meanwhile is not broken
    if not _holds(path, content):
        if is_old:
            log.warning("broken file %s is rewritten", path)
        with write_atomically(path) as file:
            if isinstance(content, str):
                file.write(content.encode())
            else:
                file.write(encode_png(content))


def _holds(path: Path, content: str | UInt8[np.ndarray, "h w 3"]) -> bool:
    """Return whether a file has exactly this text or, decoded, these pixels."""
    try:
        data = read_bytes(path)
        if isinstance(content, str):
            return data == content.encode()
        return np.array_equal(decode_image(data), content)
    except (DatasetError, OSError, ValueError, SyntaxError):  # Pillow's errors for other files than images
        return False


def _write_file(path: Path, content: str | UInt8[np.ndarray, "h w 3"]) -> None:
    """Write a text as UTF-8 or an image as PNG."""
    if isinstance(content, str):
        path.write_text(content, encoding="utf-8", newline="\n")
    else:
        path.write_bytes(encode_png(content))


def _rename(temporary: Path, target: Path) -> None:
    """Rename a folder to `target`; do nothing if another process has written `target` meanwhile."""
    try:
        os.rename(temporary, target)
    except OSError:
        if not target.is_dir():  # else another process wrote the same folder in the meantime
            raise


def _architecture(level: Level) -> Iterable[Mesh]:
    """Return the existing meshes of a level's rooms and grounds."""
    parts = [mesh for room in level.rooms for mesh in (room.ceiling, room.floor, room.walls)]
    return (mesh for mesh in (*parts, *(ground.mesh for ground in level.grounds)) if mesh is not None)


def house_document(house: House) -> dict[str, Any]:
    """Return the content of house.json as JSON values, in SUNCG's order of keys, with boxes from the geometry.

    Fields of `house.extra` are last and replace others of the same name.
    """
    levels = [_level(level, house) for level in house.levels]
    return {
        "version": house.version,
        "id": house.id,
        "up": [0, 1, 0],
        "front": [0, 0, 1],
        "scaleToMeters": 1,
        "levels": [entry for entry, _ in levels],
        **_bbox(_union([bounds for _, bounds in levels])),
        **house.extra,
    }


def _level(level: Level, house: House) -> tuple[dict[str, Any], Bounds | None]:
    """Return a level as JSON values, nodes in order of their index, and its bounds in the scene [m], see `_union`."""
    things = {node.index: _bounds(node, house) for node in (*level.objects, *level.boxes, *level.grounds)}
    for room in level.rooms:
        own = [_mesh_bounds(mesh) for mesh in (room.ceiling, room.floor, room.walls) if mesh is not None]
        things[room.index] = _union(own + [things[i] for i in room.members])
    nodes = sorted((*level.rooms, *level.objects, *level.boxes, *level.grounds), key=lambda node: node.index)
    bounds = _union(list(things.values()))
    others = sorted(node.index for node in (*level.unknown, *level.hidden))
    place = {index: i for i, index in enumerate(sorted([*others, *(node.index for node in nodes)]))}
    entries = [(node.index, _entry(node, _bbox(things[node.index]), place) | dict(node.extra)) for node in nodes]
    entries += [(node.index, dict(node.data)) for node in (*level.unknown, *level.hidden)]
    ordered = [entry for _, entry in sorted(entries, key=lambda pair: pair[0])]
    return {"id": level.id, **_bbox(bounds), "nodes": ordered, **level.extra}, bounds


def _entry(node: Node, bbox: dict[str, Any], place: Mapping[int, int]) -> dict[str, Any]:
    """Convert a node to JSON; `place` maps a node's index to its position in the written list.

    `bbox` is a result of `_bbox`. Meshes that are None are written as hidden.
    """
    entry: dict[str, Any] = {"id": node.id, "type": type(node).__name__.removesuffix("Node"), "valid": 1}
    match node:
        case RoomNode():
            members = [place[i] for i in node.members]
            entry |= {"modelId": node.model_id, "nodeIndices": members, "roomTypes": list(node.types)}
            hidden = {"hideCeiling": node.ceiling, "hideFloor": node.floor, "hideWalls": node.walls}
            entry |= {key: 1 for key, mesh in hidden.items() if mesh is None}
            return entry | bbox
        case GroundNode():
            return entry | {"modelId": node.model_id} | ({"hideFloor": 1} if node.mesh is None else {}) | bbox
        case BoxNode():
            entry |= {"transform": _numbers(node.transform.T), "dimensions": _numbers(node.dimensions)}
            return entry | bbox | {"materials": [_material(m) for m in node.materials]}
        case ObjectNode():
            state = state_of(node.model_id, node.model_key)
            entry |= {"modelId": node.model_id} | ({"state": state} if state else {})
            entry |= {"transform": _numbers(node.transform.T)} | ({"isMirrored": 1} if node.is_mirrored else {})
            return entry | bbox | {"materials": [_material(m) for m in node.materials]}
    raise TypeError(f"unknown node {type(node).__name__}")


def _bounds(node: ObjectNode | BoxNode | GroundNode, house: House) -> Bounds | None:
    """Return the bounds of a node in the scene [m]: of its base model or mesh; without these its stated `bbox`.

    An object without either has the bounds of its model in the state shown; a ground without either has None.
    """
    match node:
        case ObjectNode():
            if node.model_id not in house.models and node.bbox is not None:
                return node.bbox
            points = house.models.get(node.model_id, house.models[node.model_key]).vertices
        case BoxNode():
            points = _BOX_CORNERS * node.dimensions
        case GroundNode():
            return node.bbox if node.mesh is None else _mesh_bounds(node.mesh)
    # By columns: reductions over axes of length three are several times as slow in NumPy.
    moved = np.ascontiguousarray((points @ node.transform[:3, :3].T).T) + node.transform[:3, 3:]
    return np.stack([moved.min(1), moved.max(1)])


def _mesh_bounds(mesh: Mesh) -> Bounds:
    """Return the minimum and maximum corner of all vertices [m]."""
    return np.stack([mesh.vertices.min(0), mesh.vertices.max(0)])


def _union(bounds: Sequence[Bounds | None]) -> Bounds | None:
    """Return the bounds around all `bounds` that are not None; None without any, such as of an empty level."""
    known = [b for b in bounds if b is not None]
    return np.stack([np.min([b[0] for b in known], 0), np.max([b[1] for b in known], 0)]) if known else None


def _bbox(bounds: Bounds | None) -> dict[str, Any]:
    """Return the field `bbox` of bounds as {"bbox": JSON values}; {} for None."""
    return {} if bounds is None else {"bbox": {"min": _numbers(bounds[0]), "max": _numbers(bounds[1])}}


def _numbers(values: np.ndarray) -> list[int | float]:
    """Return a flat list, rounded to 9 decimals; integral values become integers, as JavaScript writes them."""
    rounded = (np.round(values.reshape(-1).astype(float), 9) + 0.0).tolist()
    return [int(x) if x.is_integer() else x for x in rounded]


def _material(material: Material) -> dict[str, str]:
    """Convert a material override to JSON values, its colour to `#rrggbb`."""
    entry = {"name": material.name}
    if material.texture_name:
        entry["texture"] = material.texture_name
    if material.diffuse is not None:
        entry["diffuse"] = "#" + "".join(f"{round(255 * x):02x}" for x in material.diffuse)
    return entry
