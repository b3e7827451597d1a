"""Hinges and slides of an MJCF scene as movable parts of the meshes of their objects."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.datasets.gltf.scene_lights import to_vector
from home_mjx.datasets.mjcf.model import LEVEL_LINEAR, MjcfScene
from home_mjx.datasets.taxonomy import part_kind
from home_mjx.schema.house import Joint, JointKind

FREE, SLIDE, HINGE = 0, 2, 3  # `mujoco.mjtJoint`
MIN_RANGE = 1e-4  # [rad] or [m], minimum range of a joint that moves


@dataclass(frozen=True)
class PartFinder:
    """Finder of the movable parts of one object.

    Attributes:
        scene: The scene.
        bodies: Bodies of the object, each after the one that carries it.
        faces: Body of each face of the object's mesh.
        back: Model from house, both Y up.
    """

    scene: MjcfScene
    bodies: Sequence[int]
    faces: Int[np.ndarray, " f"]
    back: Float[np.ndarray, "4 4"]

    def parts(self, model_id: str) -> tuple[Joint, ...]:
        """Return the outermost hinges and slides that move faces and have a range, with all faces below their bodies.

        Joint value 0 is the reference pose. A joint that is not limited has half a turn to both sides.
        """
        found = []
        for joint in self._outermost():
            mask = np.isin(self.faces, self.scene.subtree(int(self.scene.model.jnt_bodyid[joint])))
            low, high = self._range(joint)
            if mask.any() and high - low > MIN_RANGE:
                found.append(self._joint(joint, model_id, mask, low, high))
        return tuple(found)

    def is_free(self) -> bool:
        """Return whether the object floats on a free joint."""
        kinds = self.scene.model.jnt_type
        return any(kinds[joint] == FREE for body in self.bodies[:1] for joint in self._joints(body))

    def num_carried(self) -> int:
        """Return the number of hinges and slides on parts that another joint moves, which have no record."""
        kinds = [int(self.scene.model.jnt_type[j]) for body in self.bodies for j in self._joints(body)]
        return sum(kind in (SLIDE, HINGE) for kind in kinds) - len(list(self._outermost()))

    def _outermost(self) -> Iterator[int]:
        """Yield the first hinge or slide of each body that no such joint of the object moves already."""
        moved: set[int] = set()
        for body in self.bodies:
            kinds = [(j, int(self.scene.model.jnt_type[j])) for j in self._joints(body)]
            first = next((j for j, kind in kinds if kind in (SLIDE, HINGE)), None)
            if body not in moved and first is not None:
                yield first
                moved |= set(self.scene.subtree(body))

    def _joints(self, body: int) -> range:
        """Return the joints of a body."""
        first = int(self.scene.model.body_jntadr[body])
        return range(first, first + int(self.scene.model.body_jntnum[body])) if first >= 0 else range(0)

    def _range(self, joint: int) -> tuple[float, float]:
        """Return the range of a joint from the reference pose [rad] or [m], which is part of it."""
        model = self.scene.model
        if not model.jnt_limited[joint]:
            return (-np.pi, np.pi) if model.jnt_type[joint] == HINGE else (0.0, 0.0)
        low, high = (model.jnt_range[joint] - model.qpos0[model.jnt_qposadr[joint]]).tolist()
        return min(low, 0.0), max(high, 0.0)

    def _joint(self, joint: int, model_id: str, mask: Bool[np.ndarray, " f"], low: float, high: float) -> Joint:
        """Return the record of a joint that moves the faces of a mask; a spring's rest tells the closed pose."""
        model, data = self.scene.model, self.scene.data
        address, turn = int(model.jnt_qposadr[joint]), data.xaxis[joint]
        axis = self.back[:3, :3] @ LEVEL_LINEAR @ turn
        point = self.back[:3, :3] @ LEVEL_LINEAR @ data.xanchor[joint] + self.back[:3, 3]
        rest = float(model.qpos_spring[address] - model.qpos0[address]) if model.qpos_spring[address] else 0.0
        kind: JointKind = "hinge" if int(model.jnt_type[joint]) == HINGE else "slide"
        names = model.joint(joint).name, model.body(int(model.jnt_bodyid[joint])).name
        return Joint(
            model_id=model_id,
            part=f"{part_kind(kind, float(turn[2]), *names)}_{joint}",
            kind=kind,
            axis=to_vector(axis / np.linalg.norm(axis)),
            point=to_vector(point),
            low=low,
            high=high,
            face_ranges=_runs(mask),
            closed=float(np.clip(rest, low, high)),
        )


def _runs(mask: Bool[np.ndarray, " f"]) -> tuple[tuple[int, int], ...]:
    """Return the first and last index of each run of true values."""
    edge = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]])))
    return tuple((int(a), int(b) - 1) for a, b in edge.reshape(-1, 2))
