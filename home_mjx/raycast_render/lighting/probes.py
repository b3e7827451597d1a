"""Light from baked probes: mixture of light groups for one environment, and irradiance between the probes of a room."""

import math
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.bank.records.lights import (
    HORIZON,
    OTHER_LAMPS,
    OWN_LAMPS,
    SUN_AZIMUTHS,
    SUNS,
    ZENITH,
    LightProbes,
)
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.lighting.gloss import ShadingPoint
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.surface import index_by_instance
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, take, take_vec
from home_mjx.schema.compiled import MAX_DEPTH_BELOW_FLOOR

PROBE_OFFSET = 0.05  # [m], distance above a surface at which probes are interpolated
FACING_DEPTH, MIN_FACING = 0.1, 0.02  # [m], from a surface's plane at which probes count fully or least; least weight
VIEW_OFFSET = 0.25  # [m], distance towards the viewer at which surfaces without a room look for one, as in doorways
FACADE_GAP = 0.15  # [m], distance from the probes of a room beyond which a wall that faces away is outdoors
MAX_COLOR = 65408.0  # the largest number of packed colours
ZENITH_UP, ZENITH_LEVEL = 0.8 * math.pi, 0.9585  # irradiance of the sky's zenith part on floors, and on walls


class Daylight(Pytree):
    """Daylight of an environment."""

    sky: Float[Array, ""] | float  # radiance [W/m^2/sr]
    horizon: Vec  # colour of the sky at the horizon
    sun: Vec  # normal irradiance [W/m^2]
    azimuth: Float[Array, ""] | float  # [degrees]


class PreparedLight(Pytree):
    """Irradiance of one environment at probes and texels, all light groups together, with colours as in the bake."""

    probes: UInt32[Array, "n 6"]  # by face
    texels: UInt32[Array, " x"]


class MixedProbes(Pytree):
    """Irradiance at the probes of one environment, all light groups together."""

    light: Float[Array, "n 6 3"] | UInt32[Array, "n 6"]  # [W/m^2], by face; integers are packed
    start: Int[Array, ""] | int  # row of the house's first probe


def mix_groups(
    probes: LightProbes, house: Int[Array, ""], look: AppearanceOverrides | None, day: Daylight
) -> MixedProbes:
    """Mix the light groups by the lamps and daylight of one environment.

    Without overrides that depend on the environment, the mixture is that of all houses of the bank, and environments
    of a batch share it.
    """
    own = varies(look)
    light = probes.light[house] if own else probes.light.reshape(-1, *probes.light.shape[2:])
    mixed = jnp.zeros((len(light), 6, 3), jnp.float32)
    for group, weight in group_weights(day).items():
        part = unpack_colors(light[:, group]) * weight[None, None]
        if group in (OWN_LAMPS, OTHER_LAMPS) and look is not None and look.lamps is not None:
            part = part * lamp_factors(probes, house, look.lamps, probes.room[house])[group][:, None, None]
        mixed = mixed + part
    mixed = jax.lax.optimization_barrier(mixed)
    return MixedProbes(mixed, 0 if own else house * probes.light.shape[1])


def varies(look: AppearanceOverrides | None) -> bool:
    """Return whether overrides change the light of an environment, so that it has a mixture of its own."""
    return look is not None and any(
        x is not None for x in (look.lamps, look.daylight, look.sun_azimuth, look.sun_elevation)
    )


def unpack_colors(packed: UInt32[Array, "*n"]) -> Float[Array, "*n 3"]:
    """Unpack colours of `light_probes.field.pack_colors`."""
    scale = jnp.exp2((packed >> 27).astype(jnp.float32) - 24.0)
    channels = [((packed >> shift) & 511).astype(jnp.float32) * scale for shift in (0, 9, 18)]
    return jnp.stack(channels, axis=-1)


def pack_colors(color: Float[Array, "*n 3"]) -> UInt32[Array, "*n"]:
    """Pack colours as `light_probes.field.pack_colors` does; errors are at most 1/1024 of the largest channel."""
    color = jnp.clip(color, 0.0, MAX_COLOR)
    top = jnp.max(color, axis=-1)
    power = (_bits(jnp.maximum(top, 2.0**-16)) >> 23) - 126  # top < 2 ** power
    power = power + (jnp.round(top * _power_of_two(9 - power)) >= 512)
    channels = jnp.round(color * _power_of_two(9 - power)[..., None]).astype(jnp.uint32)
    packed = channels[..., 0] | channels[..., 1] << 9 | channels[..., 2] << 18
    return packed | (power + 15).astype(jnp.uint32) << 27


def take_colors(table: Float[Array, "n 3"] | UInt32[Array, " n"], row: Int[Array, "*rays"]) -> Vec:
    """Return rows of a table of colours, which may be packed."""
    if table.ndim > 1:
        return take_vec(table, row)
    packed = take(table, row)
    scale = _power_of_two((packed >> 27).astype(jnp.int32) - 24)
    return Vec(*(((packed >> shift) & 511).astype(jnp.float32) * scale for shift in (0, 9, 18)))


def _bits(number: Float[Array, "*n"]) -> Int[Array, "*n"]:
    """Return the bits of numbers."""
    return jax.lax.bitcast_convert_type(number, jnp.int32)


def _power_of_two(power: Int[Array, "*n"]) -> Float[Array, "*n"]:
    """Return 2 to integers from -126 to 127."""
    return jax.lax.bitcast_convert_type((power + 127) << 23, jnp.float32)


def group_weights(day: Daylight) -> dict[int, Float[Array, "3"]]:
    """Return the weight of groups by number and colour but for factors of lamps; suns are interpolated by azimuth.

    Groups whose weight is known to be 0 when the program is traced, such as most suns, are left out.
    """
    sky = jnp.full(3, day.sky, jnp.float32)
    horizon, sun = (jnp.stack([jnp.asarray(c, jnp.float32) for c in (v.x, v.y, v.z)]) for v in (day.horizon, day.sun))
    weights: dict[int, Array] = {OWN_LAMPS: jnp.ones(3), OTHER_LAMPS: jnp.ones(3), ZENITH: sky, HORIZON: sky * horizon}
    step = SUN_AZIMUTHS[1] - SUN_AZIMUTHS[0]
    for group, angle in enumerate(SUN_AZIMUTHS, SUNS):
        apart = abs((day.azimuth - angle + 180.0) % 360.0 - 180.0) / step
        if not isinstance(apart, float) or apart < 1:
            weights[group] = sun * jnp.maximum(1.0 - apart, 0.0)
    return weights


def lamp_factors(
    probes: LightProbes, house: Int[Array, ""], lamps: Float[Array, " rooms_and_none"], place: Int[Array, " n"]
) -> tuple[Float[Array, " n"], Float[Array, " n"]]:
    """Return the factors of own and other lamps in rooms `place` of a house, given those of lamps by room + 1."""
    rooms = probes.first.shape[1]
    own = lamps[jnp.clip(jnp.arange(rooms) + 1, 0, len(lamps) - 1)]
    others = probes.spill[house] @ own
    return own[place], others[place]


def probe_room(scene: Scene, point: ShadingPoint) -> Int[Array, "*rays"]:
    """Return the room whose probes light each point; -1 outdoors.

    That is the room of the surface, or, for surfaces without one and moving ones, the room in front of them. Facades,
    which face away from their room beyond its probes, are outdoors.
    """
    moves = index_by_instance(
        jnp.zeros(scene.geometry.instance_model.shape[1], bool),
        scene.moving,
        jnp.ones_like(scene.moving.instance, bool),
    )
    fixed = (point.room >= 0) & ~take(moves, jnp.maximum(point.instance, 0))
    room = jnp.where(fixed, point.room, _room_at(scene, point.pos + point.view * VIEW_OFFSET))
    return jnp.where(_is_facade(scene, point, room), -1, room)


def _room_at(scene: Scene, pos: Vec) -> Int[Array, "*rays"]:
    """Return the room of the navigation grids at points; -1 outside of rooms."""
    table, spec = scene.bank.navigation, scene.bank.spec
    _, levels, rows, columns = table.room.shape
    floors, origin = table.floor[scene.house], table.origin[scene.house]
    level = sum((pos.z > floors[i] - MAX_DEPTH_BELOW_FLOOR).astype(jnp.int32) for i in range(levels)) - 1
    column, row = (jnp.floor((x - o) / spec.cell) for x, o in ((pos.x, origin[0]), (pos.y, origin[1])))
    inside = (level >= 0) & (row >= 0) & (column >= 0) & (row < rows) & (column < columns)
    place = (jnp.clip(row, 0, rows - 1) * columns + jnp.clip(column, 0, columns - 1)).astype(jnp.int32)
    place = (scene.house * levels + jnp.maximum(level, 0)) * rows * columns + place
    return jnp.where(inside, take(table.room.reshape(-1), place).astype(jnp.int32), -1)


def _is_facade(scene: Scene, point: ShadingPoint, room: Int[Array, "*rays"]) -> Bool[Array, "*rays"]:
    """Return whether points face away from their room beyond its probes."""
    probes: LightProbes = scene.bank.bakes["light_probes"]
    row = scene.house * probes.first.shape[1] + jnp.maximum(room, 0)
    low = take_vec(probes.origin.reshape(-1, 3), row)
    high = low + take_vec(probes.step.reshape(-1, 3), row) * (take_vec(probes.count.reshape(-1, 3), row).map(_less_one))
    beyond = [
        ((x > top + FACADE_GAP) & (n > 0.5)) | ((x < bottom - FACADE_GAP) & (n < -0.5))
        for x, n, bottom, top in zip(*(_parts(v) for v in (point.pos, point.normal, low, high)), strict=True)
    ]
    return (room >= 0) & (beyond[0] | beyond[1] | beyond[2])


def probe_irradiance(
    probes: LightProbes, mixed: MixedProbes, house: Int[Array, ""], pos: Vec, normal: Vec, room: Int[Array, "*rays"]
) -> Vec:
    """Compute the irradiance [W/m^2] at points of rooms with unit normals; 0 where `room` has no probes.

    Source: J. McTaggart, "Half-Life 2 / Valve Source shading", 2004: the ambient cube, exact for planes along the axes,
    as most of a home are.
    """
    row = house * probes.first.shape[1] + jnp.maximum(room, 0)
    first = take(probes.first.reshape(-1), row)
    count = take_vec(probes.count.reshape(-1, 3), row)
    place = (pos + normal * PROBE_OFFSET - take_vec(probes.origin.reshape(-1, 3), row)).map(
        lambda x, step, n: jnp.clip(x / step, 0.0, (n - 1).astype(jnp.float32)),
        take_vec(probes.step.reshape(-1, 3), row),
        count,
    )
    low = place.map(lambda x, n: jnp.minimum(x.astype(jnp.int32), n - 2), count)
    share = place.map(lambda x, i: x - i.astype(jnp.float32), low)
    cell = mixed.start + jnp.maximum(first, 0) + (low.x * count.y + low.y) * count.z + low.z
    step = take_vec(probes.step.reshape(-1, 3), row)
    found = _interpolate(mixed.light, cell, count, share, step, normal)
    return found * jnp.where((room >= 0) & (first >= 0), 1.0, 0.0)


def _interpolate(light: Array, cell: Int[Array, "*rays"], count: Vec, share: Vec, step: Vec, normal: Vec) -> Vec:
    """Return the irradiance between the eight probes from `cell` on: that of three faces by squares of the normal.

    Probes behind the surface, such as those inside of it or below a table, have the least weight.
    """
    rows = light.reshape(-1) if light.ndim == 2 else light.reshape(-1, 3)
    faces = [(axis, n * n, jnp.where(n < 0, 2 * axis + 1, 2 * axis)) for axis, n in enumerate(_parts(normal))]
    rise = Vec(*(n * x for n, x in zip(_parts(normal), _parts(step), strict=True)))  # of the plane's distance by step
    low = PROBE_OFFSET - rise.dot(share)  # distance of the first probe from the plane
    found, total = Vec(0.0, 0.0, 0.0), 0.0
    for corner in range(8):
        x, y, z = corner & 1, corner >> 1 & 1, corner >> 2
        above = low + x * rise.x + y * rise.y + z * rise.z
        weight = jnp.clip(0.5 + above * (0.5 / FACING_DEPTH), MIN_FACING, 1.0)
        for one, part in ((x, share.x), (y, share.y), (z, share.z)):
            weight = weight * (part if one else 1.0 - part)
        total = total + weight
        row = 6 * (cell + x * count.y * count.z + y * count.z + z)
        for _, square, face in faces:
            found = found + take_colors(rows, row + face) * (weight * square)
    return found * (1.0 / total)


def open_irradiance(day: Daylight, zenith: Vec, ground: Vec, normal: Vec) -> Vec:
    """Compute the sky's irradiance on normals without obstacles; see `light_probes.emitters.open_sky`."""
    up = normal.z
    high = ZENITH_LEVEL + up * ZENITH_UP / 2 + up * up * (ZENITH_UP / 2 - ZENITH_LEVEL)
    total, below = math.pi * (1 + up) / 2, math.pi * (1 - up) / 2
    return (zenith * high + day.horizon * (total - high) + ground * below) * day.sky


def _less_one(count: Any) -> Any:
    """Return the number of steps between `count` probes."""
    return (count - 1).astype(jnp.float32)


def _parts(vec: Vec) -> tuple[Any, Any, Any]:
    """Return the components x, y and z."""
    return vec.x, vec.y, vec.z
