"""Portals between rooms: doors, openings and stairs; and the number of portals between rooms."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, shortest_path
from scipy.spatial import KDTree

from home_mjx.geometry.geodesic import is_walkable_rise
from home_mjx.geometry.polygons import is_inside_polygon
from home_mjx.scene_compile.objects.doorways import Doorway
from home_mjx.scene_compile.objects.stairs import Staircase
from home_mjx.schema.compiled import PortalKind, Portals, RoomTable

NO_LEAF = (-1, -1)

# The fields of Portals.
Row = tuple[tuple[int, int], tuple[float, float, float], float, PortalKind, tuple[int, int]]


def find_portals(
    rooms: RoomTable,
    room: Int[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, "l ny nx"],
    height: Float[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
    doorways: Sequence[Sequence[Doorway]],
    stairs: Sequence[tuple[Staircase, float]] = (),
) -> Portals:
    """Find the portals of all levels: openings, doors (width 0 if agents cannot pass), and stairs.

    Rows are by level, then stairs. Pairs of rooms are ascending; the outdoors is room -1.

    Args:
        rooms: Outlines and floors.
        room: Room of each cell; -1 if none.
        standable: Cells where agents can stand.
        height: Height of the cells [m].
        centres: x and y of the cells [m].
        doorways: Doorways of each level.
        stairs: Stairs of the house, each with the width that an agent's axis can cross [m]; 0 if none.
    """
    rows: list[Row] = []
    for grid, doors in enumerate(doorways):
        found = _crossings(rooms, room[grid], standable[grid], height[grid], centres)
        rows += [_match_door(row, doors) for row in found]
        rows += _closed_doors(rooms, [door for door in doors if not any(_inside(door, row) for row in found)])
    rows += [_stairs(*one) for one in stairs]
    if not rows:
        pair = np.zeros((0, 2), np.int32)
        return Portals(pair, np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int32), pair)
    pairs, points, widths, kinds, leaves = zip(*rows, strict=True)
    pairs, kinds, leaves = (np.array(column, np.int32) for column in (pairs, kinds, leaves))
    return Portals(np.sort(pairs), np.array(points), np.array(widths), kinds, leaves)


def _crossings(
    rooms: RoomTable,
    room: Int[np.ndarray, "ny nx"],
    standable: Bool[np.ndarray, "ny nx"],
    height: Float[np.ndarray, "ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[Row]:
    """Return one opening per place where an agent can step from a cell of one room into a cell of another.

    Its point is the mean of the cells' common edges there, on the higher floor. Its width is the extent of their
    middles, plus one cell.
    """
    x, y = np.meshgrid(*centres)
    inside = np.where(standable, room, -1)
    cell = float(centres[0][1] - centres[0][0]) if len(centres[0]) > 1 else 1.0
    pairs, points = [], []
    for here, there in (np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:]):
        a, b = inside[here], inside[there]
        step = (a >= 0) & (b >= 0) & (a != b) & is_walkable_rise(height[here] - height[there], cell)
        pairs.append(np.sort(np.stack([a[step], b[step]], axis=-1)))
        points.append(np.stack([(v[here] + v[there])[step] / 2 for v in (x, y)], axis=-1))
    pair, point = np.concatenate(pairs), np.concatenate(points)
    rows: list[Row] = []
    for a, b in np.unique(pair, axis=0).tolist():
        for cluster in _clusters(point[(pair == (a, b)).all(axis=1)], 1.5 * cell):
            x0, y0 = cluster.mean(axis=0).tolist()
            width = float(np.hypot(*np.ptp(cluster, axis=0))) + cell
            rows.append(((a, b), (x0, y0, float(rooms.floor[[a, b]].max())), width, PortalKind.OPENING, NO_LEAF))
    return rows


def _clusters(points: Float[np.ndarray, "n 2"], reach: float) -> list[Float[np.ndarray, "_ 2"]]:
    """Return the connected components of points, where those up to `reach` [m] apart are connected."""
    pairs = KDTree(points).query_pairs(reach, output_type="ndarray")
    near = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    count, label = connected_components(near, directed=False)
    return [points[label == i] for i in range(count)]


def _inside(door: Doorway, row: Row) -> bool:
    """Return whether the point of a row is in a door's footprint."""
    return bool(is_inside_polygon(door.footprint, np.array(row[1][:2])))


def _match_door(row: Row, doors: Sequence[Doorway]) -> Row:
    """Return the row as a door if its point is inside the footprint of one of `doors`, else unchanged."""
    door = next((door for door in doors if _inside(door, row)), None)
    return row if door is None else (*row[:3], PortalKind.DOOR, door.leaf)


def _closed_doors(rooms: RoomTable, doors: Sequence[Doorway]) -> list[Row]:
    """Return rows of width 0 for those (impassable) doors that are between different rooms or lead outside.

    Doors without a room on either side have none. The height is the floor of the room of higher index.
    """
    rows: list[Row] = []
    for door in doors:
        a, b = door.room
        if a != b:
            x, y = door.footprint.mean(axis=0).tolist()
            rows.append(((a, b), (x, y, float(rooms.floor[max(a, b)])), 0.0, PortalKind.DOOR, door.leaf))
    return rows


def _stairs(stairs: Staircase, width: float) -> Row:
    """Return the portal of stairs, at the foot of the first slope."""
    x, y = stairs.slopes[0].foot.tolist()
    return stairs.room, (x, y, stairs.low), width, PortalKind.STAIRS, NO_LEAF


def room_hops(portals: Portals, num_rooms: int) -> Int[np.ndarray, "r r"]:
    """Return the minimum number of passable portals from room to room; 0 to itself, -1 if there is no way.

    Portals of width 0 or to the outdoors do not count.
    """
    passed = portals.room[(portals.width > 0) & (portals.room[:, 0] >= 0)]
    graph = coo_matrix((np.ones(len(passed)), passed.T), shape=(num_rooms, num_rooms))
    hops = shortest_path(graph.tocsr(), directed=False, unweighted=True)
    return np.where(np.isfinite(hops), hops, -1).astype(np.int16)
