"""Small objects that lie about: rooms get more of them until they have their number."""

from collections.abc import Mapping, Sequence

import numpy as np

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.furnish.space.floor_placement import add_at_wall
from home_procgen.furnish.space.room_space import RoomSpace
from home_procgen.furnish.space.support_surfaces import find_support_surfaces
from home_procgen.furnish.space.top_placement import place_on_top
from home_procgen.furnish.space.wall_placement import hang_kind
from home_procgen.primitives.categories import CATEGORIES
from home_procgen.style.object_kinds import resolve_kind

MAX_SMALL_EDGE = 0.5  # [m], longest edge of a small object
SINGLE_KINDS = {
    *("soap_dish", "soap_dispenser", "cellphone", "telephone", "table_clock", "hair_dryer", "radio", "fruit_bowl"),
    *("chessboard", "teapot", "tool_box"),
}
MAX_ALIKE = 4  # maximum number of objects of one family in a room to which more are added; 1 of a single kind
ATTEMPTS_PER_OBJECT, NUM_PLACES = 6, 3  # draws for each missing object, and places that each draw tries
MAX_SURFACES = 6  # surfaces of a model that get objects, in descending order of area
MAX_SURFACE_HEIGHT = 1.6  # [m] above the floor
SHELF_HEIGHT = 1.0  # [m], underside of a shelf in rooms with few tops
# Coarse and fine classes of which small models count.
SMALL_COARSE = {
    *("books", "candle", "computer", "decoration", "kitchenware", "kitchen_appliance", "magazines", "music", "plant"),
    *("shoes", "toy", "trash_can", "trinket", "vase"),
}
SMALL_FINE = {
    *("cellphone", "hair_dryer", "helmet", "ipad", "iron", "soap_dish", "soap_dispenser", "telephone", "toiletries"),
    "weight_scale",
}
SUPPORT_FAMILIES = {
    *("dining_table", "table", "coffee_table", "side_table", "console", "desk", "dressing_table", "nightstand"),
    *("dresser", "tv_stand", "bookshelf", "shelving", "shoes_cabinet", "kitchen_cabinet", "basin", "washer", "dryer"),
    *("cart", "game_table"),
}
_READ = ("book", "books", "magazine")
_SHOWN = ("ornament", "figure", "candle", "table_vase", "small_plant")
_DRUNK = ("cup", "glass", "bottle", "jug")
_WASHED = ("set_toiletries", "soap_dish", "soap_dispenser", "candle", "set_toiletries")
_STORED = ("tool_box", "containers", "bottle", "books", "table_vase")
# Number of small objects of a room of average clutter, and kinds to add.
SMALL_OBJECTS: Mapping[str, tuple[int, Sequence[str]]] = {
    "Living_Room": (14, (*_READ, *_SHOWN, "cup", "glass", "cellphone", "fruit_bowl", "radio")),
    "Kitchen": (18, (*_DRUNK, "plates", "containers", "bread", "food", "fruit_bowl", "small_plant", "plates", "cup")),
    "Dining_Room": (13, (*_DRUNK, *_SHOWN, "plates", "fruit_bowl", "teapot")),
    "Bedroom": (13, (*_READ, *_SHOWN, "cellphone", "table_clock", "set_toiletries", "glass")),
    "Child_Room": (13, ("toy_animal", "toy", "book", "books", "toy", "cup", "chessboard")),
    "Guest_Room": (12, (*_READ, *_SHOWN, "glass", "table_clock")),
    "Office": (12, (*_READ, "books", "cup", "figure", "small_plant", "cellphone", "table_clock", "containers")),
    "Bathroom": (10, (*_WASHED, "small_plant", "hair_dryer")),
    "Toilet": (6, (*_WASHED, "small_plant")),
    "Hallway": (10, (*_SHOWN, "telephone", "magazine", "books")),
    "Hall": (11, (*_SHOWN, *_READ, "telephone")),
    "Lobby": (9, (*_SHOWN, *_READ, "telephone")),
    "Entryway": (5, (*_SHOWN, "telephone")),
    "Wardrobe": (10, ("candle", "ornament", "books", "table_vase")),
    "Storage": (9, _STORED),
    "Boiler_room": (7, _STORED),
    "Garage": (9, _STORED),
    "Gym": (6, ("bottle", "cup", "magazine", "radio", "table_clock")),
}
SHELVED_TYPES = ("Bathroom", "Toilet", "Hallway", "Hall", "Lobby", "Entryway", "Wardrobe", "Gym", "Garage")
SHOE_TYPES = ("Hallway", "Hall", "Lobby", "Entryway", "Wardrobe")
MAX_SHOES = 2  # pairs that are added


def add_small_objects(room: RoomSpace) -> None:
    """Place small objects on the furniture of a room until it has its number, which grows with the clutter."""
    if room.kind not in SMALL_OBJECTS:
        return
    number, kinds = SMALL_OBJECTS[room.kind]
    wanted = number * (0.65 * room.style.equipment.small_objects + 0.6 * room.style.clutter)
    missing = round(wanted) - sum(map(is_small, room.items))
    if missing > 0 and room.kind in SHOE_TYPES:
        missing -= sum(add_at_wall(room, "shoes") is not None for _ in range(MAX_SHOES))
    if missing > 2 and room.kind in SHELVED_TYPES:
        hang_kind(room, "plate_shelf", SHELF_HEIGHT)
    tops = [(item, k, area) for item in room.items for k, area in _low_surfaces(item)]
    if not tops:
        return
    share = np.sqrt([area for _, _, area in tops])
    for at in room.rng.choice(len(tops), max(missing, 0) * ATTEMPTS_PER_OBJECT, p=share / share.sum()).tolist():
        item, k, _ = tops[at]
        kind = str(kinds[int(room.rng.integers(len(kinds)))])
        family = resolve_kind(kind)[0]
        if sum(one.model.family == family for one in room.items) >= (1 if kind in SINGLE_KINDS else MAX_ALIKE):
            continue
        placed = place_on_top(room, item, kind, surfaces=slice(k, k + 1), attempts=NUM_PLACES)
        missing -= placed is not None
        if missing <= 0:
            return


def is_small(item: PlacedModel) -> bool:
    """Return whether an object is small and portable; seats, lamps and objects on walls are not."""
    fine = item.model.fine
    named = CATEGORIES[fine].coarse in SMALL_COARSE or fine in SMALL_FINE
    return named and bool(np.ptp(item.box, axis=0).max() <= MAX_SMALL_EDGE)


def _low_surfaces(item: PlacedModel) -> list[tuple[int, float]]:
    """Return index and area [m^2] of large surfaces below `MAX_SURFACE_HEIGHT`; empty outside `SUPPORT_FAMILIES`."""
    if item.model.family not in SUPPORT_FAMILIES:
        return []
    tops = find_support_surfaces(item.model.id)[:MAX_SURFACES]
    return [(k, top.area) for k, top in enumerate(tops) if item.position[1] + top.height < MAX_SURFACE_HEIGHT]
