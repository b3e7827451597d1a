"""Successive hits along rays, one cast per hit, for backends without a native implementation."""

from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.partition import varying_false
from home_mjx.raycast_render.scene.surface import index_by_instance
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, DynamicInstances, RawHit, RayQuery, Rays


def cast_multi_hit_by_loop(
    cast: Callable[..., RawHit],
    geometry: Geometry,
    house: Int[Array, " e"],
    moving: DynamicInstances,
    rays: Rays,
    query: RayQuery,
) -> RawHit:
    """Return successive hits (e r steps) of rays (e r ...), found with one closest-hit `cast` (`RayBackend`) per step.

    A ray ignores the last object that it hit until it hits another one; at first, its `exclude`. Hits of the
    architecture, which has no id, change nothing in that. Each hit's t is from
    the ray's origin, and all entries from a ray's first miss on are misses. `query` has the number of hits and the
    offset behind each; see `cast_multi_hit`.
    """
    whole, objects = (
        rays.expanded(),
        jax.vmap(index_by_instance)(geometry.instance_object[house], moving, moving.object_id),
    )

    def step(ahead: tuple[Array, Array, Array], _: None) -> tuple[tuple[Array, Array, Array], RawHit]:
        """Return the interval and excluded object of the next cast, and the hits of this one."""
        start, end, exclude = ahead
        hit = cast(geometry, house, moving, rays.replace(t_min=start, t_max=end, exclude=exclude), CLOSEST_HIT)
        met = hit.instance >= 0
        object_id = jnp.take_along_axis(objects, jnp.maximum(hit.instance, 0), axis=1, mode="clip")
        start = jnp.where(met, hit.t + jnp.float32(query.hit_epsilon), start)
        # After its first miss a ray gets an empty interval, which costs nothing.
        return (start, jnp.where(met, end, -jnp.inf), jnp.where(met & (object_id >= 0), object_id, exclude)), hit

    never = varying_false(house, moving, rays)  # makes the loop's carry device-varying under `shard_map`
    start, end, exclude = (jnp.where(never, jnp.zeros_like(x), x) for x in (whole.t_min, whole.t_max, whole.exclude))
    _, hits = jax.lax.scan(step, (start, end, exclude), length=query.num_hits)
    return jax.tree.map(lambda x: jnp.moveaxis(x, 0, 2), hits)
