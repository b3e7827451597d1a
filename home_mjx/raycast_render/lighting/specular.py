"""Specular transport of camera rays: through glass and off mirrors."""

from dataclasses import dataclass

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Materials
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.cameras.camera import Camera, Lens, pixel_footprint
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import material_rows, unit_normals
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.schema.compiled import RayKind
from home_mjx.schema.material_kinds import MATERIAL_KINDS

GLASS = MATERIAL_KINDS.index("glass")
HIT_EPSILON = 1e-4  # [m], offset from a surface at which a ray continues


@dataclass(frozen=True)
class CameraRays:
    """One ray per pixel through the same sample point, with its first hit.

    Attributes:
        origin: Origins of the rays [m], world.
        direction: Directions, world; of unit length for some models of `lens` only.
        hit: First hits; `hit.t` is in units of the direction's length.
        camera: Camera that casts the rays.
        lens: Its projection model and resolution.
        sample: Index of the sample; 0 is the pixel's centre.
        exclude: Object id hidden from the camera; -1 none.
    """

    origin: Float[Array, "*image 3"]
    direction: Float[Array, "*image 3"]
    hit: Hit
    camera: Camera
    lens: Lens
    sample: Int[Array, ""] | int
    exclude: Int[Array, ""] | int


class PathState(Pytree):
    """Path state of camera rays: last segment, hit, footprint and throughput."""

    origin: Vec  # [m], of the last segment
    direction: Vec  # of the last segment, with the length of the camera ray's
    hit: Hit
    footprint: Float[Array, "*rays"]  # [m], of the footprint at the origin of the last segment
    throughput: Vec  # throughput of glass and mirrors on the path

    @property
    def end(self) -> Vec:
        """World end of the last segment [m]; its origin on a miss."""
        return self.origin + self.direction * jnp.where(self.hit.instance < 0, 0.0, self.hit.t)


def start_path(rays: CameraRays) -> PathState:
    """Return the path state of camera rays before specular transport: their first hits, throughput 1."""
    width = jnp.full_like(rays.hit.t, pixel_footprint(rays.camera, rays.lens)[0])
    white = Vec(*[jnp.ones_like(width)] * 3)
    return PathState(Vec.unpack(rays.origin), Vec.unpack(rays.direction), rays.hit, width, white)


def trace_specular(
    scene: Scene,
    path: PathState,
    footprint_growth: Float[Array, ""],
    max_specular_depth: int,
    exclude: Int[Array, ""] | int,
) -> PathState:
    """Trace camera rays through at most `max_specular_depth` specular events.

    Behind the first pane or mirror all translucent glass is ignored, so that any number of panes costs one ray.
    From there on only mirrors are events.

    Args:
        scene: Scene of one environment.
        path: Camera rays and their first hits.
        footprint_growth: Increase of the footprint's width per unit of t [m].
        max_specular_depth: Maximum number of casts; 0 returns `path`.
        exclude: Object id hidden from the camera, except in mirrors; -1 none.
    """
    for _ in range(max_specular_depth):
        path = _extend_path(scene, path, footprint_growth, exclude)
    return path


def _extend_path(
    scene: Scene,
    path: PathState,
    growth: Float[Array, ""],
    exclude: Int[Array, ""] | int,
) -> PathState:
    """Cast rays at translucent glass or a mirror one segment on; multiply throughput by its transmittance or colour.

    Other rays are unchanged. The new segment passes all translucent glass, also behind a mirror. From a mirror it does
    not ignore `exclude`. A translucent glass that is a mirror reflects.
    """
    hit, bank = path.hit, scene.bank
    row = jnp.maximum(material_rows(scene, hit), 0)
    seen = hit.instance >= 0
    mirror = seen & take(bank.finish.mirror, row)
    glass = (take(bank.materials.kind, row) == GLASS) & (take(bank.materials.albedo, row, 3) < 1)
    on = mirror | (seen & glass)
    normal = unit_normals(scene, path.direction, hit)
    bent = path.direction - normal * (2 * path.direction.dot(normal))
    direction = select(mirror, bent, path.direction)
    # Offset the origin from a mirror, since float32 rounding may put the hit point behind it.
    pos = select(on, select(mirror, path.end + normal * HIT_EPSILON, path.end), path.origin)
    # The barrier prevents recomputation after the cast.
    pos, direction, on, mirror, row = jax.lax.optimization_barrier((pos, direction, on, mirror, row))
    found = cast(
        scene,
        pos.pack(),
        direction.pack(),
        t_max=jnp.where(on, jnp.inf, -1.0),
        exclude=jnp.where(mirror, -1, exclude),
        mask=int(RayKind.LIGHT),
    )
    tint = select(mirror, take_vec(bank.materials.albedo, row), _transmittance(bank.materials, row))
    return PathState(
        origin=pos,
        direction=direction,
        hit=jax.tree.map(lambda new, old: jnp.where(on, new, old), found, hit),
        footprint=path.footprint + growth * jnp.where(on, hit.t, 0.0),
        throughput=select(on, path.throughput * tint, path.throughput),
    )


def _transmittance(materials: Materials, row: Int[Array, "*rays"]) -> Vec:
    """Return the transmittance of glass by row: 1 - opacity * (1 - colour), so 1 if clear, its colour if opaque."""
    opacity = take(materials.albedo, row, 3)
    return take_vec(materials.albedo, row).map(lambda color: 1 - opacity * (1 - color))
