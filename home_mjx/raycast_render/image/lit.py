"""The lit preset: the lights of the house, shadows, glass, mirrors, gloss, and textures without sparkle.

Global illumination would replace `_ambient`: all else is light that comes straight from lights.
"""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.cast import occluded
from home_mjx.raycast_render.image import lights, texture
from home_mjx.raycast_render.image.optics import Sight, follow
from home_mjx.raycast_render.image.preset import Lit
from home_mjx.raycast_render.surface import by_instance, material_rows, semantics, texture_coordinates
from home_mjx.raycast_render.types import Hit, Scene
from home_mjx.scene_compile.bank import HouseBank
from home_mjx.scene_compile.compiled import Semantic
from home_mjx.scene_compile.lights import REFLECTANCE
from home_mjx.scene_compile.pytree import Pytree

WHITE = 5.0  # luminance that becomes white
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
ZENITH, HORIZON, GROUND = (0.45, 0.68, 1.0), (0.9, 0.96, 1.0), (0.2, 0.21, 0.16)  # of the sky's radiance


class Corner(Pytree):
    """The triangle that was hit, in the world."""

    area: Float[Array, "*rays 3"]  # normal facing the ray, as long as twice the area [m^2]
    shading: Float[Array, "*rays 3"]  # unit smooth normal, on the same side


def radiance(
    bank: HouseBank,
    scene: Scene,
    sight: Sight,
    growth: Float[Array, ""],
    spread: Float[Array, "*rays 2"],
    options: Lit,
    exclude: Int[Array, ""] | int = -1,
    executor: str | None = None,
) -> Float[Array, "*rays 3"]:
    """Light that comes along rays [W/m^2/sr].

    Args:
        bank: The houses.
        scene: The environment.
        sight: Camera rays and what they hit first.
        growth: Of the footprint's width per unit of t [m].
        spread: Where on lines, rectangles and the sun light comes from, -1..1.
        options: Of the preset.
        exclude: Object id that the camera does not see, except in mirrors.
        executor: See `cast`.
    """
    sight = follow(bank, scene, sight, growth, options.bounces, exclude, executor)
    hit = sight.hit
    corner = _corner(bank, scene, sight.direction, hit)
    row = jnp.maximum(material_rows(scene, hit), 0)
    point = _point(bank, scene, sight, corner, row)
    placed = lights.place_lights(bank, scene, options)
    got = lights.lamp_light(scene, placed, point, spread, options.num_lights, executor)
    if options.sun > 0:
        sun = lights.sun_light(scene, point, spread, options, executor)
        got = jax.tree.map(jnp.add, got, sun)
    ambient = _ambient(bank, scene, point, spread, options, executor)
    color = _color(bank, scene, sight, corner, row, growth)
    color, row, got = jax.lax.optimization_barrier((color, row, got))
    light = color * (got.diffuse + ambient) / math.pi + bank.finish.specular[row] * got.specular
    return sight.tint * jnp.where(hit.instance[..., None] < 0, sky(sight.direction, options), light)


def tone_map(light: Float[Array, "*rays 3"], exposure: float) -> Float[Array, "*rays 3"]:
    """Linear light for a display, 0..1, from light of any strength.

    Luminances up to `WHITE` fit; colours keep their hue until they reach it.

    Source: E. Reinhard et al., "Photographic tone reproduction for digital images", SIGGRAPH 2002, equation 4.
    """
    light = light * exposure
    luminance = jnp.sum(light * jnp.broadcast_to(jnp.array(LUMINANCE, jnp.float32), light.shape), axis=-1)
    scale = (1 + luminance / WHITE**2) / (1 + luminance)
    return jnp.clip(light * scale[..., None], 0.0, 1.0)


def sky(direction: Float[Array, "*rays 3"], options: Lit) -> Float[Array, "*rays 3"]:
    """Radiance where rays hit nothing: blue above, bright at the horizon, bare ground below."""
    up = direction[..., 2:] / jnp.maximum(jnp.linalg.norm(direction, axis=-1, keepdims=True), 1e-9)
    zenith, horizon, ground = (
        jnp.broadcast_to(jnp.array(c, jnp.float32), direction.shape) for c in (ZENITH, HORIZON, GROUND)
    )
    high = jnp.sqrt(jnp.clip(up, 0.0, 1.0))
    return options.sky * jnp.where(up >= 0, horizon + high * (zenith - horizon), ground)


def _corner(bank: HouseBank, scene: Scene, direction: Float[Array, "*rays 3"], hit: Hit) -> Corner:
    triangle = scene.geometry.triangle[jnp.maximum(hit.triangle, 0)]
    edges = jnp.cross(triangle[..., 1, :] - triangle[..., 0, :], triangle[..., 2, :] - triangle[..., 0, :])
    weight = jnp.stack([1 - hit.u - hit.v, hit.u, hit.v], axis=-1)
    corners = bank.finish.normal[jnp.maximum(hit.triangle, 0)]
    pose = by_instance(scene.geometry.instance_pose[scene.house], scene.moving, scene.moving.pose)
    inverse = by_instance(scene.geometry.instance_inverse[scene.house], scene.moving, scene.moving.inverse)
    scale = jnp.abs(jnp.linalg.det(pose[..., :3]))
    instance = jnp.maximum(hit.instance, 0)
    rows, corners, edges = jax.lax.optimization_barrier((inverse[instance][..., :3], corners, edges))
    smooth = jnp.sum(weight[..., None] * corners, axis=-2)
    # A normal transforms by the transpose of the inverse; with the determinant its length is the area.
    area = jnp.sum(rows * edges[..., :, None], axis=-2) * scale[instance][..., None]
    smooth = jnp.sum(rows * smooth[..., :, None], axis=-2)
    area, smooth = jax.lax.optimization_barrier((area, smooth))
    area = jnp.where(jnp.sum(area * direction, axis=-1, keepdims=True) > 0, -area, area)
    smooth = jnp.where(jnp.sum(smooth * area, axis=-1, keepdims=True) < 0, -smooth, smooth)
    flat = _unit(area)
    return Corner(area, jnp.where(jnp.sum(smooth * smooth, axis=-1, keepdims=True) > 0, _unit(smooth), flat))


def _point(bank: HouseBank, scene: Scene, sight: Sight, corner: Corner, row: Int[Array, "*rays"]) -> lights.Point:
    hit = sight.hit
    t = jnp.where(hit.instance < 0, 0.0, hit.t)
    point = lights.Point(
        pos=sight.origin + t[..., None] * sight.direction,
        normal=_unit(corner.area),
        shading=corner.shading,
        view=-_unit(sight.direction),
        shininess=bank.finish.shininess[row],
        instance=hit.instance,
        room=semantics(bank, scene, hit, Semantic.ROOM),
    )
    return jax.lax.optimization_barrier(point)


def _color(
    bank: HouseBank,
    scene: Scene,
    sight: Sight,
    corner: Corner,
    row: Int[Array, "*rays"],
    growth: Float[Array, ""],
) -> Float[Array, "*rays 3"]:
    """Diffuse reflectance: the material's colour times its texture, filtered over the pixel's footprint."""
    hit = sight.hit
    uv = scene.geometry.triangle_uv[jnp.maximum(hit.triangle, 0)]
    a, b = uv[..., 1, :] - uv[..., 0, :], uv[..., 2, :] - uv[..., 0, :]
    textures = bank.materials.textures
    texels = jnp.abs(a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]) * texture.edge_of(textures) ** 2
    area = jnp.maximum(jnp.linalg.norm(corner.area, axis=-1), 1e-12)
    facing = jnp.abs(jnp.sum(_unit(corner.area) * _unit(sight.direction), axis=-1))
    width = sight.width + growth * jnp.where(hit.instance < 0, 0.0, hit.t)
    footprint = width * width / jnp.maximum(facing, 0.05)
    level = texture.mip_level(footprint * texels / area)
    layer = bank.materials.texture[row]
    texel = texture.trilinear(textures, jnp.maximum(layer, 0), texture_coordinates(scene, hit), level)
    return bank.materials.albedo[row][..., :3] * jnp.where(layer[..., None] < 0, 1.0, texel)


def _ambient(
    bank: HouseBank,
    scene: Scene,
    point: lights.Point,
    spread: Float[Array, "*rays 2"],
    options: Lit,
    executor: str | None,
) -> Float[Array, "*rays 3"]:
    """Irradiance by what surfaces reflect on each other: alike in all of a room, less in corners."""
    table = bank.lights.ambient[scene.house]
    daylight = options.sky * jnp.array(lights.DAYLIGHT, jnp.float32)
    level = table[:, 0] + table[:, 1] * jnp.broadcast_to(daylight, table[:, 1].shape)
    received = options.ambient * level[jnp.clip(point.room + 1, 0, table.shape[0] - 1)]
    if options.corners <= 0:
        return received
    near = occluded(
        scene,
        point.pos + lights.OFFSET * point.normal,
        _cosine_direction(point.shading, spread),
        t_max=jnp.where(point.instance < 0, -1.0, options.corners),
        executor=executor,
    )
    return received * jnp.where(near, REFLECTANCE, 1.0)[..., None]


def _cosine_direction(normal: Float[Array, "*rays 3"], spread: Float[Array, "*rays 2"]) -> Float[Array, "*rays 3"]:
    """Unit directions about the normal, as dense as the cosine: the normal plus a point of the unit sphere."""
    z, turn = 0.999 * spread[..., 0], math.pi * spread[..., 1]
    ring = jnp.sqrt(1 - z * z)
    return _unit(normal + jnp.stack([ring * jnp.cos(turn), ring * jnp.sin(turn), z], axis=-1))


def _unit(vectors: Float[Array, "*rays 3"]) -> Float[Array, "*rays 3"]:
    return vectors / jnp.maximum(jnp.linalg.norm(vectors, axis=-1, keepdims=True), 1e-20)
