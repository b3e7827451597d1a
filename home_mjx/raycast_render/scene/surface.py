"""Surface attributes of hits from the bank's tables: ids, materials, texture coordinates and normals."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.scene.types import DynamicInstances, Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec


def object_ids(scene: Scene, hit: Hit) -> Int[Array, "*rays"]:
    """Return the object ids of hits; I + a for agent a, -1 for the architecture and on a miss."""
    ids = index_by_instance(scene.geometry.instance_object[scene.house], scene.moving, scene.moving.object_id)
    return jnp.where(hit.instance < 0, -1, take(ids, jnp.maximum(hit.instance, 0)))


def material_rows(scene: Scene, hit: Hit) -> Int[Array, "*rays"]:
    """Return the rows of hits in the bank's material table; -1 on a miss."""
    first = index_by_instance(scene.geometry.instance_material[scene.house], scene.moving, scene.moving.material)
    slot = take(scene.geometry.triangle_slot, jnp.maximum(hit.triangle, 0))
    return jnp.where(hit.instance < 0, -1, take(first, jnp.maximum(hit.instance, 0)) + slot)


def semantics(scene: Scene, hit: Hit, column: int) -> Int[Array, "*rays"]:
    """Return values of hits in a column (`schema.semantic.Semantic`) of the semantic table; -1 for none or a miss."""
    first = index_by_instance(scene.geometry.instance_semantic[scene.house], scene.moving, scene.moving.semantic)
    part = take(scene.geometry.triangle_part, jnp.maximum(hit.triangle, 0))
    row = take(first, jnp.maximum(hit.instance, 0)) + part
    return jnp.where(hit.instance < 0, -1, take(scene.bank.semantics, row, int(column)))


def texture_coordinates(scene: Scene, hit: Hit) -> tuple[Float[Array, "*rays"], Float[Array, "*rays"]]:
    """Return texture coordinates u and v of hits, not wrapped; v = 0 is the bottom row. Undefined on a miss."""
    u, v = texture_corners(scene, hit)
    weight = Vec(1 - hit.u - hit.v, hit.u, hit.v)
    return weight.dot(u), weight.dot(v)


def texture_corners(scene: Scene, hit: Hit) -> tuple[Vec, Vec]:
    """Return texture coordinates u, then v, of hit triangles (on a miss: triangle 0); x, y, z are corners 0, 1, 2."""
    triangle, table = jnp.maximum(hit.triangle, 0), scene.geometry.triangle_uv
    u, v = (Vec(*(take(table, triangle, corner, i) for corner in range(3))) for i in range(2))
    return u, v


def face_normals(scene: Scene, direction: Float[Array, "*rays 3"], hit: Hit) -> Float[Array, "*rays 3"]:
    """Return unit geometric normals of the triangles in the world, facing the rays; zero on a miss."""
    return unit_normals(scene, Vec.unpack(direction), hit).pack()


def unit_normals(scene: Scene, direction: Vec, hit: Hit) -> Vec:
    """Return unit geometric normals in the world, facing the rays, zero on a miss: `face_normals` as a `Vec`."""
    area = area_vectors(scene, direction, hit)
    return area * jnp.where(hit.instance < 0, 0.0, area.inverse_norm())


def area_vectors(scene: Scene, direction: Vec, hit: Hit) -> Vec:
    """Return normals in the world, facing the rays, as long as twice the triangle's area [m^2]; arbitrary on a miss.

    Normals perpendicular to their ray keep the side of counter-clockwise corners.
    """
    a, b, c = (take_vec(scene.geometry.triangle, jnp.maximum(hit.triangle, 0), k) for k in range(3))
    area = area_to_world(scene, (b - a).cross(c - a), hit)
    return select(area.dot(direction) > 0, -area, area)


def area_to_world(scene: Scene, local: Vec, hit: Hit) -> Vec:
    """Transform cross products of two model vectors, such as edges, from the frame of the hit model to the world.

    They transform by the transpose of the inverse times |determinant|, as normals do except for their length.
    """
    inverse = index_by_instance(scene.geometry.instance_inverse[scene.house], scene.moving, scene.moving.inverse)
    rows = [Vec.unpack(inverse[:, i, :3]) for i in range(3)]
    volume = 1 / jnp.maximum(jnp.abs(rows[0].dot(rows[1].cross(rows[2]))), 1e-30)
    # The barrier keeps this computation per instance; fusion with later operations would repeat it per pixel.
    rows = jax.lax.optimization_barrier([row * volume for row in rows])
    instance = jnp.maximum(hit.instance, 0)
    x, y, z = (row.map(lambda column: take(column, instance)) for row in rows)
    return x * local.x + y * local.y + z * local.z


def index_by_instance(static: Array, moving: DynamicInstances, moved: Array) -> Array:
    """Return a table by instance: `static` (I rows), D rows of 0; row d of `moved` replaces row `moving.instance[d]`.

    Entries of -1 are skipped.
    """
    size = static.shape[0] + moving.instance.shape[0]
    table = jnp.concatenate([static, jnp.zeros((size - static.shape[0], *static.shape[1:]), static.dtype)])
    return table.at[jnp.where(moving.instance < 0, size, moving.instance)].set(moved, mode="drop")
