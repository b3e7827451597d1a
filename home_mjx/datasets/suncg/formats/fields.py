"""Known fields of house.json: of the house, its levels, and its nodes by type."""

from typing import Any

from home_mjx.datasets.suncg.formats.element import JsonValue

HOUSE_FIELDS = {"version", "id", "up", "front", "scaleToMeters", "levels", "bbox", "materials", "camera"}
LEVEL_FIELDS = {"id", "bbox", "nodes", "valid"}
_NODE = {"id", "type", "valid", "bbox", "transform", "materials", "materialIndices"}
NODE_FIELDS = {
    "object": _NODE | {"modelId", "state", "isMirrored"},
    "box": _NODE | {"dimensions", "isMirrored"},
    "room": _NODE | {"modelId", "nodeIndices", "roomTypes", "hideCeiling", "hideFloor", "hideWalls", "stats"},
    "ground": _NODE | {"modelId", "hideFloor"},
}
PRESERVED_FIELDS = {"camera", "stats"}  # known, but unused; preserved for writing


def preserved_fields(value: JsonValue, known: set[str]) -> dict[str, Any]:
    """Return the fields of a JSON object that are only needed for writing: unknown ones and `PRESERVED_FIELDS`, unchanged."""
    return unknown_fields(value, known - PRESERVED_FIELDS)


def unknown_fields(value: JsonValue, known: set[str]) -> dict[str, Any]:
    """Return the unknown fields of a JSON object, unchanged."""
    return {key: data for key, data in value.data.items() if key not in known} if isinstance(value.data, dict) else {}
