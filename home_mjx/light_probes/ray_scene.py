"""Rays through one house at rest on the CPU: static instances and door leaves as placed, without movable objects."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.light_probes.kernels import compile_kernels
from home_mjx.raycast_render.backends.cpu import GEOMETRY_OPERANDS
from home_mjx.raycast_render.backends.numba.packet import FIRST_RAY_OPERAND, RowCounts
from home_mjx.raycast_render.scene.scene import BOX_MARGIN
from home_mjx.schema.compiled import RayKind

SIZED_OPERANDS = ("node_child", "triangle", "model_root", "house_root", "material_mask")


class Hits(NamedTuple):
    """Nearest hits of rays; see `raycast_render` for the fields."""

    t: Float[np.ndarray, " n"]
    instance: Int[np.ndarray, " n"]
    triangle: Int[np.ndarray, " n"]
    front: Bool[np.ndarray, " n"]


@dataclass(frozen=True)
class RayScene:
    """Operands of the native ray caster for one house of a bank.

    Attributes:
        arrays: Operands before those of rays, which live as long as this record.
        sizes: Their numbers of rows.
    """

    arrays: tuple[np.ndarray, ...]
    sizes: RowCounts

    @classmethod
    def from_bank(cls, bank: HouseBank, index: int, ignored: Int[np.ndarray, " k"]) -> "RayScene":
        """Return house `index` of a bank without the instances `ignored`."""
        host = {name: np.ascontiguousarray(getattr(bank.geometry, name)) for name in GEOMETRY_OPERANDS}
        moving = _doors(bank, index, host)
        host["instance_model"] = host["instance_model"].copy()
        host["material_mask"] = _without(host, index, ignored)
        layers, edge = host["cutout"].shape[:2]
        numbers = layers, edge, host["instance_model"].shape[1], len(moving[0])
        sizes = (*(len(host[name]) for name in SIZED_OPERANDS), *numbers)
        return cls((*host.values(), np.full(1, index, np.int32), *moving), RowCounts(*map(np.int64, sizes)))

    def nearest(self, origin: Float[np.ndarray, "n 3"], way: Float[np.ndarray, "n 3"]) -> Hits:
        """Return the nearest hits of rays that block light; `instance` is -1 on a miss."""
        return self._cast(origin, way, np.full(len(origin), np.inf, np.float32), False)

    def is_clear(
        self, origin: Float[np.ndarray, "n 3"], way: Float[np.ndarray, "#n 3"], reach: Float[np.ndarray, " n"]
    ) -> Bool[np.ndarray, " n"]:
        """Return whether nothing blocks light from `origin` to `origin + reach * way`; False for a negative reach."""
        return (self._cast(origin, way, reach.astype(np.float32), True).instance < 0) & (reach >= 0)

    def _cast(self, origin: np.ndarray, way: np.ndarray, reach: np.ndarray, any_hit: bool) -> Hits:
        """Cast rays up to `reach`."""
        n = len(origin)
        if n == 0:
            return Hits(np.zeros(0, np.float32), np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0, bool))
        origin, way = (np.ascontiguousarray(np.broadcast_to(x, (n, 3)), np.float32) for x in (origin, way))
        start, hidden, mask = np.zeros(1, np.float32), np.full(1, -1, np.int32), np.full(1, RayKind.LIGHT, np.int32)
        rays = origin, way, start, reach, hidden, mask
        t, (u, v), (instance, triangle) = np.empty(n, np.float32), np.empty((2, n), np.float32), np.empty((2, n), "i4")
        front = np.empty(n, bool)
        operands = np.array([x.ctypes.data for x in (*self.arrays, *rays)], np.int64)
        results = np.array([x.ctypes.data for x in (t, instance, triangle, u, v, front)], np.int64)
        assert len(operands) == FIRST_RAY_OPERAND + len(rays)
        counts = np.array([n, n, 1, n, 1, 1], np.int64)
        compile_kernels().cast(operands.ctypes.data, counts.ctypes.data, results.ctypes.data, self.sizes, n, any_hit)
        return Hits(t, instance, triangle, front)


def _doors(bank: HouseBank, index: int, host: dict[str, np.ndarray]) -> tuple[np.ndarray, ...]:
    """Return the door leaves of a house as placed; fields in the order of `DynamicInstances` without poses."""
    valid = np.asarray(bank.physics.door_valid[index])
    instance = np.asarray(bank.physics.door_instance[index])[valid].astype(np.int32)
    pose = np.asarray(bank.geometry.instance_pose[index])[instance].astype(float)
    model = np.maximum(host["instance_model"][index][instance], 0)
    low, high = np.moveaxis(np.asarray(bank.geometry.model_box)[model].astype(float), 1, 0)
    middle = np.einsum("dij,dj->di", pose[..., :3], (low + high) / 2) + pose[..., 3]
    extent = np.einsum("dij,dj->di", np.abs(pose[..., :3]), (high - low) / 2) + BOX_MARGIN
    box = np.stack([middle - extent, middle + extent], axis=1).astype(np.float32)
    rows = (host[name][index][instance] for name in ("instance_inverse", "instance_object", "instance_material"))
    inverse, object_id, material = (np.ascontiguousarray(row) for row in rows)
    return instance, model, inverse, box, object_id, material


def _without(host: dict[str, np.ndarray], index: int, ignored: Int[np.ndarray, " k"]) -> Int[np.ndarray, " m"]:
    """Return the material masks, 0 for the materials of the instances `ignored`."""
    mask, models = host["material_mask"].copy(), host["instance_model"][index]
    for instance in ignored:
        slots = np.unique(
            host["triangle_slot"][_triangles(host["node_child"], int(host["model_root"][models[instance]]))]
        )
        mask[host["instance_material"][index][instance] + slots] = 0
    return mask


def _triangles(child: Int[np.ndarray, "n 2"], root: int) -> Int[np.ndarray, " t"]:
    """Return the rows of all triangles below a node."""
    rows, stack = [np.zeros(0, np.int64)], [root]
    while stack:
        for code in child[stack.pop()].tolist():
            if code >= 0:
                stack.append(code)
            elif code != -1:
                rows.append(np.arange(~code >> 4, (~code >> 4) + (~code & 15)))
    return np.concatenate(rows)
