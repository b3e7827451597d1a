"""Compiled house: the arrays of one house that all engines read (NumPy, world frame Z up, metres, no padding).

`compile_house` creates it, `cache` stores it on disk, and `bank` packs many houses into device arrays.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import IntFlag

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8, UInt16

from home_mjx.core.named_enum import NamedIntEnum
from home_mjx.schema.lighting import Gloss, LightTable, MaterialMaps

BANDS = (125.0, 250.0, 500.0, 1000.0, 2000.0, 4000.0, 8000.0)  # [Hz], octave centres


ARCHITECTURE = 0  # instance index of walls, floors and ceilings in every house
NUM_BANDS = 7  # octaves 125 .. 8000 Hz
MAX_DEPTH = 32  # maximum levels of child links in a `BVH`; sets the stack size of the ray casters
EMPTY_LEAF = -1  # code of an empty leaf in a `BVH`


class RayKind(IntFlag):
    """Ray kinds as bits of a material's blocking mask."""

    CAMERA = 1
    LIGHT = 2
    SOUND = 4
    ALL = 7


@dataclass(frozen=True)
class BVH:
    """A binary bounding-volume hierarchy; node 0 is the root.

    A child code >= 0 is an inner node; a negative one is a leaf: `~code` encodes `first << 4 | count`,
    so -1 is an empty leaf. `first` counts primitives (triangles, or instances in a top tree).
    """

    box: Float[np.ndarray, "n 2 6"]  # per child: min xyz, max xyz
    child: Int[np.ndarray, "n 2"]


@dataclass(frozen=True)
class MaterialTable:
    """Optical and acoustic properties of materials, one row per material."""

    albedo: Float[np.ndarray, "r 4"]  # sRGB diffuse 0..1, and opacity
    texture: tuple[str, ...]  # absolute path of the image, "" for none
    kind: tuple[str, ...]  # semantic and acoustic name, such as "wood", "wallpaper"; "" unknown
    mask: Int[np.ndarray, " r"]  # bits of `RayKind` that the material blocks
    absorption: Float[np.ndarray, "r bands"]  # energy fractions per octave
    scattering: Float[np.ndarray, "r bands"]
    transmission: Float[np.ndarray, "r bands"]
    maps: MaterialMaps = field(default_factory=MaterialMaps.empty)


@dataclass(frozen=True)
class Model:
    """A library model in its own frame (Z up), with triangles in the order of the leaves of its tree."""

    key: str  # content-addressed: file stem, variant and digest
    triangle: Float[np.ndarray, "t 3 3"]  # [m]
    uv: Float[np.ndarray, "t 3 2"]
    normal: Float[np.ndarray, "t 3 3"]  # unit, per corner; interpolated on smooth surfaces
    slot: Int[np.ndarray, " t"]  # material slot
    part: Int[np.ndarray, " t"]  # semantic part; 0 for objects
    tree: BVH
    box: Float[np.ndarray, "2 3"]  # [m], minimum and maximum corner


@dataclass(frozen=True)
class Instances:
    """Instances of models that rays can hit; row `ARCHITECTURE` is the house's own geometry."""

    model: tuple[str, ...]  # keys into the library
    pose: Float[np.ndarray, "i 3 4"]  # world from model: linear part (rotation, scale, mirror) and translation [m]
    object_id: Int[np.ndarray, " i"]  # Semantic.OBJECT_ID; -1 for the architecture
    material: Int[np.ndarray, " i"]  # first row of its slots in the house's MaterialTable
    semantic: Int[np.ndarray, " i"]  # first row of its parts in the semantic table
    body: Int[np.ndarray, " i"]  # index of the movable body; -1 static


@dataclass(frozen=True)
class Colliders:
    """Static collision boxes of the architecture and objects, and invisible barriers that keep agents in the rooms."""

    pos: Float[np.ndarray, "c 3"]  # [m], centre
    quat: Float[np.ndarray, "c 4"]  # wxyz
    size: Float[np.ndarray, "c 3"]  # [m], half extents
    object_id: Int[np.ndarray, " c"]  # Semantic.OBJECT_ID of the box's object; -1 for the architecture and barriers


@dataclass(frozen=True)
class Bodies:
    """Movable bodies, one box each, in order of priority (lightest first)."""

    instance: Int[np.ndarray, " k"]
    pos: Float[np.ndarray, "k 3"]  # [m], centre of the box = centre of mass
    quat: Float[np.ndarray, "k 4"]  # wxyz
    size: Float[np.ndarray, "k 3"]  # [m], half extents
    mass: Float[np.ndarray, " k"]  # [kg]
    friction: Float[np.ndarray, " k"]  # sliding
    restitution: Float[np.ndarray, " k"]  # ratio of the speeds after and before a bounce, 0..1
    from_model: Float[np.ndarray, "k 3 4"]  # body frame from model frame, constant


@dataclass(frozen=True)
class Doors:
    """Door leaves between rooms, and fronts of furniture, each an instance of its own on a hinge or a rail.

    Hinges are vertical, rails horizontal.

    Each leaf has one joint coordinate q, 0 as authored. For a hinged leaf q is an angle about +z: its box and its
    instance are rotated by q about the vertical line through `pivot`. A sliding leaf is translated by q along `slide`.
    Leaves of exterior doors are closed and static, and have no row here.

    A drawer is a leaf whose box is its front, with a tray: more boxes that move with it, in the frame of its box. Its
    boxes are bottom, sides and back. Of leaves without a tray they have negative half extents.
    """

    instance: Int[np.ndarray, " h"]
    pivot: Float[np.ndarray, "h 2"]  # [m], position of the hinge in plan; for a sliding leaf the centre of its box
    closed: Float[np.ndarray, " h"]  # [rad] or [m], coordinate at which the leaf is closed
    fully_open: Float[np.ndarray, " h"]  # [rad] or [m], coordinate at which the leaf is fully open
    low: Float[np.ndarray, " h"]  # [rad] or [m], minimum coordinate; `low` or `high` equals `closed`
    high: Float[np.ndarray, " h"]  # [rad] or [m], maximum coordinate
    pos: Float[np.ndarray, "h 3"]  # [m], centre of the leaf's box at q = 0
    quat: Float[np.ndarray, "h 4"]  # wxyz
    size: Float[np.ndarray, "h 3"]  # [m], half extents
    mass: Float[np.ndarray, " h"]  # [kg]
    slide: Float[np.ndarray, "h 2"]  # unit direction of sliding; 0: hinged
    is_front: Bool[np.ndarray, " h"]  # of a piece of furniture, not between rooms
    tray_pos: Float[np.ndarray, "_ t 3"] = field(default_factory=lambda: np.zeros((0, 0, 3)))  # [m], centres, per leaf
    tray_size: Float[np.ndarray, "_ t 3"] = field(default_factory=lambda: np.zeros((0, 0, 3)))  # [m], half extents

    @property
    def num_tray_boxes(self) -> int:
        """Number of boxes of a tray; 0 if no leaf has one, and `tray_pos` and `tray_size` may then lack rows."""
        return self.tray_size.shape[1]

    @property
    def is_sliding(self) -> Bool[np.ndarray, " h"]:
        """Mask of sliding leaves."""
        return (self.slide != 0).any(axis=1)

    def bank_rows(self, num_doors: int, num_slides: int) -> Int[np.ndarray, " h"]:
        """Return leaves' rows in a table of `num_doors`: hinged from 0, sliding from `num_doors - num_slides`.

        Each kind keeps the order of its leaves. Their numbers are not checked against the capacities.
        """
        hinged, sliding = np.cumsum(~self.is_sliding) - 1, num_doors - num_slides + np.cumsum(self.is_sliding) - 1
        return np.where(self.is_sliding, sliding, hinged).astype(np.int32)

    @staticmethod
    def empty() -> "Doors":
        """Return a table of doors without rows."""
        flat = np.zeros(0)
        box = {"pos": np.zeros((0, 3)), "quat": np.zeros((0, 4)), "size": np.zeros((0, 3))}
        angles = dict.fromkeys(("closed", "fully_open", "low", "high"), flat)
        kinds = {"slide": np.zeros((0, 2)), "is_front": np.zeros(0, bool)}
        return Doors(np.zeros(0, np.int32), np.zeros((0, 2)), **angles, **box, mass=flat, **kinds)


@dataclass(frozen=True)
class Compartments:
    """Free boxes behind fronts of furniture, in which things can be; those of drawers move with their leaf."""

    leaf: Int[np.ndarray, " n"]  # row of Doors: the front
    pos: Float[np.ndarray, "n 3"]  # [m], centre with the front shut
    quat: Float[np.ndarray, "n 4"]  # wxyz, about z only
    size: Float[np.ndarray, "n 3"]  # [m], half extents

    @staticmethod
    def empty() -> "Compartments":
        """Return a table of compartments without rows."""
        return Compartments(np.zeros(0, np.int32), np.zeros((0, 3)), np.zeros((0, 4)), np.zeros((0, 3)))


@dataclass(frozen=True)
class Ramps:
    """Ramps that replace flights of stairs: static boxes whose upper sides connect two floors."""

    object_id: Int[np.ndarray, " f"]  # Semantic.OBJECT_ID of the stairs
    pos: Float[np.ndarray, "f 3"]  # [m], centre
    quat: Float[np.ndarray, "f 4"]  # wxyz; the box's x axis points uphill
    size: Float[np.ndarray, "f 3"]  # [m], half extents
    slope: Float[np.ndarray, " f"]  # [rad], above the horizontal
    up: Float[np.ndarray, "f 2"]  # unit direction uphill in the plan
    collider: Int[np.ndarray, " f"]  # row of Colliders with the same box

    @staticmethod
    def empty() -> "Ramps":
        """Return a table of ramps without rows."""
        box = {"pos": np.zeros((0, 3)), "quat": np.zeros((0, 4)), "size": np.zeros((0, 3))}
        rows = np.zeros(0, np.int32)
        return Ramps(rows, **box, slope=np.zeros(0), up=np.zeros((0, 2)), collider=rows)


@dataclass(frozen=True)
class Planes:
    """Rectangles of walls, floors and ceilings that reflect sound specularly, facing the room."""

    center: Float[np.ndarray, "p 3"]  # [m]
    normal: Float[np.ndarray, "p 3"]  # unit, towards the room
    axis_u: Float[np.ndarray, "p 3"]  # [m], half extent vectors in the plane
    axis_v: Float[np.ndarray, "p 3"]
    material: Int[np.ndarray, " p"]  # row in the house's MaterialTable


@dataclass(frozen=True)
class RoomTable:
    """Rooms in file order."""

    type: Int[np.ndarray, " r"]  # first known label, index into ROOM_TYPES; -1 unknown
    level: Int[np.ndarray, " r"]
    polygon: tuple[Float[np.ndarray, "_ 2"], ...]  # [m], floor outline in x and y
    floor: Float[np.ndarray, " r"]  # [m], height of the floor's top
    ceiling: Float[np.ndarray, " r"]  # [m], height of the ceiling's underside
    labels: Int[np.ndarray, " r"]  # all labels as a bit mask, see `categories.room_labels`; 0 unknown


class PortalKind(NamedIntEnum):
    """Kinds of connection between two rooms."""

    OPENING = 0
    DOOR = 1
    STAIRS = 2


@dataclass(frozen=True)
class Portals:
    """Connections between rooms."""

    room: Int[np.ndarray, "p 2"]  # room indices, the lower first; -1 outdoors
    pos: Float[np.ndarray, "p 3"]  # [m], middle, on the floor
    width: Float[np.ndarray, " p"]  # [m], clear width for an agent's axis with the leaves open; 0: impassable
    kind: Int[np.ndarray, " p"]  # PortalKind
    leaf: Int[np.ndarray, "p 2"]  # rows of Doors: leaves that close it; -1 none


FIELD_UNIT = 0.0025  # [m], unit of stored geodesic distances
FIELD_UNREACHABLE = 65535  # stored distance where there is no path
# [m], maximum distance between surfaces that share a mirror plane, as of slightly oblique walls; so far from its plane
# rays may hit a reflecting surface.
MAX_MIRROR_DISTANCE = 0.06
MAX_DEPTH_BELOW_FLOOR = 0.3  # [m], maximum depth below a level's lowest floor of points assigned to that level


@dataclass(frozen=True)
class ExtrapolatedCells:
    """Reachable cells outside the home region: cells close to walls, and cells occupied by movable objects.

    Their numbers follow those of the home cells.
    """

    num_free: int  # number of leading cells that are free as authored, with less clearance than the home region
    coords: Int[np.ndarray, "e 3"]  # grid, row and column
    height: Float[np.ndarray, " e"]  # [m], of the floor or ramp
    field: UInt16[np.ndarray, "e g"]  # [FIELD_UNIT], extrapolated distances to the goals; see `navigation.extrapolated`
    nearest_cell: Int[np.ndarray, "l ny nx"]  # number of each cell, or of the nearest numbered cell


@dataclass(frozen=True)
class HouseNavigation:
    """Walkable grids, one per level that has rooms, the lowest first; row = y, column = x.

    Region 0 is the home region: the connected region with the largest area on the ground floor, including levels that
    agents reach by stairs. Its cells are numbered in the order of the grids. It contains ramps: the part of a ramp
    that is more than `MAX_DEPTH_BELOW_FLOOR` below the upper level is in the lower level's grid. Starts and goals are
    on floors.
    """

    origin: Float[np.ndarray, " 2"]  # [m], corner of cell (0, 0) of every grid
    cell: float  # [m]
    agent_radius: float  # [m], radius of the agents that fit into `region`
    agent_height: float  # [m]
    level: Int[np.ndarray, " l"]  # level index of each grid
    floor: Float[np.ndarray, " l"]  # [m], lowest floor of each level
    region: Int[np.ndarray, "l ny nx"]  # connected region of the agent's axis, by area; -1 none
    region_area: Float[np.ndarray, " n"]  # [m^2]
    room: Int[np.ndarray, "l ny nx"]  # room index; -1 outside
    height: Float[np.ndarray, " c"]  # [m], height of the floor or ramp under each home cell
    start: Float[np.ndarray, "s 3"]  # [m], sampled points of the home region, on the floor
    goal: Float[np.ndarray, "g 3"]
    field: UInt16[np.ndarray, "c g"]  # [FIELD_UNIT], geodesic distance of home cells to goals; FIELD_UNREACHABLE
    extrapolated: ExtrapolatedCells
    portals: Portals
    room_hops: Int[np.ndarray, "r r"]  # minimum number of portals between two rooms; -1 unreachable

    @property
    def home_mask(self) -> Bool[np.ndarray, "l ny nx"]:
        """Mask of the home region, by grid, row and column."""
        return self.region == 0

    @property
    def cell_coords(self) -> Int[np.ndarray, "c 3"]:
        """Grid, row and column of each home cell, in the order of its number: grid by grid, row by row."""
        return np.argwhere(self.home_mask)

    def distance(self, goal: int) -> Float[np.ndarray, "l ny nx"]:
        """Return home cells' distances to row `goal` of `self.goal` [m]; inf if unreachable, and in all other cells."""
        field = np.full(self.region.shape, np.inf)
        stored = self.field[:, goal]
        field[self.home_mask] = np.where(stored == FIELD_UNREACHABLE, np.inf, stored * FIELD_UNIT)
        return field


@dataclass(frozen=True)
class CompiledHouse:
    """A compiled house, the input of all engines."""

    id: str
    offset: Float[np.ndarray, " 3"]  # [m], added to file coordinates (after Z up) to get the world frame
    box: Float[np.ndarray, "2 3"]  # [m], minimum and maximum corner
    instances: Instances
    top_bvh: BVH  # over static instances
    materials: MaterialTable
    semantics: Int[np.ndarray, "q columns"]  # columns: Semantic
    colliders: Colliders
    exposed_edges: Int[np.ndarray, " c"]  # per collider: bit i is row i of `geometry.diffraction_edges.edge_rows`
    bodies: Bodies
    planes: Planes
    rooms: RoomTable
    navigation: HouseNavigation
    models: Mapping[str, Model]
    ground_floor: float  # [m], top of the lowest level that has rooms
    lot: Float[np.ndarray, "2 2"]  # [m], minimum and maximum x and y of the area that the fence encloses
    agent_materials: MaterialTable  # one row per material slot of the agent's model
    report: Mapping[str, int]  # counts: levels, rooms, objects, parts, triangles, ...
    doors: Doors = field(default_factory=Doors.empty)
    ramps: Ramps = field(default_factory=Ramps.empty)
    lights: LightTable = field(default_factory=LightTable.empty)
    gloss: Gloss = field(default_factory=lambda: Gloss.matt(0))  # of the first rows of `materials`; the others are matt
    # Ids of objects that would be movable if they did not intersect other geometry.
    blocked_objects: Int[np.ndarray, " n"] = field(default_factory=lambda: np.zeros(0, np.int32))
    compartments: Compartments = field(default_factory=Compartments.empty)


TextureArray = UInt8[np.ndarray, "l p 4"]  # layers, texels of all mip levels
