"""Text descriptions of objects, from their semantic records."""

from collections.abc import Sequence

from home_mjx.errors import UnknownNameError
from home_mjx.scene_compile.semantics.appearance import Appearance
from home_mjx.scene_compile.semantics.types import HouseSemantics, ObjectSemantics

UNNAMED_CATEGORIES = ("empty", "unknown")  # fine categories that are replaced by "object"
MAX_NEIGHBOURS = 3  # maximum number of neighbours in a description
SUPPORT_PHRASES = {
    "floor": "stands on the floor",
    "wall": "is on the wall",
    "ceiling": "hangs from the ceiling",
    "": "is",
}


def short_text(size: str, look: Appearance, category: str) -> str:
    """Return a text of size (unless normal), CSS colours, fine category, and materials that textures determine.

    This is the form of HoME. Missing items are left out; the categories `empty` and `unknown` become "object".

    Args:
        size: One of `SIZES`, or "".
        look: Colours and materials.
        category: Fine category.

    Example:
        >>> look = Appearance({"css": ("linen",)}, ("wood",), is_textured=True)
        >>> short_text("small", look, "coffee_table")
        'small linen coffee table made of wood'
    """
    colors = look.colors["css"]
    words = [size] * (size not in ("", "normal")) + ([_listed(colors)] if colors else [])
    made = f" made of {_listed(look.materials)}" if look.is_textured and look.materials else ""
    return " ".join([*words, _noun(category)]) + made


def describe_object(house: HouseSemantics, object_id: int) -> str:
    """Return two or three sentences: category, size, position and neighbours of an object.

    Args:
        house: Semantics of the house.
        object_id: One of `house.objects_by_id`.

    Raises:
        UnknownNameError: The house does not have this object.

    Example:
        >>> describe_object(meaning, 46)  # doctest: +SKIP
        'A gray sofa made of leather, 1.31 m wide, 1.01 m deep and 0.80 m high. It stands on the floor in the bedroom …'
    """
    if object_id not in house.objects_by_id:
        raise UnknownNameError(f"house has no object {object_id}", hint="`objects_by_id` lists all objects.")
    item = house.objects_by_id[object_id]
    width, depth, height = (2 * item.box.half[0]).tolist()
    x, y, z = item.position
    short = item.description
    article = "An" if short[0] in "aeiou" else "A"
    return " ".join(
        [
            f"{article} {short}, {width:.2f} m wide, {depth:.2f} m deep and {height:.2f} m high.",
            f"It {_holds(house, item)} {_where(item)} at x {x:.2f}, y {y:.2f}, z {z:.2f} m.",
            *_near(house, item),
        ]
    )


def _holds(house: HouseSemantics, item: ObjectSemantics) -> str:
    """Return the predicate of an object's support, such as `is on the table`."""
    held = item.support
    if held.container >= 0:
        return f"is in the {_noun(house.objects_by_id[held.container].fine)}"
    return (
        f"is on the {_noun(house.objects_by_id[held.supporter].fine)}"
        if held.supporter >= 0
        else SUPPORT_PHRASES[held.kind]
    )


def _where(item: ObjectSemantics) -> str:
    """Return the place of an object in words, such as `in the kitchen (room 2, level 0)`."""
    if item.room < 0:
        return f"outside of every room of level {item.level}"
    names = [name.replace("_", " ").lower() for name in item.room_types]
    kind = f"the {_listed(names)}" if names else "a room of unknown type"
    return f"in {kind} (room {item.room}, level {item.level})"


def _near(house: HouseSemantics, item: ObjectSemantics) -> list[str]:
    """Return one sentence with the nearest of the objects next to it, at most `MAX_NEIGHBOURS`; [] without any."""
    beside = [
        house.objects_by_id[r.object]
        for r in house.relations
        if r.subject == item.object_id and r.predicate == "next to"
    ]
    beside.sort(key=lambda other: sum((a - b) ** 2 for a, b in zip(item.position, other.position, strict=True)))
    names = [f"the {other.description}" for other in beside[:MAX_NEIGHBOURS]]
    return [f"Next to it: {', '.join(names)}."] if names else []


def _noun(category: str) -> str:
    """Return a category in words: spaces for underscores, "object" for `UNNAMED_CATEGORIES`."""
    return "object" if category in UNNAMED_CATEGORIES else category.replace("_", " ")


def _listed(words: Sequence[str]) -> str:
    """Return at least one word as an enumeration, such as `a, b and c`."""
    *first, last = words
    return f"{', '.join(first)} and {last}" if first else last
