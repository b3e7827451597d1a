"""Batching primitive of `cast`: rays as (environments, rays per environment), with all levels of `vmap` folded in."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jaxtyping import Array

from home_mjx.bank.records import Geometry
from home_mjx.core.native.partition import ENV, RAY, Axes, partition_kernel
from home_mjx.raycast_render.backends.registry import RayBackend, find_backend
from home_mjx.raycast_render.scene.types import DynamicInstances, RawHit, RayQuery, Rays

BatchedCast = Callable[[Geometry, Array, DynamicInstances, Rays], RawHit]
NUM_ENV_ARRAYS = 9  # arrays with a leading axis of environments: the house and the fields of `DynamicInstances`
NUM_RAY_FIELDS = 6  # fields of `Rays`


@functools.cache
def flat_cast(backend: str | None, query: RayQuery) -> BatchedCast:
    """Return the cast of a backend and query as a function on rays (e r ...) in environments (e ...) of one geometry.

    `vmap` of the function extends axis e or axis r. Results are cached.
    """
    run = find_backend(backend)

    def cast_whole(geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays) -> RawHit:
        """Cast on one device."""
        return run(geometry, house, moving, rays, query)

    spread = partition_kernel(cast_whole, _leading_axes)

    @custom_vmap
    def cast(geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays) -> RawHit:
        """Cast on all devices of the operands' sharding."""
        return spread(geometry, house, moving, rays)

    @cast.def_vmap
    def fold(size: int, batched: Any, geometry: Geometry, house: Array, moving: DynamicInstances, rays: Rays) -> Any:
        """Cast a batch of `size` as more environments, or as more rays if only rays are batched."""
        geometry_batched, house_batched, moving_batched, rays_batched = batched
        if size == 0:
            hits = _no_hits(cast, tuple(batched), (geometry, house, moving, rays))
        elif _any(geometry_batched):
            hits = _cast_sequentially(run, query, size, tuple(batched), (geometry, house, moving, rays))
        elif _any((house_batched, moving_batched)):
            places = _broadcast(size, (house, moving, rays), (house_batched, moving_batched, rays_batched))
            hits = cast(geometry, *jax.tree.map(_merge, places))
            hits = jax.tree.map(lambda x: x.reshape(size, x.shape[0] // size, *x.shape[1:]), hits)
        else:
            hits = cast(geometry, house, moving, _fold_rays(size, rays, rays_batched))
            hits = jax.tree.map(lambda x: jnp.moveaxis(_split(x, size), 1, 0), hits)
        return hits, jax.tree.map(lambda _: True, hits)

    return cast


def _leading_axes(operands: list[tuple[int, ...]], results: list[tuple[int, ...]]) -> tuple[list[Axes], list[Axes]]:
    """Return the mapped leading axes of operands and of results, by their shapes, for `partition_kernel`.

    Geometry has none, all others `ENV`; results and fields with one value per ray also `RAY`.
    """
    num_rays = results[0][1]
    rays = [(ENV, RAY) if shape[1] == num_rays else (ENV,) for shape in operands[-NUM_RAY_FIELDS:]]
    shared = [()] * (len(operands) - NUM_ENV_ARRAYS - NUM_RAY_FIELDS)
    return [*shared, *[(ENV,)] * NUM_ENV_ARRAYS, *rays], [(ENV, RAY)] * len(results)


def _no_hits(cast: BatchedCast, batched: Any, args: Any) -> RawHit:
    """Return hits (0 e r ...) of an empty `vmap`, without calling a backend; `batched` marks the arrays it maps."""
    one = jax.tree.map(lambda x, b: jax.ShapeDtypeStruct(x.shape[1:] if b else x.shape, x.dtype), args, batched)
    return jax.tree.map(lambda x: jnp.zeros((0, *x.shape), x.dtype), jax.eval_shape(cast, *one))


def _cast_sequentially(run: RayBackend, query: RayQuery, size: int, batched: Any, args: Any) -> RawHit:
    """Return hits (size e r ...) of batch elements with geometries of their own, cast one after another."""

    def one(args: tuple[Geometry, Array, DynamicInstances, Rays]) -> RawHit:
        """Cast one element of the batch."""
        geometry, house, moving, rays = args
        return run(geometry, house, moving, rays, query)

    return jax.lax.map(one, _broadcast(size, args, batched))


def _fold_rays(size: int, rays: Rays, batched: Any) -> Rays:
    """Fold a batch axis into rays: (e r ...), or (size e r ...) of batched fields, to (e size*r ...).

    Fields with one value for all rays and batch elements keep it.
    """
    count = max(x.shape[2 if b else 1] for x, b in zip(jax.tree.leaves(rays), jax.tree.leaves(batched), strict=True))

    def merge(x: Array, is_batched: bool) -> Array:
        """Fold one field."""
        if not is_batched and x.shape[1] == 1:
            return x
        x = x if is_batched else x[None]
        x = jnp.broadcast_to(x, (size, x.shape[1], count, *x.shape[3:]))
        return _merge(jnp.swapaxes(x, 0, 1), 1)

    return jax.tree.map(merge, rays, batched)


def _any(batched: Any) -> bool:
    """Return whether any leaf of the flags is True."""
    return any(jax.tree.leaves(batched))


def _broadcast(size: int, values: Any, batched: Any) -> Any:
    """Give every array a leading axis of `size`: those not marked in `batched` are repeated."""
    return jax.tree.map(lambda x, b: x if b else jnp.broadcast_to(x[None], (size, *x.shape)), values, batched)


def _merge(x: Array, axis: int = 0) -> Array:
    """Return x with an axis and the next one merged into one."""
    return x.reshape(*x.shape[:axis], x.shape[axis] * x.shape[axis + 1], *x.shape[axis + 2 :])


def _split(x: Array, size: int) -> Array:
    """Reshape hits (e size*r ...) to (e size r ...)."""
    return x.reshape(x.shape[0], size, x.shape[1] // size, *x.shape[2:])
