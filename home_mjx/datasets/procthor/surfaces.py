"""Names of AI2-THOR's materials and rooms to our materials and types of rooms."""

from collections.abc import Mapping

from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.procthor.records import ThorMaterial
from home_mjx.datasets.taxonomy import plain_word
from home_mjx.schema.house import Material

# Part of a material's name -> family of textures on floors and on walls; the first that occurs counts.
FAMILIES: tuple[tuple[str, str, str], ...] = (
    ("brick", "bricks", "bricks"),
    ("marble", "marble", "marble"),
    ("granite", "marble", "marble"),
    ("stone", "stone", "stone"),
    ("slate", "stone", "stone"),
    ("porcelain", "tile", "tile"),
    ("tile", "tile", "tile"),
    ("ceramic", "tile", "tile"),
    ("carpet", "carpet", "textile"),
    ("rug", "carpet", "textile"),
    ("fabric", "carpet", "textile"),
    ("concrete", "concrete", "concrete"),
    ("cement", "concrete", "concrete"),
    ("metal", "metal", "metal"),
    ("steel", "metal", "metal"),
    ("laminate", "laminate", "paneling"),
    ("linoleum", "lnm", "lnm"),
    ("wood", "prkt", "paneling"),
    ("cabinet", "laminate", "paneling"),
    ("floor", "laminate", "paneling"),
    ("counter", "laminate", "paneling"),
    ("wallpaper", "wallp", "wallp"),
)
COLORS: Mapping[str, tuple[float, float, float]] = {  # sRGB of paints by a word in the name
    "brown": (0.55, 0.42, 0.32),
    "red": (0.6, 0.25, 0.22),
    "blue": (0.5, 0.6, 0.72),
    "green": (0.55, 0.65, 0.5),
    "yellow": (0.88, 0.8, 0.55),
    "orange": (0.85, 0.62, 0.42),
    "beige": (0.86, 0.8, 0.7),
    "cream": (0.92, 0.88, 0.78),
    "grey": (0.68, 0.68, 0.68),
    "gray": (0.68, 0.68, 0.68),
    "black": (0.16, 0.16, 0.17),
    "pink": (0.88, 0.7, 0.7),
    "purple": (0.55, 0.45, 0.6),
}
WHITE = (0.95, 0.95, 0.93)
# Part of a room's type in plain letters -> type of `ROOM_TYPES`; the first that occurs counts.
ROOMS: tuple[tuple[str, str], ...] = (
    ("bathroom", "Bathroom"),
    ("restroom", "Toilet"),
    ("toilet", "Toilet"),
    ("kitchen", "Kitchen"),
    ("living", "Living_Room"),
    ("lounge", "Living_Room"),
    ("dining", "Dining_Room"),
    ("child", "Child_Room"),
    ("kid", "Child_Room"),
    ("nursery", "Child_Room"),
    ("guest", "Guest_Room"),
    ("bedroom", "Bedroom"),
    ("office", "Office"),
    ("study", "Office"),
    ("library", "Office"),
    ("hallway", "Hallway"),
    ("corridor", "Hallway"),
    ("entry", "Entryway"),
    ("foyer", "Entryway"),
    ("lobby", "Lobby"),
    ("hall", "Hall"),
    ("closet", "Wardrobe"),
    ("wardrobe", "Wardrobe"),
    ("laundry", "Storage"),
    ("storage", "Storage"),
    ("pantry", "Storage"),
    ("garage", "Garage"),
    ("gym", "Gym"),
    ("balcony", "Balcony"),
    ("terrace", "Terrace"),
    ("room", "Room"),
)


def room_type(text: str) -> str:
    """Return the type of a room; "" if the text says none.

    Example:
        >>> room_type("LivingRoom"), room_type("master bedroom-2"), room_type("crypt")
        ('Living_Room', 'Bedroom', '')
    """
    word = plain_word(text)
    return next((found for part, found in ROOMS if part in word), "")


def surface_material(found: ThorMaterial, on_floor: bool, provider: FurnitureProvider) -> Material:
    """Return the material of a floor or, else, of walls or ceilings: a texture by words in its name, or a paint."""
    word = plain_word(found.name)
    family = next((floor if on_floor else wall for part, floor, wall in FAMILIES if part in word), "")
    if family:
        return provider.surface(family, found.name, "surface")
    if on_floor and found.color is None:
        return provider.surface("laminate", found.name, "surface")
    return Material("paint", found.color or paint_color(word), None, 1.0)


def paint_color(word: str) -> tuple[float, float, float]:
    """Return the colour [sRGB] that a material's name in plain letters says; white if it says none."""
    return next((color for part, color in COLORS.items() if part in word), WHITE)
