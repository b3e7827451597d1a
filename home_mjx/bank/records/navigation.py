"""Navigation records of a bank."""

import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.bank.records.declaration import REPEAT_ROWS
from home_mjx.bank.records.owners import HouseOwner
from home_mjx.core.pytree import Pytree, array
from home_mjx.schema.categories import coarse_index
from home_mjx.schema.compiled import FIELD_UNREACHABLE
from home_mjx.schema.semantic import Semantic

SURFACE_KINDS = ("floor", "wall")  # columns of `NavigationArrays.room_surface`


def first_cell(at: HouseOwner) -> int:
    """Return the row of a house's first cell in the bank's `cell_coords` and `field`."""
    return at.start["cell"]


def num_cells(at: HouseOwner) -> int:
    """Count the cells of a house's home region."""
    return len(at.house.navigation.field)


def num_free_cells(at: HouseOwner) -> int:
    """Count all cells of a house's home region, plus those of its extrapolated cells that are free as authored."""
    return num_cells(at) + at.house.navigation.extrapolated.num_free


def cell_numbers(at: HouseOwner) -> Int[np.ndarray, "levels grid_rows grid_columns"]:
    """Return the row in the bank of each home or extrapolated cell; elsewhere, ~ that of the nearest such cell.

    In padding it is ~ the row of the nearest cell to the closest grid point of the house.
    """
    navigation = at.house.navigation
    nearest, own = navigation.extrapolated.nearest_cell, navigation.home_mask
    own[tuple(navigation.extrapolated.coords.T)] = True
    sizes = at.sizes["levels"], at.sizes["grid_rows"], at.sizes["grid_columns"]
    beyond = [(0, size - length) for size, length in zip(sizes, nearest.shape, strict=True)]
    number = at.start["cell"] + np.pad(nearest, beyond, mode="edge")
    return np.where(np.pad(own, beyond), number, ~number)


def cell_coords(at: HouseOwner) -> Int[np.ndarray, "c 3"]:
    """Return level, row, column of a house's numbered cells: those of the home region, then the extrapolated ones."""
    navigation = at.house.navigation
    return np.concatenate([navigation.cell_coords, navigation.extrapolated.coords])


def cell_heights(at: HouseOwner) -> Float[np.ndarray, " c"]:
    """Return the heights of the floor or ramp under a house's cells [m], in the order of `cell_coords`."""
    navigation = at.house.navigation
    return np.concatenate([navigation.height, navigation.extrapolated.height])


def goal_fields(at: HouseOwner) -> UInt16[np.ndarray, "c g"]:
    """Return geodesic distances [FIELD_UNIT] from home cells, then extrapolated ones, as `cell_coords`, to the goals.

    `FIELD_UNREACHABLE` stands for no path. Goals repeat in turn up to the bank's number; more are cut.
    """
    navigation = at.house.navigation
    field = np.concatenate([navigation.field, navigation.extrapolated.field])
    return field[:, np.arange(at.sizes["goals"]) % field.shape[1]]


def room_surfaces(at: HouseOwner) -> Int[np.ndarray, "r 2"]:
    """Return the rows in the bank's `semantics` of each room's floor and of its first wall; -1 if none."""
    rows = at.house.semantics
    rooms = np.arange(len(at.house.rooms.type))
    parts = rows[:, Semantic.OBJECT_ID] < 0
    found = [_first(parts & (rows[:, Semantic.COARSE] == coarse_index(kind)), rows, rooms) for kind in SURFACE_KINDS]
    return np.stack([np.where(row < 0, -1, row + at.start["semantic"]) for row in found], axis=-1)


def _first(
    among: Bool[np.ndarray, " q"], rows: Int[np.ndarray, "q columns"], rooms: Int[np.ndarray, " r"]
) -> Int[np.ndarray, " r"]:
    """Return for each room the index of its first semantic row in the mask `among`; -1 none."""
    fits = among & (rows[:, Semantic.ROOM] == rooms[:, None])
    return np.where(fits.any(axis=1), fits.argmax(axis=1), -1)


def portal_leaves(at: HouseOwner) -> Int[np.ndarray, "p 2"]:
    """Return the rows, along the house's own `doors` axis, of the leaves that close each portal; -1 none.

    Rows are those of `HouseOwner.door_row`.
    """
    row = np.append(at.door_row, -1)
    return row[at.house.navigation.portals.leaf]


class NavigationArrays(Pytree):
    """Grids of every house and level, starts, goals and portals; see `compiled.HouseNavigation`.

    Reachable cells are numbered through all houses. Within a house the order is: cells of the home region, cells that
    are free as authored but close to obstacles, cells occupied by movable objects.
    """

    origin: Float[Array, "h 2"] = array("[m], corner of cell (0, 0) of a house's grids", source="navigation.origin")
    floor: Float[Array, "h levels"] = array(
        "[m], floor of each level that has rooms, from below; inf padding", source="navigation.floor", fill=np.inf
    )
    first_cell: Int[Array, " h"] = array("row of a house's first cell in `cell_coords` and `field`", source=first_cell)
    num_cells: Int[Array, " h"] = array(
        "number of cells of the home region, the first cells of a house", source=num_cells
    )
    num_free_cells: Int[Array, " h"] = array(
        "number of those and of the following cells that are free as authored", source=num_free_cells
    )
    cell: Int[Array, "h levels grid_rows grid_columns"] = array(
        "row of `cell_coords` and `field`; if unreachable, ~ the row of the nearest reachable cell", source=cell_numbers
    )
    cell_coords: Int[Array, "cell 3"] = array("level, row and column", source=cell_coords, dtype=np.int16)
    height: Float[Array, " cell"] = array("[m], height of the floor or ramp", source=cell_heights)
    field: UInt16[Array, "cell goals"] = array(
        "[FIELD_UNIT], geodesic distance to each goal of the cell's house; FIELD_UNREACHABLE no path",
        source=goal_fields,
        fill=FIELD_UNREACHABLE,
    )
    region: Int[Array, "h levels grid_rows grid_columns"] = array(
        "0 home region, others by area; -1 not walkable",
        source="navigation.region",
        fill=-1,
        dtype=np.int16,
    )
    room: Int[Array, "h levels grid_rows grid_columns"] = array(
        "-1 outside", source="navigation.room", fill=-1, dtype=np.int16
    )
    room_type: Int[Array, "h rooms"] = array(
        "first label, index into ROOM_TYPES; -1 none", source="rooms.type", fill=-1
    )
    room_labels: Int[Array, "h rooms"] = array(
        "all labels as a bit mask: bit i stands for ROOM_TYPES[i]; 0 none", source="rooms.labels", fill=0
    )
    room_surface: Int[Array, "h rooms 2"] = array(
        "semantic rows of a room's floor and of its first wall, absolute; -1 none", source=room_surfaces, fill=-1
    )
    start: Float[Array, "h starts 3"] = array("[m], on the floor", source="navigation.start", fill=REPEAT_ROWS)
    goal: Float[Array, "h goals 3"] = array("[m], on the floor", source="navigation.goal", fill=REPEAT_ROWS)
    portal_room: Int[Array, "h portals 2"] = array(
        "-1 outdoors, and padding", source="navigation.portals.room", fill=-1
    )
    portal_pos: Float[Array, "h portals 3"] = array("[m]", source="navigation.portals.pos")
    portal_width: Float[Array, "h portals"] = array(
        "[m], clear width for agents; 0: impassable, and padding", source="navigation.portals.width"
    )
    portal_kind: Int[Array, "h portals"] = array(
        "compiled.PortalKind; -1 padding", source="navigation.portals.kind", fill=-1
    )
    portal_leaf: Int[Array, "h portals 2"] = array("door leaves that close it; -1 none", source=portal_leaves, fill=-1)
    room_hops: Int[Array, "h rooms rooms"] = array(
        "minimum number of portals between two rooms; -1 unreachable",
        source="navigation.room_hops",
        fill=-1,
        dtype=np.int16,
    )
