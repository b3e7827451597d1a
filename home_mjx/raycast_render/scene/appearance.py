"""Appearance overrides of one environment: lights, exposure, colours and textures.

An override is a few numbers per environment. Per-material values are hashes of the material's row, so that no
environment needs its own material table.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.vec import Vec, take

# Multipliers and shifts of MurmurHash3's finaliser; A. Appleby, 2011.
MULTIPLIER_1, MULTIPLIER_2, SHIFTS = 0x85EBCA6B, 0xC2B2AE35, (16, 13, 16)
GOLDEN = 0x9E3779B1  # 2^32 over the golden ratio, which separates neighbouring rows
UNIT_SCALE = 2.0**-24
RED, GREEN, BLUE, SWAP, LAYER = range(5)  # channels of `hash_uniform`, one per random number of a material


class AppearanceOverrides(Pytree):
    """Appearance overrides of an episode; None keeps the house's value."""

    seed: UInt32[Array, ""]  # of the random numbers of materials
    lamps: Float[Array, " rooms_and_none"] | None = None  # factor of the lamps by room + 1
    daylight: Float[Array, ""] | None = None  # factor of sun and sky, outdoors and through windows
    sun_azimuth: Float[Array, ""] | None = None  # [rad]
    sun_elevation: Float[Array, ""] | None = None  # [rad]
    exposure: Float[Array, ""] | None = None  # factor of the light that cameras receive
    tint: Float[Array, ""] | None = None  # maximum relative change of each material's red, green and blue
    lights: Float[Array, " lights"] | None = None  # factor of each lamp's direct light, instead of `lamps`
    glow: Float[Array, " instances"] | None = None  # emission of surfaces that are switched on, 0 to 1
    swap: Float[Array, ""] | None = None  # probability that a textured material gets a random texture of the bank


def scale_lamps(
    look: AppearanceOverrides | None, light: Vec, daylight: Bool[Array, "*#n"], room: Int[Array, "*#n"]
) -> Vec:
    """Scale lights by the episode's factors: `look.daylight` where `daylight`, else `look.lamps[room + 1]`.

    Lamps outside rooms have room -1, so their factor is `look.lamps[0]`. Indices are clipped. A factor that is None, or
    no `look`, leaves them unchanged.
    """
    if look is not None and look.lamps is not None:
        lamps = take(look.lamps, jnp.clip(room + 1, 0, look.lamps.shape[0] - 1))
        light = light * jnp.where(daylight, 1.0, lamps)
    if look is not None and look.daylight is not None:
        light = light * jnp.where(daylight, look.daylight, 1.0)
    return light


def scale_lights(
    look: AppearanceOverrides | None, light: Vec, daylight: Bool[Array, " l"], room: Int[Array, " l"]
) -> Vec:
    """Scale all lights of a house by their own factors `look.lights`, else by `scale_lamps`; daylight as there."""
    if look is None or look.lights is None:
        return scale_lamps(look, light, daylight, room)
    return scale_lamps(look.replace(lamps=None), light * jnp.where(daylight, 1.0, look.lights), daylight, room)


def instance_glow(look: AppearanceOverrides | None, instance: Int[Array, "*rays"]) -> Float[Array, "*rays"] | None:
    """Return the emission of instances, 0 for agents and on a miss (-1); None without `look.glow`."""
    if look is None or look.glow is None:
        return None
    count = look.glow.shape[0]
    return jnp.where((instance >= 0) & (instance < count), take(look.glow, jnp.clip(instance, 0, count - 1)), 0.0)


def scale_daylight(look: AppearanceOverrides | None, light: Vec) -> Vec:
    """Scale the light of sun or sky by the episode's factor `daylight`; unchanged if there is none."""
    return light if look is None or look.daylight is None else light * look.daylight


def scale_exposure(look: AppearanceOverrides | None, light: Vec) -> Vec:
    """Scale the light that a camera receives by the episode's factor `exposure`; unchanged if there is none."""
    return light if look is None or look.exposure is None else light * look.exposure


def tint_materials(look: AppearanceOverrides | None, color: Vec, row: Int[Array, "*rays"]) -> Vec:
    """Scale colours by a random factor in 1 ± `look.tint` per channel and material row, clipped to [0, 1].

    All rays of a row get the same factors. Without `look.tint`: unchanged.
    """
    if look is None or look.tint is None:
        return color
    tint = look.tint
    factors = (1 + tint * (2 * hash_uniform(look.seed, row, channel) - 1) for channel in (RED, GREEN, BLUE))
    return (color * Vec(*factors)).map(lambda x: jnp.clip(x, 0.0, 1.0))


def swap_textures(
    look: AppearanceOverrides | None, layer: Int[Array, "*rays"], row: Int[Array, "*rays"], layers: Array
) -> Array:
    """Return texture layers, with probability `look.swap` per material row random ones from 0 .. max(`layers`).

    All rays of a row get the same layer. A `layer` of -1, no texture, stays -1. Without `look.swap`: unchanged.
    """
    if look is None or look.swap is None:
        return layer
    count = jnp.max(layers, initial=-1) + 1
    other = (hash_uniform(look.seed, row, LAYER) * count.astype(jnp.float32)).astype(jnp.int32)
    goes = (layer >= 0) & (hash_uniform(look.seed, row, SWAP) < look.swap)
    return jnp.where(goes, jnp.minimum(other, count - 1), layer)


def hash_uniform(seed: UInt32[Array, ""], row: Int[Array, "*n"], what: int) -> Float[Array, "*n"]:
    """Return a pseudorandom number in [0, 1) for each row, determined by seed, row and channel `what`.

    Example:
        >>> hash_uniform(jnp.uint32(7), jnp.arange(2), RED).shape
        (2,)
    """
    own = _mix_bits(row.astype(jnp.uint32) * jnp.uint32(GOLDEN) + jnp.uint32(what))
    return (_mix_bits(own ^ seed) >> 8).astype(jnp.float32) * jnp.float32(UNIT_SCALE)


def _mix_bits(x: UInt32[Array, "*n"]) -> UInt32[Array, "*n"]:
    """Apply MurmurHash3's 32-bit finaliser."""
    x = (x ^ (x >> SHIFTS[0])) * jnp.uint32(MULTIPLIER_1)
    x = (x ^ (x >> SHIFTS[1])) * jnp.uint32(MULTIPLIER_2)
    return x ^ (x >> SHIFTS[2])
