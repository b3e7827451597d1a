"""The lit preset: direct light of the house's lights, shadows, glass, mirrors, specular highlights, filtered textures.

Global illumination would replace `_ambient`; all other terms are direct light.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.look import scale_daylight, scale_lamps, swap_textures, tint_materials
from home_mjx.raycast_render.scene.surface import (
    area_to_world,
    area_vectors,
    material_rows,
    semantics,
    texture_coordinates,
    texture_corners,
)
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take, take_vec
from home_mjx.raycast_render.shaders import lights, texture
from home_mjx.raycast_render.shaders.daytime import sun_redness
from home_mjx.raycast_render.shaders.optics import PathState, trace_specular
from home_mjx.raycast_render.shaders.preset import LitShader
from home_mjx.schema.lighting import MEAN_REFLECTANCE
from home_mjx.schema.semantic import Semantic

WHITE_LUMINANCE = 5.0  # luminance after exposure that is mapped to white
MEAN_LUMINANCE_TARGET = 0.5  # target of the mean luminance after exposure; `tone_map` maps it to 0.34
MIN_METERED_LUMINANCE = 1e-4  # [W/m^2/sr], minimum luminance in auto exposure
ZENITH_COLOR, HORIZON_COLOR, GROUND_COLOR = (
    (0.45, 0.68, 1.0),
    (0.9, 0.96, 1.0),
    (0.2, 0.21, 0.16),
)  # factors of the sky's radiance
DUSK_COLOR = (1.35, 0.72, 0.42)  # factor at the horizon at sunset


class HitFrame(Pytree):
    """Normals of the hit triangle, in the world."""

    area: Vec  # normal facing the ray, with a length of twice the area [m^2]
    shading: Vec  # unit smooth normal, on the same side


def radiance(
    scene: Scene,
    path: PathState,
    footprint_growth: Float[Array, ""],
    light_sample: lights.LightSample,
    options: LitShader,
    exclude: Int[Array, ""] | int = -1,
) -> Vec:
    """Compute the radiance along rays [W/m^2/sr].

    Args:
        scene: Scene of one environment.
        path: Camera rays and their first hits.
        footprint_growth: Increase of the footprint's width per unit of t [m].
        light_sample: Emitting positions on linear lights, rectangular lights and the sun.
        options: Options of the preset.
        exclude: Object id hidden from the camera, except in mirrors.
    """
    path = trace_specular(scene, path, footprint_growth, options.max_specular_depth, exclude)
    row = jnp.maximum(material_rows(scene, path.hit), 0)
    corner = _hit_frame(scene, path)
    point = _shading_point(scene, path, corner, row)
    color = _diffuse_reflectance(scene, path, corner, row, footprint_growth)
    # The barrier prevents recomputation of the surface for every light.
    point, color, row = jax.lax.optimization_barrier((point, color, row))
    placed = lights.place_lights(scene, options)
    got = lights.lamp_light(scene, placed, point, light_sample, options.num_lights)
    if options.sun > 0:
        sun = lights.sun_light(scene, point, light_sample, options)
        got = jax.tree.map(jnp.add, got, sun)
    ambient = _ambient(scene, point, light_sample, options)
    light = color * (got.diffuse + ambient) * (1 / math.pi) + take_vec(scene.bank.finish.specular, row) * got.specular
    above = scale_daylight(scene.appearance, sky_radiance(path.direction, options))
    return path.throughput * select(path.hit.instance < 0, above, light)


def tone_map(light: Vec, exposure: float | Float[Array, ""]) -> Vec:
    """Map light of any strength to linear display light in [0, 1].

    Luminances up to `WHITE_LUMINANCE` fit; colours keep their hue until a channel saturates.

    Source: E. Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002, equation 4.
    """
    light = light * exposure
    luminance = light.dot(Vec(*lights.LUMINANCE))
    return (light * ((1 + luminance / WHITE_LUMINANCE**2) / (1 + luminance))).map(lambda x: jnp.clip(x, 0.0, 1.0))


def auto_exposure(light: Vec) -> Float[Array, ""]:
    """Return the exposure that maps an image's logarithmic mean luminance to `MEAN_LUMINANCE_TARGET`.

    Source: equation 1 of the source of `tone_map`.
    """
    luminance = jnp.maximum(light.dot(Vec(*lights.LUMINANCE)), MIN_METERED_LUMINANCE)
    return MEAN_LUMINANCE_TARGET / jnp.exp(jnp.log(luminance).mean())


def sky_radiance(direction: Vec, options: LitShader) -> Vec:
    """Return the sky's radiance: blue above, bright at the horizon, red there at dusk, bare ground below."""
    up = direction.z * direction.inverse_norm()
    high = jnp.sqrt(jnp.clip(up, 0.0, 1.0))
    horizon = lights.mix_colors(HORIZON_COLOR, DUSK_COLOR, sun_redness(options.sun_elevation))
    above = horizon + (Vec(*ZENITH_COLOR) - horizon) * high
    return select(up >= 0, above, Vec(*GROUND_COLOR)) * options.sky


def _hit_frame(scene: Scene, sight: PathState) -> HitFrame:
    hit = sight.hit
    area = area_vectors(scene, sight.direction, hit)
    a, b, c = (take_vec(scene.bank.finish.normal, jnp.maximum(hit.triangle, 0), k) for k in range(3))
    smooth = area_to_world(scene, a * (1 - hit.u - hit.v) + b * hit.u + c * hit.v, hit)
    side = smooth.dot(area)
    smooth = select(side < 0, -smooth, smooth)
    return HitFrame(area, select(smooth.dot(smooth) > 0, smooth, area).unit())


def _shading_point(scene: Scene, sight: PathState, corner: HitFrame, row: Int[Array, "*rays"]) -> lights.ShadingPoint:
    return lights.ShadingPoint(
        pos=sight.end,
        normal=corner.area.unit(),
        shading=corner.shading,
        view=-sight.direction.unit(),
        shininess=take(scene.bank.finish.shininess, row),
        instance=sight.hit.instance,
        room=semantics(scene, sight.hit, Semantic.ROOM),
    )


def _diffuse_reflectance(
    scene: Scene, sight: PathState, corner: HitFrame, row: Int[Array, "*rays"], growth: Float[Array, ""]
) -> Vec:
    """Return the diffuse reflectance: the material's colour times its texture, filtered over the pixel's footprint."""
    hit, materials, textures = sight.hit, scene.bank.materials, scene.bank.materials.textures
    u, v = texture_corners(scene, hit)
    texels = (u.y - u.x) * (v.z - v.x) - (v.y - v.x) * (u.z - u.x)
    texels = jnp.abs(texels) * texture.texture_edge(textures) ** 2
    inverse = corner.area.inverse_norm()
    facing = jnp.abs(corner.area.dot(sight.direction)) * inverse * sight.direction.inverse_norm()
    width = sight.footprint + growth * jnp.where(hit.instance < 0, 0.0, hit.t)
    footprint = width * width / jnp.maximum(facing, 0.05)
    level = texture.mip_level(footprint * texels * jnp.minimum(inverse, 1e12))
    layer = swap_textures(scene.appearance, take(materials.texture, row), row, materials.texture)
    texel = texture.sample_trilinear(textures, jnp.maximum(layer, 0), *texture_coordinates(scene, hit), level)
    color = tint_materials(scene.appearance, take_vec(materials.albedo, row), row)
    return select(layer < 0, color, color * texel)


def _ambient(scene: Scene, point: lights.ShadingPoint, spread: lights.LightSample, options: LitShader) -> Vec:
    """Return the irradiance by interreflection: uniform within a room, reduced by ambient occlusion."""
    table = scene.bank.lights.ambient
    place = scene.house * table.shape[1] + jnp.clip(point.room + 1, 0, table.shape[1] - 1)
    lamps, daylight = (take_vec(table.reshape(-1, 2, 3), place, source) for source in range(2))
    daylight = daylight * Vec(*lights.SKY_COLOR) * options.sky
    lamps = scale_lamps(scene.appearance, lamps, jnp.bool_(False), point.room)
    daylight = scale_lamps(scene.appearance, daylight, jnp.bool_(True), point.room)
    received = (lamps + daylight) * options.ambient
    if options.ao_radius <= 0 or spread is None:
        return received
    near = occluded(
        scene,
        (point.pos + point.normal * lights.SHADOW_BIAS).pack(),
        _cosine_direction(point.shading, spread).pack(),
        t_max=jnp.where(point.instance < 0, -1.0, options.ao_radius),
    )
    return received * jnp.where(near, MEAN_REFLECTANCE, 1.0)


def _cosine_direction(normal: Vec, spread: Float[Array, "*rays 2"]) -> Vec:
    """Sample cosine-distributed unit directions about the normal: the normal plus a point of the unit sphere."""
    z, turn = 0.999 * spread[..., 0], math.pi * spread[..., 1]
    ring = jnp.sqrt(1 - z * z)
    return (normal + Vec(ring * jnp.cos(turn), ring * jnp.sin(turn), z)).unit()
