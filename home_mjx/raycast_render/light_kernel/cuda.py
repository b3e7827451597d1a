"""Radiance of camera rays on NVIDIA GPUs: `radiance.cu`, one launch from first hits to light."""

import functools
from pathlib import Path

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records.gpu_geometry import gpu_geometry
from home_mjx.bank.records.lights import LightProbes
from home_mjx.core.native.kernel import compile_sources, launch_ptx
from home_mjx.core.native.vmap_call import batch_kernel, traced_constant
from home_mjx.raycast_render.backends import cuda as rays
from home_mjx.raycast_render.light_kernel import operands
from home_mjx.raycast_render.light_kernel.operands import LightInputs
from home_mjx.raycast_render.lighting.specular import GLASS, PathState
from home_mjx.raycast_render.lighting.texture import texture_edge
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.schema.semantic import Semantic

SOURCES = (rays.SOURCE, *(Path(__file__).with_name(name) for name in ("surface.cuh", "light.cuh", "radiance.cu")))
SHARED = ("node", "triangle", "material_mask", "uv", "cutout", "fixed", "house_root", "normal", "part")
SHARED = (*SHARED, "instance_semantic", "semantics", "albedo", "specular", "shininess", "texture", "textures", "kind")
SHARED = (*SHARED, "mirror", *operands.PLACES, *operands.BAKES)
OWN = ("house", "moving", "box", "moving_slot", "moving_semantic", "look", "look_ids", *operands.LAMPS, "glow")
OWN = (*OWN, "glowing", "emission", "exclude", *operands.RAYS[:-1])
NAMES = (*SHARED, *operands.MIXED, *OWN)
PLACE = {name: place for place, name in enumerate(NAMES)}
Flags = tuple[tuple[str, int], ...]


def compile_kernels() -> str:
    """Return `radiance.cu` compiled to PTX that all GPUs of this process can run."""
    return compile_sources(*SOURCES, WITHOUT_CASTS=1)


def path_radiance(
    scene: Scene,
    probes: LightProbes,
    path: PathState,
    growth: Float[Array, ""],
    exclude: Int[Array, ""] | int,
    depth: int,
    inputs: LightInputs,
) -> Vec:
    """Compute the radiance along camera rays, by glass and mirrors too [W/m^2/sr]; that of the sky on a miss.

    The kernel of `surface_light` must be usable on the GPU; there is no fallback.

    Args:
        scene: Scene of one environment.
        probes: Its baked light.
        path: Camera rays to their first hits.
        growth: Increase of footprints per unit of t [m].
        exclude: Object id hidden from the camera, except in mirrors; -1 none.
        depth: Maximum number of specular events.
        inputs: Light of the environment.
    """
    image = path.hit.t.shape
    packed = inputs.probe.ndim == 2  # colours of six faces, in one number each
    shared = _shared_operands(scene, probes)
    mixed = inputs.probe, inputs.texel
    first = len(shared) + (0 if packed else len(mixed))
    own = _own_operands(scene, path, growth, exclude, inputs)
    given = tuple(x if i < first else x[None] for i, x in enumerate((*shared, *mixed, *own)))
    width = image[1] if len(image) == 2 else 0
    flags = (*_sizes(probes, inputs), ("depth", depth), ("packed", int(packed)), ("width", width))
    light = _batched(first, flags)(*given)[0][0]
    return Vec.unpack(light.reshape(*image, 3))


def _shared_operands(scene: Scene, probes: LightProbes) -> tuple[Array, ...]:
    """Return the operands `SHARED`."""
    geometry, bank, table = scene.geometry, scene.bank, scene.bank.navigation
    gpu = gpu_geometry(geometry) if geometry.gpu is None else geometry.gpu
    materials, finish = bank.materials, bank.finish
    casts = gpu.node, gpu.triangle, geometry.material_mask, geometry.triangle_uv, geometry.cutout, gpu.instance
    surfaces = geometry.house_root, finish.normal, geometry.triangle_part, geometry.instance_semantic, bank.semantics
    looks = materials.albedo, finish.specular, finish.shininess, materials.texture, materials.textures, materials.kind
    places = geometry.instance_model, geometry.model_triangle, table.room, table.floor, table.origin
    return *casts, *surfaces, *looks, finish.mirror, *places, *(getattr(probes, name) for name in operands.BAKES)


def _own_operands(
    scene: Scene, path: PathState, growth: Float[Array, ""], exclude: Int[Array, ""] | int, inputs: LightInputs
) -> tuple[Array, ...]:
    """Return the operands `OWN` of one environment."""
    house, slot, _, _, semantic, *look = operands.environment_operands(scene)
    glow = None if scene.appearance is None else scene.appearance.glow
    *hits, footprint = operands.ray_operands(path)
    return (
        house,
        *rays.moving_operands(scene.geometry, scene.moving),
        slot,
        semantic,
        *look,
        *operands.lamp_operands(inputs),
        jnp.stack([footprint[0], growth]),
        jnp.zeros(1) if glow is None else glow,
        *_emission(scene),
        jnp.asarray(exclude, jnp.int32),
        *hits,
    )


def _emission(scene: Scene) -> tuple[Int[Array, " g"], Float[Array, "g 3"]]:
    """Return the rows of materials that emit, and their emission; a row of padding if there are none."""
    lights = scene.bank.lights
    if not lights.glowing.shape[1]:
        return jnp.full(1, -1, jnp.int32), jnp.zeros((1, 3), jnp.float32)
    return lights.glowing[scene.house], lights.glow[scene.house]


def _sizes(probes: LightProbes, inputs: LightInputs) -> Flags:
    """Return the static numbers of a call that its operands do not tell."""
    rows = inputs.probe.shape[0], inputs.texel.shape[0]
    houses = 1 if inputs.probe.ndim == 2 else probes.first.shape[0]
    probe_rows, texel_rows = (count // houses for count in rows)
    names = ("probes", probe_rows), ("texels", texel_rows), ("lamps", inputs.num_lamps)
    return (*names, *((name, int(getattr(inputs, name))) for name in ("sun", "baked", "sunny")))


@functools.cache
def _batched(num_shared: int, flags: Flags):  # noqa: ANN202  (a `vmap_call.Step`)
    """Return the kernel for all environments."""
    return batch_kernel(functools.partial(_run, flags), num_shared, 1)


def _run(flags: Flags, *given: Array) -> tuple[Array, ...]:
    """Launch the kernel on operands `NAMES`."""
    at = {name: given[place] for name, place in PLACE.items()}
    environments, count = at["t"].shape
    values = dict(flags)
    size = traced_constant(_size_vector(at, values))
    result = jax.ShapeDtypeStruct((environments, count, 3), jnp.float32)
    grid = rays.launch_grid(environments, count, values["width"])
    return launch_ptx("shade_paths", compile_kernels(), grid, rays.BLOCK, 0, (*given, size), (result,))


def _size_vector(at: dict[str, Array], values: dict[str, int]) -> tuple[int, ...]:
    """Return the numbers of `enum Size` of radiance.cu."""
    environments, count = at["t"].shape
    rows = {name: x.shape[0] for name, x in at.items()}
    each = {name: x.shape[1] for name, x in at.items() if x.ndim > 1}
    tiled = rays.tile_width(count, values["width"])
    casts = environments, count, each["fixed"], each["moving"], tiled, rows["node"], rows["triangle"]
    casts = *casts, rows["material_mask"], rows["house_root"], *at["cutout"].shape[:2]
    surfaces = *at["semantics"].shape, int(Semantic.ROOM), GLASS, *at["textures"].shape, texture_edge(at["textures"])
    bakes = values["probes"], values["texels"], each["first"], each["chart_start"], each["chart"], each["chart_first"]
    places = rows["model_triangle"], *at["grid"].shape[1:], each["moving_slot"]
    lamps = each["lights"], *at["by_room"].shape[1:], each["by_instance"], each["glow"], each["glowing"]
    flags = (values[name] for name in ("depth", "lamps", "sun", "baked", "sunny", "packed"))
    return *casts, *surfaces, *bakes, *places, *lamps, *flags
