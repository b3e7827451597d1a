"""Reads house.json: the house, its levels, and which nodes of a level count."""

import json
from collections.abc import Sequence
from dataclasses import replace
from typing import Any, TypeVar

from home_mjx.scene_compile.house import Box, Ground, House, Level, Node, Object, Room

from .assets import Assets
from .nodes import READERS, Reading, read_bbox
from .place import Value, read_json

N = TypeVar("N", bound=Node)


def read_house(house_id: str, assets: Assets) -> House:
    """One house with every mesh that it shows.

    Args:
        house_id: Name of its folder.
        assets: Meshes and textures of the dataset.

    Raises:
        DatasetError: house.json or a file that it needs is missing or broken.
    """
    path = assets.root / "house" / house_id / "house.json"
    document = read_json(path)
    reading = Reading(house_id, assets, document.member("materials"), _scale(document.member("scaleToMeters")))
    _check_header(document, reading)
    levels = tuple(
        read_level(value, index, reading)
        for index, value in enumerate(document.member("levels").entries())
        if value.member("valid").flag(default=True)
    )
    if not any(level.rooms or level.objects or level.boxes or level.grounds for level in levels):
        raise document.member("levels").error("house shows nothing", "Remove its folder from the dataset.")
    version = document.member("version")
    return House(
        id=house_id,
        version=version.text() if version.present else "",
        path=path,
        levels=levels,
        models=reading.models,
        problems=tuple(reading.problems),
    )


def _scale(value: Value) -> float:
    scale = value.number() if value.present else 1.0
    if scale <= 0:
        raise value.error(f"expected metres per unit above 0, got {scale}", "SUNCG writes 1.")
    return scale


def _check_header(document: Value, reading: Reading) -> None:
    version, house_id = document.member("version"), document.member("id")
    if not version.present or not version.text().startswith("suncg"):
        reading.note(version, f"version is {json.dumps(version.data)}: read as suncg@1.0.0")
    if not house_id.present or house_id.text() != reading.house_id:
        reading.note(house_id, f"id is {json.dumps(house_id.data)}: the folder's name is taken")
    for key, axis in (("up", [0, 1, 0]), ("front", [0, 0, 1])):
        value = document.member(key)
        if value.present and value.vector(3).tolist() != axis:
            reading.note(value, f"expected {axis}: ignored, as other readers do")


def read_level(level: Value, index: int, reading: Reading) -> Level:
    """One storey."""
    nodes = level.member("nodes")
    if not nodes.present:
        reading.note(nodes, "level without nodes")
    values = nodes.entries() if nodes.present else []
    found = [node for i, value in enumerate(values) if (node := _read_node(value, f"{index}_{i}", i, reading))]
    same = _duplicates(found, values, reading)
    found = [node for node in found if node.index not in same]
    rooms = [_with_members(room, values, found, same, reading) for room in _of_type(found, Room)]
    return Level(
        id=_id(level, str(index), reading),
        index=index,
        rooms=tuple(rooms),
        objects=_of_type(found, Object),
        boxes=_of_type(found, Box),
        grounds=_of_type(found, Ground),
    )


def _of_type(nodes: Sequence[Node], kind: type[N]) -> tuple[N, ...]:
    return tuple(node for node in nodes if isinstance(node, kind))


def _read_node(value: Value, default_id: str, index: int, reading: Reading) -> Node | None:
    if not value.data:
        reading.note(value, "empty node: left out")
        return None
    if not value.member("valid").flag(default=True):
        return None  # the format's own way of hiding a node
    kind = value.member("type")
    reader = READERS.get(kind.text().lower()) if kind.present else None
    if reader is None:
        reading.note(kind, f"unknown node type {json.dumps(kind.data)}: node left out")
        return None
    common: dict[str, Any] = {
        "id": _id(value, default_id, reading),
        "index": index,
        "path": value.element,
        "bbox": read_bbox(value, reading),
    }
    return reader(value, common, reading)


def _id(value: Value, default: str, reading: Reading) -> str:
    """The id as a string; some files write numbers, some nothing."""
    found = value.member("id")
    if not found.present:
        reading.note(found, f"no id: `{default}` taken")
        return default
    return found.data if isinstance(found.data, str) else str(found.integer())


def _duplicates(nodes: Sequence[Node], values: Sequence[Value], reading: Reading) -> dict[int, int]:
    """Nodes that repeat an earlier one in every respect, by index; one that only shares its id is kept."""
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
        reading.note(values[node.index].member("id"), f"`{node.id}` is also the id of {earlier.path}, {what}")
    return same


def _with_members(
    room: Room, values: Sequence[Value], found: Sequence[Node], same: dict[int, int], reading: Reading
) -> Room:
    """The room with those members that are shown, each once."""
    place = values[room.index].member("nodeIndices")
    for index in room.members:
        if not 0 <= index < len(values):
            reading.note(place, f"index {index} is out of range: the level has {len(values)} nodes")
    if len(set(room.members)) < len(room.members):
        reading.note(place, "nodes listed twice")
    members = list(dict.fromkeys(same.get(index, index) for index in room.members))
    architecture = [node.index for node in found if isinstance(node, Room | Ground) and node.index in members]
    if architecture:
        reading.note(place, f"indices {architecture} are rooms or grounds: not taken as members")
    furniture = {node.index for node in found if isinstance(node, Object | Box)}
    return replace(room, members=tuple(index for index in members if index in furniture))
