"""One house as the arrays that the engines need: NumPy, world frame (Z up, metres), no padding.

`compile_house` makes it, `cache` stores it, `bank` puts many of them on the device.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntEnum, IntFlag

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8, UInt16

from home_mjx.schema.lighting import Gloss, LightTable

BANDS = (125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0)  # [Hz], octave centres


ARCHITECTURE = 0  # instance index of walls, floors and ceilings in every house
NUM_BANDS = 7  # octaves 125 .. 8000 Hz


class Ray(IntFlag):
    """Kinds of ray, as bits of the mask of what a material stops."""

    CAMERA = 1
    LIGHT = 2
    SOUND = 4
    ALL = 7


@dataclass(frozen=True)
class Tree:
    """A binary bounding-volume tree; node 0 is the root.

    A child code >= 0 is an inner node; a negative one is a leaf: `~code` holds `first << 4 | count`,
    so -1 is an empty leaf. `first` counts primitives (triangles, or instances in a top tree).
    """

    box: Float[np.ndarray, "n 2 6"]  # per child: min xyz, max xyz
    child: Int[np.ndarray, "n 2"]


@dataclass(frozen=True)
class MaterialTable:
    """Rows of materials, for light and for sound."""

    albedo: Float[np.ndarray, "r 4"]  # sRGB diffuse 0..1, and opacity
    texture: tuple[str, ...]  # absolute path of the image, "" for none
    kind: tuple[str, ...]  # semantic and acoustic name, such as "wood", "wallpaper"; "" unknown
    mask: Int[np.ndarray, " r"]  # Ray bits that the material stops
    absorption: Float[np.ndarray, "r bands"]  # energy fractions per octave
    scattering: Float[np.ndarray, "r bands"]
    transmission: Float[np.ndarray, "r bands"]


@dataclass(frozen=True)
class Model:
    """A library model in its own frame (Z up), triangles in the order of its tree's leaves."""

    key: str  # content-addressed: file stem, variant and digest
    triangle: Float[np.ndarray, "t 3 3"]  # [m]
    uv: Float[np.ndarray, "t 3 2"]
    normal: Float[np.ndarray, "t 3 3"]  # unit, of the corners; smooth where the surface is meant to be round
    slot: Int[np.ndarray, " t"]  # material slot
    part: Int[np.ndarray, " t"]  # semantic part; 0 for objects
    tree: Tree
    box: Float[np.ndarray, "2 3"]


@dataclass(frozen=True)
class Instances:
    """Everything a ray can hit; row `ARCHITECTURE` is the house itself."""

    model: tuple[str, ...]  # keys into the library
    pose: Float[np.ndarray, "i 3 4"]  # world from model: linear part (rotation, scale, mirror) and translation [m]
    object_id: Int[np.ndarray, " i"]  # Semantic.OBJECT; -1 for the architecture
    material: Int[np.ndarray, " i"]  # first row of its slots in the house's MaterialTable
    semantic: Int[np.ndarray, " i"]  # first row of its parts in the semantic table
    body: Int[np.ndarray, " i"]  # index of the movable body; -1 static


@dataclass(frozen=True)
class Colliders:
    """Static collision boxes: of the architecture, of objects, and invisible ones that keep agents in the rooms."""

    pos: Float[np.ndarray, "c 3"]  # [m], centre
    quat: Float[np.ndarray, "c 4"]  # wxyz
    size: Float[np.ndarray, "c 3"]  # [m], half extents
    object_id: Int[np.ndarray, " c"]  # Semantic.OBJECT of the box's object; -1 for the architecture and barriers


@dataclass(frozen=True)
class Bodies:
    """Movable objects, one box each, in the order of priority."""

    instance: Int[np.ndarray, " k"]
    pos: Float[np.ndarray, "k 3"]  # [m], centre of the box = centre of mass
    quat: Float[np.ndarray, "k 4"]  # wxyz
    size: Float[np.ndarray, "k 3"]  # [m], half extents
    mass: Float[np.ndarray, " k"]  # [kg]
    friction: Float[np.ndarray, " k"]  # sliding
    restitution: Float[np.ndarray, " k"]  # part of the speed that is left after a bounce, 0..1
    from_model: Float[np.ndarray, "k 3 4"]  # body frame from model frame, constant


@dataclass(frozen=True)
class Doors:
    """Leaves of doors between rooms, each its own instance on a vertical hinge or a horizontal rail.

    Each has one coordinate, 0 as placed. Of a hinged leaf it is an angle about +z: at angle q its box and its instance
    are turned by q about the vertical line through `pivot`. A sliding leaf is shifted by q along `slide`.
    Leaves of doors that lead outdoors are shut and static: they are not listed.
    """

    instance: Int[np.ndarray, " h"]
    pivot: Float[np.ndarray, "h 2"]  # [m], where the hinge meets the plan; of a sliding leaf the middle of its box
    closed: Float[np.ndarray, " h"]  # [rad] or [m], coordinate at which the leaf is closed
    wide: Float[np.ndarray, " h"]  # at which it is wide open, as far as it can be
    low: Float[np.ndarray, " h"]  # between `low` and `high` it moves freely; one of them is `closed`
    high: Float[np.ndarray, " h"]
    pos: Float[np.ndarray, "h 3"]  # [m], centre of the leaf's box, as placed
    quat: Float[np.ndarray, "h 4"]  # wxyz
    size: Float[np.ndarray, "h 3"]  # [m], half extents
    mass: Float[np.ndarray, " h"]  # [kg]
    slide: Float[np.ndarray, "h 2"]  # unit direction in which it slides; 0: it is hinged

    @property
    def slides(self) -> Bool[np.ndarray, " h"]:
        """Which leaves slide."""
        return (self.slide != 0).any(axis=1)

    def rows(self, num_doors: int, num_slides: int) -> Int[np.ndarray, " h"]:
        """Row of each leaf in a table of so many, of which the last slide."""
        hinged, sliding = np.cumsum(~self.slides) - 1, num_doors - num_slides + np.cumsum(self.slides) - 1
        return np.where(self.slides, sliding, hinged).astype(np.int32)

    @staticmethod
    def none() -> "Doors":
        """No doors."""
        flat = np.zeros(0)
        box = {"pos": np.zeros((0, 3)), "quat": np.zeros((0, 4)), "size": np.zeros((0, 3))}
        angles = dict.fromkeys(("closed", "wide", "low", "high"), flat)
        return Doors(np.zeros(0, np.int32), np.zeros((0, 2)), **angles, **box, mass=flat, slide=np.zeros((0, 2)))


@dataclass(frozen=True)
class Ramps:
    """Slopes that stand for flights of stairs: static boxes, the upper side of each from floor to floor."""

    object_id: Int[np.ndarray, " f"]  # Semantic.OBJECT of the stairs
    pos: Float[np.ndarray, "f 3"]  # [m], centre
    quat: Float[np.ndarray, "f 4"]  # wxyz; the box's x axis points uphill
    size: Float[np.ndarray, "f 3"]  # [m], half extents
    slope: Float[np.ndarray, " f"]  # [rad], above the horizontal
    up: Float[np.ndarray, "f 2"]  # unit direction uphill in the plan
    collider: Int[np.ndarray, " f"]  # row of Colliders with the same box

    @staticmethod
    def none() -> "Ramps":
        """No stairs."""
        box = {"pos": np.zeros((0, 3)), "quat": np.zeros((0, 4)), "size": np.zeros((0, 3))}
        rows = np.zeros(0, np.int32)
        return Ramps(rows, **box, slope=np.zeros(0), up=np.zeros((0, 2)), collider=rows)


@dataclass(frozen=True)
class Planes:
    """Rectangles of walls, floors and ceilings that mirror sound, facing the room."""

    center: Float[np.ndarray, "p 3"]  # [m]
    normal: Float[np.ndarray, "p 3"]
    axis_u: Float[np.ndarray, "p 3"]  # [m], half extent vectors in the plane
    axis_v: Float[np.ndarray, "p 3"]
    material: Int[np.ndarray, " p"]  # row in the house's MaterialTable


@dataclass(frozen=True)
class Rooms:
    """Rooms in file order."""

    type: Int[np.ndarray, " r"]  # index into ROOM_TYPES; -1 unknown
    level: Int[np.ndarray, " r"]
    polygon: tuple[Float[np.ndarray, "_ 2"], ...]  # [m], floor outline in x and y
    floor: Float[np.ndarray, " r"]  # [m], height of the floor's top
    ceiling: Float[np.ndarray, " r"]  # [m], height of the ceiling's underside


class PortalKind(IntEnum):
    """The kinds of connection between two rooms."""

    OPENING = 0
    DOOR = 1
    STAIRS = 2


@dataclass(frozen=True)
class Portals:
    """Connections between rooms."""

    room: Int[np.ndarray, "p 2"]  # room indices, the lower first; -1 outdoors
    pos: Float[np.ndarray, "p 3"]  # [m], middle, on the floor
    width: Float[np.ndarray, " p"]  # [m], over which an agent's axis can cross with leaves open; 0: agents cannot
    kind: Int[np.ndarray, " p"]  # PortalKind
    leaf: Int[np.ndarray, "p 2"]  # rows of Doors: leaves that can close it; -1 none


FIELD_UNIT = 0.0025  # [m], of stored geodesic distances
FIELD_FAR = 65535  # stored distance where there is no path
BELOW_FLOOR = 0.3  # [m]: a point so far below the lowest floor of a level still counts as on that level


@dataclass(frozen=True)
class Fringe:
    """Cells beside the home region that agents can come to: close to walls, and where things stand that can be moved.

    They are numbered after the home cells.
    """

    narrow: int  # the first so many are free as things stand, with less room than in the home region
    place: Int[np.ndarray, "e 3"]  # grid, row and column
    height: Float[np.ndarray, " e"]  # [m], of the floor or ramp
    field: UInt16[np.ndarray, "e g"]  # [FIELD_UNIT], distances of the home region continued: see `navigation.fringe`
    nearest: Int[np.ndarray, "l ny nx"]  # of every cell: its number, or that of the nearest cell that has one


@dataclass(frozen=True)
class Navigation:
    """Where an agent can stand: one grid per level that has rooms, the lowest first; row = y, column = x.

    Region 0 is the home region: the largest one of the ground floor and, where agents climb stairs, of the levels that
    are joined to it. Its cells are numbered in the order of the grids. Ramps are part of it: of each, what lies more
    than `BELOW_FLOOR` below the upper level is in the grid of the lower one. Starts and goals lie on floors.
    """

    origin: Float[np.ndarray, " 2"]  # [m], corner of cell (0, 0) of every grid
    cell: float  # [m]
    agent_radius: float  # [m], of the agents for whom there is room in `region`
    agent_height: float  # [m]
    level: Int[np.ndarray, " l"]  # level index of each grid
    floor: Float[np.ndarray, " l"]  # [m], lowest floor of each level
    region: Int[np.ndarray, "l ny nx"]  # connected region where the agent's axis may be, larger before smaller; -1 none
    region_area: Float[np.ndarray, " n"]  # [m^2]
    room: Int[np.ndarray, "l ny nx"]  # room index; -1 outside
    height: Float[np.ndarray, " c"]  # [m], of the floor or ramp under each home cell
    start: Float[np.ndarray, "s 3"]  # [m], sampled points of the home region, on the floor
    goal: Float[np.ndarray, "g 3"]
    field: UInt16[np.ndarray, "c g"]  # [FIELD_UNIT], geodesic distance of each home cell to each goal; FIELD_FAR
    fringe: Fringe
    portals: Portals
    room_hops: Int[np.ndarray, "r r"]  # least number of portals between two rooms; -1 no way

    @property
    def free(self) -> Bool[np.ndarray, "l ny nx"]:
        """The home region."""
        return self.region == 0

    @property
    def place(self) -> Int[np.ndarray, "c 3"]:
        """Grid, row and column of each home cell."""
        return np.argwhere(self.free)

    def distance(self, goal: int) -> Float[np.ndarray, "l ny nx"]:
        """Geodesic distance to a goal [m]; inf where there is no path."""
        field = np.full(self.region.shape, np.inf)
        field[self.free] = np.where(self.field[:, goal] == FIELD_FAR, np.inf, self.field[:, goal] * FIELD_UNIT)
        return field


@dataclass(frozen=True)
class CompiledHouse:
    """A house ready for the engines."""

    id: str
    offset: Float[np.ndarray, " 3"]  # [m], added to file coordinates (after Z up) to get the world frame
    box: Float[np.ndarray, "2 3"]
    instances: Instances
    top: Tree  # over static instances
    materials: MaterialTable
    semantics: Int[np.ndarray, "q columns"]  # columns: Semantic
    colliders: Colliders
    bodies: Bodies
    planes: Planes
    rooms: Rooms
    navigation: Navigation
    models: Mapping[str, Model]
    ground_floor: float  # [m], top of the lowest level that has rooms
    lot: Float[np.ndarray, "2 2"]  # [m], minimum and maximum x and y of the area that the fence encloses
    agent_materials: MaterialTable  # one row per material slot of the agent's model
    report: Mapping[str, int]  # counts: levels, rooms, objects, parts, triangles, ...
    doors: Doors = field(default_factory=Doors.none)
    ramps: Ramps = field(default_factory=Ramps.none)
    lights: LightTable = field(default_factory=LightTable.none)
    gloss: Gloss = field(default_factory=lambda: Gloss.matt(0))  # of the first rows of `materials`; the rest is matt
    # Ids of objects that could be pushed if they did not stand in something.
    stuck: Int[np.ndarray, " n"] = field(default_factory=lambda: np.zeros(0, np.int32))


TextureArray = UInt8[np.ndarray, "l p 4"]  # layers, texels of all mip levels
