"""From a hit to what it means: model triangle, instance and the bank's tables."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.types import Hit, Moving, Scene
from home_mjx.scene_compile.bank import HouseBank


def object_ids(scene: Scene, hit: Hit) -> Int[Array, "*rays"]:
    """Object ids; -1 for the architecture and on a miss."""
    ids = by_instance(scene.geometry.instance_object[scene.house], scene.moving, scene.moving.object_id)
    return jnp.where(hit.instance < 0, -1, ids[jnp.maximum(hit.instance, 0)])


def material_rows(scene: Scene, hit: Hit) -> Int[Array, "*rays"]:
    """Rows in the bank's material table; -1 on a miss."""
    first = by_instance(scene.geometry.instance_material[scene.house], scene.moving, scene.moving.material)
    rows = first[jnp.maximum(hit.instance, 0)] + scene.geometry.triangle_slot[jnp.maximum(hit.triangle, 0)]
    return jnp.where(hit.instance < 0, -1, rows)


def semantics(bank: HouseBank, scene: Scene, hit: Hit, column: int) -> Int[Array, "*rays"]:
    """A column of the semantic table (`compiled.Semantic`); -1 on a miss."""
    first = by_instance(scene.geometry.instance_semantic[scene.house], scene.moving, scene.moving.semantic)
    rows = first[jnp.maximum(hit.instance, 0)] + scene.geometry.triangle_part[jnp.maximum(hit.triangle, 0)]
    return jnp.where(hit.instance < 0, -1, bank.semantics[:, column][rows])


def texture_coordinates(scene: Scene, hit: Hit) -> Float[Array, "*rays 2"]:
    """Texture coordinates; v = 0 is the bottom row. Meaningless on a miss."""
    corner = scene.geometry.triangle_uv[jnp.maximum(hit.triangle, 0)]
    weight = jnp.stack([1 - hit.u - hit.v, hit.u, hit.v], axis=-1)
    return jnp.sum(weight[..., None] * corner, axis=-2)


def normals(scene: Scene, direction: Float[Array, "*rays 3"], hit: Hit) -> Float[Array, "*rays 3"]:
    """Unit normals of the flat triangles in the world, turned against the rays; zero on a miss."""
    triangle = scene.geometry.triangle[jnp.maximum(hit.triangle, 0)]
    local = jnp.cross(triangle[..., 1, :] - triangle[..., 0, :], triangle[..., 2, :] - triangle[..., 0, :])
    inverse = by_instance(scene.geometry.instance_inverse[scene.house], scene.moving, scene.moving.inverse)
    # A normal transforms by the transpose of the inverse.
    rows = inverse[jnp.maximum(hit.instance, 0)][..., :3]
    # Without barriers XLA gathers and crosses again for each component of what follows.
    local, rows = jax.lax.optimization_barrier((local, rows))
    world = jax.lax.optimization_barrier(jnp.sum(rows * local[..., :, None], axis=-2))
    world = jnp.where(jnp.sum(world * direction, axis=-1, keepdims=True) > 0, -world, world)
    length = jnp.linalg.norm(world, axis=-1, keepdims=True)
    return jnp.where(hit.instance[..., None] < 0, 0, world / jnp.maximum(length, 1e-30))


def by_instance(static: Array, moving: Moving, moved: Array) -> Array:
    """A table over all instance numbers of one environment: the house's, then the agents'."""
    size = static.shape[0] + moving.instance.shape[0]
    table = jnp.concatenate([static, jnp.zeros((size - static.shape[0], *static.shape[1:]), static.dtype)])
    return table.at[jnp.where(moving.instance < 0, size, moving.instance)].set(moved, mode="drop")
