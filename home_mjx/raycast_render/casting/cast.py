"""Closest and any hits of rays in one environment's scene."""

from typing import Any

import jax
import jax.numpy as jnp
from jax import lax
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Geometry
from home_mjx.core.native.fork_guard import refuse_forked
from home_mjx.raycast_render.casting.flat import flat_cast
from home_mjx.raycast_render.casting.hit_gradient import differentiable
from home_mjx.raycast_render.scene.types import CLOSEST, Hit, Moving, Query, Rays, Scene
from home_mjx.schema.compiled import Ray

Distance = Float[Array, "..."] | float
Id = Int[Array, "..."] | int


def cast(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = Ray.CAMERA,
    executor: str | None = None,
) -> Hit:
    """The closest hits of rays with t_min <= t <= t_max, for any leading shape.

    Triangles are two-sided and the intersection is watertight: no ray slips between triangles that share an edge. t, u
    and v can be differentiated with respect to the rays and to `scene.moving.pose`, as the hit triangle moves; ids
    have no gradient. Batch with `vmap`; everything but `scene.bank` may be batched at no cost.

    Args:
        scene: The environment.
        origin: [m], world; one for all rays is read once, which is quicker.
        direction: World; t counts in units of its length.
        t_min: Start of the part of the ray that counts, >= 0; one value or one per ray.
        t_max: Its end; rays with t_max < t_min hit nothing and cost nothing.
        exclude: Object id that the ray ignores, or I + a for agent a; -1 none.
        mask: `Ray` bits; materials that stop none of them are ignored.
        executor: "xla", "cpu" or "cuda". None takes the scene's; if that is None too, the best one of the platform for
            which the program is compiled.

    Returns:
        The hits, with the leading shape of `origin`.

    Raises:
        ConfigError: There is no such executor.
        ExecutorError: The executor cannot run in this process.

    Example:
        >>> hit = cast(scene, jnp.zeros(3), jnp.array([1.0, 0.0, 0.0]))  # doctest: +SKIP
        >>> hit.t  # doctest: +SKIP
        Array(2.95, dtype=float32)
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared(origin, t_min, t_max, exclude, mask)
    return _hit(scene, rays, _run(scene, rays, shared, executor, CLOSEST))


def occluded(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = Ray.LIGHT,
    executor: str | None = None,
) -> Bool[Array, "*rays"]:
    """Whether anything stops the rays between t_min and t_max; cheaper than `cast`. See there.

    Example:
        >>> offset = lamp - point  # doctest: +SKIP
        >>> lit = ~occluded(scene, point, offset, t_min=1e-3, t_max=1.0)  # doctest: +SKIP
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared(origin, t_min, t_max, exclude, mask)
    _, instance, *_ = _run(scene, rays, shared, executor, Query(any_hit=True))
    return (instance >= 0).reshape(rays.t_min.shape)


def cast_through(
    scene: Scene,
    origin: Float[Array, "*#rays 3"],
    direction: Float[Array, "*#rays 3"],
    steps: int,
    skin: float,
    t_min: Distance = 0.0,
    t_max: Distance = float("inf"),
    exclude: Id = -1,
    mask: Id = Ray.CAMERA,
    executor: str | None = None,
) -> Hit:
    """The hits along rays, one after the other: what `cast` would find if each cast began behind the hit before it.

    Once a ray has met an object, it leaves that one out, and no other, until it meets the next: one hit stands for all
    its faces. The architecture has no such id, so a ray meets both faces of a wall. On a GPU this is one kernel call.
    For use within the package. Gradients are those of `cast`.

    Args:
        scene: The environment.
        origin: [m], world; one for all rays is read once, which is quicker.
        direction: World; t counts in units of its length.
        steps: How many hits, at least 1.
        skin: How far behind a hit, in units of t, the next cast begins.
        t_min: Start of the part of the ray that counts, as in `cast`.
        t_max: Its end.
        exclude: Object id that the ray ignores until it meets another; -1 none.
        mask: `Ray` bits.
        executor: As in `cast`.

    Returns:
        The hits, with the leading shape of `origin` and a last axis of `steps`: from a ray's first miss on all are
        misses.

    Raises:
        ConfigError: There is no such executor.
        ExecutorError: The executor cannot run in this process.

    Example:
        >>> hit = cast_through(scene, eye, ahead, steps=4, skin=1e-4)  # doctest: +SKIP
        >>> hit.t  # doctest: +SKIP
        Array([1.2, 1.3, 2.95, inf], dtype=float32)
    """
    rays = _rays(origin, direction, t_min, t_max, exclude, mask)
    shared = _shared(origin, t_min, t_max, exclude, mask)
    hits = _run(scene, rays, shared, executor, Query(steps=steps, skin=skin))
    each = jax.tree.map(lambda x: jnp.repeat(jnp.expand_dims(x, rays.t_min.ndim), steps, rays.t_min.ndim), rays)
    return _hit(scene, each, hits)


def _hit(scene: Scene, rays: Rays, hits: tuple[Array, ...]) -> Hit:
    """Executors' results, of one hit per ray, with gradients and in the rays' shape."""
    t, instance, triangle, u, v, front = (x.reshape(-1) for x in hits)
    t, u, v = differentiable(scene, rays, instance, triangle, t, u, v)
    t = jnp.where(instance < 0, jnp.inf, t)
    return Hit(*(x.reshape(rays.t_min.shape) for x in (t, instance, triangle, u, v, front)))


def _rays(origin: Array, direction: Array, t_min: Distance, t_max: Distance, exclude: Id, mask: Id) -> Rays:
    shape = jnp.broadcast_shapes(origin.shape, direction.shape)[:-1]

    def fill(value: Any, dtype: Any) -> Array:
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


def _shared(origin: Array, t_min: Distance, t_max: Distance, exclude: Id, mask: Id) -> tuple[str, ...]:
    """Names of the fields with one value for all rays.

    In a fixed order: that of a set of strings differs between processes, and JAX's compile cache would never hit.
    """
    given = {"t_min": t_min, "t_max": t_max, "exclude": exclude, "mask": mask}
    return (*(name for name, x in given.items() if jnp.ndim(x) == 0), *(("origin",) if origin.ndim == 1 else ()))


def _run(scene: Scene, rays: Rays, shared: tuple[str, ...], executor: str | None, query: Query) -> tuple[Array, ...]:
    """Hits of shape (rays,) or (rays, steps); the executor gets one value of each `shared` field: less to read."""
    refuse_forked("cast rays")
    count = rays.t_min.size
    flat = jax.tree.map(lambda x: x.reshape(1, count, *x.shape[rays.t_min.ndim :]), rays)
    flat = flat.replace(**{name: getattr(flat, name)[:, :1] for name in shared})
    house, moving = scene.geometry.known_house(scene.house), _known(scene.geometry, scene.moving)
    args = scene.geometry, house[None], jax.tree.map(lambda x: x[None], moving), flat
    hits = flat_cast(executor or scene.executor, query)(*jax.tree.map(lax.stop_gradient, args))
    return tuple(x[0] for x in hits)


def _known(geometry: Geometry, moving: Moving) -> Moving:
    """What moves, with the nearest models and materials that there are: native code would read past its arrays."""
    models, materials = geometry.model_root.shape[0], geometry.material_mask.shape[0]
    return moving.replace(
        model=jnp.clip(moving.model, 0, models - 1), material=jnp.clip(moving.material, 0, materials - 1)
    )
