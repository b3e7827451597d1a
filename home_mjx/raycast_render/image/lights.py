"""Light that reaches points from the lights of a house."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.raycast_render.cast import occluded
from home_mjx.raycast_render.image.preset import Lit
from home_mjx.raycast_render.surface import by_instance
from home_mjx.raycast_render.types import Scene
from home_mjx.scene_compile.bank import HouseBank
from home_mjx.scene_compile.compiled import ARCHITECTURE
from home_mjx.scene_compile.pytree import Pytree

OFFSET = 5e-4  # [m] above the surface, where rays to lights start
GAP = 0.05  # [m] before the light, where they end: bulbs may be sunk into ceilings
ELSEWHERE = 0.1  # weight of lights in other rooms when lights are chosen
SHADE = 0.6  # [m], least distance of a lamp's own surfaces from its light
DAYLIGHT = (0.85, 0.93, 1.0)  # colour of the sky's light
SUNLIGHT = (1.0, 0.93, 0.82)
INDEX_BITS = 10  # of a choice's key; the lights of a house are fewer than 2**10


class Placed(Pytree):
    """The lights of one environment in the world, as rows, for one gather: see `_COLUMNS`."""

    row: Float[Array, "l 18"]
    instance: Int[Array, " l"]
    object_id: Int[Array, " l"]
    room: Int[Array, " l"]


class Point(Pytree):
    """Where light is wanted, for rays of any shape."""

    pos: Float[Array, "*rays 3"]  # [m]
    normal: Float[Array, "*rays 3"]  # unit, of the triangle, facing the ray
    shading: Float[Array, "*rays 3"]  # unit, smooth
    view: Float[Array, "*rays 3"]  # unit, to where it is seen from
    shininess: Float[Array, "*rays"]
    instance: Int[Array, "*rays"]  # -1: nothing there
    room: Int[Array, "*rays"]


class Received(Pytree):
    """Light at points."""

    diffuse: Float[Array, "*rays 3"]  # irradiance [W/m^2]
    specular: Float[Array, "*rays 3"]  # radiance of the gloss, for a specular reflectance of 1 [W/m^2/sr]


def place_lights(bank: HouseBank, scene: Scene, options: Lit) -> Placed:
    """The lights of the environment's house; those of lamps that were moved stand where the lamps are."""
    lights, house, geometry = bank.lights, scene.house, scene.geometry
    instance = lights.instance[house]
    carrier = jnp.maximum(instance, 0)
    pose = by_instance(geometry.instance_pose[house], scene.moving, scene.moving.pose)[carrier]
    linear = pose[..., :3]

    def turned(vectors: Float[Array, "l 3"]) -> Float[Array, "l 3"]:
        return jnp.sum(linear * vectors[:, None, :], axis=-1)

    aim = turned(lights.direction[house])
    aim = aim / jnp.maximum(jnp.linalg.norm(aim, axis=-1, keepdims=True), 1e-9)
    sky = jnp.where(lights.daylight[house], options.sky, 1.0)[:, None]
    tint = jnp.where(lights.daylight[house][:, None], jnp.array([DAYLIGHT], jnp.float32), 1.0)
    numbers = jnp.stack([lights.exponent[house], lights.cutoff[house], lights.area[house]], axis=-1)
    columns = [
        turned(lights.pos[house]) + pose[..., 3],
        turned(lights.axis_u[house]),
        turned(lights.axis_v[house]),
        aim,
        lights.intensity[house] * sky * tint,
        numbers,
    ]
    objects = by_instance(geometry.instance_object[house], scene.moving, scene.moving.object_id)[carrier]
    return Placed(jnp.concatenate(columns, axis=-1), instance, objects, lights.room[house])


def lamp_light(
    scene: Scene,
    lights: Placed,
    point: Point,
    spread: Float[Array, "*rays 2"],
    count: int,
    executor: str | None = None,
) -> Received:
    """Light of the most important lights of each point, as far as nothing stands between.

    Args:
        scene: The environment.
        lights: Its lights.
        point: Where.
        spread: Where on lines and rectangles light comes from, -1..1 along each axis.
        count: Lights per point.
        executor: See `cast`.
    """
    key = choose(lights, point, count)
    chosen = key & (2**INDEX_BITS - 1)
    row = lights.row[chosen]
    row, chosen, key = jax.lax.optimization_barrier((row, chosen, key))
    axis = point.instance.ndim
    at = jax.tree.map(
        lambda x: jnp.broadcast_to(jnp.expand_dims(x, axis), (*chosen.shape, *x.shape[axis:])),
        point,
    )
    source = row[..., 0:3] + spread[..., None, :1] * row[..., 3:6] + spread[..., None, 1:] * row[..., 6:9]
    offset = source - at.pos
    own = _is_own(lights.instance[chosen], at.instance, row[..., 17])
    light, toward = _unshadowed(row, offset, at, own)
    active = (key >> INDEX_BITS > 0) & jnp.any(light > 0, axis=-1)
    start = at.pos + OFFSET * at.normal
    way = source - start
    length = jnp.linalg.norm(way, axis=-1)
    reach = jnp.where(active & ~own, 1 - GAP / jnp.maximum(length, GAP), -1.0)
    blocked = occluded(scene, start, way, t_max=reach, exclude=lights.object_id[chosen], executor=executor)
    light = jnp.where((active & ~blocked)[..., None], light, 0.0)
    gloss = blinn_phong(at, toward)[..., None]
    return Received(jnp.sum(light, axis=-2), jnp.sum(light * gloss, axis=-2))


def choose(lights: Placed, point: Point, count: int) -> Int[Array, "*rays k"]:
    """The lights that would give a point the most light, the brightest first.

    Returns:
        Keys whose lowest `INDEX_BITS` are the light; what is above is 0 where there are no more lights.
    """
    row = lights.row

    def column(i: int) -> Float[Array, "..."]:
        return row[:, i].reshape((1,) * point.instance.ndim + (-1,))

    offset = [column(i) - point.pos[..., i, None] for i in range(3)]
    square = sum(x * x for x in offset)
    facing = sum(x * point.shading[..., i, None] for i, x in enumerate(offset))
    leaving = -sum(x * column(9 + i) for i, x in enumerate(offset))
    inverse = jax.lax.rsqrt(jnp.maximum(square, 1e-4))
    power = 0.2126 * column(12) + 0.7152 * column(13) + 0.0722 * column(14)
    strength = power * _profile(leaving * inverse, column(15), column(16)) * jnp.maximum(facing * inverse, 0.0)
    strength = strength / (square + column(17) / math.pi)
    rooms = lights.room.reshape((1,) * point.instance.ndim + (-1,))
    here = (rooms == point.room[..., None]) | (point.room[..., None] < 0)
    carriers = lights.instance.reshape(rooms.shape)
    own = _is_own(carriers, point.instance[..., None], column(17))
    strength = jnp.where(own, power / SHADE**2, jnp.where(here, strength, ELSEWHERE * strength))
    strength = jnp.where(carriers >= 0, strength, 0.0)
    bits = jax.lax.bitcast_convert_type(strength, jnp.int32) >> INDEX_BITS
    number = jnp.arange(row.shape[0], dtype=jnp.int32).reshape(rooms.shape)
    keys = (bits << INDEX_BITS) | number
    found = [jnp.max(keys, axis=-1)]
    for _ in range(min(count, row.shape[0]) - 1):
        found.append(jnp.max(jnp.where(keys < found[-1][..., None], keys, 0), axis=-1))
    return jnp.stack(found, axis=-1)


def sun_light(
    scene: Scene, point: Point, spread: Float[Array, "*rays 2"], options: Lit, executor: str | None = None
) -> Received:
    """Light of the sun, where it is seen; its disc is a degree wide."""
    azimuth, elevation = math.radians(options.sun_azimuth), math.radians(options.sun_elevation)
    east, up = math.cos(azimuth), math.sin(elevation)
    aim = jnp.array([east * math.cos(elevation), math.sin(azimuth) * math.cos(elevation), up], jnp.float32)
    level = jnp.array([-math.sin(azimuth), east, 0.0], jnp.float32)
    tilt = jnp.cross(aim, level)
    shape = point.pos.shape
    toward = jnp.broadcast_to(aim, shape)
    way = toward + 0.0087 * (
        spread[..., :1] * jnp.broadcast_to(level, shape) + spread[..., 1:] * jnp.broadcast_to(tilt, shape)
    )
    facing = _facing(point, toward)
    reach = jnp.where((facing > 0) & (point.instance >= 0), jnp.inf, -1.0)
    blocked = occluded(scene, point.pos + OFFSET * point.normal, way, t_max=reach, executor=executor)
    strength = jnp.where(blocked | (reach < 0), 0.0, options.sun * facing)[..., None]
    color = strength * jnp.broadcast_to(jnp.array(SUNLIGHT, jnp.float32), shape)
    return Received(color, color * blinn_phong(point, toward)[..., None])


def blinn_phong(point: Point, toward: Float[Array, "*rays 3"]) -> Float[Array, "*rays"]:
    """Gloss as a fraction of the irradiance, (n + 8) / (8 pi) * cos^n of the half vector.

    Source: T. Akenine-Möller et al., "Real-Time Rendering", on the normalised Blinn-Phong reflectance.
    """
    half = toward + point.view
    half = half / jnp.maximum(jnp.linalg.norm(half, axis=-1, keepdims=True), 1e-6)
    cosine = jnp.clip(jnp.sum(half * point.shading, axis=-1), 1e-4, 1.0)
    return (point.shininess + 8) / (8 * math.pi) * jnp.exp(point.shininess * jnp.log(cosine))


def _is_own(carrier: Array, instance: Array, area: Array) -> Array:
    """Whether the surface is part of the lamp whose light it is; the frame of a window is not."""
    return (carrier == instance) & (carrier != ARCHITECTURE) & (area == 0)


def _unshadowed(
    row: Float[Array, "*rays 18"], offset: Float[Array, "*rays 3"], at: Point, own: Array
) -> tuple[Float[Array, "*rays 3"], Float[Array, "*rays 3"]]:
    """Irradiance [W/m^2] by one light if nothing stands between, and the unit direction to it.

    Rectangles count as discs of their area around the point that light comes from: J. R. Wallace et al., "A ray tracing
    algorithm for progressive radiosity", SIGGRAPH 1989. A lamp's own surfaces, such as its shade, let light through.
    """
    square = jnp.sum(offset * offset, axis=-1)
    square = jnp.maximum(square, jnp.where(own, SHADE**2, 1e-4))
    toward = offset / jnp.maximum(jnp.linalg.norm(offset, axis=-1, keepdims=True), 1e-6)
    leaving = -jnp.sum(toward * row[..., 9:12], axis=-1)
    profile = jnp.where(own, 1.0, _profile(leaving, row[..., 15], row[..., 16]))
    facing = jnp.where(own, 0.7, _facing(at, toward))
    strength = profile * facing / (square + row[..., 17] / math.pi)
    return row[..., 12:15] * strength[..., None], toward


def _facing(at: Point, toward: Float[Array, "*rays 3"]) -> Float[Array, "*rays"]:
    """Cosine at the surface; 0 if the light is behind the triangle or behind the surface that it stands for."""
    above = jnp.sum(toward * at.normal, axis=-1) > 0
    return jnp.where(above, jnp.maximum(jnp.sum(toward * at.shading, axis=-1), 0.0), 0.0)


def _profile(cosine: Array, exponent: Array, cutoff: Array) -> Array:
    """Share of the intensity that a light has in a direction."""
    power = jnp.exp(exponent * jnp.log(jnp.maximum(cosine, 1e-6)))
    return jnp.where(cosine >= cutoff, power, 0.0)
