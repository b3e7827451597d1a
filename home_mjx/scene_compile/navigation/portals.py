"""Where rooms meet: doors, openings without one, and stairs; and which room leads to which."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components, shortest_path
from scipy.spatial import KDTree

from home_mjx.scene_compile.geometry.polygons import inside_polygon, smallest_room
from home_mjx.scene_compile.navigation.geodesic import Link
from home_mjx.schema.compiled import PortalKind, Portals, Rooms

BESIDE = 0.35  # [m] from the middle of a doorway: there a room begins on either side

Row = tuple[tuple[int, int], tuple[float, float, float], float, PortalKind]  # as the fields of Portals


def find_portals(
    rooms: Rooms,
    room: Int[np.ndarray, "l ny nx"],
    standable: Bool[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
    doorways: Sequence[Sequence[Float[np.ndarray, "4 2"]]],
    links: Sequence[Link] = (),
) -> Portals:
    """Portals of all levels.

    Args:
        rooms: Outlines and floors.
        room: Room of each cell; -1 none.
        standable: Where an agent's axis may be.
        centres: x and y of the cells [m].
        doorways: Footprints of the doors of each level [m].
        links: Stairs.
    """
    rows: list[Row] = []
    for grid, footprints in enumerate(doorways):
        found = _crossings(rooms, room[grid], standable[grid], centres)
        rows += [_named(row, footprints) for row in found]
        met = [f for f in footprints if any(_inside(f, row[1]) for row in found)]
        rows += _closed(rooms, [f for f in footprints if not any(f is m for m in met)], room[grid])
    rows += [_stairs(rooms, room, centres, link) for link in links]
    if not rows:
        return Portals(np.zeros((0, 2), np.int32), np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.int32))
    pairs, points, widths, kinds = zip(*rows, strict=True)
    return Portals(np.sort(np.array(pairs, np.int32)), np.array(points), np.array(widths), np.array(kinds, np.int32))


def _crossings(
    rooms: Rooms,
    room: Int[np.ndarray, "ny nx"],
    standable: Bool[np.ndarray, "ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
) -> list[Row]:
    """One row per place where an agent can step from one room into another."""
    x, y = np.meshgrid(*centres)
    inside = np.where(standable, room, -1)
    pairs, points = [], []
    for here, there in (np.s_[:-1], np.s_[1:]), (np.s_[:, :-1], np.s_[:, 1:]):
        a, b = inside[here], inside[there]
        step = (a >= 0) & (b >= 0) & (a != b)
        pairs.append(np.sort(np.stack([a[step], b[step]], axis=-1)))
        points.append(np.stack([(v[here] + v[there])[step] / 2 for v in (x, y)], axis=-1))
    pair, point = np.concatenate(pairs), np.concatenate(points)
    cell = float(centres[0][1] - centres[0][0]) if len(centres[0]) > 1 else 1.0
    rows: list[Row] = []
    for a, b in np.unique(pair, axis=0).tolist():
        for cluster in _clusters(point[(pair == (a, b)).all(axis=1)], 1.5 * cell):
            x0, y0 = cluster.mean(axis=0).tolist()
            width = float(np.hypot(*np.ptp(cluster, axis=0))) + cell
            rows.append(((a, b), (x0, y0, float(rooms.floor[[a, b]].max())), width, PortalKind.OPENING))
    return rows


def _clusters(points: Float[np.ndarray, "n 2"], reach: float) -> list[Float[np.ndarray, "_ 2"]]:
    pairs = KDTree(points).query_pairs(reach, output_type="ndarray")
    near = coo_matrix((np.ones(len(pairs)), pairs.T), shape=(len(points),) * 2)
    count, label = connected_components(near, directed=False)
    return [points[label == i] for i in range(count)]


def _inside(footprint: Float[np.ndarray, "4 2"], pos: tuple[float, float, float]) -> bool:
    return bool(inside_polygon(footprint, np.array(pos[:2])))


def _named(row: Row, footprints: Sequence[Float[np.ndarray, "4 2"]]) -> Row:
    """The row as a door if it lies in a doorway."""
    door = any(_inside(f, row[1]) for f in footprints)
    return (*row[:3], PortalKind.DOOR) if door else row


def _closed(rooms: Rooms, footprints: Sequence[Float[np.ndarray, "4 2"]], room: Int[np.ndarray, "ny nx"]) -> list[Row]:
    """Doors that agents cannot pass: shut, blocked or to the outside."""
    here = np.unique(room[room >= 0])
    rows: list[Row] = []
    for corners in footprints:
        along, across = corners[1] - corners[0], corners[3] - corners[0]
        normal = across / np.linalg.norm(across)
        middle = corners[0] + (along + across) / 2
        a, b = smallest_room(rooms, here, middle + normal * np.array([[-BESIDE], [BESIDE]])).tolist()
        if a != b:
            at = (float(middle[0]), float(middle[1]), float(rooms.floor[max(a, b)]))
            rows.append(((a, b), at, 0.0, PortalKind.DOOR))
    return rows


def _stairs(
    rooms: Rooms,
    room: Int[np.ndarray, "l ny nx"],
    centres: tuple[Float[np.ndarray, " nx"], Float[np.ndarray, " ny"]],
    link: Link,
) -> Row:
    a, b = int(room[link.start]), int(room[link.end])
    _, row, column = link.start
    at = (float(centres[0][column]), float(centres[1][row]), float(rooms.floor[a]))
    return (a, b), at, float(centres[0][1] - centres[0][0]), PortalKind.STAIRS


def room_hops(portals: Portals, num_rooms: int) -> Int[np.ndarray, "r r"]:
    """Least number of portals on the way from room to room; -1 where there is none.

    Args:
        portals: Those that agents can pass count.
        num_rooms: Number of rooms.
    """
    passed = portals.room[(portals.width > 0) & (portals.room[:, 0] >= 0)]
    graph = coo_matrix((np.ones(len(passed)), passed.T), shape=(num_rooms, num_rooms))
    hops = shortest_path(graph.tocsr(), directed=False, unweighted=True)
    return np.where(np.isfinite(hops), hops, -1).astype(np.int16)
