"""Light sources of a house: lamps of objects, and daylight through windows."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from home_mjx.core.checks import check_number
from home_mjx.core.color import decode_srgb
from home_mjx.geometry.meshes import bounds, to_z_up, transform
from home_mjx.geometry.polygons import boundary_edges, find_innermost_point, find_smallest_room, polygon_area
from home_mjx.scene_compile.objects.placed_objects import PlacedObject
from home_mjx.schema.compiled import ARCHITECTURE, RoomTable
from home_mjx.schema.house import BoxNode, Light
from home_mjx.schema.lighting import MEAN_REFLECTANCE, LightTable

DAYLIGHT_CATEGORIES = ("window", "door", "garage_door")  # coarse and fine categories whose glass transmits daylight
MAX_MERGE_DISTANCE = 0.6  # [m], lights of one lamp closer than this are merged
MIN_MERGE_COSINE = 0.9  # minimum cosine of the angle between the directions of merged lights
ROOM_PROBE_DISTANCE = 0.5  # [m], distance from a window of the points that are tested for a room
PANEL_DROP = 0.05  # [m], distance of an added room light below the ceiling
PANEL_EDGE = 0.5  # [m], edge length of an added room light
POINT_CUTOFF = -2.0  # cutoff of point lights: every direction exceeds this cosine


@dataclass(frozen=True)
class LightOptions:
    """Options of lights that are added to lamps and windows.

    Attributes:
        room_power: Power per floor area of an added light panel, under the ceiling of each room without a lamp
            [W/m^2]; many rooms of SUNCG have none. 0: such rooms have only daylight.

    Raises:
        ConfigError: `room_power` is not a number of at least 0.
    """

    room_power: float = 3.0

    def __post_init__(self) -> None:
        check_number("room_power", self.room_power, 0)


@dataclass(frozen=True)
class LightSource:
    """One light source: a row of a `LightTable`, with its total flux."""

    pos: Float[np.ndarray, "3"]
    flux: Float[np.ndarray, "3"]  # [W]; daylight [m^2 sr], to be multiplied by the sky's radiance
    instance: int
    room: int
    axis_u: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    axis_v: Float[np.ndarray, "3"] = field(default_factory=lambda: np.zeros(3))
    direction: Float[np.ndarray, "3"] = field(default_factory=lambda: np.array([0.0, 0.0, -1.0]))
    exponent: float = 0.0
    cutoff: float = POINT_CUTOFF
    area: float = 0.0
    daylight: bool = False

    @property
    def intensity(self) -> Float[np.ndarray, "3"]:
        """Radiant intensity along `direction` [W/sr], daylight [m^2]: flux over the integral of the angular profile."""
        low = max(self.cutoff, 0.0 if self.exponent else -1.0)
        share = 2 * np.pi * (1 - low * abs(low) ** self.exponent) / (self.exponent + 1)
        return self.flux / share


def build_lights(
    objects: Sequence[PlacedObject],
    rooms: RoomTable,
    options: LightOptions,
) -> LightTable:
    """Build the light table of a house: lamps, daylight, panels in rooms without a lamp, and ambient light by room.

    Lights of objects are first, in their order and in their models' frames. Panels follow by room, in the world; rooms
    without an outline get none.
    """
    found = [s for o in objects for s in (*find_lamp_sources(o), *_daylight(o, rooms))]
    lit = {s.room for s in found if not s.daylight}
    dark = [r for r, polygon in enumerate(rooms.polygon) if r not in lit and len(polygon)]
    found += [_room_source(rooms, r, options) for r in dark if options.room_power]
    ambient = compute_ambient_irradiance(found, rooms)
    if not found:
        return replace(LightTable.empty(), ambient=ambient)
    columns = {name: np.stack([getattr(s, name) for s in found]) for name in _COLUMNS}
    return LightTable(
        **columns,
        instance=np.array([s.instance for s in found], np.int32),
        room=np.array([s.room for s in found], np.int32),
        ambient=ambient,
    )


_COLUMNS = ("pos", "axis_u", "axis_v", "direction", "intensity", "exponent", "cutoff", "area", "daylight")


def find_lamp_sources(item: PlacedObject) -> Iterator[LightSource]:
    """Yield a lamp's lights in its model's frame, close ones merged, as of a chandelier; none for Box nodes."""
    if isinstance(item.node, BoxNode):
        return
    for group in _groups(item.node.lights):
        yield _lamp_source(group, item.instance, item.room)


def _groups(lights: Iterable[Light]) -> list[list[Light]]:
    """Group lights: each joins the first group whose first light it can be merged with."""
    groups: list[list[Light]] = []
    for light in lights:
        home = next((g for g in groups if _alike(g[0], light)), None)
        if home is None:
            groups.append([light])
        else:
            home.append(light)
    return groups


def _alike(a: Light, b: Light) -> bool:
    """Return whether two lights are merged: close points, or close spots with similar aim, of equal cutoff.

    Lines are never merged.
    """
    if a.kind != b.kind or a.kind == "line" or a.cutoff != b.cutoff:
        return False
    near = np.linalg.norm(np.subtract(a.position, b.position)) < MAX_MERGE_DISTANCE
    return bool(near and (a.kind == "point" or _aim(a) @ _aim(b) > MIN_MERGE_COSINE))


def _aim(light: Light) -> Float[np.ndarray, "3"]:
    """Return a light's unit direction in its model's frame, Z up; down if the file has none, or zeros."""
    given = light.direction if light.direction and any(light.direction) else (0.0, -1.0, 0.0)
    direction = np.array(given, float)
    return to_z_up(direction / np.linalg.norm(direction))


def _lamp_source(group: Sequence[Light], instance: int, room: int) -> LightSource:
    """Return the light of a group, in its model's frame: total flux, and power-weighted mean ends.

    Kind, aim, exponent and cutoff are those of the first.
    """
    power = np.array([light.power for light in group], float)
    share = power / max(power.sum(), 1e-9)
    ends = [(light.position, light.position if light.end is None else light.end) for light in group]
    start, end = (to_z_up(share @ np.array(points, float)) for points in zip(*ends, strict=True))
    flux = power @ decode_srgb(np.array([light.color for light in group], float))
    lead = group[0]
    aimed = lead.kind == "spot" or (lead.kind == "line" and lead.direction is not None)
    shape = {"direction": _aim(lead), "exponent": lead.dropoff, "cutoff": _cutoff(lead)} if aimed else {}
    return LightSource((start + end) / 2, flux, instance, room, (end - start) / 2, **shape)


def _cutoff(light: Light) -> float:
    """Return the cosine of a light's cutoff angle, which is 90 degrees if the file has none, and at least 0.05 rad."""
    return float(np.cos(np.clip(np.pi / 2 if light.cutoff is None else light.cutoff, 0.05, np.pi)))


def _daylight(item: PlacedObject, rooms: RoomTable) -> Iterator[LightSource]:
    """Yield the daylight source of a window's or door's glass, in its model's frame, if between a room and outdoors.

    Glass is all triangles of slots with opacity below 1. The source is the rectangle around them, in the middle of
    their thinner horizontal extent, and shines into the room. Its flux is pi times its area, times the tint of the
    first of them.
    """
    if {item.info.fine, item.info.coarse}.isdisjoint(DAYLIGHT_CATEGORIES):
        return
    surfaces = item.surfaces
    glass = np.array([s.opacity < 1 for s in surfaces], bool)[item.model.slot]
    if not glass.any():
        return
    low, high = bounds(item.model.triangle[glass].astype(np.float64))
    stretch = np.linalg.norm(item.pose[:, :3], axis=0)
    thin = int(np.argmin(((high - low) * stretch)[:2]))  # windows are upright, so their normal is horizontal
    across = 1 - thin
    normal = np.eye(3)[thin]
    facing = _inward(item, (low + high) / 2, normal, rooms)
    if facing is None:
        return
    side, room = facing
    half = (high - low) / 2
    area = float(np.prod(2 * half[[across, 2]] * stretch[[across, 2]]))
    pane = surfaces[int(item.model.slot[glass][0])]
    tint = 1 - pane.opacity * (1 - decode_srgb(np.array(pane.color)))
    yield LightSource(
        pos=(low + high) / 2,
        flux=np.pi * area * tint,
        instance=item.instance,
        room=room,
        axis_u=np.eye(3)[across] * half[across],
        axis_v=np.eye(3)[2] * half[2],
        direction=side * normal,
        exponent=1.0,
        cutoff=0.0,
        area=area,
        daylight=True,
    )


def _inward(
    item: PlacedObject, middle: Float[np.ndarray, "3"], normal: Float[np.ndarray, "3"], rooms: RoomTable
) -> tuple[int, int] | None:
    """Return 1 if the room is along `normal`, else -1, and the room; None unless exactly one side has a room.

    `middle` is the centre of the glass; both are in the model's frame.
    """
    center = transform(item.pose, middle)
    out = item.pose[:, :3] @ normal
    out = out / np.linalg.norm(out)
    here = np.flatnonzero(rooms.level == item.level)
    beside = [int(find_smallest_room(rooms, here, (center + side * ROOM_PROBE_DISTANCE * out)[:2])) for side in (1, -1)]
    inside = [room >= 0 for room in beside]
    if sum(inside) != 1:
        return None
    return (1, beside[0]) if inside[0] else (-1, beside[1])


def _room_source(rooms: RoomTable, room: int, options: LightOptions) -> LightSource:
    """Return a panel light below the ceiling at a room's innermost point that shines down, its power by floor area."""
    polygon = rooms.polygon[room]
    x, y = find_innermost_point(polygon)
    power = options.room_power * polygon_area(polygon)
    pos = np.array([x, y, rooms.ceiling[room] - PANEL_DROP])
    half = np.diag([PANEL_EDGE / 2, PANEL_EDGE / 2, 0])
    area = {"axis_u": half[0], "axis_v": half[1], "area": PANEL_EDGE**2}
    return LightSource(pos, np.full(3, power), ARCHITECTURE, room, exponent=1.0, cutoff=0.0, **area)


def compute_ambient_irradiance(sources: Sequence[LightSource], rooms: RoomTable) -> Float[np.ndarray, "r 2 3"]:
    """Compute the uniform irradiance of each room by interreflection: of lamps [W/m^2] and daylight [sr].

    With flux F, mean reflectance p and surface A it is F / A * (p + p^2 + ...) = F / A * p / (1 - p). This is the
    ambient term of M. F. Cohen et al., "A progressive refinement approach to fast radiosity image generation",
    SIGGRAPH 1988.

    Column 0 is that of lamps, column 1 that of daylight, per radiance of the sky. Row r + 1 is room r. Row 0 is for
    points outside all rooms: the mean of all rooms for lamps, and half the sky for daylight. Sources outside all rooms
    do not count.
    """
    flux = np.zeros((len(rooms.type), 2, 3))
    for s in sources:
        if s.room >= 0:
            flux[s.room, int(s.daylight)] += s.flux
    surface = np.array([_surface(rooms, r) for r in range(len(rooms.type))]).reshape(-1, 1, 1)
    inside = flux / surface * MEAN_REFLECTANCE / (1 - MEAN_REFLECTANCE)
    nowhere = np.stack([inside[:, 0].mean(axis=0) if len(inside) else np.zeros(3), np.full(3, np.pi / 2)])
    return np.concatenate([nowhere[None], inside])


def _surface(rooms: RoomTable, room: int) -> float:
    """Return the area of a room's floor, ceiling and walls [m^2]; at least 1, with walls at least 1 m high."""
    polygon = rooms.polygon[room]
    start, end = boundary_edges(polygon).swapaxes(0, 1)
    around = np.linalg.norm(end - start, axis=1).sum()
    height = max(float(rooms.ceiling[room] - rooms.floor[room]), 1.0)
    return max(2 * polygon_area(polygon) + float(around) * height, 1.0)
