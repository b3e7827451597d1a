"""Boxes nearest to the line from source to listener: by a CUDA kernel on NVIDIA GPUs, by XLA operations elsewhere."""

import functools
from pathlib import Path

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.native.kernel import Kernel, compile_sources, launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes
from home_mjx.core.native.vmap_call import call_kernel, traced_constant
from home_mjx.core.transforms import length3, sum3

SOURCE = Path(__file__).with_name("nearest_boxes.cu")
THREADS, WARP = 256, 32  # as in nearest_boxes.cu
NUM_PROJECTIONS = 3  # projections onto segment and box, as in nearest_boxes.cu
MIN_LINE_LENGTH = 0.01  # [m], minimum distance of source and listener, as in nearest_boxes.cu
WITHOUT_EDGES = -2  # owner of a box without exposed edges, as in nearest_boxes.cu
KERNEL = Kernel("home_mjx_nearest_boxes", "diffraction uses slower XLA operations", cuda=lambda: _ptx())


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

    Lengths are those of `_path_lengths`.

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
    fast = {"cuda": functools.partial(_by_cuda, count=count)} if _bytes(num_boxes) <= max_shared_bytes() else {}
    operands = fixed, fixed_owner, house, jax.lax.stop_gradient(moving), moving_owner, ends, bodies
    return KERNEL.select(functools.partial(_by_xla, count=count), fast, *operands)


def _by_xla(
    fixed: Float[Array, "h 15 n"],
    fixed_owner: Int[Array, "h n"],
    house: Int[Array, ""],
    moving: Float[Array, "15 m"],
    moving_owner: Int[Array, " m"],
    ends: Float[Array, "6"],
    bodies: Int[Array, "2"],
    count: int,
) -> Int[Array, " k"]:
    """Compute `nearest_boxes`, over which the path from source to listener is shortest, with XLA operations.

    `ends` is the source, then the listener [m]. `count` must not exceed the number of boxes, n + m. Boxes of `bodies`
    and those without exposed edges come last.
    """
    owner = jnp.concatenate([fixed_owner[house], moving_owner])
    excluded = (owner <= WITHOUT_EDGES) | ((owner >= 0) & jnp.any(owner[:, None] == bodies[None], axis=1))
    length = _path_lengths(jnp.concatenate([fixed[house], moving], axis=1), ends[:3], ends[3:])
    return jax.lax.top_k(-jnp.where(excluded, jnp.inf, length), count)[1].astype(jnp.int32)


def _path_lengths(
    boxes: Float[Array, "15 n"], source: Float[Array, "3"], listener: Float[Array, "3"]
) -> Float[Array, " n"]:
    """Compute the length [m] of a path from source via a point of each box to listener; boxes as in `nearest_boxes`.

    Starting at the box's centre, the point is projected onto the segment from source to listener, and from there back
    onto the box, `NUM_PROJECTIONS` times. It approaches the point nearest to the segment.
    """
    way = listener - source
    center, axis, half = boxes[:3].T, jnp.moveaxis(boxes[3:12].reshape(3, 3, -1), -1, 0), boxes[12:].T

    def closer(place: Float[Array, "n 3"]) -> Float[Array, "n 3"]:
        """Project one point per box onto the segment from source to listener, and that point back onto its box."""
        share = sum3((place - source[None]) * way[None]) / jnp.maximum(sum3(way * way), MIN_LINE_LENGTH**2)
        on_line = source[None] + jnp.clip(share, 0.0, 1.0)[:, None] * way[None]
        inside = jnp.clip(sum3(axis * (on_line - center)[:, None]), -half, half)
        return center + sum3(jnp.swapaxes(axis * inside[:, :, None], 1, 2))

    place = center
    for _ in range(NUM_PROJECTIONS):
        place = closer(place)
    return length3(place - source[None]) + length3(place - listener[None])


def _ptx() -> str:
    """Compile the CUDA kernel; return its PTX code."""
    return compile_sources(SOURCE)


def _bytes(num_boxes: int) -> int:
    """Return the shared memory of a block [bytes]: a length per box, and two values per warp."""
    return 4 * (num_boxes + 2 * THREADS // WARP)


def _by_cuda(
    fixed: Float[Array, "h 15 n"], fixed_owner: Int[Array, "h n"], *given: Array, count: int
) -> Int[Array, " k"]:
    """Compute `nearest_boxes` by the CUDA kernel; arguments as those of `_by_xla`."""
    return call_kernel(launch_nearest, (count,), (fixed, fixed_owner), given)


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
