"""Arrays of one house for rays of sound on the CPU, and batches of rays through them (Numba, no JAX program)."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cache
from typing import Any, NamedTuple, Protocol, no_type_check, runtime_checkable

import numpy as np
from jaxtyping import Bool, Float, Int
from numba import njit, types

from home_mjx.bank.bank import HouseBank
from home_mjx.core.native import ffi, memory, simd
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, pointer_to
from home_mjx.core.native.numba_cache import verify_cache_once
from home_mjx.core.native.simd import LANES
from home_mjx.core.transforms import quat_matrix
from home_mjx.core.workers import map_threads
from home_mjx.geometry.meshes import invert
from home_mjx.geometry.rotations import yaw_quat
from home_mjx.raycast_render.backends.cpu import GEOMETRY_OPERANDS
from home_mjx.raycast_render.backends.numba import cutouts, intersect, packet, traverse
from home_mjx.raycast_render.backends.numba.packet import FIRST_RAY_OPERAND, RowCounts, make_tiling
from home_mjx.raycast_render.backends.numba.traverse import cast_packet
from home_mjx.raycast_render.scene.scene import BOX_MARGIN
from home_mjx.schema.compiled import BANDS, RayKind

NUM_RAY_FIELDS = 6
REACH = 6  # index of `RayMemory.reach` in the arrays of a visibility test
RAYS_PER_TASK = 1 << 14  # rays of a task of `HouseRays.occluded`
CAST_MODULES: tuple[Any, ...] = ffi, memory, simd, cutouts, intersect, packet, traverse  # that compile into a cast

Pointer = Any  # a C pointer, which Numba indexes like an array
floats, integers, words = pointer_to(types.float32), pointer_to(types.int32), pointer_to(types.int64)
compiled = compile_inner()


class CastScene(NamedTuple):
    """Arrays of `traverse.SceneArrays` for casts of rays, and their numbers of rows."""

    operands: Pointer  # (26,) int64, addresses; those of the rays are written by `cast_rays`
    sizes: RowCounts


class RayMemory(NamedTuple):
    """Memory of a cast."""

    counts: Pointer  # (6,) int64
    results: Pointer  # (6,) int64, addresses
    constants: Pointer  # (3,) float32 or int32: t_min, no excluded object, mask
    reach: Pointer  # (n,) float32, t_max; negative: no ray
    t: Pointer  # (n,) float32
    instance: Pointer  # (n,) int32; -1 on a miss
    triangle: Pointer  # (n,) int32


@runtime_checkable
class SightLines(Protocol):
    """A house in which lines between points are tested."""

    def occluded(self, start: Float[np.ndarray, "n 3"], end: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return for each pair of points [m] whether a surface that blocks sound is between them."""
        ...


@dataclass(frozen=True)
class HouseRays:
    """One house of a bank in its initial state, with all doors wide open, for rays of sound.

    Attributes:
        arrays: Operands of casts.
        sizes: Their numbers of rows.
        surfaces: Arrays of `flight.Surfaces`.
    """

    arrays: tuple[np.ndarray, ...]
    sizes: RowCounts
    surfaces: tuple[np.ndarray, ...]

    @classmethod
    def from_bank(cls, bank: HouseBank, index: int) -> "HouseRays":
        """Return the arrays of house `index` of a bank."""
        geometry, table = bank.geometry, bank.materials
        moving = _moving_instances(bank, index)
        host = {name: np.ascontiguousarray(getattr(geometry, name)) for name in GEOMETRY_OPERANDS}
        arrays = (*host.values(), np.full(1, index, np.int32), *moving)
        counted = ("node_child", "triangle", "model_root", "house_root", "material_mask")
        layers, edge = host["cutout"].shape[:2]
        numbers = layers, edge, host["instance_model"].shape[1], len(moving.instance)
        sizes = (*(len(host[name]) for name in counted), *numbers)
        inverse, first = host["instance_inverse"][index].copy(), host["instance_material"][index].copy()
        inverse[moving.instance], first[moving.instance] = moving.inverse, moving.material
        acoustic = (table.absorption, table.scattering, table.transmission)
        padded = (np.pad(np.asarray(x, np.float32), ((0, 0), (0, LANES - len(BANDS)))) for x in acoustic)
        surfaces = host["triangle"], host["triangle_slot"], inverse, first, *padded
        return cls(arrays, RowCounts(*map(np.int64, sizes)), surfaces)

    def operands(self) -> Int[np.ndarray, " 26"]:
        """Return the addresses for a cast; the arrays live as long as this record.

        Those of rays are 0, until `cast_rays` writes them.
        """
        return np.array([array.ctypes.data for array in self.arrays] + [0] * NUM_RAY_FIELDS, np.int64)

    def occluded(self, start: Float[np.ndarray, "n 3"], end: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return for each pair of points [m] whether a surface that blocks sound is between them."""
        start = np.ascontiguousarray(start, np.float32)
        way = np.ascontiguousarray(end - start, np.float32)
        cuts = range(0, len(start), RAYS_PER_TASK)
        parts = [(start[i : i + RAYS_PER_TASK], way[i : i + RAYS_PER_TASK]) for i in cuts]
        found = map_threads(lambda part: self._occluded(*part), parts)
        return np.concatenate([*found, np.zeros(0, bool)])

    def _occluded(self, start: Float[np.ndarray, "n 3"], way: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, " n"]:
        """Return whether a surface that blocks sound is between `start` and `start + way`, in one task."""
        arrays = self.operands(), start, way, *ray_memory(len(start))
        arrays[REACH][:] = 1.0
        _test_occlusion(addresses(arrays), self.sizes, len(start))
        return arrays[REACH + 2] >= 0


class _MovingInstances(NamedTuple):
    """Movable objects and doors that the house has; fields as of `DynamicInstances`."""

    instance: Int[np.ndarray, " d"]
    model: Int[np.ndarray, " d"]
    inverse: Float[np.ndarray, "d 3 4"]
    box: Float[np.ndarray, "d 2 3"]
    object_id: Int[np.ndarray, " d"]
    material: Int[np.ndarray, " d"]


def _moving_instances(bank: HouseBank, index: int) -> _MovingInstances:
    """Return the movable objects of a house at their initial poses, and its doors wide open; see `make_open_scene`."""
    geometry, physics = bank.geometry, bank.physics
    bodies = np.flatnonzero(np.asarray(physics.body_valid[index]))
    doors = np.flatnonzero(np.asarray(physics.door_valid[index]))
    turn = np.asarray(bank.fronts.open_doors(physics, index))[doors].astype(float)
    slide, pivot = (np.asarray(x[index])[doors].astype(float) for x in (physics.door_slide, physics.door_pivot))
    instance = np.concatenate(
        [np.asarray(physics.body_instance[index])[bodies], np.asarray(physics.door_instance[index])[doors]]
    ).astype(np.int32)
    placed = _compose(
        _rigid(*(np.asarray(x[index])[bodies].astype(float) for x in (physics.body_pos, physics.body_quat))),
        np.asarray(physics.body_from_model[index])[bodies].astype(float),
    )
    leaves = _compose(
        _door_motion(pivot, turn, slide),
        np.asarray(geometry.instance_pose[index])[instance[len(bodies) :]].astype(float),
    )
    pose = np.concatenate([placed, leaves])
    model = np.maximum(np.asarray(geometry.instance_model[index])[instance], 0).astype(np.int32)
    low, high = np.moveaxis(np.asarray(geometry.model_box)[model].astype(float), 1, 0)
    middle = np.einsum("dij,dj->di", pose[..., :3], (low + high) / 2) + pose[..., 3]
    extent = np.einsum("dij,dj->di", np.abs(pose[..., :3]), (high - low) / 2) + BOX_MARGIN
    return _MovingInstances(
        instance,
        model,
        np.ascontiguousarray(invert(pose), np.float32),
        np.stack([middle - extent, middle + extent], axis=1).astype(np.float32),
        np.asarray(geometry.instance_object[index])[instance],
        np.asarray(geometry.instance_material[index])[instance],
    )


def _rigid(pos: Float[np.ndarray, "n 3"], quat: Float[np.ndarray, "n 4"]) -> Float[np.ndarray, "n 3 4"]:
    """Return the affine maps from body frames to the world; quaternions are wxyz."""
    return np.concatenate([np.moveaxis(quat_matrix(quat.T, np), 2, 0), pos[..., None]], axis=2)


def _door_motion(
    pivot: Float[np.ndarray, "n 2"], turn: Float[np.ndarray, " n"], slide: Float[np.ndarray, "n 2"]
) -> Float[np.ndarray, "n 3 4"]:
    """Return rotations by `turn` [rad] about the vertical through `pivot`; for sliding doors, shifts by `turn` [m]."""
    angle = np.where((slide != 0).any(axis=1), 0.0, turn)
    out = _rigid(np.zeros((len(turn), 3)), yaw_quat(angle))
    out[:, :2, 3] = pivot - np.einsum("dij,dj->di", out[:, :2, :2], pivot) + turn[:, None] * slide
    return out


def _compose(outer: Float[np.ndarray, "n 3 4"], inner: Float[np.ndarray, "n 3 4"]) -> Float[np.ndarray, "n 3 4"]:
    """Return the affine maps that apply `inner`, then `outer`."""
    out = outer[..., :3] @ inner
    out[..., 3] += outer[..., 3]
    return out


def ray_memory(count: int) -> tuple[np.ndarray, ...]:
    """Return the arrays of `RayMemory` for `count` rays, followed by those that nothing reads."""
    constants = np.zeros(3, np.int32)
    constants[1:] = -1, int(RayKind.SOUND)
    whole, parts, kinds = np.empty(count, np.float32), np.empty((2, count), np.float32), np.empty((2, count), np.int32)
    counts, results = np.array([count, count, 1, count, 1, 1], np.int64), np.zeros(6, np.int64)
    front = np.empty(count, np.uint8)
    taken = counts, results, constants, np.empty(count, np.float32), whole, kinds[0], kinds[1]
    results[:] = [x.ctypes.data for x in (whole, *kinds, *parts, front)]
    return *taken, parts, kinds, front


def addresses(arrays: Iterable[np.ndarray]) -> Int[np.ndarray, " n"]:
    """Return the addresses of arrays, which must be contiguous and must outlive their use."""
    return np.array([array.ctypes.data for array in arrays], np.int64)


@verify_cache_once
@no_type_check
def _test_occlusion(at, sizes, count):
    """Cast rays until any hit, on arrays at the addresses `at`; verifies Numba's disk cache once."""
    _compiled_test()(at, sizes, count)


@cache
def _compiled_test() -> Any:
    """Return the compiled `test_occlusion`, from Numba's disk cache if it is there."""
    # Numba's cache checks this file and the values that a function closes over: the digest stands for other files.
    digest = ffi.hash_sources(*(part.__file__ for part in CAST_MODULES))

    @njit(error_model="numpy", nogil=True, cache=True)
    @no_type_check
    def test_occlusion(at, sizes, count):
        """Cast `count` rays until any hit."""
        _ = digest
        cast_rays(CastScene(words(at[0]), sizes), at[1], at[2], read_memory(at, 3), count, True)

    return test_occlusion


@compiled
@no_type_check
def read_memory(at, first):
    """Return the `RayMemory` whose arrays are at the addresses `at[first]`, `at[first + 1]`, ..."""
    return RayMemory(
        words(at[first]), words(at[first + 1]), integers(at[first + 2]), floats(at[first + 3]), floats(at[first + 4]),
        integers(at[first + 5]), integers(at[first + 6]),
    )  # fmt: skip


@compiled
@no_type_check
def cast_rays(scene, origin, direction, memory, count, any_hit):
    """Cast `count` rays up to `memory.reach` and write their nearest hits, or with `any_hit` any, to `memory`.

    Rays of negative reach are not cast; `memory.instance` is -1 on a miss. `origin`, `direction`: addresses of float32
    arrays (n, 3).
    """
    operands, constants = scene.operands, address_of(memory.constants)
    operands[FIRST_RAY_OPERAND], operands[FIRST_RAY_OPERAND + 1] = origin, direction
    operands[FIRST_RAY_OPERAND + 2], operands[FIRST_RAY_OPERAND + 3] = constants, address_of(memory.reach)
    operands[FIRST_RAY_OPERAND + 4], operands[FIRST_RAY_OPERAND + 5] = constants + 4, constants + 8
    tiles = make_tiling(count, 0)
    for number in range(tiles.packets):
        cast_packet(operands, memory.counts, memory.results, scene.sizes, tiles, any_hit, number)
