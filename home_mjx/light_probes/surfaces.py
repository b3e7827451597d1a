"""Surfaces that rays hit: position, normal, room and reflectance."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.light_probes.emitters import mean_colors
from home_mjx.light_probes.lattice import ProbeLattice, is_facade
from home_mjx.light_probes.ray_scene import Hits
from home_mjx.schema.compiled import MAX_DEPTH_BELOW_FLOOR, CompiledHouse
from home_mjx.schema.semantic import Semantic

PROBE_OFFSET = 0.05  # [m], distance above a surface at which probes are interpolated; as of `shaders.probes`
VIEW_OFFSET = 0.25  # [m], distance towards the viewer at which surfaces without a room look for one, as in doorways


class SurfacePoints(NamedTuple):
    """Points of surfaces at hits of rays; rows of misses are arbitrary."""

    seen: Bool[np.ndarray, " n"]  # False on a miss
    pos: Float[np.ndarray, "n 3"]
    normal: Float[np.ndarray, "n 3"]  # unit, facing the ray
    room: Int[np.ndarray, " n"]  # whose probes light it; -1 outdoors
    albedo: Float[np.ndarray, "n 3"]


@dataclass(frozen=True)
class SurfaceTables:
    """Tables of one house, on the host.

    Attributes:
        house: The compiled house.
        triangle: Corners of the bank's triangles in their models' frames [m].
        slot: Their material slots.
        part: Their semantic parts.
        material: First material row of each instance.
        semantic: First row in `rooms` of each instance.
        rooms: Room of each semantic row; -1 none.
        color: Reflectance of each material row.
    """

    house: CompiledHouse
    triangle: Float[np.ndarray, "t 3 3"]
    slot: Int[np.ndarray, " t"]
    part: Int[np.ndarray, " t"]
    material: Int[np.ndarray, " i"]
    semantic: Int[np.ndarray, " i"]
    rooms: Int[np.ndarray, " q"]
    color: Float[np.ndarray, "r 3"]

    @classmethod
    def from_bank(cls, bank: HouseBank, house: CompiledHouse) -> "SurfaceTables":
        """Return the tables of a house of a bank."""
        geometry, instances = bank.geometry, house.instances
        triangle, slot, part = (
            np.asarray(x) for x in (geometry.triangle, geometry.triangle_slot, geometry.triangle_part)
        )
        rooms = house.semantics[:, Semantic.ROOM]
        first = instances.material, instances.semantic
        return cls(house, triangle, slot, part, *first, rooms, mean_colors(house))

    def points(
        self, lattice: ProbeLattice, origin: Float[np.ndarray, "n 3"], way: Float[np.ndarray, "n 3"], hits: Hits
    ) -> SurfacePoints:
        """Return the points that rays hit."""
        seen = hits.instance >= 0
        instance, triangle = np.where(seen, hits.instance, 0), np.where(seen, hits.triangle, 0)
        corners = self.triangle[triangle]
        edges = np.stack([corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]], axis=1)
        one, two = np.moveaxis(np.einsum("nij,nkj->nki", self.house.instances.pose[instance, :, :3], edges), 1, 0)
        normal = np.cross(one, two)
        normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-20)
        normal *= np.where(np.einsum("ij,ij->i", normal, way) > 0, -1, 1)[:, None]
        pos = origin + way * np.where(seen, hits.t, 0)[:, None]
        room = self._rooms(lattice, pos, normal, pos - way * VIEW_OFFSET, instance, triangle)
        return SurfacePoints(seen, pos, normal, room, self.color[self.material[instance] + self.slot[triangle]])

    def _rooms(
        self,
        lattice: ProbeLattice,
        pos: np.ndarray,
        normal: np.ndarray,
        ahead: np.ndarray,
        instance: np.ndarray,
        triangle: np.ndarray,
    ) -> Int[np.ndarray, " n"]:
        """Return the room whose probes light each point: its surface's, else that of `ahead`; -1 outdoors."""
        room = self.rooms[self.semantic[instance] + self.part[triangle]]
        room = np.where(room >= 0, room, find_rooms(self.house, ahead))
        return np.where(is_facade(lattice, pos, normal, room), -1, room)


def find_rooms(house: CompiledHouse, pos: Float[np.ndarray, "n 3"]) -> Int[np.ndarray, " n"]:
    """Return the room of the navigation grids at points; -1 outside of rooms."""
    grid, navigation = house.navigation.room, house.navigation
    level = (pos[:, 2:] > navigation.floor - MAX_DEPTH_BELOW_FLOOR).sum(axis=1) - 1
    column, row = np.floor((pos[:, :2] - navigation.origin) / navigation.cell).astype(int).T
    inside = (level >= 0) & (row >= 0) & (column >= 0) & (row < grid.shape[1]) & (column < grid.shape[2])
    return np.where(inside, grid[tuple(np.where(inside, x, 0) for x in (level, row, column))], -1)
