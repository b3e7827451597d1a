"""Light from baked texels: irradiance on faces that have a chart, mixed from light groups for one environment."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int, UInt32

from home_mjx.bank.records.lights import KEY_LAMPS, KEY_SUN, OTHER_LAMPS, OWN_LAMPS, LightProbes
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.lighting.probes import (
    Daylight,
    group_weights,
    lamp_factors,
    take_colors,
    unpack_colors,
    varies,
)
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import Hit, Scene
from home_mjx.raycast_render.scene.vec import Vec, take, take_vec


class MixedTexels(Pytree):
    """Irradiance at the texels of one environment, all light groups together."""

    light: Float[Array, "n 3"] | UInt32[Array, " n"]  # [W/m^2]; integers are packed
    start: Int[Array, ""] | int  # row of the house's first texel


def mix_texels(
    probes: LightProbes,
    house: Int[Array, ""],
    look: AppearanceOverrides | None,
    day: Daylight,
    lamps: bool = False,
    sun: bool = False,
) -> MixedTexels:
    """Mix the light groups of texels as `mix_groups` does for probes.

    Args:
        probes: The baked light.
        house: The environment's house.
        look: Its overrides.
        day: Its daylight.
        lamps: Add the direct light of the rooms' key lamps.
        sun: Add the direct light of the sun, which stands at `TEXEL_SUN_AZIMUTH`.
    """
    own = varies(look)
    texels = probes.texel[house] if own else probes.texel.reshape(-1, probes.texel.shape[-1])
    weights = group_weights(day)
    if lamps:
        weights[KEY_LAMPS] = jnp.ones(3)
    if sun:
        weights[KEY_SUN] = jnp.stack([jnp.asarray(c, jnp.float32) for c in (day.sun.x, day.sun.y, day.sun.z)])
    factors: dict[int, Array] = {}
    if look is not None and look.lamps is not None:
        near, far = lamp_factors(probes, house, look.lamps, probes.texel_room[house])
        factors = {OWN_LAMPS: near, OTHER_LAMPS: far, KEY_LAMPS: near}
    mixed = jnp.zeros((len(texels), 3), jnp.float32)
    for group, weight in weights.items():
        part = unpack_colors(texels[:, group]) * weight
        mixed = mixed + (part * factors[group][:, None] if group in factors else part)
    return MixedTexels(jax.lax.optimization_barrier(mixed), 0 if own else house * probes.texel.shape[1])


def find_chart(scene: Scene, probes: LightProbes, hit: Hit) -> Int[Array, "*rays"]:
    """Return the charts of hit faces; -1 for backs of triangles, faces without one, moving instances, and a miss."""
    start, model = probes.chart_start[scene.house], jnp.maximum(scene.geometry.instance_model[scene.house], 0)
    start = start[: len(model)]
    offset = start - scene.geometry.model_triangle[model[: len(start)]]
    instance = jnp.clip(hit.instance, 0, len(start) - 1)
    charted = hit.front & (hit.instance == instance) & (take(start, instance) >= 0)
    count = probes.chart.shape[1]
    row = jnp.clip(take(offset, instance) + hit.triangle, 0, count - 1)
    chart = take(probes.chart.reshape(-1), scene.house * count + row).astype(jnp.int32)
    return jnp.where(charted, chart, -1)


def texel_irradiance(
    probes: LightProbes, mixed: MixedTexels, house: Int[Array, ""], pos: Vec, chart: Int[Array, "*rays"]
) -> Vec:
    """Compute the irradiance [W/m^2] at points of charts, between four texels; arbitrary where `chart` is -1."""
    row = house * probes.chart_first.shape[1] + jnp.maximum(chart, 0)
    frame = probes.chart_frame.reshape(-1, 3, 3)
    offset = pos - take_vec(frame, row, 0)
    cell: Int[Array, "*rays"] = mixed.start + take(probes.chart_first.reshape(-1), row)
    counts = [take(probes.chart_count.reshape(-1, 2), row, axis).astype(jnp.int32) for axis in range(2)]
    shares = []
    for axis, stride in ((0, counts[1]), (1, 1)):
        place = jnp.clip(offset.dot(take_vec(frame, row, 1 + axis)), 0.0, (counts[axis] - 1).astype(jnp.float32))
        low = jnp.minimum(place.astype(jnp.int32), counts[axis] - 2)
        shares.append(place - low.astype(jnp.float32))
        cell = cell + low * stride
    found = Vec(0.0, 0.0, 0.0)
    for corner in range(4):
        x, y = corner & 1, corner >> 1
        weight = (shares[0] if x else 1.0 - shares[0]) * (shares[1] if y else 1.0 - shares[1])
        found = found + take_colors(mixed.light, cell + x * counts[1] + y) * weight
    return found
