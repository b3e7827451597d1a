"""Call of the kernel of surface light, and the cast of its shadow rays."""

import functools
from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.bank.records.lights import LightProbes
from home_mjx.core.native.kernel import Kernel, call_native
from home_mjx.core.native.vmap_call import batch_kernel
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.light_kernel import cuda, operands
from home_mjx.raycast_render.light_kernel.operands import LightInputs
from home_mjx.raycast_render.lighting.specular import PathState
from home_mjx.raycast_render.scene.types import Scene

TARGET = "home_mjx_surface_light"


def _compile() -> tuple[Any, Any]:
    """Import and compile the Numba code; return its C functions."""
    from home_mjx.raycast_render.light_kernel import chunks

    return chunks.compile_chunks()


KERNEL = Kernel(
    TARGET, "falling back to slower shading of `lit` and `baked`", cpu=_compile, cuda=lambda: cuda.compile_kernels()
)


def surface_light(
    scene: Scene, probes: LightProbes, path: PathState, growth: Float[Array, ""], inputs: LightInputs
) -> Float[Array, "*image 3"]:
    """Compute the radiance of surfaces at the ends of paths [W/m^2/sr]; 0 on a miss. `KERNEL` must be usable.

    Args:
        scene: Scene of one environment.
        probes: Its baked light.
        path: Camera rays to their last hits.
        growth: Increase of footprints per unit of t [m].
        inputs: Light of the environment.
    """
    packed = inputs.probe.ndim == 2  # colours of six faces, in one number each
    shared = operands.shared_operands(scene, probes)
    own = (
        *operands.environment_operands(scene),
        *operands.lamp_operands(inputs),
        growth.reshape(1),
        *operands.ray_operands(path),
    )
    mixed = inputs.probe, inputs.texel
    first = len(shared) + (0 if packed else len(mixed))
    given = tuple(x if i < first else x[None] for i, x in enumerate((*shared, *mixed, *own)))
    flags = (("baked", inputs.baked), ("lamps", inputs.num_lamps), ("packed", packed))
    flags = (*flags, ("sun", inputs.sun), ("sunny", inputs.sunny))
    found = _batched(first, tuple((name, int(value)) for name, value in flags))(*given)
    base, start, way, reach, exclude, share = (x[0] for x in found)
    image = path.hit.t.shape
    shapes = [(reach.shape[0], *image, *x.shape[2:]) for x in (start, way, reach, exclude, share)]
    start, way, reach, exclude, share = (
        x.reshape(shape) for x, shape in zip((start, way, reach, exclude, share), shapes, strict=True)
    )
    blocked = occluded(scene, start, way, t_max=reach, exclude=exclude)
    return base.reshape(*image, 3) + jnp.sum(jnp.where(blocked[..., None], 0.0, share), axis=0)


@functools.cache
def _batched(num_shared: int, flags: tuple[tuple[str, int], ...]) -> Callable[..., tuple[Array, ...]]:
    """Return the kernel for all environments."""
    return batch_kernel(functools.partial(_run, flags), num_shared, len(operands.RESULTS))


def _run(flags: tuple[tuple[str, int], ...], *given: Array) -> tuple[Array, ...]:
    """Call the kernel on operands `operands.NAMES`."""
    values = dict(flags)
    environments, count = given[operands.PLACE["t"]].shape
    rays = max(values["lamps"] + values["sun"], 1)
    shapes = ((count, 3), (rays, count, 3), (rays, count, 3), (rays, count), (rays, count), (rays, count, 3))
    kinds = (jnp.float32, jnp.float32, jnp.float32, jnp.float32, jnp.int32, jnp.float32)
    results = [jax.ShapeDtypeStruct((environments, *s), k) for s, k in zip(shapes, kinds, strict=True)]
    return call_native(TARGET, given, results, **values)
