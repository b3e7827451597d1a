"""Rays that go on: through glass and the gaps of leaves, and off mirrors."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Materials
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import material_rows, texture_coordinates, unit_normals
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.raycast_render.shaders import texture
from home_mjx.schema.compiled import Ray
from home_mjx.schema.material_kinds import MATERIAL_KINDS

GLASS = MATERIAL_KINDS.index("glass")
CUT = 128  # texels of less opacity are holes
PAST = 1e-4  # [m] beyond a surface, where a ray goes on


class Sight(Pytree):
    """What pixels see at the end of their rays."""

    origin: Vec  # of the last stretch
    direction: Vec  # as long as the camera's
    hit: Hit
    width: Float[Array, "*rays"]  # of the footprint where the last stretch starts [m]
    tint: Vec  # what glass and mirrors on the way leave of the light

    @property
    def end(self) -> Vec:
        """Where the rays end [m]; their origin if they meet nothing."""
        return self.origin + self.direction * jnp.where(self.hit.instance < 0, 0.0, self.hit.t)


def follow(
    scene: Scene,
    sight: Sight,
    growth: Float[Array, ""],
    bounces: int,
    exclude: Int[Array, ""] | int,
) -> Sight:
    """Where rays end that may go on `bounces` times.

    Behind the first pane no more glass is seen, so that both faces of a pane, or of many, cost one ray.

    Args:
        scene: The environment.
        sight: First hits.
        growth: Of the footprint's width per unit of t [m].
        bounces: Casts at most.
        exclude: Object id that the camera does not see, except in mirrors.
    """
    for _ in range(bounces):
        sight = _go_on(scene, sight, growth, exclude)
    return sight


def _go_on(
    scene: Scene,
    sight: Sight,
    growth: Float[Array, ""],
    exclude: Int[Array, ""] | int,
) -> Sight:
    hit, bank = sight.hit, scene.bank
    row = jnp.maximum(material_rows(scene, hit), 0)
    seen = hit.instance >= 0
    mirror = seen & take(bank.finish.mirror, row)
    hole = seen & ~mirror & _holes(scene, hit, row)
    glass = (take(bank.materials.kind, row) == GLASS) & (take(bank.materials.albedo, row, 3) < 1)
    on = mirror | hole | (seen & glass)
    normal = unit_normals(scene, sight.direction, hit)
    bent = sight.direction - normal * (2 * sight.direction.dot(normal))
    direction = select(mirror, bent, sight.direction)
    # A mirror has no thickness to get past, but float32 may put the point behind it.
    pos = select(on, select(mirror, sight.end + normal * PAST, sight.end), sight.origin)
    # The barrier keeps what is known before the cast from being computed again after it.
    pos, direction, on, hole, mirror, row = jax.lax.optimization_barrier((pos, direction, on, hole, mirror, row))
    found = cast(
        scene,
        pos.packed(),
        direction.packed(),
        t_min=jnp.where(hole, PAST * direction.inverse_norm(), 0.0),
        t_max=jnp.where(on, jnp.inf, -1.0),
        exclude=jnp.where(mirror, -1, exclude),
        mask=jnp.where(hole, int(Ray.CAMERA), int(Ray.LIGHT)),
    )
    tint = select(mirror, take_vec(bank.materials.albedo, row), _through(bank.materials, row))
    return Sight(
        origin=pos,
        direction=direction,
        hit=jax.tree.map(lambda new, old: jnp.where(on, new, old), found, hit),
        width=sight.width + growth * jnp.where(on, hit.t, 0.0),
        tint=select(on & ~hole, sight.tint * tint, sight.tint),
    )


def _through(materials: Materials, row: Int[Array, "*rays"]) -> Vec:
    """What glass leaves of the light: clear glass all, coloured glass most of its own colour."""
    opacity = take(materials.albedo, row, 3)
    return take_vec(materials.albedo, row).map(lambda color: 1 - opacity * (1 - color))


def _holes(scene: Scene, hit: Hit, row: Int[Array, "*rays"]) -> Bool[Array, "*rays"]:
    """Whether rays have met a texture where it is cut out."""
    materials = scene.bank.materials
    layer = take(materials.texture, row)
    texel = texture.nearest(materials.textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit))
    return (layer >= 0) & (texture.channel(texel, texture.ALPHA) < CUT)
