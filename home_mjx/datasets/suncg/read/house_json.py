"""Reader of house.json: the house, its levels, and the valid nodes of each level."""

import json
from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.suncg.formats.asset_library import AssetLibrary
from home_mjx.datasets.suncg.formats.json_value import (
    HOUSE_FIELDS,
    LEVEL_FIELDS,
    NODE_FIELDS,
    JsonValue,
    preserved_fields,
    read_json,
)
from home_mjx.datasets.suncg.formats.variants import SuncgMetadata
from home_mjx.datasets.suncg.read.backdrops import cut_backdrops
from home_mjx.datasets.suncg.read.door_joints import attach_parts
from home_mjx.datasets.suncg.read.missing_parts import add_part_fallbacks, collect_fallbacks
from home_mjx.datasets.suncg.read.nodes import READERS, read_bbox
from home_mjx.datasets.suncg.read.reader_state import ReaderState
from home_mjx.schema.house import BoxNode, GroundNode, House, Level, Node, ObjectNode, RoomNode, UnknownNode

MAX_NODES = 10_000  # maximum nodes of one level; SUNCG's largest houses have about two thousand
MAX_LEVELS = 100
AXES = (("up", [0, 1, 0]), ("front", [0, 0, 1]))
N = TypeVar("N", bound=Node)


def read_house(
    house_id: str, assets: AssetLibrary, options: ReadOptions, left_out: Callable[[str], bool], tables: SuncgMetadata
) -> House:
    """Read one house with all meshes of its visible nodes.

    If `assets` is tolerant, missing parts get fallbacks. `left_out` returns whether the options exclude a model id.
    `tables` is used for lights, doors and fallbacks.

    Raises:
        DatasetError: house.json or a file that it needs is missing or broken.
    """
    document = read_json(house_path(house_id, assets))
    reading = ReaderState(house_id, assets, left_out, options, tables=tables)
    house = attach_parts(build_house(document, reading), reading)
    if not any(level.rooms or level.objects or level.boxes or level.grounds for level in house.levels):
        raise document.member("levels").error("house has no visible node", "Remove its folder from the dataset.")
    return house


def house_path(house_id: str, assets: AssetLibrary) -> Path:
    """Return the path of a house's house.json, which may not exist."""
    return assets.root / "house" / house_id / "house.json"


def build_house(document: JsonValue, reading: ReaderState) -> House:
    """Build the house that a house.json describes; `reading` records problems.

    Errors are raised, or recorded if `reading` collects them; then broken levels and nodes are left out.
    """
    reading.materials = document.member("materials")
    reading.scale = reading.attempt(_scale, document.member("scaleToMeters")) or 1.0
    reading.attempt(_check_header, document, reading)
    values = reading.attempt(_bounded, document.member("levels"), MAX_LEVELS) or []
    levels = [reading.attempt(read_level, value, index, reading) for index, value in enumerate(values)]
    version = document.member("version").data
    house = House(
        id=reading.house_id,
        version=version if isinstance(version, str) else "",
        path=document.file,
        levels=tuple(level for level in levels if level is not None),
        models=reading.models,
        problems=tuple(problem for _, problem in reading.notes),
        extra=preserved_fields(document, HOUSE_FIELDS),
    )
    return replace(house, fallbacks=collect_fallbacks(house, reading)) if reading.tolerant else house


def _bounded(value: JsonValue, most: int) -> list[JsonValue]:
    """Return the entries of a list; raise `DatasetError` if there are more than `most`."""
    entries = value.entries()
    if len(entries) > most:
        raise value.error(f"expected at most {most} entries, got {len(entries)}")
    return entries


def _scale(value: JsonValue) -> float:
    """Return metres per unit, 1 if null; raise `DatasetError` outside 0.0001..10000."""
    scale = value.number() if value.has_value else 1.0
    if not 1e-4 <= scale <= 1e4:
        raise value.error(f"expected metres per unit above 0, 0.0001 to 10000, got {scale:g}", "SUNCG writes 1.")
    return scale


def _check_header(document: JsonValue, reading: ReaderState) -> None:
    """Note a version, id or axes other than expected; none of them changes how the house is read.

    Raise `DatasetError` if one has the wrong type.
    """
    version, house_id = document.member("version"), document.member("id")
    if not version.has_value or not version.text().startswith("suncg"):
        reading.note(version, "format-version", f"version is {json.dumps(version.data)}: read as suncg@1.0.0")
    if not house_id.has_value or house_id.text() != reading.house_id:
        reading.note(house_id, "house-id", f"id is {json.dumps(house_id.data)}: the folder's name is used")
    for key, axis in AXES:
        value = document.member(key)
        if value.has_value and value.vector(3).tolist() != axis:
            reading.note(value, "axes", f"expected {axis}: ignored, as other readers do")


def read_level(level: JsonValue, index: int, reading: ReaderState) -> Level | None:
    """Read one storey, number `index` in the file; None if its `valid` is 0.

    Repeated nodes are left out, and backdrops cut. If the assets are tolerant, missing meshes of rooms get fallbacks.
    """
    if not level.member("valid").flag(default=True):
        return None
    nodes = level.member("nodes")
    if not nodes.has_value:
        reading.note(nodes, "empty-level", "level without nodes")
    values = _bounded(nodes, MAX_NODES) if nodes.has_value else []
    read = [reading.attempt(_read_node, value, f"{index}_{i}", i, reading) for i, value in enumerate(values)]
    found = [node for node in read if node is not None]
    same = _duplicates(found, values, reading)
    if reading.tolerant:
        found = add_part_fallbacks(found, reading)
    found = cut_backdrops([node for node in found if node.index not in same], level, reading)
    kinds = {node.index: isinstance(node, ObjectNode | BoxNode) for node in found if not isinstance(node, UnknownNode)}
    rooms = [_with_members(room, values, kinds, same, reading) for room in _of_type(found, RoomNode)]
    return Level(
        id=_id(level, str(index), reading),
        index=index,
        rooms=tuple(rooms),
        objects=_of_type(found, ObjectNode),
        boxes=_of_type(found, BoxNode),
        grounds=_of_type(found, GroundNode),
        unknown=_of_type(found, UnknownNode),
        hidden=_hidden(values, index, {node.index for node in found}),
        extra=preserved_fields(level, LEVEL_FIELDS),
    )


def _hidden(values: Sequence[JsonValue], level: int, shown: Collection[int]) -> tuple[UnknownNode, ...]:
    """Return the empty and disabled JSON objects of a level that are not in `shown`, as `UnknownNode`s.

    They are kept because they occupy positions in the list.
    """
    found = [(i, value) for i, value in enumerate(values) if i not in shown and isinstance(value.data, dict)]
    off = [(i, value) for i, value in found if not value.data or value.data.get("valid", 1) in (0, "0", False)]
    return tuple(UnknownNode(f"{level}_{i}", i, value.element, None, data=value.data) for i, value in off)


def _of_type(nodes: Sequence[Node], kind: type[N]) -> tuple[N, ...]:
    """Return the nodes of one class, in order."""
    return tuple(node for node in nodes if isinstance(node, kind))


def _read_node(value: JsonValue, default_id: str, index: int, reading: ReaderState) -> Node | None:
    """Read node `index` of a level; None if it is empty, which is noted, disabled, or left out by its reader.

    A node of an unknown type is noted and kept as `UnknownNode`.
    """
    if not value.data:
        reading.note(value, "empty-node", "empty node: left out")
        return None
    if not value.member("valid").flag(default=True):
        return None  # the format's own way of hiding a node
    kind = value.member("type")
    reader = READERS.get(kind.text().lower()) if kind.has_value else None
    common: dict[str, Any] = {"id": _id(value, default_id, reading), "index": index, "path": value.element}
    if reader is None:
        reading.note(kind, "node-type", f"unknown node type {json.dumps(kind.data)}: kept, but not shown")
        return UnknownNode(**common, bbox=None, data=value.data)
    extra = preserved_fields(value, NODE_FIELDS[kind.text().lower()])
    return reader(value, common | {"bbox": read_bbox(value, reading), "extra": extra}, reading)


def _id(value: JsonValue, default: str, reading: ReaderState) -> str:
    """Return the id of a level or node as a string, also from a number; `default`, with a note, if it has none."""
    found = value.member("id")
    if not found.has_value:
        reading.note(found, "missing-id", f"no id: `{default}` is used")
        return default
    return found.data if isinstance(found.data, str) else str(found.integer())


def _duplicates(nodes: Sequence[Node], values: Sequence[JsonValue], reading: ReaderState) -> dict[int, int]:
    """Map the index of each exact repetition to that of the earlier node; report all shared ids as problems."""
    first: dict[str, Node] = {}
    same: dict[int, int] = {}
    for node in nodes:
        earlier = first.setdefault(node.id, node)
        if earlier is node:
            continue
        equal = values[node.index].data == values[earlier.index].data
        if equal:
            same[node.index] = earlier.index
        what = "an equal node: left out" if equal else "another node: both kept"
        message = f"`{node.id}` is also the id of {earlier.path}, {what}"
        reading.note(values[node.index].member("id"), "duplicate-id", message)
    return same


def _with_members(
    room: RoomNode,
    values: Sequence[JsonValue],
    kinds: Mapping[int, bool],
    same: Mapping[int, int],
    reading: ReaderState,
) -> RoomNode:
    """Return the room with objects and boxes as members, each once; note invalid and repeated members.

    Args:
        room: The room, with its members as read.
        values: JSON values of the level's nodes.
        kinds: Nodes by index: True for objects and boxes, False for rooms and grounds; unknown nodes are absent.
        same: Indices of repeated nodes, and those of the nodes that replace them; see `_duplicates`.
        reading: Collects the problems.
    """
    place = values[room.index].member("nodeIndices")
    beyond = [index for index in room.members if not 0 <= index < len(values)]
    if beyond:
        more = f", and {len(beyond) - 1} more" if len(beyond) > 1 else ""
        message = f"index {beyond[0]} is out of range: the level has {len(values)} nodes{more}"
        reading.note(place, "member-index", message)
    if len(set(room.members)) < len(room.members):
        reading.note(place, "repeated-member", "nodes listed twice")
    members = list(dict.fromkeys(same.get(index, index) for index in room.members))
    architecture = sorted(index for index in members if kinds.get(index) is False)
    if architecture:
        reading.note(place, "member-type", f"indices {architecture} are rooms or grounds: not taken as members")
    return replace(room, members=tuple(index for index in members if kinds.get(index)))
