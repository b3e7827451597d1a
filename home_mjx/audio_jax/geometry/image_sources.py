"""Image sources in rectangles up to third order, with geometric validation of their paths."""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import length3, sum3

MIN_PLANE_DISTANCE = 1e-6  # [m], minimum distance of an image from its mirror plane
CORNER_TOLERANCE = 1e-4  # [m], tolerance at edges of mirrors: a path into a corner is valid in both orders of its sides


class Mirrors(Pytree):
    """Rectangles that reflect sound on the side of their normal."""

    center: Float[Array, "m 3"]  # [m]
    normal: Float[Array, "m 3"]
    u: Float[Array, "m 3"]  # [m], half extent vectors
    v: Float[Array, "m 3"]
    valid: Bool[Array, " m"]
    material: Int[Array, " m"] | None = None  # row of the material table; -1 or None: that of the surface hit by rays


class ImageSources(Pytree):
    """Specular paths of `order` reflections each."""

    length: Float[Array, " i"]  # [m]; inf if the path is not valid
    point: Float[Array, "i k 3"]  # [m], reflection points in order from the listener; padded with the source
    normal: Float[Array, "i k 3"]  # of the mirrors there; padded with 0
    order: Int[Array, " i"]  # number of reflections
    mirror: Int[Array, "i k"]  # index of each mirror; -1 none


@functools.cache
def mirror_sequences(num_mirrors: int, order: int) -> Int[np.ndarray, "i k"]:
    """Enumerate the sequences of `order` mirror indices whose neighbours differ, one per row, in lexicographic order.

    Example:
        >>> len(mirror_sequences(6, 1)), len(mirror_sequences(6, 2)), len(mirror_sequences(6, 3))
        (6, 30, 150)
    """
    every = itertools.product(range(num_mirrors), repeat=order)
    kept = [row for row in every if all(a != b for a, b in itertools.pairwise(row))]
    return np.array(kept, np.int32).reshape(-1, order)


def find_image_sources(
    mirrors: Mirrors, source: Float[Array, "3"], listener: Float[Array, "3"], max_order: int
) -> ImageSources:
    """Find image sources of orders 1 to `max_order`, at least 1, and validate their paths backwards from the listener.

    With m mirrors there are m + m (m - 1) + m (m - 1)² sequences of orders 1, 2 and 3.

    Returns:
        One row per sequence, by order; `length` is inf if its path is invalid. Occlusion is not tested.

    Example:
        >>> x, y, z = np.eye(3, dtype=np.float32) * 5  # a cube of 10 m
        >>> sides = [(x, y, z), (-x, y, z), (y, x, z), (-y, x, z), (z, x, y), (-z, x, y)]
        >>> n, u, v = (jnp.array(column) for column in zip(*sides, strict=True))
        >>> cube = Mirrors(-n, n / 5, u, v, jnp.ones(6, bool))
        >>> found = find_image_sources(cube, jnp.array([0.1, 0.2, 0.3]), jnp.array([2.5, -2.4, 3.0]), max_order=3)
        >>> int(jnp.isfinite(found.length).sum())  # 63 with the direct path
        62
    """
    count = mirrors.valid.shape[0]
    parts = [
        _validate_sequences(mirrors, mirror_sequences(count, order), source, listener, max_order)
        for order in range(1, max_order + 1)
    ]
    return jax.tree.map(lambda *x: jnp.concatenate(x), *parts)


def _validate_sequences(
    mirrors: Mirrors,
    rows: Int[np.ndarray, "i k"],
    source: Float[Array, "3"],
    listener: Float[Array, "3"],
    max_order: int,
) -> ImageSources:
    """Validate one path per sequence of mirror indices (from the source on) in `rows`; invalid ones have length inf.

    Valid paths meet each mirror inside its rectangle, from the reflecting side. Reflections are padded to `max_order`,
    see `ImageSources`.
    """
    count, order = rows.shape
    met = [jax.tree.map(lambda x, k=k: x[rows[:, k]], mirrors) for k in range(order)]
    image, valid = [jnp.broadcast_to(source, (count, 3))], jnp.ones(count, bool)
    for mirror in met:
        before = _signed_distance(mirror, image[-1])
        image.append(image[-1] - 2 * before[:, None] * mirror.normal)
        valid = valid & mirror.valid & (before > MIN_PLANE_DISTANCE)
    at, points = jnp.broadcast_to(listener, (count, 3)), []
    for mirror, behind in zip(met[::-1], image[:0:-1], strict=True):
        before, after = _signed_distance(mirror, at), _signed_distance(mirror, behind)
        share = before / jnp.maximum(before - after, MIN_PLANE_DISTANCE)
        at = at + share[:, None] * (behind - at)
        valid = valid & (before > -CORNER_TOLERANCE) & (after < -MIN_PLANE_DISTANCE) & _is_inside(mirror, at)
        points.append(at)
    rest = jnp.broadcast_to(source, (count, max_order - order, 3))
    normals = jnp.stack([mirror.normal for mirror in met[::-1]], axis=1)
    length = length3(image[-1] - listener[None])
    return ImageSources(
        jnp.where(valid, length, jnp.inf),
        jnp.concatenate([jnp.stack(points, axis=1), rest], axis=1),
        jnp.concatenate([normals, jnp.zeros_like(rest)], axis=1),
        jnp.full(count, order, jnp.int32),
        jnp.pad(jnp.asarray(rows[:, ::-1]), [(0, 0), (0, max_order - order)], constant_values=-1),
    )


def select_nearest_mirrors(
    mirrors: Mirrors, source: Float[Array, "3"], listener: Float[Array, "3"], count: int
) -> Mirrors:
    """Select up to `count` mirrors with the shortest paths from source to listener, shortest first.

    The reflection point is the specular point on the plane, clamped to the rectangle; heights behind the plane count as
    0. Invalid mirrors, and those that have both source and listener behind them, come last, with `valid` False.
    """
    before = (
        jnp.maximum(_signed_distance(mirrors, source[None]), 0),
        jnp.maximum(_signed_distance(mirrors, listener[None]), 0),
    )
    share = before[1] / jnp.maximum(before[0] + before[1], MIN_PLANE_DISTANCE)
    point = listener[None] + share[:, None] * (source - listener)[None] - mirrors.center
    size = [sum3(half * half) for half in (mirrors.u, mirrors.v)]
    place = [
        jnp.clip(sum3(point * half) / jnp.maximum(s, MIN_PLANE_DISTANCE), -1, 1)[:, None] * half
        for half, s in zip((mirrors.u, mirrors.v), size, strict=True)
    ]
    point = mirrors.center + place[0] + place[1]
    length = length3(point - source[None]) + length3(point - listener[None])
    length = jnp.where(mirrors.valid & (before[0] + before[1] > 0), length, jnp.inf)
    shortest, kept = jax.lax.top_k(-length, min(count, length.size))
    found = jax.tree.map(lambda x: x[kept], mirrors)
    return found.replace(valid=found.valid & jnp.isfinite(shortest))


def _signed_distance(mirror: Mirrors, point: Float[Array, "#i 3"]) -> Float[Array, " i"]:
    """Return signed distances of points from the mirrors' planes [m], positive on the reflecting side."""
    return sum3((point - mirror.center) * mirror.normal)


def _is_inside(mirror: Mirrors, point: Float[Array, "i 3"]) -> Bool[Array, " i"]:
    """Return whether points in the planes of mirrors are inside their rectangles, with `CORNER_TOLERANCE`."""

    def along(half: Float[Array, "i 3"]) -> Bool[Array, " i"]:
        """Return whether points are within the extent from -`half` to `half`."""
        size = length3(half)
        return jnp.abs(sum3((point - mirror.center) * half)) <= size * (size + CORNER_TOLERANCE)

    return along(mirror.u) & along(mirror.v)
