"""The `cpu` executor: Numba code that XLA calls directly, compiled and tested on first use."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.fork_guard import record_process
from home_mjx.core.native.platforms import find_problem, is_usable, local_devices
from home_mjx.core.native.sharding import varying_false
from home_mjx.errors import BackendError
from home_mjx.raycast_render.backends.probe import find_fault
from home_mjx.raycast_render.backends.step_by_step import cast_multi_hit_by_loop
from home_mjx.raycast_render.scene.types import DynamicInstances, RawHit, RayQuery, Rays

TARGET = "home_mjx_cast"

_kept: list[object] = []  # keeps compiled functions alive: XLA may call them until the process ends


def cast_cpu(
    geometry: Geometry, house: Int[Array, " e"], moving: DynamicInstances, rays: Rays, query: RayQuery
) -> RawHit:
    """Cast rays of shape (environments, rays per environment); see `executors.RayBackend`.

    Raises:
        ExecutorError: The executor is not available in this process.
    """
    problem = cpu_problem()
    if problem:
        raise BackendError(f"the `cpu` executor is not available: {problem}", hint="Use executor='xla'.")
    return _call(geometry, house, moving, rays, query)


@functools.cache
def cpu_available() -> bool:
    """Return whether the `cpu` executor works in this process; warn once if JAX has a CPU backend and it fails."""
    return is_usable("cpu", cpu_problem(), "falling back to the slower `xla` executor for ray casts")


@functools.cache
def cpu_problem() -> str | None:
    """Return the reason why the executor is not available; None if it works.

    The first call compiles, registers and tests it.
    """
    return find_problem("cpu", _start)


def _start() -> str | None:
    record_process()
    from home_mjx.raycast_render.backends.numba.ffi_handler import build_handler

    compiled = build_handler()
    _kept.extend(compiled)
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(compiled[-1].ctypes), platform="cpu", api_version=1)
    with jax.default_device(local_devices("cpu")[0]):
        return find_fault(_call)


def _call(geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays, query: RayQuery) -> RawHit:
    if query.num_hits:
        return cast_multi_hit_by_loop(_call, geometry, house, moving, rays, query)
    shape = rays.shape
    float_, int_ = jax.ShapeDtypeStruct(shape, jnp.float32), jax.ShapeDtypeStruct(shape, jnp.int32)
    results = (float_, int_, int_, float_, float_, jax.ShapeDtypeStruct(shape, jnp.bool_))
    # In the order of native.Operands, then of Rays.
    operands = (
        geometry.node_box,
        geometry.node_child,
        geometry.triangle,
        geometry.triangle_slot,
        geometry.model_root,
        geometry.house_root,
        geometry.instance_model,
        geometry.instance_inverse,
        geometry.instance_object,
        geometry.instance_material,
        geometry.material_mask,
        house,
        moving.instance,
        moving.model,
        moving.inverse,
        moving.box,
        moving.object_id,
        moving.material,
        rays.origin,
        rays.direction,
        rays.t_min,
        rays.t_max,
        rays.exclude,
        rays.mask,
    )
    operands = (x.astype(jnp.float32 if jnp.issubdtype(x.dtype, jnp.floating) else jnp.int32) for x in operands)
    attributes = {"any_hit": np.int32(query.any_hit), "width": np.int32(rays.width)}
    hits = RawHit(*jax.ffi.ffi_call(TARGET, results)(*operands, **attributes))
    never = varying_false(house, moving, rays)
    return jax.tree.map(lambda x: jnp.where(never, jnp.zeros_like(x), x), hits)
