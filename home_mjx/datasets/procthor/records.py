"""Records of a house as ProcTHOR's JSON has it: Unity's frame, left-handed, Y up, metres and degrees."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from home_mjx.schema.house import Problem

Point = tuple[float, float]  # (x, z) [m]
Triple = tuple[float, float, float]


@dataclass(frozen=True)
class ThorMaterial:
    """A material: a name of AI2-THOR's, and a colour that multiplies it."""

    name: str
    color: Triple | None = None  # sRGB, 0..1


@dataclass(frozen=True)
class ThorRoom:
    """A room."""

    id: str
    type: str
    corners: tuple[Point, ...]  # of the middle lines of its walls
    floor: ThorMaterial
    walls: ThorMaterial
    outside: ThorMaterial
    ceiling: ThorMaterial


@dataclass(frozen=True)
class ThorWall:
    """A wall of one room; both sides of a wall between rooms are walls of their own."""

    id: str
    room: str
    start: Point  # origin of positions along it
    end: Point
    height: float
    material: ThorMaterial
    is_empty: bool  # no wall: the rooms are open to each other
    is_exterior: bool  # the outer skin of another wall


@dataclass(frozen=True)
class ThorOpening:
    """A door, a doorway or a window."""

    element: str
    kind: str  # `door` or `window`
    asset: str
    start: Point
    end: Point
    low: float  # [m], above the floor
    high: float
    openable: bool
    openness: float  # 0 closed to 1 open
    rooms: tuple[str, str]


@dataclass(frozen=True)
class ThorObject:
    """A thing with the things on it or in it; positions are absolute."""

    element: str
    asset: str
    kind: str  # such as `Dresser`
    room: str  # id of its room; "" if the file does not tell
    position: Triple  # middle of its box
    rotation: Triple  # [deg], about x, y, z
    children: tuple["ThorObject", ...] = ()
    footprint: tuple[float, float] | None = None  # [m], extents along the house's x and z, if the file has them


@dataclass(frozen=True)
class ThorLight:
    """A point light."""

    position: Triple
    color: Triple  # sRGB, 0..1
    intensity: float


@dataclass(frozen=True)
class ThorHouse:
    """A house."""

    schema: str
    rooms: tuple[ThorRoom, ...]
    walls: tuple[ThorWall, ...]
    openings: tuple[ThorOpening, ...]
    open_lines: tuple[tuple[Point, Point], ...]  # lines without a wall
    objects: tuple[ThorObject, ...]
    lights: tuple[ThorLight, ...]
    height: float  # [m], of its walls
    problems: Sequence[Problem] = ()
    extra: Mapping[str, Any] = field(default_factory=dict)
