"""The `cpu` backend: Numba code that XLA calls directly, compiled and tested on first use."""

from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.kernel import call_native
from home_mjx.raycast_render.backends.multi_hit_loop import cast_multi_hit_by_loop
from home_mjx.raycast_render.scene.types import DynamicInstances, RawHit, RayQuery, Rays

TARGET = "home_mjx_cast"
# Leading operands of the Numba kernel: fields of `Geometry`; after the house, fields of `DynamicInstances`.
GEOMETRY_OPERANDS = (
    *("node_box", "node_child", "triangle", "triangle_slot", "model_root", "house_root"),
    *("instance_model", "instance_inverse", "instance_object", "instance_material"),
    *("material_mask", "triangle_uv", "cutout"),
)
MOVING_OPERANDS = ("instance", "model", "inverse", "box", "object_id", "material")


def compile_chunks() -> tuple[Any, Any]:
    """Import and compile the Numba code; return its C functions `count` (chunks of a call) and `work` (of a job)."""
    from home_mjx.raycast_render.backends.numba import chunks

    return chunks.compile_chunks()


def cast_cpu(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast rays (e r ...) by the Numba kernel; return hits (e r), or (e r steps) if `query.num_hits` is not 0.

    A miss has t `MISS`, instance and triangle -1. After an any-hit query only the sign of `instance` counts.
    `registry.KERNEL` must be usable on the CPU; there is no fallback.
    """
    if query.num_hits:
        return cast_multi_hit_by_loop(cast_cpu, geometry, house, moving, rays, query)
    shape = rays.shape
    float_, int_ = jax.ShapeDtypeStruct(shape, jnp.float32), jax.ShapeDtypeStruct(shape, jnp.int32)
    results = (float_, int_, int_, float_, float_, jax.ShapeDtypeStruct(shape, jnp.bool_))
    # In the order that the Numba kernel expects: geometry, scene, then `Rays`.
    scene = *(getattr(geometry, name) for name in GEOMETRY_OPERANDS), house
    scene = *scene, *(getattr(moving, name) for name in MOVING_OPERANDS)
    operands = *scene, rays.origin, rays.direction, rays.t_min, rays.t_max, rays.exclude, rays.mask
    return RawHit(*call_native(TARGET, operands, results, any_hit=query.any_hit, width=rays.width))
