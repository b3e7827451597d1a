"""What no agent and no thing may do in a house, by formulas of its own: from boxes and the files of floors."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

ON_AXIS = 9  # points of an agent's axis
BESIDE_ROOMS = 0.3  # [m], from a floor: half of what a doorway is deep, and more


@dataclass(frozen=True)
class HouseOracle:
    """One house.

    Attributes:
        pos: (n, 3) [m], middles of the static boxes that rise above the ground floor.
        rot: (n, 3, 3), from their frames to the world.
        half: (n, 3) [m].
        plan: (t, 3, 2) [m], triangles of the rooms' floors as seen from above; None: anywhere.
        floor: [m], top of the ground floor.
    """

    pos: np.ndarray
    rot: np.ndarray
    half: np.ndarray
    plan: np.ndarray | None
    floor: float

    @classmethod
    def of(cls, physics, house: int, plan: np.ndarray | None = None) -> "HouseOracle":
        """From the arrays of a bank, on the host."""
        pos, quat, half = (
            np.asarray(x[house], float) for x in (physics.collider_pos, physics.collider_quat, physics.collider_size)
        )
        floor = float(physics.floor[house])
        real = (pos[:, 2] > -50) & (pos[:, 2] + half[:, 2] > floor + 0.01)
        rot = Rotation.from_quat(quat[real], scalar_first=True).as_matrix()
        return cls(pos[real], rot, half[real], plan, floor)

    def local(self, points: np.ndarray) -> np.ndarray:
        """(..., n, 3): points (..., 3) in the frames of the boxes."""
        return np.einsum("...nj,njk->...nk", points[..., None, :] - self.pos, self.rot)

    def depth(self, pos: np.ndarray, radius: float, height: float) -> np.ndarray:
        """(..., n) [m]: how deep upright capsules are in each box; below 0 beside it."""
        axis = np.linspace(-1, 1, ON_AXIS)[:, None] * [0, 0, height / 2 - radius]
        out = np.abs(self.local(pos[..., None, :] + axis)) - self.half
        away = np.linalg.norm(np.maximum(out, 0), axis=-1)
        return (radius - np.where(away > 0, away, out.max(axis=-1))).max(axis=-2)

    def passed(self, before: np.ndarray, after: np.ndarray, slack: float = 0.02) -> np.ndarray:
        """(...): whether a way (..., 3) leads from outside of a box into it or through it; boxes are `slack` smaller.

        The slab test: the way is in a box where it is between its three pairs of planes.
        """
        begin, end, half = self.local(before), self.local(after), np.maximum(self.half - slack, 1e-3)
        way = np.where(np.abs(end - begin) < 1e-12, 1e-12, end - begin)
        ends = np.stack([(-half - begin) / way, (half - begin) / way])
        enters, leaves = ends.min(axis=0).max(axis=-1), ends.max(axis=0).min(axis=-1)
        return np.any((enters > 0) & (enters < np.minimum(leaves, 1)), axis=-1)

    def outdoors(self, pos: np.ndarray) -> np.ndarray:
        """(...): whether places (..., 3) are farther than `BESIDE_ROOMS` from every floor, in the plan."""
        if self.plan is None:
            return np.zeros(pos.shape[:-1], bool)
        start, end = self.plan, np.roll(self.plan, -1, axis=1)
        away, edge = pos[..., None, None, :2] - start, end - start
        along = np.clip((away * edge).sum(-1) / np.maximum((edge**2).sum(-1), 1e-12), 0, 1)
        near = np.linalg.norm(away - along[..., None] * edge, axis=-1).min(axis=-1) < BESIDE_ROOMS
        turn = edge[..., 0] * away[..., 1] - edge[..., 1] * away[..., 0]
        inside = np.all(turn >= 0, axis=-1) | np.all(turn <= 0, axis=-1)
        return ~np.any(near | inside, axis=-1)


def plan_of(dataset, compiled) -> np.ndarray:
    """(t, 3, 2) [m]: the floors of a house as its files have them, Y up, in the frame of the compiled house."""
    house = dataset.load_house(compiled.id)
    meshes = [room.floor for level in house.levels for room in level.rooms if room.floor is not None]
    corners = np.concatenate([mesh.vertices[mesh.faces] for mesh in meshes])
    return np.stack([corners[..., 0], -corners[..., 2]], axis=-1) + compiled.offset[:2]


def energy(physics, house: int, pos: np.ndarray, speed: np.ndarray, spin: np.ndarray, floor: float) -> np.ndarray:
    """(e) [J], of the movable bodies of environments in a house: of height above its floor, and of motion."""
    used = np.asarray(physics.body_valid[house])
    mass, inertia = (np.asarray(x[house], float) for x in (physics.body_mass, physics.body_inertia))
    moving = 0.5 * mass * (speed**2).sum(-1) + 0.5 * (inertia * spin**2).sum(-1)
    return np.where(used, mass * 9.81 * (pos[..., 2] - floor) + moving, 0).sum(-1)
