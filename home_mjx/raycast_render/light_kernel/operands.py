"""Operands and results of the kernel of surface light, from the scene of one environment."""

from typing import NamedTuple

import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.records.lights import LightProbes
from home_mjx.raycast_render.lighting.lights import LampTables, PlacedLights
from home_mjx.raycast_render.lighting.specular import PathState
from home_mjx.raycast_render.scene.appearance import AppearanceOverrides
from home_mjx.raycast_render.scene.types import Scene

# Arrays that environments share, then those of each; `SHARED` ends with mixed light, unless each has its own.
SURFACES = ("triangle", "uv", "normal", "slot", "part", "inverse", "instance_material", "instance_semantic")
MATERIALS = ("semantics", "albedo", "specular", "shininess", "texture", "textures")
BAKES = ("first", "origin", "step", "count", "chart_start", "chart", "chart_frame", "chart_count", "chart_first")
PLACES = ("instance_model", "model_triangle", "grid", "floor", "corner")
MIXED = ("probe", "texel")
ENVIRONMENT = ("house", "moving_slot", "moving_inverse", "moving_material", "moving_semantic", "look", "look_ids")
LAMPS = ("lights", "light_ids", "by_room", "by_instance", "sky", "growth")
RAYS = ("t", "instance", "triangle_hit", "u", "v", "front", "from_", "direction", "footprint")
NAMES = (*SURFACES, *MATERIALS, *BAKES, *PLACES, *MIXED, *ENVIRONMENT, *LAMPS, *RAYS)
NUM_SHARED = len((*SURFACES, *MATERIALS, *BAKES, *PLACES))
ATTRIBUTES = ("baked", "lamps", "packed", "sun", "sunny")  # in alphabetical order, as kernels read them
RESULTS = ("base", "start", "way", "reach", "exclude", "share")
PLACE = {name: place for place, name in enumerate(NAMES)}


class LightInputs(NamedTuple):
    """Light of one environment: what the kernel reads besides surfaces.

    Attributes:
        probe: Mixed light of probes, of all houses in floats or of this environment, packed.
        texel: That of texels.
        lights: Lights of the environment.
        lamps: Choice of lamps at points.
        sky: Colours of the sky at the zenith, the horizon and the ground, the factor `ambient`, direction and light of
            the sun, and the edge of a navigation cell [m].
        num_lamps: Lamps per point.
        sun: Whether the sun shines.
        baked: Texels have the light of lamps.
        sunny: Texels have the light of the sun.
    """

    probe: Array
    texel: Array
    lights: PlacedLights
    lamps: LampTables
    sky: Float[Array, " n"]
    num_lamps: int
    sun: bool
    baked: bool
    sunny: bool


def shared_operands(scene: Scene, probes: LightProbes) -> tuple[Array, ...]:
    """Return the operands up to `PLACES`, which all environments share."""
    geometry, bank, table = scene.geometry, scene.bank, scene.bank.navigation
    materials, finish = bank.materials, bank.finish
    surfaces = geometry.triangle, geometry.triangle_uv, finish.normal, geometry.triangle_slot, geometry.triangle_part
    instances = geometry.instance_inverse, geometry.instance_material, geometry.instance_semantic
    looks = bank.semantics, materials.albedo, finish.specular, finish.shininess, materials.texture, materials.textures
    bakes = (getattr(probes, name) for name in BAKES)
    places = geometry.instance_model, geometry.model_triangle, table.room, table.floor, table.origin
    return *surfaces, *instances, *looks, *bakes, *places


def environment_operands(scene: Scene) -> tuple[Array, ...]:
    """Return the operands `ENVIRONMENT` of one environment."""
    moving = scene.moving
    size = scene.geometry.instance_model.shape[1] + moving.instance.shape[0]
    rows = jnp.arange(moving.instance.shape[0], dtype=jnp.int32)
    slot = (
        jnp.full(size, -1, jnp.int32).at[jnp.where(moving.instance < 0, size, moving.instance)].set(rows, mode="drop")
    )
    look = _look_operands(scene.appearance, scene.bank.materials.texture)
    return scene.house, slot, moving.inverse, moving.material, moving.semantic, *look


def _look_operands(look: AppearanceOverrides | None, texture: Array) -> tuple[Array, Array]:
    """Return tint and swap, 0 for none, then the seed's bits and the last texture layer."""
    zero = jnp.float32(0)
    if look is None:
        return jnp.zeros(2, jnp.float32), jnp.zeros(2, jnp.int32)
    amounts = [zero if x is None else x.astype(jnp.float32) for x in (look.tint, look.swap)]
    last = jnp.max(texture, initial=-1).astype(jnp.int32)
    return jnp.stack(amounts), jnp.stack([look.seed.astype(jnp.int32), last])


def light_operands(lights: PlacedLights) -> tuple[Array, Array]:
    """Return the operands `lights` and `light_ids`."""
    vectors = lights.pos, lights.direction, lights.intensity
    numbers = lights.power, lights.exponent, lights.cutoff, lights.area
    table = jnp.stack([*(c for v in vectors for c in (v.x, v.y, v.z)), *numbers], axis=-1)
    return table, jnp.stack([lights.instance, lights.object_id], axis=-1)


def lamp_operands(inputs: LightInputs) -> tuple[Array, ...]:
    """Return the operands `LAMPS` but for `growth`."""
    return *light_operands(inputs.lights), inputs.lamps.by_room, inputs.lamps.by_instance, inputs.sky


def ray_operands(path: PathState) -> tuple[Array, ...]:
    """Return the operands `RAYS`, of one axis."""
    hit, count = path.hit, path.hit.t.size
    shape = path.hit.t.shape
    flat = [x.reshape(count) for x in (hit.t, hit.instance, hit.triangle, hit.u, hit.v, hit.front)]
    # Packing computes each component once; stacking would repeat shared parts for each.
    vectors = [
        v.map(lambda c: jnp.broadcast_to(c, shape)).pack().reshape(count, 3) for v in (path.origin, path.direction)
    ]
    return *flat, *vectors, path.footprint.reshape(count)
