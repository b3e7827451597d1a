"""The `cuda` backend: `cast.cu`, called by XLA; compiled for the installed GPU and tested on first use."""

from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Geometry
from home_mjx.bank.records.gpu_geometry import gpu_geometry, pack_instances, to_center_half
from home_mjx.core.native.kernel import compile_sources, launch_ptx
from home_mjx.core.native.partition import varying_as
from home_mjx.core.native.vmap_call import traced_constant
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, MISS, DynamicInstances, RawHit, RayQuery, Rays

SOURCE = Path(__file__).with_name("cast.cu")
WARP = 32
BLOCK = 64  # threads per block, as in cast.cu
TILE = (8, 4)  # [px], width and height of the image tile of a warp, as in cast.cu
MAX_GRID = 65535  # maximum blocks along the second and third axis


def cast_cuda(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast rays (e r ...) by the CUDA kernels; return hits (e r), or (e r steps) if `query.num_hits` is not 0.

    A miss has t `MISS`, instance and triangle -1. After an any-hit query only the sign of `instance` counts.
    `registry.KERNEL` must be usable on the GPU; there is no fallback.
    """
    shape = (*rays.shape, query.num_hits) if query.num_hits else rays.shape
    floats, ints = jax.ShapeDtypeStruct(shape, jnp.float32), jax.ShapeDtypeStruct(shape, jnp.int32)
    results = (ints,) if query.any_hit else (floats, ints, ints, floats, floats, jax.ShapeDtypeStruct(shape, jnp.bool_))
    if 0 in shape:
        hits = varying_as((house, moving, rays), [jnp.zeros(x.shape, x.dtype) for x in results])
    else:
        entry = "cast_any" if query.any_hit else "cast_through" if query.num_hits else "cast_closest"
        grid, operands = launch_grid(*rays.shape, rays.width), kernel_operands(geometry, house, moving, rays, query)
        hits = launch_ptx(entry, compile_kernels(), grid, BLOCK, 0, operands, results)
    return _any_hit_result(hits[0]) if query.any_hit else RawHit(*hits)


def compile_kernels() -> str:
    """Return `cast.cu` compiled to PTX that all GPUs of this process can run."""
    return compile_sources(SOURCE)


def _any_hit_result(instance: Int[Array, "e r"]) -> RawHit:
    """Return an any-hit result: only the sign of `instance`, negative without a hit, counts; the rest is filled in."""
    zero = jnp.zeros_like(instance, jnp.float32)
    return RawHit(jnp.where(instance < 0, MISS, zero), instance, jnp.minimum(instance, 0), zero, zero, zero > 0)


def kernel_operands(
    geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays, query: RayQuery = CLOSEST_HIT
) -> tuple[Array, ...]:
    """Return the operands of all kernels of `cast.cu` in their order: geometry, instances, houses, rays, sizes."""
    gpu = gpu_geometry(geometry) if geometry.gpu is None else geometry.gpu
    fields = (rays.origin, rays.direction, rays.t_min, rays.t_max, rays.exclude, rays.mask)
    own = (int(x.shape[1] == rays.shape[1]) for x in fields)  # one value per ray, or one per environment
    tiled = tile_width(rays.shape[1], rays.width)
    rows = (x.shape[0] for x in (gpu.node, gpu.triangle, geometry.material_mask, geometry.house_root))
    walk = query.num_hits, int(np.float32(query.hit_epsilon).view(np.int32))
    texels = geometry.cutout.shape[:2]
    size = (*rays.shape, gpu.instance.shape[1], moving.instance.shape[1], tiled, *own, *rows, *walk, *texels)
    return (
        gpu.node,
        gpu.triangle,
        geometry.material_mask.astype(jnp.int32),
        geometry.triangle_uv.astype(jnp.float32),
        geometry.cutout.astype(jnp.uint32),
        gpu.instance,
        *moving_operands(geometry, moving),
        geometry.house_root.astype(jnp.int32),
        house.astype(jnp.int32),
        *(x.astype(jnp.float32) for x in fields[:4]),
        *(x.astype(jnp.int32) for x in fields[4:]),
        traced_constant(size),
    )


def moving_operands(
    geometry: Geometry, moving: DynamicInstances
) -> tuple[Float[Array, "*e d 16"], Float[Array, "*e d 6"]]:
    """Return the records of moving instances and their boxes.

    Boxes of empty ones (`instance` -1) become boxes that no ray hits.
    """
    low, high = (moving.box[..., i, :].astype(jnp.float32) for i in range(2))
    low = jnp.where((moving.instance >= 0)[..., None], low, jnp.inf)
    root = geometry.model_root[jnp.maximum(moving.model, 0)]
    records = pack_instances(moving.inverse, root, moving.instance, moving.object_id, moving.material)
    return records, to_center_half(low, high)


def tile_width(count: int, width: int) -> int:
    """Return `width` [px] if warps cast image tiles; 0 if it is below `TILE[0]` or does not divide `count` rays."""
    return width if width >= TILE[0] and count % width == 0 else 0


def launch_grid(environments: int, count: int, width: int) -> tuple[int, int, int]:
    """Return the grid for `count` rays per environment: blocks of one environment, then environments along two axes.

    `width`: image width [px]; 0 if the rays form no image. The product of the last two axes may exceed `environments`.
    """
    width = tile_width(count, width)
    warps = -(-width // TILE[0]) * -(-count // (width * TILE[1])) if width else -(-count // WARP)
    return -(-warps * WARP // BLOCK), min(environments, MAX_GRID), -(-environments // MAX_GRID)
