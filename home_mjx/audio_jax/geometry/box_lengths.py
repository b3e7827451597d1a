"""Lengths of the paths from source to listener over boxes, with XLA, and constants shared with native kernels."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.transforms import length3, sum3

NUM_PROJECTIONS = 3  # projections onto segment and box, as in nearest_boxes.cu
MIN_LINE_LENGTH = 0.01  # [m], minimum distance of source and listener, as in nearest_boxes.cu
WITHOUT_EDGES = -2  # owner of a box without exposed edges, as in nearest_boxes.cu
NUM_FIELDS = 15  # values of a box: centre, axes and half sizes
MAX_STACK_RESULTS = 256  # maximum number of results of the CPU kernel, whose lengths are on the stack


def nearest_boxes_by_xla(
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
    length = path_lengths(jnp.concatenate([fixed[house], moving], axis=1), ends[:3], ends[3:])
    return jax.lax.top_k(-jnp.where(excluded, jnp.inf, length), count)[1].astype(jnp.int32)


def path_lengths(
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
