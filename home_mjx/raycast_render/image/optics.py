"""Rays that go on: through glass and the gaps of leaves, and off mirrors."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.raycast_render.cast import cast
from home_mjx.raycast_render.image import texture
from home_mjx.raycast_render.surface import material_rows, normals, texture_coordinates
from home_mjx.raycast_render.types import Hit, Scene
from home_mjx.scene_compile.bank import HouseBank
from home_mjx.scene_compile.compiled import Ray
from home_mjx.scene_compile.material_kinds import MATERIAL_KINDS
from home_mjx.scene_compile.pytree import Pytree

GLASS = MATERIAL_KINDS.index("glass")
CUT = 128  # texels of less opacity are holes
PAST = 1e-4  # [m] beyond a surface, where a ray goes on


class Sight(Pytree):
    """What pixels see at the end of their rays."""

    origin: Float[Array, "*rays 3"]  # of the last stretch
    direction: Float[Array, "*rays 3"]  # as long as the camera's
    hit: Hit
    width: Float[Array, "*rays"]  # of the footprint where the last stretch starts [m]
    tint: Float[Array, "*rays 3"]  # what glass and mirrors on the way leave of the light


def follow(
    bank: HouseBank,
    scene: Scene,
    sight: Sight,
    growth: Float[Array, ""],
    bounces: int,
    exclude: Int[Array, ""] | int,
    executor: str | None = None,
) -> Sight:
    """Where rays end that may go on `bounces` times.

    Behind the first pane no more glass is seen, so that both faces of a pane, or of many, cost one ray.

    Args:
        bank: The houses.
        scene: The environment.
        sight: First hits.
        growth: Of the footprint's width per unit of t [m].
        bounces: Casts at most.
        exclude: Object id that the camera does not see, except in mirrors.
        executor: See `cast`.
    """
    for _ in range(bounces):
        sight = _go_on(bank, scene, sight, growth, exclude, executor)
    return sight


def _go_on(
    bank: HouseBank,
    scene: Scene,
    sight: Sight,
    growth: Float[Array, ""],
    exclude: Int[Array, ""] | int,
    executor: str | None,
) -> Sight:
    hit = sight.hit
    row = jnp.maximum(material_rows(scene, hit), 0)
    seen = hit.instance >= 0
    mirror = seen & bank.finish.mirror[row]
    hole = seen & ~mirror & _holes(bank, scene, hit, row)
    glass = seen & ~mirror & ~hole & (bank.materials.kind[row] == GLASS) & (bank.materials.albedo[row][..., 3] < 1)
    on = mirror | hole | glass
    t = jnp.where(on, hit.t, 0.0)
    length = jnp.linalg.norm(sight.direction, axis=-1)
    normal = normals(scene, sight.direction, hit)
    bent = sight.direction - 2 * jnp.sum(sight.direction * normal, axis=-1, keepdims=True) * normal
    direction = jnp.where(mirror[..., None], bent, sight.direction)
    pos = sight.origin + t[..., None] * sight.direction
    # A mirror has no thickness to get past, but float32 may put the point behind it.
    pos = jnp.where(mirror[..., None], pos + PAST * normal, pos)
    pos, direction, on = jax.lax.optimization_barrier((pos, direction, on))
    found = cast(
        scene,
        pos,
        direction,
        t_min=jnp.where(hole, PAST / length, 0.0),
        t_max=jnp.where(on, jnp.inf, -1.0),
        exclude=jnp.where(mirror, -1, exclude),
        mask=jnp.where(hole, int(Ray.CAMERA), int(Ray.LIGHT)),
        executor=executor,
    )
    tint = jnp.where(mirror[..., None], bank.materials.albedo[row][..., :3], _through(bank, row))
    return Sight(
        origin=jnp.where(on[..., None], pos, sight.origin),
        direction=direction,
        hit=jax.tree.map(lambda new, old: jnp.where(on, new, old), found, hit),
        width=sight.width + t * growth,
        tint=jnp.where((on & ~hole)[..., None], sight.tint * tint, sight.tint),
    )


def _through(bank: HouseBank, row: Int[Array, "*rays"]) -> Float[Array, "*rays 3"]:
    """What glass leaves of the light: clear glass all, coloured glass most of its own colour."""
    color = bank.materials.albedo[row]
    return 1 - color[..., 3:] * (1 - color[..., :3])


def _holes(bank: HouseBank, scene: Scene, hit: Hit, row: Int[Array, "*rays"]) -> Bool[Array, "*rays"]:
    """Whether rays have met a texture where it is cut out."""
    layer = bank.materials.texture[row]
    texel = texture.nearest(bank.materials.textures, jnp.maximum(layer, 0), texture_coordinates(scene, hit))
    return (layer >= 0) & (texel[..., 3] < CUT)
