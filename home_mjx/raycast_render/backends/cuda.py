"""The `cuda` executor: `cast.cu`, called by XLA; compiled for the installed GPU and tested on first use."""

import functools
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.bank.records.gpu_geometry import gpu_geometry, pack_instances, to_center_half
from home_mjx.core.native.platforms import PTX_TARGET, compile_ptx_for_all, find_problem, is_usable, local_devices
from home_mjx.core.native.sharding import varying_false
from home_mjx.errors import BackendError
from home_mjx.raycast_render.backends.probe import find_fault
from home_mjx.raycast_render.scene.constants import MISS
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, DynamicInstances, RawHit, RayQuery, Rays

TARGET = PTX_TARGET
SOURCE = Path(__file__).with_name("cast.cu")
WARP = 32
BLOCK = 64  # threads per block, as in cast.cu
TILE = (8, 4)  # [px], width and height of the image tile of a warp, as in cast.cu
MAX_GRID = 65535  # maximum blocks along the second and third axis


def cast_cuda(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast rays of shape (environments, rays per environment); see `executors.RayBackend`.

    Raises:
        ExecutorError: The executor is not available in this process.
    """
    problem = cuda_problem()
    if problem:
        raise BackendError(f"the `cuda` executor is not available: {problem}", hint="Use executor='xla'.")
    return _call(geometry, house, moving, rays, query)


@functools.cache
def cuda_available() -> bool:
    """Return whether the `cuda` executor works in this process; warn once if there is an NVIDIA GPU and it fails."""
    return is_usable("cuda", cuda_problem(), "falling back to the slower `xla` executor for ray casts")


@functools.cache
def cuda_problem() -> str | None:
    """Return the reason why the executor is not available; None if it works. The first call compiles and tests it."""
    return find_problem("cuda", _start)


@functools.cache
def compile_kernels() -> str:
    """Compile PTX that all GPUs of this process can run."""
    return compile_ptx_for_all(SOURCE)


def _start() -> str | None:
    with jax.default_device(local_devices("cuda")[0]):
        return find_fault(_call)


def _call(geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays, query: RayQuery) -> RawHit:
    shape = (*rays.shape, query.num_hits) if query.num_hits else rays.shape
    floats, ints = jax.ShapeDtypeStruct(shape, jnp.float32), jax.ShapeDtypeStruct(shape, jnp.int32)
    results = (ints,) if query.any_hit else (floats, ints, ints, floats, floats, jax.ShapeDtypeStruct(shape, jnp.bool_))
    if 0 in shape:
        hits = tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    else:
        name = "cast_any" if query.any_hit else "cast_through" if query.num_hits else "cast_closest"
        call = jax.ffi.ffi_call(TARGET, results)
        hits = call(*kernel_operands(geometry, house, moving, rays, query), **_launch(name, rays))
    never = varying_false(house, moving, rays)
    hits = [jnp.where(never, jnp.zeros_like(x), x) for x in hits]
    return _any_hit_result(hits[0]) if query.any_hit else RawHit(*hits)


def _any_hit_result(instance: Int[Array, "e r"]) -> RawHit:
    """Return the result of an any-hit query, in which only the sign of `instance` is defined."""
    zero = jnp.zeros_like(instance, jnp.float32)
    return RawHit(jnp.where(instance < 0, MISS, zero), instance, jnp.minimum(instance, 0), zero, zero, zero > 0)


def kernel_operands(
    geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays, query: RayQuery = CLOSEST_HIT
) -> tuple[Array, ...]:
    """Return the operands of the kernels, in their order."""
    gpu = gpu_geometry(geometry) if geometry.gpu is None else geometry.gpu
    low, high = (moving.box[..., i, :].astype(jnp.float32) for i in range(2))
    low = jnp.where((moving.instance >= 0)[..., None], low, jnp.inf)
    root = geometry.model_root[jnp.maximum(moving.model, 0)]
    fields = (rays.origin, rays.direction, rays.t_min, rays.t_max, rays.exclude, rays.mask)
    own = (int(x.shape[1] == rays.shape[1]) for x in fields)  # one value per ray, or one per environment
    tiled = tile_width(rays.shape[1], rays.width)
    rows = (x.shape[0] for x in (gpu.node, gpu.triangle, geometry.material_mask, geometry.house_root))
    walk = query.num_hits, int(np.float32(query.hit_epsilon).view(np.int32))
    size = (*rays.shape, gpu.instance.shape[1], moving.instance.shape[1], tiled, *own, *rows, *walk)
    return (
        gpu.node,
        gpu.triangle,
        geometry.material_mask.astype(jnp.int32),
        gpu.instance,
        pack_instances(moving.inverse, root, moving.instance, moving.object_id, moving.material),
        to_center_half(low, high),
        geometry.house_root.astype(jnp.int32),
        house.astype(jnp.int32),
        *(x.astype(jnp.float32) for x in fields[:4]),
        *(x.astype(jnp.int32) for x in fields[4:]),
        _constants(size, jnp.int32),
    )


def _constants(values: tuple, dtype: Any) -> Array:
    """Build an array inside the program, since a partitioned function may not capture arrays."""
    return jnp.concatenate([jnp.full(1, value, dtype) for value in values])


def tile_width(count: int, width: int) -> int:
    """Return the image width if warps cast tiles of it; 0 if the rays form no image or one narrower than a tile."""
    return width if width >= TILE[0] and count % width == 0 else 0


def launch_grid(environments: int, count: int, width: int) -> tuple[int, int, int]:
    """Return the grid for `count` rays per environment: blocks of one environment, then environments along two axes."""
    width = tile_width(count, width)
    warps = -(-width // TILE[0]) * -(-count // (width * TILE[1])) if width else -(-count // WARP)
    return -(-warps * WARP // BLOCK), min(environments, MAX_GRID), -(-environments // MAX_GRID)


def _launch(name: str, rays: Rays) -> dict[str, Any]:
    names = "grid_x", "grid_y", "grid_z", "block_x", "block_y", "block_z", "shared_mem_bytes"
    environments, count = rays.shape
    sizes = (*launch_grid(environments, count, rays.width), BLOCK, 1, 1, 0)
    numbers = {name: np.int32(size) for name, size in zip(names, sizes, strict=True)}
    return {"name": name, "kernel_type": "ptx", "kernel_data": compile_kernels(), **numbers}
