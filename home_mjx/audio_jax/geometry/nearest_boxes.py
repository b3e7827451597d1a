"""Boxes nearest to the line from source to listener: by native kernels on CPUs and NVIDIA GPUs, else by XLA."""

import functools
from collections.abc import Callable
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.geometry.box_lengths import MAX_STACK_RESULTS, nearest_boxes_by_xla
from home_mjx.core.native.kernel import Kernel, call_native, compile_sources, launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes
from home_mjx.core.native.vmap_call import call_kernel, traced_constant

SOURCE = Path(__file__).with_name("nearest_boxes.cu")
THREADS, WARP = 256, 32  # as in nearest_boxes.cu


def nearest_boxes(
    fixed: Float[Array, "h 15 n"],
    fixed_owner: Int[Array, "h n"],
    house: Int[Array, ""],
    moving: Float[Array, "15 m"],
    moving_owner: Int[Array, " m"],
    source: Float[Array, "3"],
    listener: Float[Array, "3"],
    bodies: Int[Array, "2"],
    count: int,
) -> Int[Array, " k"]:
    """Return indices of the boxes over which the path from source to listener is shortest, shortest first.

    Lengths are those of `path_lengths`.

    Args:
        fixed: Boxes of all houses: centre [m], axes (unit vectors, one after the other), half sizes [m].
        fixed_owner: Object of each box; -1: architecture, `WITHOUT_EDGES`: the box has no exposed edge.
        house: Index of the environment's house.
        moving: Boxes of the environment, as `fixed`.
        moving_owner: Their objects, as `fixed_owner`.
        source: [m].
        listener: [m].
        bodies: Objects whose boxes do not count; -1 none.
        count: Maximum number of boxes.

    Returns:
        Indices into the fixed boxes of the house followed by the moving ones: `count`, or n + m if that is less. Boxes
        that do not count come last. Of equal lengths the lower index comes first.
    """
    num_boxes = fixed_owner.shape[1] + moving_owner.shape[0]
    count = min(count, num_boxes)
    ends = jax.lax.stop_gradient(jnp.concatenate([source, listener]))
    fast: dict[str, Callable[..., Array]] = {}
    if 0 < count <= MAX_STACK_RESULTS:
        fast["cpu"] = functools.partial(_by_cpu, count=count)
    if _bytes(num_boxes) <= max_shared_bytes():
        fast["cuda"] = functools.partial(_by_cuda, count=count)
    operands = fixed, fixed_owner, house, jax.lax.stop_gradient(moving), moving_owner, ends, bodies
    return KERNEL.select(functools.partial(nearest_boxes_by_xla, count=count), fast, *operands)


def _ptx() -> str:
    """Compile the CUDA kernel; return its PTX code."""
    return compile_sources(SOURCE)


def _bytes(num_boxes: int) -> int:
    """Return the shared memory of a block [bytes]: a length per box, and two values per warp."""
    return 4 * (num_boxes + 2 * THREADS // WARP)


def _by_cuda(
    fixed: Float[Array, "h 15 n"], fixed_owner: Int[Array, "h n"], *given: Array, count: int
) -> Int[Array, " k"]:
    """Compute `nearest_boxes` by the CUDA kernel; arguments as those of `nearest_boxes_by_xla`."""
    return call_kernel(launch_nearest, (count,), (fixed, fixed_owner), given)


def _by_cpu(
    fixed: Float[Array, "h 15 n"], fixed_owner: Int[Array, "h n"], *given: Array, count: int
) -> Int[Array, " k"]:
    """Compute `nearest_boxes` by the CPU kernel; arguments as those of `nearest_boxes_by_xla`."""
    return call_kernel(_call_nearest, (count,), (fixed, fixed_owner), given)


def _call_nearest(count: int, *given: Array) -> tuple[Array, ...]:
    """Call the CPU kernel for the operands of `launch_nearest`; return one array (e count)."""
    result = jax.ShapeDtypeStruct((given[2].shape[0], count), jnp.int32)
    return tuple(call_native(KERNEL.name, given, [result])) if result.size else (jnp.zeros(result.shape, jnp.int32),)


def _compile_chunks() -> tuple[Any, Any]:
    """Compile the CPU kernel; Numba is imported only here, because it loads slowly."""
    from home_mjx.audio_jax.geometry.numba_nearest_boxes import compile_chunks

    return compile_chunks()


KERNEL = Kernel(
    "home_mjx_nearest_boxes", "diffraction uses slower XLA operations", cpu=_compile_chunks, cuda=lambda: _ptx()
)


def launch_nearest(count: int, *given: Array) -> tuple[Array, ...]:
    """Launch the kernel for the operands of `nearest_boxes`, all but the first two with a leading axis e.

    Source and listener are one operand (e 6).

    Returns:
        One array (e count) of indices, see `nearest_boxes`.
    """
    sizes = given[1].shape[1], given[4].shape[1], count
    result = jax.ShapeDtypeStruct((given[2].shape[0], count), jnp.int32)
    grid, shared = (given[2].shape[0],), _bytes(sizes[0] + sizes[1])
    return launch_ptx("nearest_boxes", _ptx(), grid, THREADS, shared, (*given, traced_constant(sizes)), (result,))
