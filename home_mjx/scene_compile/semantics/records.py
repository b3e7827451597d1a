"""Semantics as plain dictionaries for JSON."""

from typing import Any

from home_mjx.scene_compile.semantics.appearance import Appearance
from home_mjx.scene_compile.semantics.describe import describe_object
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics, PartSemantics

Record = dict[str, Any]


def house_record(house: HouseSemantics) -> Record:
    """Return a JSON-compatible dictionary of rooms, parts, objects and observer-independent relations.

    Objects have the `text` of `describe_object`; relations are lists of subject, predicate and object.
    """
    return {
        "id": house.id,
        "rooms": [{"room": r.index, "types": list(r.types), "level": r.level, "area": r.area} for r in house.rooms],
        "parts": [_part(part) for part in house.parts],
        "objects": [_object(item) | {"text": describe_object(house, item.object_id)} for item in house.objects],
        "relations": [[r.subject, r.predicate, r.object] for r in house.relations],
        "objects_outside": [item.object_id for item in house.objects_outside],
    }


def _part(part: PartSemantics) -> Record:
    """Convert a part to JSON values."""
    place = {"part": part.index, "category": part.category, "room": part.room, "room_type": part.room_type}
    place |= {"room_types": list(part.room_types)}
    size = {"level": part.level, "partition": part.partition, "area": part.area, "description": part.description}
    return place | size | _look(part.appearance)


def _object(item: ObjectSemantics) -> Record:
    """Convert an object to JSON values; `edges` are the full edge lengths of its box [m]."""
    return {
        "object_id": item.object_id,
        "node": item.node,
        "model": item.model,
        "fine": item.fine,
        "coarse": item.coarse,
        "nyu40": item.nyu40,
        "room": item.room,
        "room_type": item.room_type,
        "room_types": list(item.room_types),
        "level": item.level,
        "position": list(item.position),
        "edges": (2 * item.box.half[0]).tolist(),
        "yaw": float(item.box.yaw[0]),
        "size": item.size,
        "support": item.support.kind,
        "supporter": item.support.supporter,
        "container": item.support.container,
        "description": item.description,
        **_look(item.appearance),
    }


def _look(look: Appearance) -> Record:
    """Convert an appearance to JSON values."""
    colors = {level: list(names) for level, names in look.colors.items()}
    return {"colors": colors, "materials": list(look.materials), "textured": look.is_textured}
