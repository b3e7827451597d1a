"""Clouds, haze and blades of grass, as cameras see them outdoors; they light nothing."""

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.records.materials import KIND_INDEX
from home_mjx.raycast_render.lighting.specular import PathState
from home_mjx.raycast_render.scene.appearance import hash_uniform
from home_mjx.raycast_render.scene.surface import material_rows
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, take

CLOUD_HEIGHT, CLOUD_SIZE = 1.0, 0.9  # height of the layer, and width of its largest clouds, in the same unit
CLOUD_OCTAVES, CLOUD_EDGE = 5, 0.15  # of the noise; half of the share of ranks from clear to dense
NOISE_MEAN, NOISE_SCALE = 0.484, 0.068  # of the sum of octaves, whose distribution is nearly logistic
CLOUD_COLOR, CLOUD_LEVEL = (1.0, 1.0, 1.02), 1.15  # times the radiance of the sky
LOWEST_CLOUDS = 0.12  # sine of the elevation below which clouds fade
GRASS_SIZES, GRASS_CONTRAST = (0.012, 0.15), (0.55, 0.25)  # [m]; amplitudes about the mean, of blades and of tufts
GRASS = KIND_INDEX["grass"]
MIN_HEIGHT = 0.1  # [m], of an eye above the ground


def cloud_density(direction: Vec, cover: float) -> Float[Array, "*rays"]:
    """Return the opacity of clouds in directions of any length: 0 clear, 1 dense; `cover` 0 is none, 1 a closed sky.

    The clouds are a plane layer of fractal noise, equal in all episodes. They thin out towards the horizon.

    Source: K. Perlin, "An image synthesizer", SIGGRAPH 1985.
    """
    up = direction.z * direction.inverse_norm()
    reach = CLOUD_HEIGHT / (jnp.maximum(up, 0.0) + 0.05) * direction.inverse_norm() / CLOUD_SIZE
    x, y = direction.x * reach, direction.y * reach
    noise = jnp.zeros_like(x)
    for octave in range(CLOUD_OCTAVES):
        noise = noise + _value_noise(x * 2.0**octave, y * 2.0**octave, octave) * 0.5 ** (octave + 1)
    rank = 1 / (1 + jnp.exp((NOISE_MEAN - noise) / NOISE_SCALE))
    dense = _smooth((rank - (1 - cover) * (1 + 2 * CLOUD_EDGE) + 2 * CLOUD_EDGE) / (2 * CLOUD_EDGE))
    return dense * _smooth(up / LOWEST_CLOUDS)


def add_clouds(sky: Vec, direction: Vec, cover: float, radiance: float) -> Vec:
    """Return the sky's light [W/m^2/sr] with clouds before it; `radiance` is that of the sky, which clouds scatter."""
    dense = cloud_density(direction, cover)
    shade = CLOUD_LEVEL * radiance * (1.0 - 0.35 * dense)
    return sky * (1 - dense) + Vec(*CLOUD_COLOR) * (shade * dense)


def add_haze(path: PathState, light: Vec, horizon: Vec, extinction: float) -> Vec:
    """Return light behind haze, which has the colour of the horizon; by Koschmieder's law, exp(-extinction * distance).

    Distances [m] are those of hits from the last mirror or pane. Rays that miss reach a plane ground at height 0; above
    the horizon they are unchanged.
    """
    inverse = path.direction.inverse_norm()
    down = jnp.maximum(-path.direction.z * inverse, 1e-6)
    ground = jnp.maximum(path.origin.z, MIN_HEIGHT) / down
    missed = path.hit.instance < 0
    distance = jnp.where(missed, ground, path.hit.t / inverse)
    clear = jnp.where(missed & (path.direction.z >= 0), 1.0, jnp.exp(-extinction * jnp.minimum(distance, 1e6)))
    return light * clear + horizon * (1 - clear)


def grass_detail(scene: Scene, path: PathState, growth: Float[Array, ""]) -> Float[Array, "*rays"]:
    """Return factors of the light of lawns, of mean 1: blades and tufts, which fade where pixels are larger; else 1."""
    hit, pos = path.hit, path.end
    row = jnp.maximum(material_rows(scene, hit), 0)
    lawn = (hit.instance >= 0) & (take(scene.bank.materials.kind, row) == GRASS)
    width = path.footprint + growth * jnp.where(hit.instance < 0, 0.0, hit.t)
    facing = jnp.maximum(jnp.abs(path.direction.z) * path.direction.inverse_norm(), 0.05)
    factor = jnp.ones_like(width)
    for what, (size, contrast) in enumerate(zip(GRASS_SIZES, GRASS_CONTRAST, strict=True)):
        noise = 2 * _value_noise(jnp.asarray(pos.x) / size, jnp.asarray(pos.y) / size, CLOUD_OCTAVES + what) - 1
        factor = factor + contrast * noise * jnp.clip(2 - width / (facing * size), 0.0, 1.0)
    return jnp.where(lawn, factor, 1.0)


def _value_noise(x: Float[Array, "*rays"], y: Float[Array, "*rays"], what: int) -> Float[Array, "*rays"]:
    """Return smooth noise in [0, 1) with a random value at every point with integer coordinates; `what`: which."""
    column, row = (jnp.floor(jnp.clip(v, -1e6, 1e6)) for v in (x, y))
    across, along = _smooth(x - column), _smooth(y - row)

    def corner(dx: int, dy: int) -> Float[Array, "*rays"]:
        """Return the value of a corner of the cell."""
        cell = (column.astype(jnp.int32) + dx) * 8191 + (row.astype(jnp.int32) + dy)
        return hash_uniform(jnp.uint32(0), cell, what)

    lower = corner(0, 0) * (1 - across) + corner(1, 0) * across
    upper = corner(0, 1) * (1 - across) + corner(1, 1) * across
    return lower * (1 - along) + upper * along


def _smooth(x: Float[Array, "*rays"]) -> Float[Array, "*rays"]:
    """Return 0 below 0, 1 above 1 and a smooth step between."""
    x = jnp.clip(x, 0.0, 1.0)
    return x * x * (3 - 2 * x)
