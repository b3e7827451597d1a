"""The room file beside an exported house: its rooms, for the package's own readers of MJCF and glTF scenes."""

import json

import numpy as np

from home_mjx.schema.categories import FINE, ROOM_TYPES
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic

NO_CATEGORIES = ("unknown", "empty")  # fine categories that readers need not know


def room_file(house: CompiledHouse, has_objects: bool = True) -> bytes:
    """Return the JSON file that states the rooms of a house and, on request, the categories of its objects, by body.

    Its frame has y up: (x, z) of a corner is (x, -y) of the world.
    """
    rooms, owner = house.rooms, house.instances.object_id
    fine = house.semantics[house.instances.semantic, Semantic.FINE]
    objects = {f"object{owner[i]}": FINE[fine[i]] for i in range(len(owner)) if i != ARCHITECTURE and fine[i] >= 0}
    listed = [
        {
            **({"type": ROOM_TYPES[rooms.type[i]]} if rooms.type[i] >= 0 else {}),
            "corners": np.round(polygon * [1.0, -1.0], 6).tolist(),
            "level": int(rooms.level[i]),
            "floor": float(rooms.floor[i]),
            "ceiling": float(rooms.ceiling[i]),
        }
        for i, polygon in enumerate(rooms.polygon)
        if len(polygon)
    ]
    known = {name: category for name, category in objects.items() if category not in NO_CATEGORIES}
    return json.dumps({"rooms": listed} | ({"objects": known} if has_objects else {}), indent=1).encode()
