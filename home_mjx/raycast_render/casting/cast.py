"""Closest-hit and any-hit ray queries in one environment's scene."""

from typing import Any

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.fork_guard import check_not_forked
from home_mjx.raycast_render.casting.batching import flat_cast
from home_mjx.raycast_render.casting.hit_gradient import attach_gradient
from home_mjx.raycast_render.scene.types import CLOSEST_HIT, DynamicInstances, Hit, RayQuery, Rays, Scene
from home_mjx.schema.compiled import RayKind

Distance = Float[Array, "..."] | float
Id = Int[Array, "..."] | int


def cast(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = RayKind.CAMERA,
    backend: str | None = None,
) -> Hit:
    """Cast rays and return their closest hits with t_min <= t <= t_max, for any leading shape.

    Triangles are two-sided and the intersection is watertight: no ray passes between triangles that share an edge. t, u
    and v are differentiable with respect to the rays and to `scene.moving.pose`, which moves the hit triangle; ids have
    no gradient. Batch with `vmap`; batching anything except `scene.bank` is free.

    Args:
        scene: Scene of one environment.
        origin: [m], world; a single origin for all rays is read once, which is faster.
        direction: World; t is in units of its length.
        t_min: Start of the ray interval, >= 0; one value or one per ray.
        t_max: End of the ray interval; rays with t_max < t_min have no hit and no cost.
        exclude: Object id that the ray ignores, or I + a for agent a; -1 none.
        mask: `RayKind` bits; the ray ignores materials that match none of them.
        backend: "xla", "cpu" or "cuda". None selects the scene's; if that is None too, the fastest one of the platform
            for which the program is compiled.

    Returns:
        The hits, with the leading shape of the rays.

    Raises:
        ConfigError: The backend is unknown.
        BackendError: The backend cannot run in this process.

    Example:
        >>> hit = cast(scene, jnp.zeros(3), jnp.array([1.0, 0.0, 0.0]))  # doctest: +SKIP
        >>> hit.t  # doctest: +SKIP
        Array(2.95, dtype=float32)
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared_fields(origin, t_min, t_max, exclude, mask)
    return _hit(scene, rays, _run(scene, rays, shared, backend, CLOSEST_HIT))


def occluded(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = RayKind.LIGHT,
    backend: str | None = None,
) -> Bool[Array, "*rays"]:
    """Return whether anything blocks the rays in [t_min, t_max]; cheaper than `cast`, same arguments (mask: LIGHT).

    Rays with t_max < t_min are not occluded.

    Example:
        >>> offset = lamp - point  # doctest: +SKIP
        >>> lit = ~occluded(scene, point, offset, t_min=1e-3, t_max=1.0)  # doctest: +SKIP
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared_fields(origin, t_min, t_max, exclude, mask)
    _, instance, *_ = _run(scene, rays, shared, backend, RayQuery(any_hit=True))
    return (instance >= 0).reshape(rays.t_min.shape)


def cast_multi_hit(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    num_hits: int,
    hit_epsilon: float,
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = RayKind.CAMERA,
    backend: str | None = None,
) -> Hit:
    """Return successive hits along rays, each found as if a new cast began behind the hit before it.

    Once a ray has hit an object, it ignores that object until it hits another one, so one hit represents all of its
    faces. The architecture has no object id, so a ray hits both faces of a wall. On a GPU this is one kernel call. For
    internal use. Other arguments, gradients and errors are those of `cast`. `num_hits` is at least 1. A ray goes on
    `hit_epsilon`, in units of t, behind a hit. It ignores `exclude` until it hits another object.

    Returns:
        The hits, with the leading shape of the rays and a last axis of `num_hits`. All entries from a ray's first
        miss on are misses.
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared_fields(origin, t_min, t_max, exclude, mask)
    hits = _run(scene, rays, shared, backend, RayQuery(num_hits=num_hits, hit_epsilon=hit_epsilon))
    each = jax.tree.map(lambda x: jnp.repeat(jnp.expand_dims(x, rays.t_min.ndim), num_hits, rays.t_min.ndim), rays)
    return _hit(scene, each, hits)


def _hit(scene: Scene, rays: Rays, hits: tuple[Array, ...]) -> Hit:
    """Attach gradients to a backend's flat results, one hit per ray, in the rays' shape; t of misses becomes inf."""
    t, instance, triangle, u, v, front = (x.reshape(-1) for x in hits)
    t, u, v = attach_gradient(scene, rays, instance, triangle, t, u, v)
    t = jnp.where(instance < 0, jnp.inf, t)
    return Hit(*(x.reshape(rays.t_min.shape) for x in (t, instance, triangle, u, v, front)))


def _rays(origin: Array, direction: Array, t_min: Distance, t_max: Distance, exclude: Id, mask: Id) -> Rays:
    """Build rays with all fields broadcast to the leading shape of origins and directions, broadcast together.

    The other arguments cannot extend that shape.
    `width` is the last axis of that shape; 0 if it has fewer than two axes.
    """
    shape = jnp.broadcast_shapes(origin.shape, direction.shape)[:-1]

    def fill(value: Any, dtype: Any) -> Array:
        """Broadcast one value, or one per ray, to the leading shape."""
        return jnp.broadcast_to(jnp.asarray(value, dtype), shape)

    return Rays(
        origin=jnp.broadcast_to(origin, (*shape, 3)).astype(jnp.float32),
        direction=jnp.broadcast_to(direction, (*shape, 3)).astype(jnp.float32),
        t_min=fill(t_min, jnp.float32),
        t_max=fill(t_max, jnp.float32),
        exclude=fill(exclude, jnp.int32),
        mask=fill(mask, jnp.int32),
        width=shape[-1] if len(shape) > 1 else 0,
    )


def _shared_fields(origin: Array, t_min: Distance, t_max: Distance, exclude: Id, mask: Id) -> tuple[str, ...]:
    """Return the names of `Rays` fields with one value for all rays: scalars, and an origin of shape (3).

    The order is fixed. The order of a set of strings would differ between processes, and JAX's compilation cache would
    never hit.
    """
    given = {"t_min": t_min, "t_max": t_max, "exclude": exclude, "mask": mask}
    return (*(name for name, x in given.items() if jnp.ndim(x) == 0), *(("origin",) if origin.ndim == 1 else ()))


def _run(scene: Scene, rays: Rays, shared: tuple[str, ...], backend: str | None, query: RayQuery) -> tuple[Array, ...]:
    """Run the backend; return the fields of `RawHit`, of shape (rays,) or (rays, steps), rays being flat.

    The backend gets a single value of each `shared` field, which saves memory traffic.
    """
    check_not_forked("cast rays")
    count = rays.t_min.size
    flat = jax.tree.map(lambda x: x.reshape(1, count, *x.shape[rays.t_min.ndim :]), rays)
    flat = flat.replace(**{name: getattr(flat, name)[:, :1] for name in shared})
    house, moving = scene.geometry.clip_house_index(scene.house), _clip_rows(scene.geometry, scene.moving)
    args = scene.geometry, house[None], jax.tree.map(lambda x: x[None], moving), flat
    hits = flat_cast(backend or scene.backend, query)(*jax.tree.map(lax.stop_gradient, args))
    return tuple(x[0] for x in hits)


def _clip_rows(geometry: Geometry, moving: DynamicInstances) -> DynamicInstances:
    """Clip the models and materials of moving instances to valid rows, since native code does not check bounds."""
    models, materials = geometry.model_root.shape[0], geometry.material_mask.shape[0]
    return moving.replace(
        model=jnp.clip(moving.model, 0, models - 1), material=jnp.clip(moving.material, 0, materials - 1)
    )
