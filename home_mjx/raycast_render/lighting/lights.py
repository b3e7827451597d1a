"""Direct light at surface points from the lights of a house."""

import math
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.lighting.gloss import ShadingPoint, ggx
from home_mjx.raycast_render.lighting.sun_and_sky import sun_redness
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides, scale_daylight, scale_lights
from home_mjx.raycast_render.scene.surface import index_by_instance
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, select, take
from home_mjx.schema.compiled import ARCHITECTURE

SHADOW_BIAS = 5e-4  # [m], offset of shadow rays above the surface at their origin
SHADOW_RAY_END = 0.05  # [m], distance before the light at which shadow rays end; bulbs may be recessed into ceilings
OTHER_ROOM_WEIGHT = 0.1  # weight of lights in other rooms in the selection of lights
MIN_LIGHT_DISTANCE = 0.6  # [m], minimum distance that is assumed between a lamp's own surfaces and its light
SKY_COLOR = (0.85, 0.93, 1.0)  # colour of the sky's light
SUN_COLOR, SUNSET_COLOR = (1.0, 0.93, 0.82), (1.0, 0.6, 0.3)
LUMINANCE = (0.2126, 0.7152, 0.0722)  # ITU-R BT.709
INDEX_BITS = 10  # bits of a key for the light's index; a house has fewer than 2**10 lights
LIGHTS_PER_STEP = 4  # lights compared per scan step: 16 are not faster and take three times as long to compile

Color = tuple[float, float, float]
# Emitting position on a light, in [-1, 1] along each of its axes; None: its centre.
LightSample = Float[Array, "*rays 2"] | None


class PlacedLights(Pytree):
    """Lights in world coordinates, intensity in [W/sr]: all of one environment, or one per point."""

    pos: Vec  # [m]
    axis_u: Vec  # [m], half extents
    axis_v: Vec
    direction: Vec  # unit
    intensity: Vec
    power: Float[Array, "*lights"]  # luminance of the intensity
    exponent: Float[Array, "*lights"]
    cutoff: Float[Array, "*lights"]
    area: Float[Array, "*lights"]  # [m^2]
    instance: Int[Array, "*lights"]  # -1 padding
    object_id: Int[Array, "*lights"]
    room: Int[Array, "*lights"]


class LampTables(Pytree):
    """Rows of the light table of one environment by what they light; -1 none."""

    by_room: Int[Array, "rooms_and_none keys"]  # key lamps by room + 1: lamps that need shadow rays, brightest first
    by_instance: Int[Array, "instances 2"]  # last and first light that a lamp carries


class IncidentLight(Pytree):
    """Incident light at points, summed over lights: irradiance, and radiance reflected towards the viewer."""

    diffuse: Vec  # irradiance [W/m^2]
    specular: Vec  # specular radiance for a specular reflectance of 1 [W/m^2/sr]


def no_light(point: ShadingPoint) -> IncidentLight:
    """Return the light at points of no lamp."""
    dark = point.pos.map(jnp.zeros_like)
    return IncidentLight(dark, dark)


def place_lights(scene: Scene, sky: float) -> PlacedLights:
    """Return the lights of the environment's house in world coordinates; lights of lamps follow their lamps.

    `sky` is the radiance of the sky, which windows emit [W/m^2/sr]. Intensities include the factors of `scale_lights`.
    Padding has `instance` -1 and intensity 0.
    """
    lights, house, geometry = scene.bank.lights, scene.house, scene.geometry
    instance = lights.instance[house]
    carrier = jnp.maximum(instance, 0)
    pose = index_by_instance(geometry.instance_pose[house], scene.moving, scene.moving.pose)[carrier]
    columns = [Vec.unpack(pose[:, :, i]) for i in range(4)]

    def turned(vectors: Float[Array, "l 3"]) -> Vec:
        """Rotate vectors from the frames of their instances to the world."""
        local = Vec.unpack(vectors)
        return columns[0] * local.x + columns[1] * local.y + columns[2] * local.z

    daylight = lights.daylight[house]
    intensity = Vec.unpack(lights.intensity[house])
    intensity = select(daylight, intensity * Vec(*SKY_COLOR) * sky, intensity)
    intensity = scale_lights(scene.appearance, intensity, daylight, lights.room[house])
    placed = PlacedLights(
        pos=turned(lights.pos[house]) + columns[3],
        axis_u=turned(lights.axis_u[house]),
        axis_v=turned(lights.axis_v[house]),
        direction=turned(lights.direction[house]).unit(),
        intensity=intensity,
        power=intensity.dot(Vec(*LUMINANCE)),
        exponent=lights.exponent[house],
        cutoff=lights.cutoff[house],
        area=lights.area[house],
        instance=instance,
        object_id=index_by_instance(geometry.instance_object[house], scene.moving, scene.moving.object_id)[carrier],
        room=lights.room[house],
    )
    # The barrier keeps this computation per light; fusion with later operations would repeat it per pixel.
    return jax.lax.optimization_barrier(placed)


def lamp_light(
    scene: Scene, lights: PlacedLights, point: ShadingPoint, spread: LightSample, chosen: Int[Array, "k *rays"]
) -> IncidentLight:
    """Compute irradiance and specular radiance at points, each from its lights `chosen`; 0 on a miss.

    Shadow rays ignore the lamp that carries the light, and none start on it.

    Args:
        scene: Scene of one environment.
        lights: Its lights.
        point: Shading points.
        spread: Emitting positions in [-1, 1] along both axes of linear and rectangular lights; None: their centres.
        chosen: Rows of the light table; -1 none.
    """
    light = jax.tree.map(lambda column: take(column, jnp.maximum(chosen, 0)), lights)
    at = jax.tree.map(lambda x: jnp.broadcast_to(jnp.asarray(x)[None], chosen.shape), point)
    source = light.pos
    if spread is not None:
        source = source + light.axis_u * spread[None, ..., 0] + light.axis_v * spread[None, ..., 1]
    own = _is_own_lamp(light, at.instance)
    strength, toward = _unoccluded_irradiance(light, source - at.pos, at, own)
    strength = jnp.where((chosen >= 0) & (light.power > 0) & (at.instance >= 0), strength, 0.0)
    start = at.pos + at.normal * SHADOW_BIAS
    way = source - start
    reach = jnp.where(
        (strength > 0) & ~own, 1 - SHADOW_RAY_END * jnp.minimum(way.inverse_norm(), 1 / SHADOW_RAY_END), -1.0
    )
    gloss = strength * ggx(at, toward)
    # The barrier prevents recomputation on the other side of the cast.
    start, way, reach, strength, gloss = jax.lax.optimization_barrier((start, way, reach, strength, gloss))
    blocked = occluded(scene, start.pack(), way.pack(), t_max=reach, exclude=light.object_id)

    def arriving(share: Float[Array, "k *rays"]) -> Vec:
        """Return the sum over lights of intensity times share, without occluded ones."""
        return (light.intensity * jnp.where(blocked, 0.0, share)).map(lambda x: jnp.sum(x, axis=0))

    return IncidentLight(arriving(strength), arriving(gloss))


def tabulate_lamps(scene: Scene, lights: PlacedLights, rows: Int[Array, "rooms keys"]) -> LampTables:
    """Tabulate the lamps of rooms and instances of one environment.

    Args:
        scene: Scene of one environment.
        lights: Its lights.
        rows: Rows of the light table of key lamps by room, brightest first; -1 none.
    """
    outside = jnp.where((lights.room < 0) & (lights.instance >= 0), lights.power, 0.0)
    power, best = jax.lax.top_k(jnp.pad(outside, (0, rows.shape[1])), rows.shape[1])
    size, number = scene.geometry.instance_model.shape[1], jnp.arange(len(lights.instance), dtype=jnp.int32)
    carried = (lights.instance != ARCHITECTURE) & (lights.instance >= 0) & (lights.area == 0)
    carrier = jnp.where(carried, lights.instance, size)
    last = jnp.full(size, -1, jnp.int32).at[carrier].max(number, mode="drop")
    first = jnp.full(size, len(number), jnp.int32).at[carrier].min(number, mode="drop")
    return LampTables(
        by_room=jnp.concatenate([jnp.where(power > 0, best, -1)[None].astype(jnp.int32), rows]),
        by_instance=jnp.stack([last, jnp.where(last < 0, -1, first)], axis=-1),
    )


def key_lamps(tables: LampTables, point: ShadingPoint, count: int) -> Int[Array, "count *rays"]:
    """Return the lamps of each point whose light is not in probes: on a lamp its own, then key lamps of the room.

    At points outside of rooms, the brightest lamps without a room are the key lamps. At most two lights of a lamp count
    as its own.

    Args:
        tables: Lamps of rooms and instances.
        point: Shading points.
        count: Number of lamps per point, at most the number of key lamps of a room.

    Returns:
        Rows of the light table; -1 none.
    """
    place = jnp.clip(point.room + 1, 0, tables.by_room.shape[0] - 1)
    keys = [take(tables.by_room, place, i) for i in range(count)]
    carrier = jnp.clip(point.instance, 0, tables.by_instance.shape[0] - 1)
    for i in range(tables.by_instance.shape[1]):
        keys = _insert(keys, jnp.where(carrier == point.instance, take(tables.by_instance, carrier, i), -1))
    # The barrier prevents recomputation for every column of the lights.
    return jax.lax.optimization_barrier(jnp.stack(keys))


def _insert(rows: list[Int[Array, "*rays"]], row: Int[Array, "*rays"]) -> list[Int[Array, "*rays"]]:
    """Insert `row` in front of `rows` where it is not -1; its other entry, or else the last one, drops out."""
    kept = []
    for other in rows:
        kept.append(jnp.where(row < 0, other, row))
        row = jnp.where((row < 0) | (row == other), -1, other)
    return kept


def brightest_lights(lights: PlacedLights, point: ShadingPoint, count: int) -> Int[Array, "k *rays"]:
    """Return the rows of the lights that `select_lights` selects; -1 for dark ones."""
    key = select_lights(lights, point, count)
    # The barrier prevents recomputation for every column of the lights.
    return jax.lax.optimization_barrier(jnp.where(key >> INDEX_BITS > 0, key & (2**INDEX_BITS - 1), -1))


def select_lights(lights: PlacedLights, point: ShadingPoint, count: int) -> Int[Array, "k *rays"]:
    """Select the lights with the highest estimated irradiance at each point, without occlusion, brightest first.

    Those of other rooms are weighted by `OTHER_ROOM_WEIGHT`; a lamp has high priority on its own surfaces. Of lights
    equal but for the lowest `INDEX_BITS` bits of irradiance, the one with the higher index comes first.

    Returns:
        `count` keys, or one per light if fewer: the light's index in the lowest `INDEX_BITS` bits, its irradiance in
        the others, which are 0 if the light is dark.
    """
    total = lights.instance.shape[0]
    lines = -(-total // LIGHTS_PER_STEP)

    def lines_of(column: Array) -> Array:
        """Reshape a column to lines of `LIGHTS_PER_STEP`, padded with -1."""
        padding = lines * LIGHTS_PER_STEP - total
        return jnp.pad(column, (0, padding), constant_values=-1).reshape(lines, LIGHTS_PER_STEP)

    def compare(best: list[Array], line: tuple[PlacedLights, Array]) -> tuple[list[Array], None]:
        """Insert the keys of one line of lights into the best keys, which are in descending order."""
        for i in range(LIGHTS_PER_STEP):
            light, number = jax.tree.map(lambda column, i=i: column[i], line)
            key = _light_key(light, number, point)
            for place, other in enumerate(best):
                best = [*best[:place], jnp.maximum(other, key), *best[place + 1 :]]
                key = jnp.minimum(other, key)
        return best, None

    none = [jnp.zeros_like(point.instance)] * min(count, total)
    numbers = jnp.arange(lines * LIGHTS_PER_STEP, dtype=jnp.int32).reshape(lines, LIGHTS_PER_STEP)
    best, _ = jax.lax.scan(compare, none, (jax.tree.map(lines_of, lights), numbers))
    return jnp.stack(best)


def sun_light(
    scene: Scene, point: ShadingPoint, spread: LightSample, irradiance: float, azimuth: float, elevation: float
) -> IncidentLight:
    """Compute irradiance and specular radiance by the sun, 0 if occluded or on a miss; its disc is one degree wide.

    Args:
        scene: Scene of one environment, whose overrides may replace the sun's direction.
        point: Shading points.
        spread: Emitting positions on the disc, in [-1, 1]; None: its centre.
        irradiance: Normal irradiance of the sun [W/m^2].
        azimuth: Direction to the sun from +x towards +y [degrees].
        elevation: Elevation of the sun above the horizon [degrees]; it sets the colour even if overridden.
    """
    aim, level = _sun(scene.appearance, azimuth, elevation)
    way = aim.map(lambda x: jnp.full(point.instance.shape, x, jnp.float32))
    if spread is not None:
        way = way + (level * spread[..., 0] + aim.cross(level) * spread[..., 1]) * 0.0087
    strength = jnp.where(point.instance < 0, 0.0, irradiance * _surface_cosine(point, aim))
    reach = jnp.where(strength > 0, jnp.inf, -1.0)
    start = point.pos + point.normal * SHADOW_BIAS
    gloss = strength * ggx(point, aim)
    # The barrier prevents recomputation after the cast.
    start, reach, strength, gloss = jax.lax.optimization_barrier((start, reach, strength, gloss))
    blocked = occluded(scene, start.pack(), way.pack(), t_max=reach)
    light = scale_daylight(scene.appearance, sun_color(elevation))
    return IncidentLight(*(light * jnp.where(blocked, 0.0, share) for share in (strength, gloss)))


def sun_aim(look: AppearanceOverrides | None, azimuth: float, elevation: float) -> Vec:
    """Return the unit direction to the sun, world; angles in [degrees], each that `look` has replaces the given one."""
    return _sun(look, azimuth, elevation)[0]


def sun_color(elevation: float) -> Vec:
    """Return the colour of the sun's light at an elevation [degrees]."""
    return mix_colors(SUN_COLOR, SUNSET_COLOR, sun_redness(elevation))


def mix_colors(one: Color, other: Color, share: float) -> Vec:
    """Interpolate linearly between two colours; `share` 0 is `one`, 1 is `other`."""
    return Vec(*(a + (b - a) * share for a, b in zip(one, other, strict=True)))


def _sun(look: AppearanceOverrides | None, azimuth: Any, elevation: Any) -> tuple[Vec, Vec]:
    """Return the unit direction to the sun, world, and a horizontal unit vector to the left of who faces it.

    Angles in [degrees]; each that `look` has replaces the given one.
    """
    azimuth, elevation = math.radians(azimuth), math.radians(elevation)
    given = (None, None) if look is None else (look.sun_azimuth, look.sun_elevation)
    if given == (None, None):  # computed on the host, so that the program equals the one without overrides
        turn, rise = ((math.cos(angle), math.sin(angle)) for angle in (azimuth, elevation))
    else:
        azimuth, elevation = azimuth if given[0] is None else given[0], elevation if given[1] is None else given[1]
        turn, rise = ((jnp.cos(angle), jnp.sin(angle)) for angle in (azimuth, elevation))
    return Vec(turn[0] * rise[0], turn[1] * rise[0], rise[1]), Vec(-turn[1], turn[0], 0.0)


def _light_key(light: PlacedLights, number: Int[Array, ""], point: ShadingPoint) -> Int[Array, "*rays"]:
    """Return a sortable key: upper bits of a light's estimated irradiance (0 for padding), then its index, `number`.

    Lights of other rooms count `OTHER_ROOM_WEIGHT`; at points outside of rooms, all count fully. On a lamp's own
    surfaces it is its power over `MIN_LIGHT_DISTANCE` squared.

    Powers of cosines use C. Schlick's approximation, which is exact for exponents 0 and 1: "A fast alternative to
    Phong's specular model", Graphics Gems IV, 1994.
    """
    offset = light.pos - point.pos
    square = jnp.maximum(offset.dot(offset), 1e-4)
    inverse = jax.lax.rsqrt(square)
    cosine = -offset.dot(light.direction) * inverse
    facing = jnp.maximum(offset.dot(point.shading) * inverse, 0.0)
    ahead = jnp.maximum(cosine, 1e-6)
    fall = (light.exponent + ahead * (1 - light.exponent)) * (square + light.area / math.pi)
    per_fall = jax.lax.rsqrt(fall) ** 2  # cheaper on a GPU than one division per light
    strength = jnp.where(cosine >= light.cutoff, light.power * facing * ahead * per_fall, 0.0)
    here = (light.room == point.room) | (point.room < 0)
    strength = jnp.where(here, strength, OTHER_ROOM_WEIGHT * strength)
    strength = jnp.where(_is_own_lamp(light, point.instance), light.power / MIN_LIGHT_DISTANCE**2, strength)
    bits = jax.lax.bitcast_convert_type(jnp.where(light.instance >= 0, strength, 0.0), jnp.int32)
    return (bits & -(2**INDEX_BITS)) | number


def _is_own_lamp(light: PlacedLights, instance: Int[Array, "*rays"]) -> Bool[Array, "*rays"]:
    """Return whether a surface of `instance` belongs to the lamp of the light; walls and lights with an area do not."""
    return (light.instance == instance) & (light.instance != ARCHITECTURE) & (light.area == 0)


def _unoccluded_irradiance(
    light: PlacedLights, offset: Vec, at: ShadingPoint, own: Bool[Array, "*rays"]
) -> tuple[Float[Array, "*rays"], Vec]:
    """Compute irradiance per intensity [1/m^2] without occlusion, and the unit direction to the light at `offset` [m].

    A rectangle is approximated by a disc of its area around the emitting point: J. R. Wallace et al., "A ray tracing
    algorithm for progressive radiosity", SIGGRAPH 1989. A lamp's own surfaces (`own`), such as its shade, get 0.7 of
    its intensity from any side, from at least `MIN_LIGHT_DISTANCE`. Others get `_emission_profile` times
    `_surface_cosine`, from at least 1 cm.
    """
    square = jnp.maximum(offset.dot(offset), jnp.where(own, MIN_LIGHT_DISTANCE**2, 1e-4))
    toward = offset.unit()
    profile = _emission_profile(-toward.dot(light.direction), light.exponent, light.cutoff)
    share = jnp.where(own, 0.7, profile * _surface_cosine(at, toward))
    return share / (square + light.area / math.pi), toward


def _surface_cosine(at: ShadingPoint, toward: Vec) -> Float[Array, "*rays"]:
    """Return the cosine between shading normal and unit direction to a light; 0 behind that or the geometric normal."""
    return jnp.where(toward.dot(at.normal) > 0, jnp.maximum(toward.dot(at.shading), 0.0), 0.0)


def _emission_profile(
    cosine: Float[Array, "*rays"], exponent: Float[Array, "*rays"], cutoff: Float[Array, "*rays"]
) -> Float[Array, "*rays"]:
    """Return the fraction of a light's intensity at a cosine to its axis: cosine^exponent, 0 below the cutoff.

    Cosines from the cutoff on, even negative ones, are raised to at least 1e-6.
    """
    power = jnp.exp(exponent * jnp.log(jnp.maximum(cosine, 1e-6)))
    return jnp.where(cosine >= cutoff, power, 0.0)
