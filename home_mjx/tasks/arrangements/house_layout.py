"""Host-side description of one house for the placement of objects."""

from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial.transform import Rotation

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.boxes import BoxSet, penetration_depth
from home_mjx.schema.agent import AGENT_MARGIN
from home_mjx.schema.semantic import SUPPORTS, Semantic

MAX_MASS, MAX_SIZE = 10.0, 0.7  # [kg], [m], maximum mass and horizontal size of objects that are moved
MAX_SUPPORT_GAP = 0.03  # [m], maximum distance from the bottom of an object to the top of the one that supports it


@dataclass(frozen=True)
class HouseLayout:
    """A house with its k bodies at their initial poses, without the bank's padding.

    Attributes:
        static: Boxes of static colliders; tilted ones (ramps) are replaced by upright bounding boxes.
        bodies: Upright boxes of the bodies.
        is_selected: Whether each body is selected for a new pose: it is small and supports no others.
        on_furniture: Whether each body is on furniture; the others are on a floor.
        room: Room of each body; -1 none.
        door_sweeps: Position of the hinge of each leaf in the plan, the radius that the leaf sweeps, and the heights of
            its lower and upper edge [m].
        portals: Centres of portals [m].
        goals: Navigation goals [m].
        room_grid: Room of each cell; -1 none.
        home_region: Whether each cell is in the home region.
        floor: Height of the floor of each level [m].
        origin: Corner of cell (0, 0) [m].
        cell: Cell size [m].
        agent_clearance: Minimum distance of an agent's centre from objects, including `AGENT_MARGIN` [m].
    """

    static: BoxSet
    bodies: BoxSet
    is_selected: Bool[np.ndarray, " k"]
    on_furniture: Bool[np.ndarray, " k"]
    room: Int[np.ndarray, " k"]
    door_sweeps: Float[np.ndarray, "h 5"]
    portals: Float[np.ndarray, "p 3"]
    goals: Float[np.ndarray, "g 3"]
    room_grid: Int[np.ndarray, "l ny nx"]
    home_region: Bool[np.ndarray, "l ny nx"]
    floor: Float[np.ndarray, " l"]
    origin: Float[np.ndarray, "2"]
    cell: float
    agent_clearance: float

    @classmethod
    def from_bank(cls, bank: HouseBank, house: int) -> "HouseLayout":
        """Copy the house with index `house` of a bank to host arrays, without padding."""
        names = ("portal_pos", "portal_kind", "goal", "room", "region", "floor", "origin")
        arrays = bank.physics, {name: getattr(bank.navigation, name) for name in names}
        physics, navigation = jax.device_get(jax.tree.map(lambda x: x[house], arrays))
        used = physics.body_valid
        bodies = _boxes(physics.body_pos[used], physics.body_quat[used], physics.body_size[used])
        there = physics.collider_pos[:, 2] > -50  # padding is parked below
        row = np.asarray(bank.geometry.instance_semantic[house])[physics.body_instance[used]]
        rows = np.asarray(bank.semantics)[row]
        small = (physics.body_mass[used] <= MAX_MASS) & (2 * bodies.half[:, :2].max(axis=1, initial=0) <= MAX_SIZE)
        known = np.isin(rows[:, Semantic.SUPPORT], [SUPPORTS.index("floor"), SUPPORTS.index("object")])
        room = rows[:, Semantic.ROOM]
        return cls(
            static=_boxes(physics.collider_pos[there], physics.collider_quat[there], physics.collider_size[there]),
            bodies=bodies,
            is_selected=small & known & (room >= 0) & ~_is_support(bodies),
            on_furniture=rows[:, Semantic.SUPPORT] == SUPPORTS.index("object"),
            room=room,
            door_sweeps=_door_sweeps(physics),
            portals=navigation["portal_pos"][navigation["portal_kind"] >= 0],
            goals=navigation["goal"],
            room_grid=navigation["room"],
            home_region=navigation["region"] == 0,
            floor=navigation["floor"],
            origin=navigation["origin"].astype(float),
            cell=bank.spec.cell,
            agent_clearance=bank.spec.agent_radius + AGENT_MARGIN,
        )

    def room_at(self, points: Float[np.ndarray, "n 2"], level: int) -> Int[np.ndarray, " n"]:
        """Return the room index at points (x, y) [m] on a level; -1 outside the grid and in cells of no room."""
        column, row = np.floor((points - self.origin) / self.cell).astype(int).T
        rows, columns = self.room_grid.shape[1:]
        inside = (row >= 0) & (row < rows) & (column >= 0) & (column < columns)
        return np.where(inside, self.room_grid[level, row.clip(0, rows - 1), column.clip(0, columns - 1)], -1)

    def level_of(self, room: int) -> int:
        """Return the index of the lowest level with cells of a room (an index); 0 if there is none."""
        return int((self.room_grid == room).any(axis=(1, 2)).argmax())


def _boxes(pos: Float[np.ndarray, "n 3"], quat: Float[np.ndarray, "n 4"], half: Float[np.ndarray, "n 3"]) -> BoxSet:
    """Return upright boxes from poses and half extents [m]; a tilted box becomes its axis-aligned bounding box."""
    pos, quat, half = (np.asarray(x, float).reshape(-1, x.shape[-1]) for x in (pos, quat, half))
    leans = abs(quat[:, 1:3]).max(axis=1, initial=0) > 1e-4
    around = np.einsum("nij,nj->ni", abs(_matrices(quat)), half)
    half, yaw = np.where(leans[:, None], around, half), np.where(leans, 0, 2 * np.arctan2(quat[:, 3], quat[:, 0]))
    return BoxSet(pos, half, yaw)


def _matrices(quat: Float[np.ndarray, "n 4"]) -> Float[np.ndarray, "n 3 3"]:
    """Return the rotation matrices of quaternions (wxyz)."""
    return Rotation.from_quat(quat[:, [1, 2, 3, 0]]).as_matrix() if len(quat) else np.zeros((0, 3, 3))


def _is_support(bodies: BoxSet) -> Bool[np.ndarray, " k"]:
    """Return which bodies support another: its bottom is within `MAX_SUPPORT_GAP` of their top, footprints overlap."""
    found = np.zeros(len(bodies), bool)
    for i in range(len(bodies)):
        over = abs(bodies.bottom - bodies.top[i]) < MAX_SUPPORT_GAP
        over[i] = False
        found[i] = (penetration_depth(bodies[i : i + 1], bodies[over]) > 0).any() if over.any() else False
    return found


def _door_sweeps(physics: Any) -> Float[np.ndarray, "h 5"]:
    """Return `HouseLayout.door_sweeps` of valid leaves from the physics arrays of one house."""
    used = physics.door_valid
    arm = np.linalg.norm(physics.door_pos[used, :2] - physics.door_pivot[used], axis=-1)
    reach = arm + np.hypot(*physics.door_size[used, :2].T)
    middle, half = physics.door_pos[used, 2], physics.door_size[used, 2]
    return np.c_[physics.door_pivot[used], reach, middle - half, middle + half].astype(float)
