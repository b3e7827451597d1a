"""The `cpu` executor: Numba code that XLA calls directly, compiled and tested on first use."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.fork_guard import note_start
from home_mjx.core.native.platforms import devices_of, problem_of, works
from home_mjx.core.native.sharding import varying_false
from home_mjx.errors import ExecutorError
from home_mjx.raycast_render.backends.probe import probe
from home_mjx.raycast_render.backends.step_by_step import step_by_step
from home_mjx.raycast_render.scene.types import Moving, Query, RawHit, Rays

TARGET = "home_mjx_cast"

_kept: list[object] = []  # keeps compiled functions alive: XLA may call them until the process ends


def cast_cpu(geometry: Geometry, house: Int[Array, " e"], moving: Moving, rays: Rays, query: Query) -> RawHit:
    """Cast rays of shape (environments, rays per environment); see `executors.Executor`.

    Raises:
        ExecutorError: The executor is not available in this process.
    """
    problem = cpu_problem()
    if problem:
        raise ExecutorError(f"the `cpu` executor is not available: {problem}", hint="Use executor='xla'.")
    return _call(geometry, house, moving, rays, query)


@functools.cache
def cpu_available() -> bool:
    """Return whether the `cpu` executor works in this process; warn once if JAX has a CPU backend and it fails."""
    return works("cpu", cpu_problem(), "falling back to the slower `xla` executor for ray casts")


@functools.cache
def cpu_problem() -> str | None:
    """Return the reason why the executor is not available; None if it works.

    The first call compiles, registers and tests it.
    """
    return problem_of("cpu", _start)


def _start() -> str | None:
    note_start()
    from home_mjx.raycast_render.backends.numba.ffi_handler import build_handler

    compiled = build_handler()
    _kept.extend(compiled)
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(compiled[-1].ctypes), platform="cpu", api_version=1)
    with jax.default_device(devices_of("cpu")[0]):
        return probe(_call)


def _call(geometry: Geometry, house: Array, moving: Moving, rays: Rays, query: Query) -> RawHit:
    if query.steps:
        return step_by_step(_call, geometry, house, moving, rays, query)
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
