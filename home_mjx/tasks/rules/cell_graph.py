"""Geodesic distance fields from all cells of a house to the targets of descriptors (NumPy, host only)."""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool, Float, Int, UInt16
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import connected_components, dijkstra
from scipy.spatial import KDTree

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.extrapolation import extrapolate_fields
from home_mjx.geometry.geodesic import MAX_RISE, grid_edges, has_clear_diagonals, is_walkable_rise
from home_mjx.navigation.grid import MAX_SHARED_GAP
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.schema.compiled import FIELD_UNIT, FIELD_UNREACHABLE, MAX_DEPTH_BELOW_FLOOR

MAX_BESIDE_DISTANCE = 0.3  # [m] maximum distance beyond the nearest cell of cells whose floor an object stands on
MAX_HEIGHT_ON_STOREY = 2.5  # [m] maximum height above a floor that belongs to its storey
BRUSH_COST_FACTOR = 4.0  # path cost factor where an agent brushes the leaf of an open door, which may close it
PUSH_COST_FACTOR = BRUSH_COST_FACTOR**2  # path cost factor where an agent walks into the leaf, which closes it
MIN_LEAF_CLEARANCE = 0.15  # [m] minimum clearance to a leaf that is not brushed
MAX_TURN_DISTANCE = 0.4  # [m] maximum distance to a cell in which the carried object has room to turn
MIN_EDGE_LENGTH = 1e-6  # [m] minimum edge length: sparse matrices drop edges of length 0

# End cells of the paths to a goal, and the remaining distance from each to the goal [m].
EndCells = tuple[Int[np.ndarray, "_"], Float[np.ndarray, "_"]]


class CellGraph:
    """Graph of the cells in a house's home region.

    Args:
        bank: The houses.
        house: Index of the house.
        brush_cost_factor: Cost factor of edges on which an agent would brush the leaf of an open door. The square of it
            applies where the agent would walk into the leaf.

    Attributes:
        place: Centre of each home cell, on the floor [m].
        room: Room of each home cell; -1 if none.
        at_leaf: Home cells in which an agent touches the leaf of an open door, or which such a leaf cuts off.
        cut_off: Home cells whose every path to most of the house pushes a leaf, which may close the door for good.
            Neither starts nor goals are placed there.
    """

    def __init__(self, bank: HouseBank, house: int, brush_cost_factor: float = BRUSH_COST_FACTOR) -> None:
        navigation, self._cell = bank.navigation, bank.spec.cell
        number = np.asarray(navigation.cell[house])
        first, home, free = (
            int(x[house]) for x in (navigation.first_cell, navigation.num_cells, navigation.num_free_cells)
        )
        rank = np.where(number < 0, 3, (number >= first + home).astype(int) + (number >= first + free))
        self._number, self._rank, self._home = number - first, rank, rank == 0
        self._standable = np.asarray(navigation.region[house]) >= 0
        self._rooms = np.asarray(navigation.room[house])
        self._height = np.zeros(number.shape)
        self._height[number >= 0] = np.asarray(navigation.height)[number[number >= 0]]
        plan = (np.argwhere(self._home)[:, :0:-1] + 0.5) * self._cell + np.asarray(navigation.origin[house])
        self.place = np.concatenate([plan, self._height[self._home][:, None]], axis=1)
        self.room = self._rooms[self._home]
        self._is_at_feet = self._feet_cells(np.asarray(navigation.floor[house]))[self._home]
        passable = rank <= int(has_clear_diagonals(self._cell, bank.spec.agent_radius))
        edges = [grid_edges(self._home, self._height, self._cell, passable), *self._ramp_edges()]
        sources, targets, lengths = (np.concatenate(parts) for parts in zip(*edges, strict=True))
        gap, radius = self._leaf_gaps(bank, house), bank.spec.agent_radius
        beside = gap < radius + MIN_LEAF_CLEARANCE
        slow = np.where(gap < radius, brush_cost_factor**2, np.where(beside, brush_cost_factor, 1.0))
        self.cut_off = _is_cut_off(gap < radius, sources, targets)
        self.at_leaf = beside | self.cut_off
        self._edges = sources, targets, np.maximum(slow[sources], slow[targets]) * lengths

    def _leaf_gaps(self, bank: HouseBank, house: int) -> Float[np.ndarray, " c"]:
        """Return plan distances of home cells to the nearest leaf at an agent's height, doors open [m]; inf if none."""
        leaves = jax.tree.map(lambda x: x[house], DoorLeaves.from_physics(jax.tree.map(jnp.asarray, bank.physics)))
        angle = jnp.asarray(bank.fronts.open_doors(bank.physics, house))
        pos, quat = (np.asarray(x) for x in leaves.pose_at(angle))
        found, tall = np.full(len(self.place), np.inf), bank.spec.agent_height
        for middle, (w, _, _, z), half in zip(pos, quat, np.asarray(leaves.size), strict=True):
            away, yaw = self.place - middle, 2 * np.arctan2(z, w)
            along, across = away[:, :2] @ [np.cos(yaw), np.sin(yaw)], away[:, :2] @ [-np.sin(yaw), np.cos(yaw)]
            gap = np.hypot(np.maximum(abs(along) - half[0], 0), np.maximum(abs(across) - half[1], 0))
            as_high = (away[:, 2] < half[2]) & (away[:, 2] > -half[2] - tall)
            found = np.minimum(found, np.where((half[0] > 0) & as_high, gap, np.inf))
        return found

    def compute_fields(self, ends: Sequence[EndCells]) -> UInt16[np.ndarray, "c g"]:
        """Compute path lengths from all cells of the house to goals, in units of `FIELD_UNIT`, by cell number.

        They are those of `compute_distances`, rounded, and extrapolated to reachable cells outside the home region. Too
        long ones are clipped to `FIELD_UNREACHABLE` - 1; it is `FIELD_UNREACHABLE` where no path leads.
        """
        home = self.compute_distances(ends)
        parts = [(np.argwhere(self._home), home)]
        around = [self._rank <= rank for rank in (1, 2)]
        parts += extrapolate_fields(self._home, around, self._standable, self._rooms, self._height, home, self._cell)
        place, distance = (np.concatenate(part) for part in zip(*parts, strict=True))
        whole = np.full((int(self._number.max()) + 1, len(ends)), np.inf)
        whole[self._number[tuple(place.T)]] = distance
        units = np.minimum(np.round(np.where(np.isfinite(whole), whole, 0) / FIELD_UNIT), FIELD_UNREACHABLE - 1)
        return np.where(np.isfinite(whole), units, FIELD_UNREACHABLE).astype(np.uint16)

    def compute_distances(self, ends: Sequence[EndCells]) -> Float[np.ndarray, "c g"]:
        """Compute the path length from each home cell to each goal, given by its end cells [m]; inf if unreachable.

        Steps beside the leaf of an open door count `brush_cost_factor` times, in contact with it the square of that.
        """
        cells, goals = len(self.place), len(ends)
        graph = self._graph_with_goals(ends)
        return dijkstra(graph, indices=np.arange(cells, cells + goals)).T[:cells]

    def shortest_path(self, feet: Float[np.ndarray, " 3"], ends: EndCells) -> Float[np.ndarray, "n 3"]:
        """Return the centres of cells on the shortest path to a goal's end cells; (0, 3) if there is none.

        They are points on the floor [m]. The first one is that of the home cell nearest to `feet` [m].
        """
        cells = len(self.place)
        _, previous = dijkstra(self._graph_with_goals([ends]), indices=cells, return_predecessors=True)
        path = [int(self.nearest_cell(feet)[0][0])]
        while 0 <= previous[path[-1]] < cells:
            path.append(int(previous[path[-1]]))
        return self.place[path] if previous[path[-1]] == cells else np.zeros((0, 3))

    def _graph_with_goals(self, ends: Sequence[EndCells]) -> csr_matrix:
        """Return the matrix of edge lengths [m] between home cells, and from each goal, an extra node, to end cells.

        Edges never lead back to a goal, so that no path passes through one.
        """
        cells, (sources, targets, lengths) = len(self.place), self._edges
        begins = np.concatenate([sources, targets, *[np.full(len(n), cells + g) for g, (n, _) in enumerate(ends)]])
        stops = np.concatenate([targets, sources, *[number for number, _ in ends]])
        ways = np.concatenate([lengths, lengths, *[np.maximum(way, MIN_EDGE_LENGTH) for _, way in ends]])
        return csr_matrix((ways, (begins, stops)), shape=(cells + len(ends),) * 2)

    def nearest_cells(self, low: Float[np.ndarray, " 3"], high: Float[np.ndarray, " 3"], most: int) -> EndCells:
        """Return the home cells (indices) nearest in plan to a box on its storey, and plan distances [m], ascending.

        They are at most `most`, on floors not above the box's top, and less than `MAX_HEIGHT_ON_STOREY` below its
        bottom. Cells at the leaf of an open door are excluded: an agent may push the leaf, which then hides the object
        behind it.
        """
        here = (self.place[:, 2] <= high[2]) & (self.place[:, 2] > low[2] - MAX_HEIGHT_ON_STOREY)
        storey = np.flatnonzero(here & ~self.at_leaf)
        away = _plan_gaps(self.place[storey], low, high)
        order = np.argsort(away, kind="stable")[:most]
        return storey[order], away[order]

    def floor_beside(self, low: Float[np.ndarray, " 3"], high: Float[np.ndarray, " 3"]) -> float:
        """Return the height of the floor or ramp beside a box, below its top [m]; -inf if there is none.

        Of the cells up to `MAX_BESIDE_DISTANCE` farther in plan than the nearest it is the one nearest in height to the
        bottom of the box: objects upstairs are not measured from downstairs. Cells more than `MAX_RISE` above the
        bottom count only if there is no other.
        """
        below = self.place[self.place[:, 2] < high[2]]
        away = _plan_gaps(below, low, high)
        near = away <= away.min(initial=np.inf) + MAX_BESIDE_DISTANCE
        rise = below[near, 2] - low[2]
        return float(below[near, 2][np.argmin(np.where(rise > MAX_RISE, np.inf, abs(rise)))]) if near.any() else -np.inf

    def cells_in_rooms(self, rooms: Bool[np.ndarray, " r"]) -> EndCells:
        """Return the home cells (indices) in a mask of rooms, at distance 0, without those that are cut off.

        Of two levels' cells at one place on a ramp only that of `cell_at_feet` counts: feet there are in its room.
        """
        inside = (self.room >= 0) & rooms[np.maximum(self.room, 0)]
        cells = np.flatnonzero(inside & self._is_at_feet & ~self.cut_off)
        return cells, np.zeros(len(cells))

    def nearest_cell(self, place: Float[np.ndarray, " 3"]) -> EndCells:
        """Return the home cell (index) nearest to a point, in 3D, and its plan distance [m]."""
        nearest = np.argmin(np.linalg.norm(self.place - place, axis=1))
        return np.array([nearest]), np.linalg.norm(self.place[[nearest], :2] - place[:2], axis=1)

    def has_turning_room(self, cells: Int[np.ndarray, " n"], wide: Bool[np.ndarray, " c"]) -> Bool[np.ndarray, " n"]:
        """Return which `cells` are within `MAX_TURN_DISTANCE` of the largest connected set in the mask `wide`."""
        out = self.place[~_is_cut_off(~wide, *self._edges[:2])]
        if not len(out):
            return np.zeros(len(cells), bool)
        return KDTree(out).query(self.place[cells])[0] <= MAX_TURN_DISTANCE

    def _feet_cells(self, floor: Float[np.ndarray, " levels"]) -> Bool[np.ndarray, "levels rows columns"]:
        """Return the home cells that `cell_at_feet` returns for feet at their centres, from the floor heights [m]."""
        number = np.arange(len(floor))[:, None, None]
        is_one_place = self._home & (np.abs(self._height - self._height[:, None]) <= MAX_SHARED_GAP)
        is_above = self._height[:, None] >= floor[:, None, None] - MAX_DEPTH_BELOW_FLOOR
        rank = np.where(is_above, len(floor) + number, len(floor) - 1 - number)
        return self._home & (np.where(is_one_place, rank, -1).argmax(axis=1) == number)

    def _ramp_edges(self) -> list[tuple[np.ndarray, ...]]:
        """Return (sources, targets, lengths [m]) of edges from tops of ramps, on the lower level, to upper floors."""
        number = np.where(self._home, np.cumsum(self._home).reshape(self._home.shape) - 1, -1)
        ways = []
        for level in range(len(number) - 1):
            for shift in ((0, 1), (0, -1), (1, 0), (-1, 0)):
                beyond, above = (np.roll(x[level + 1], shift, (0, 1)) for x in (number, self._height))
                rise = np.abs(above - self._height[level])
                joined = self._home[level] & (beyond >= 0) & is_walkable_rise(rise, self._cell)
                ways.append((number[level][joined], beyond[joined], np.hypot(self._cell, rise[joined])))
        return ways


def _plan_gaps(
    places: Float[np.ndarray, "n 3"], low: Float[np.ndarray, " 3"], high: Float[np.ndarray, " 3"]
) -> Float[np.ndarray, " n"]:
    """Return the distances in plan from points to a box [m]; 0 above or below it."""
    gap = np.maximum(low[:2] - places[:, :2], 0) + np.maximum(places[:, :2] - high[:2], 0)
    return np.hypot(*gap.T)


def _is_cut_off(
    blocked: Bool[np.ndarray, " c"], sources: Int[np.ndarray, " e"], targets: Int[np.ndarray, " e"]
) -> Bool[np.ndarray, " c"]:
    """Return which cells are blocked, or outside the largest connected set of unblocked cells; edges are undirected."""
    free = ~blocked[sources] & ~blocked[targets]
    count = len(blocked)
    joined = csr_matrix((np.ones(free.sum()), (sources[free], targets[free])), shape=(count, count))
    part = connected_components(joined, directed=False)[1]
    sizes = np.bincount(part, weights=~blocked, minlength=1)
    return blocked | (part != sizes.argmax())
