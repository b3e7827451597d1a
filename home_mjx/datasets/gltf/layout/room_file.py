"""The JSON file beside a scene that states its rooms, units and categories: `NAME.rooms.json`."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from jaxtyping import Float

from home_mjx.core.files import is_file
from home_mjx.datasets.gltf.layout.room_search import is_outline
from home_mjx.datasets.suncg.formats.json_value import JsonValue, read_json
from home_mjx.errors import did_you_mean
from home_mjx.schema.categories import FINE, ROOM_TYPES

UP_AXES = ("y", "z")
FIELDS = ("up", "scale", "rooms", "objects")
ROOM_FIELDS = ("type", "corners", "floor", "ceiling", "level")


@dataclass(frozen=True)
class StatedRoom:
    """A room of the file.

    Attributes:
        corners: (x, z) of its outline in the house [m].
        type: One of `ROOM_TYPES`; "" if unknown.
        level: Index of its storey, from below.
        floor: Height of its floor [m]; None: found from the geometry.
        ceiling: Height of its ceiling [m]; None: found from the geometry.
    """

    corners: Float[np.ndarray, "n 2"]
    type: str = ""
    level: int = 0
    floor: float | None = None
    ceiling: float | None = None


@dataclass(frozen=True)
class RoomFile:
    """Content of the file; the defaults are those of a scene without one.

    Attributes:
        up: Axis of the scene that points up, `y` or `z`; "" if the file does not say.
        scale: Metres per unit of the scene; None if the file does not say.
        rooms: Rooms; empty: they are found from the geometry.
        objects: Fine category by name of a node or mesh; `wall` makes it architecture.
    """

    up: str = ""
    scale: float | None = None
    rooms: tuple[StatedRoom, ...] = ()
    objects: Mapping[str, str] = field(default_factory=dict)


def room_file_path(scene: Path) -> Path:
    """Return the path of the file that states the rooms of a scene.

    Example:
        >>> room_file_path(Path("flats/scan.glb")).as_posix()
        'flats/scan.rooms.json'
    """
    return scene.with_suffix(".rooms.json")


def read_room_file(scene: Path) -> RoomFile:
    """Read the room file of a scene; the defaults if there is none.

    Raises:
        DatasetError: It has unknown fields, or values that are out of range.
    """
    path = room_file_path(scene)
    if not is_file(path):
        return RoomFile()
    value = read_json(path)
    _check_fields(value, FIELDS)
    up, scale = value.member("up"), value.member("scale")
    if up.has_value and up.text() not in UP_AXES:
        raise up.error(f"expected `y` or `z`, got `{up.text()[:20]}`")
    if scale.has_value and not 1e-6 <= scale.number() <= 1e6:
        raise scale.error(f"expected metres per unit from 1e-6 to 1e6, got {scale.number():g}")
    rooms, objects = value.member("rooms"), value.member("objects")
    return RoomFile(
        up.text() if up.has_value else "",
        scale.number() if scale.has_value else None,
        tuple(_room(room) for room in rooms.entries()) if rooms.has_value else (),
        _categories(objects) if objects.has_value else {},
    )


def _check_fields(value: JsonValue, known: tuple[str, ...]) -> None:
    """Raise `DatasetError` if an object has a field that is not in `known`."""
    value.member("")  # raises unless it is an object
    for key in value.data:
        if key not in known:
            raise value.member(key).error(f"unknown field `{key[:40]}`", did_you_mean(key, known))


def _room(value: JsonValue) -> StatedRoom:
    """Read one room."""
    _check_fields(value, ROOM_FIELDS)
    corners = np.array([point.vector(2) for point in value.member("corners").entries()]).reshape(-1, 2)
    if not is_outline(corners):
        raise value.member("corners").error("outline has no area, or crosses itself")
    kind, level = value.member("type"), value.member("level")
    if kind.has_value and kind.text() not in ROOM_TYPES:
        raise kind.error(f"unknown room type `{kind.text()[:40]}`", did_you_mean(kind.text(), ROOM_TYPES))
    if level.has_value and not 0 <= level.integer() < 100:
        raise level.error(f"expected a storey from 0 to 99, got {level.integer()}")
    floor, ceiling = (value.member(key) for key in ("floor", "ceiling"))
    return StatedRoom(
        corners,
        kind.text() if kind.has_value else "",
        level.integer() if level.has_value else 0,
        floor.coordinate() if floor.has_value else None,
        ceiling.coordinate() if ceiling.has_value else None,
    )


def _categories(value: JsonValue) -> dict[str, str]:
    """Read the categories by name."""
    value.member("")  # raises unless it is an object
    for name in value.data:
        fine = value.member(name)
        if fine.text() not in FINE:
            raise fine.error(f"unknown category `{fine.text()[:40]}`", did_you_mean(fine.text(), FINE))
    return dict(value.data)
