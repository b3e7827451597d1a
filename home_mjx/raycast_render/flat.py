"""The primitive beneath `cast`: rays as (environments, rays per environment), any nesting of `vmap` folded in."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap, sequential_vmap
from jaxtyping import Array

from home_mjx.raycast_render.executors import find_executor
from home_mjx.raycast_render.types import Moving, Rays
from home_mjx.raycast_render.xla import RawHit
from home_mjx.scene_compile.bank import Geometry

Flat = Callable[[Geometry, Array, Moving, Rays], RawHit]


@functools.cache
def flat_cast(executor: str | None, any_hit: bool) -> Flat:
    """Casts rays (e r ...) in environments (e ...) that share one geometry; `vmap` adds to e or to r."""
    run = find_executor(executor)

    @custom_vmap
    def cast(geometry: Geometry, house: Array, moving: Moving, rays: Rays) -> RawHit:
        return run(geometry, house, moving, rays, any_hit)

    @cast.def_vmap
    def fold(size: int, batched: Any, geometry: Geometry, house: Array, moving: Moving, rays: Rays) -> Any:
        geometry_batched, house_batched, moving_batched, rays_batched = batched
        rays = _broadcast(size, rays, rays_batched)
        if _any(geometry_batched):
            each = sequential_vmap(lambda *args: run(*args, any_hit))
            args = geometry, house, moving, rays
            axes = jax.tree.map(lambda b: 0 if b else None, (*batched[:3], jax.tree.map(lambda _: True, rays_batched)))
            return jax.vmap(each, axes)(*args), (True,) * 6
        if _any((house_batched, moving_batched)):
            house, moving = _broadcast(size, (house, moving), (house_batched, moving_batched))
            hits = cast(geometry, *jax.tree.map(_merge, (house, moving, rays)))
            return jax.tree.map(lambda x: x.reshape(size, -1, *x.shape[1:]), hits), (True,) * 6
        hits = cast(geometry, house, moving, jax.tree.map(lambda x: _merge(jnp.swapaxes(x, 0, 1), 1), rays))
        return jax.tree.map(lambda x: jnp.swapaxes(x.reshape(x.shape[0], size, -1), 0, 1), hits), (True,) * 6

    return cast


def _any(batched: Any) -> bool:
    return any(jax.tree.leaves(batched))


def _broadcast(size: int, values: Any, batched: Any) -> Any:
    return jax.tree.map(lambda x, b: x if b else jnp.broadcast_to(x[None], (size, *x.shape)), values, batched)


def _merge(x: Array, axis: int = 0) -> Array:
    """Merges an axis with the next one."""
    return x.reshape(*x.shape[:axis], x.shape[axis] * x.shape[axis + 1], *x.shape[axis + 2 :])
