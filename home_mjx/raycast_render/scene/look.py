"""How one environment looks different from what its house says: lights, exposure, colours and textures.

Everything is a few numbers per environment; what differs by material is a hash of its row, so that no environment has
a material table of its own.
"""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.vec import Vec, take

# Odd numbers and shifts of MurmurHash3's finaliser; A. Appleby, 2011.
FIRST, SECOND, ROUNDS = 0x85EBCA6B, 0xC2B2AE35, (16, 13, 16)
GOLDEN = 0x9E3779B1  # 2^32 over the golden ratio: neighbouring rows fall far apart
TO_UNIT = 2.0**-24
RED, GREEN, BLUE, SWAPPED, LAYER = range(5)  # what is drawn for a material


class Look(Pytree):
    """What an episode changes of a house's looks; None: as the house has it."""

    seed: UInt32[Array, ""]  # of what materials draw
    lamps: Float[Array, " rooms_and_none"] | None = None  # factor of the lamps by room + 1
    daylight: Float[Array, ""] | None = None  # factor of sun and sky, outdoors and through windows
    sun_azimuth: Float[Array, ""] | None = None  # [rad]
    sun_elevation: Float[Array, ""] | None = None  # [rad]
    exposure: Float[Array, ""] | None = None  # factor of the light that cameras take in
    tint: Float[Array, ""] | None = None  # greatest relative change of each material's red, green and blue
    swap: Float[Array, ""] | None = None  # chance of each textured material to have another texture of the bank


def dimmed(look: Look | None, light: Vec, daylight: Bool[Array, "*#n"], room: Int[Array, "*#n"]) -> Vec:
    """Light of windows, or of the lamps of rooms (-1: of none), as bright as it is in this episode."""
    if look is not None and look.lamps is not None:
        lamps = take(look.lamps, jnp.clip(room + 1, 0, look.lamps.shape[0] - 1))
        light = light * jnp.where(daylight, 1.0, lamps)
    if look is not None and look.daylight is not None:
        light = light * jnp.where(daylight, look.daylight, 1.0)
    return light


def outdoors(look: Look | None, light: Vec) -> Vec:
    """Light of sun or sky."""
    return light if look is None or look.daylight is None else light * look.daylight


def exposed(look: Look | None, light: Vec) -> Vec:
    """Light as cameras take it in."""
    return light if look is None or look.exposure is None else light * look.exposure


def tinted(look: Look | None, color: Vec, row: Int[Array, "*rays"]) -> Vec:
    """Reflectances of materials in this episode, by their rows."""
    if look is None or look.tint is None:
        return color
    tint = look.tint
    factors = (1 + tint * (2 * drawn(look.seed, row, channel) - 1) for channel in (RED, GREEN, BLUE))
    return (color * Vec(*factors)).map(lambda x: jnp.clip(x, 0.0, 1.0))


def swapped(look: Look | None, layer: Int[Array, "*rays"], row: Int[Array, "*rays"], layers: Array) -> Array:
    """Layers of the textures that materials have in this episode; -1 stays none.

    Args:
        look: Of the episode.
        layer: That the materials have.
        row: Of the materials.
        layers: (rows of the material table) those of all materials, of which any is drawn.
    """
    if look is None or look.swap is None:
        return layer
    count = jnp.max(layers, initial=-1) + 1
    other = (drawn(look.seed, row, LAYER) * count.astype(jnp.float32)).astype(jnp.int32)
    goes = (layer >= 0) & (drawn(look.seed, row, SWAPPED) < look.swap)
    return jnp.where(goes, jnp.minimum(other, count - 1), layer)


def drawn(seed: UInt32[Array, ""], row: Int[Array, "*n"], what: int) -> Float[Array, "*n"]:
    """A number in [0, 1) for each row, the same whenever it is asked for.

    Example:
        >>> drawn(jnp.uint32(7), jnp.arange(2), RED).shape
        (2,)
    """
    own = _mixed(row.astype(jnp.uint32) * jnp.uint32(GOLDEN) + jnp.uint32(what))
    return (_mixed(own ^ seed) >> 8).astype(jnp.float32) * jnp.float32(TO_UNIT)


def _mixed(x: UInt32[Array, "*n"]) -> UInt32[Array, "*n"]:
    x = (x ^ (x >> ROUNDS[0])) * jnp.uint32(FIRST)
    x = (x ^ (x >> ROUNDS[1])) * jnp.uint32(SECOND)
    return x ^ (x >> ROUNDS[2])
