"""Values that ProcTHOR's JSON is made of: points, materials and optional lists."""

from home_mjx.datasets.procthor.records import Point, ThorMaterial, Triple
from home_mjx.datasets.suncg.formats.json_value import JsonValue

MAX_POSITION = 1000.0  # [m]
MAX_LISTED = 4000  # maximum number of entries of a list; houses of ProcTHOR have up to 100 objects


def listed(value: JsonValue) -> list[JsonValue]:
    """Return the values of a list; none if the field is absent.

    Raises:
        DatasetError: It is another value, or has more than `MAX_LISTED` entries.
    """
    found = value.entries() if value.has_value else []
    if len(found) > MAX_LISTED:
        raise value.error(f"expected at most {MAX_LISTED} entries, got {len(found)}")
    return found


def text_or(value: JsonValue, default: str) -> str:
    """Return a text, also of a number, as ids of old files are; `default` if the field is absent."""
    if isinstance(value.data, int) and not isinstance(value.data, bool):
        return str(value.data)
    return value.text() if value.has_value else default


def number_or(value: JsonValue, default: float) -> float:
    """Return a finite number; `default` if the field is absent."""
    return value.number() if value.has_value else default


def position(value: JsonValue) -> float:
    """Return a coordinate [m].

    Raises:
        DatasetError: It is no finite number, or beyond `MAX_POSITION`.
    """
    number = value.number()
    if abs(number) > MAX_POSITION:
        raise value.error(f"expected a coordinate within {MAX_POSITION:g} m, got {number:g}")
    return number


def triple(value: JsonValue) -> Triple:
    """Return the members x, y and z."""
    return position(value.member("x")), position(value.member("y")), position(value.member("z"))


def plan_point(value: JsonValue) -> Point:
    """Return x and z of an object with these members, or of a list of both."""
    if isinstance(value.data, list):
        first, second = value.vector(2).tolist()
        return first, second
    return position(value.member("x")), position(value.member("z"))


def material(value: JsonValue, default: ThorMaterial) -> ThorMaterial:
    """Return a material, which old files write as its name; `default` if the field is absent."""
    if not value.has_value:
        return default
    if isinstance(value.data, str):
        return ThorMaterial(value.data)
    return ThorMaterial(text_or(value.member("name"), default.name), color_or_none(value.member("color")))


def color_or_none(value: JsonValue) -> Triple | None:
    """Return a colour with members r, g and b in 0..1, cut to this range; None if the field is absent."""
    if not value.has_value:
        return None
    red, green, blue = (min(max(value.member(key).number(), 0.0), 1.0) for key in "rgb")
    return red, green, blue
