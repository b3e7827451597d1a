"""Rules on the raw house.json: fields, ids, lists of members."""

from collections import defaultdict

from home_mjx.datasets.suncg.formats.json_value import (
    HOUSE_FIELDS,
    LEVEL_FIELDS,
    NODE_FIELDS,
    JsonValue,
    unknown_fields,
)
from home_mjx.datasets.suncg.read.nodes import TEXT_INDEX
from home_mjx.datasets.suncg.validate.context import ValidationContext


def check_document(subject: ValidationContext) -> None:
    """Report unknown fields, ids that are not positions, shared or hidden members, and missing mirror flags."""
    _check_fields(subject, subject.document, HOUSE_FIELDS)
    for index, level, nodes in subject.entries():
        _check_fields(subject, level, LEVEL_FIELDS)
        for position, node in enumerate(nodes):
            if isinstance(node.data, dict) and node.data:
                _check_node(subject, node, f"{index}_{position}")
        _check_members(subject, nodes)
    for item in subject.nodes:
        if getattr(item, "is_mirrored", False) and "isMirrored" not in _data(subject, item.path):
            subject.report("missing-mirror-flag", item.path, "the transform mirrors the model")


def _check_fields(subject: ValidationContext, value: JsonValue, known: set[str]) -> None:
    """Report the fields of an object that the format does not have."""
    for key in unknown_fields(value, known):
        subject.report("unknown-field", value.member(key).element, "kept, but no reader uses this")


def _check_node(subject: ValidationContext, node: JsonValue, expected: str) -> None:
    """Report a node's unknown fields, and an id other than `expected`."""
    kind, node_id = node.data.get("type"), node.data.get("id")
    _check_fields(subject, node, NODE_FIELDS.get(str(kind).lower(), set(node.data)))
    if isinstance(node_id, str | int) and str(node_id) != expected:
        subject.report("id-position", f"{node.element}.id", f"expected `{expected}`, got `{node_id}`")


def _check_members(subject: ValidationContext, nodes: list[JsonValue]) -> None:
    """Report nodes of a level that are members of several rooms, and members that are hidden."""
    rooms: dict[int, list[JsonValue]] = defaultdict(list)
    for node in nodes:
        for index in set(_members(node, len(nodes))):
            rooms[index].append(node)
    for index, owners in sorted(rooms.items()):
        if len(owners) > 1:
            message = f"node {index} is also a member of {owners[0].element}"
            subject.report("shared-member", f"{owners[1].element}.nodeIndices", message)
        if not _shown(nodes[index]):
            subject.report("hidden-member", f"{owners[0].element}.nodeIndices", f"node {index} is not shown")


def _members(node: JsonValue, count: int) -> list[int]:
    """Return the members of a node from 0 to `count` - 1, as listed; [] if it is hidden.

    The reader reports all other values.
    """
    listed = node.data.get("nodeIndices") if _shown(node) else None
    if not isinstance(listed, list):
        return []
    numbers = [int(i) if isinstance(i, str) and TEXT_INDEX.fullmatch(i) else i for i in listed]
    return [int(i) for i in numbers if isinstance(i, int | float) and 0 <= i < count]


def _shown(node: JsonValue) -> bool:
    """Return whether a node is neither empty nor disabled."""
    return isinstance(node.data, dict) and bool(node.data) and node.data.get("valid", 1) not in (0, "0")


def _data(subject: ValidationContext, path: str) -> dict:
    """Return the JSON object at a path such as `levels[0].nodes[2]`."""
    level, node = (int(part.partition("]")[0]) for part in path.split("[")[1:3])
    return subject.document.data["levels"][level]["nodes"][node]
