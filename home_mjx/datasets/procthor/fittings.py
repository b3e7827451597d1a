"""Doors, doorways, windows and lights of a house as objects."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.furniture import FurnitureProvider
from home_mjx.datasets.procthor.records import Point, ThorHouse, ThorLight, ThorOpening, ThorRoom
from home_mjx.datasets.procthor.shell import FLOOR, room_polygon, to_plan
from home_mjx.geometry.polygons import is_inside_polygon, polygon_area
from home_mjx.schema.house import Joint, Light, Material, Mesh

FRAME_MARGIN = 0.02  # [m], of the frame of a door or window over the edge of its hole
WINDOW_DEPTH = 0.14  # [m]
OPENNESS_STEPS = 4  # number of steps in which doors may be open, so that houses share doors
PROBE = 0.3  # [m], from a wall to a point in the room beside it
ROOM_POWER = 3.0  # [W/m^2], mean power of the lights of a house per floor area
LAMP_SIZE, BULB_DROP = (0.4, 0.1, 0.4), 0.03  # [m], of lamps; distance of the light below its lamp


@dataclass(frozen=True)
class Fitting:
    """An object that belongs to the building."""

    element: str
    asset: str
    fine: str
    key: str
    mesh: Mesh
    transform: Float[np.ndarray, "4 4"]
    words: str
    materials: tuple[Material, ...] = ()
    joints: tuple[Joint, ...] = ()
    lights: tuple[Light, ...] = ()
    room: int = -1


def opening_fitting(found: ThorOpening, rooms: Sequence[ThorRoom], provider: FurnitureProvider) -> Fitting:
    """Return a door, the frame of a doorway or a window in its hole; leaves open away from the first room."""
    start, end = np.array(to_plan(found.start)), np.array(to_plan(found.end))
    room = next((number for number, one in enumerate(rooms) if one.id in found.rooms), -1)
    width = float(np.hypot(*(end - start))) + 2 * FRAME_MARGIN
    transform = _upright(start, end, found.low + FLOOR, found.rooms[0], rooms)
    if found.kind == "window":
        transform[1, 3] -= FRAME_MARGIN
        return replace(_window(found, transform, width, provider), room=room)
    height = found.high - found.low + FRAME_MARGIN
    if found.asset.lower().startswith("doorframe"):
        mesh = provider.frame(width, height)
        return Fitting(found.element, found.asset, "arch", mesh.path.stem, mesh, transform, "a frame", room=room)
    leaves = 2 if "_double" in found.asset.lower() else 1
    turn = round(found.openness * OPENNESS_STEPS) / OPENNESS_STEPS * np.pi / 2
    door = provider.doors(width, height, leaves, turn, found.asset)
    return Fitting(
        found.element, found.asset, "door", door.key, door.mesh, transform, "an own door", joints=door.joints, room=room
    )


def _window(
    found: ThorOpening, transform: Float[np.ndarray, "4 4"], width: float, provider: FurnitureProvider
) -> Fitting:
    height = found.high - found.low + 2 * FRAME_MARGIN
    piece = provider.piece("window", "window", (width, height, WINDOW_DEPTH), found.asset)
    assert piece is not None
    transform[:3, :3] = transform[:3, :3] @ np.diag(piece.scale)
    return Fitting(found.element, found.asset, "window", piece.key, piece.mesh, transform, piece.words, piece.materials)


def _upright(
    start: Float[np.ndarray, " 2"], end: Float[np.ndarray, " 2"], low: float, room: str, rooms: Sequence[ThorRoom]
) -> Float[np.ndarray, "4 4"]:
    """Return the pose of an opening on the middle line of its wall: front into a room, base at height `low` [m]."""
    middle, way = (start + end) / 2, (end - start) / np.hypot(*(end - start))
    front = np.array([-way[1], way[0]])
    polygons = [room_polygon(found) for found in rooms if found.id == room]
    if polygons and not is_inside_polygon(polygons[0], middle + PROBE * front):
        front = -front
    pose = np.eye(4)
    pose[:3, 0], pose[:3, 2] = (front[1], 0.0, -front[0]), (front[0], 0.0, front[1])
    pose[:3, 3] = middle[0], low, middle[1]
    return pose


def light_fittings(house: ThorHouse, provider: FurnitureProvider) -> Iterator[Fitting]:
    """Generate a lamp under the ceiling for each point light of a house.

    The lights of a house have `ROOM_POWER` in the mean, and the ratios of their intensities in the file.
    """
    polygons = [room_polygon(room) for room in house.rooms]
    mean = float(np.mean([light.intensity for light in house.lights])) if house.lights else 1.0
    for number, light in enumerate(house.lights):
        room, place = _lit_room(light, polygons)
        if room >= 0:
            power = ROOM_POWER * polygon_area(polygons[room]) * light.intensity / mean
            pose = np.eye(4)
            pose[:3, 3] = place[0], house.height + FLOOR - LAMP_SIZE[1], place[1]
            yield _lamp(f"proceduralParameters.lights[{number}]", light, power, pose, room, provider)


def _lamp(
    element: str,
    light: ThorLight,
    power: float,
    pose: Float[np.ndarray, "4 4"],
    room: int,
    provider: FurnitureProvider,
) -> Fitting:
    piece = provider.piece("lightfixture", "chandelier", LAMP_SIZE, element)
    assert piece is not None
    pose[:3, :3] = np.diag(piece.scale)
    bulb = Light("point", power, light.color, (0.0, -BULB_DROP / piece.scale[1], 0.0))
    return Fitting(
        element,
        "",
        "chandelier",
        piece.key,
        piece.mesh,
        pose,
        piece.words,
        piece.materials,
        lights=(bulb,),
        room=room,
    )


def _lit_room(light: ThorLight, polygons: Sequence[Float[np.ndarray, "_ 2"]]) -> tuple[int, Point]:
    """Return the room of a light and its place there; -1 for a light outside of the house."""
    x, _, z = light.position
    point = np.array(to_plan((x, z)))
    room = next((r for r, polygon in enumerate(polygons) if is_inside_polygon(polygon, point)), -1)
    return room, (float(point[0]), float(point[1]))
