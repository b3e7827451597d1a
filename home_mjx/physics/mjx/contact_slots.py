"""Contact slots: the static boxes of the environment's house that are nearest to each owner.

Each owner (agent or movable body) has a few slot geoms that only it can touch. They are refilled before every physics
step. The cost of a step is therefore independent of the house's size, and environments in different houses share one
model.

Vectors are separate arrays per component: XLA's CPU backend turns sums over an axis of 3 into scalar loops, which was
90 times slower.
"""

from collections.abc import Sequence

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.pytree import Pytree
from home_mjx.physics.mjx.template_mjcf import PARKED_HEIGHT, PARKED_SIZE

MAX_SLOT_DISTANCE = 0.05  # [m], maximum distance of a box from its owner; farther boxes are parked
MIN_HEIGHT_ABOVE_FLOOR = 0.01  # [m], minimum height of a box above the floor; lower boxes count as floor

Vector = Sequence[Array]  # x, y, z


class OrientedBoxes(Pytree):
    """Oriented boxes."""

    pos: Float[Array, "*n 3"]  # [m], centre
    quat: Float[Array, "*n 4"]
    half: Float[Array, "*n 3"]  # [m], half extents

    @property
    def axes(self) -> list[Vector]:
        """The three box axes in the world frame, each as a list of its x, y and z arrays; `quat` must be normalised."""
        w, x, y, z = (self.quat[..., i] for i in range(4))
        one = jnp.ones_like(w)
        return [
            [one - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
            [2 * (x * y - w * z), one - 2 * (x * x + z * z), 2 * (y * z + w * x)],
            [2 * (x * z + w * y), 2 * (y * z - w * x), one - 2 * (x * x + y * y)],
        ]

    @property
    def top(self) -> Float[Array, "*n"]:
        """Height of the highest corner [m]."""
        rise = _dot([jnp.abs(axis[2]) for axis in self.axes], _components(self.half))
        return self.pos[..., 2] + rise

    def rise_above(self, floor: Float[Array, "*#n"]) -> Bool[Array, "*n"]:
        """Return whether each box rises above a floor at the given height [m] by more than `MIN_HEIGHT_ABOVE_FLOOR`."""
        return self.top > floor + jnp.float32(MIN_HEIGHT_ABOVE_FLOOR)


def half_above_floor(physics: Physics) -> Float[Array, "h c 3"]:
    """Return half extents [m] of all houses' static boxes; -1 for boxes that do not `rise_above` the ground floor.

    Padding, which is far below, is -1, too.
    """
    boxes = OrientedBoxes(physics.collider_pos, physics.collider_quat, physics.collider_size)
    above = boxes.rise_above(physics.floor[:, None])
    return jnp.where(above[..., None], physics.collider_size, jnp.float32(-1.0))


def separation(owner: OrientedBoxes, static: OrientedBoxes) -> Float[Array, " c"]:
    """Return the largest gap between the owner's box and each static box along the six face axes of both [m].

    `owner` is one box. The result is a lower bound of the distance, and exact if faces are opposite each other. The
    edge pairs of the separating axis test are omitted (Gottschalk et al. 1996). Negative values therefore mean overlap
    along these six axes, also of boxes that only an edge pair separates.
    """
    axes_a, axes_b = owner.axes, static.axes
    half_a, half_b = _components(owner.half), _components(static.half)
    between = [b - a for a, b in zip(_components(owner.pos), _components(static.pos), strict=True)]
    cosine = [[jnp.abs(_dot(u, v)) for v in axes_b] for u in axes_a]
    gaps = [jnp.abs(_dot(axes_a[i], between)) - half_a[i] - _dot(cosine[i], half_b) for i in range(3)]
    gaps += [
        jnp.abs(_dot(axes_b[j], between)) - half_b[j] - _dot([cosine[i][j] for i in range(3)], half_a) for j in range(3)
    ]
    return jnp.max(jnp.stack(gaps), axis=0)


def fill_slots(
    owner: OrientedBoxes, static: OrientedBoxes, num: int
) -> tuple[OrientedBoxes, Int[Array, " num"], Bool[Array, ""]]:
    """Select the `num` (at most all) static boxes nearest to an owner's box by `separation`, cropped around it.

    `owner` is one box. MJX's broad phase ranks pairs by bounding spheres. Without the crop, the spheres of long walls
    would displace real contacts. Boxes at `MAX_SLOT_DISTANCE` or farther are parked for the same reason.

    Returns:
        The boxes in the slots, nearest first; their indices in `static` (also if parked); whether more than `num` boxes
        have a negative `separation`. Of equally near boxes, the lower index is first.
    """
    gap = separation(owner, static)
    _, index = jax.lax.top_k(-gap, num)
    radius = jnp.sqrt(_dot(_components(owner.half), _components(owner.half))) + jnp.float32(MAX_SLOT_DISTANCE)
    nearest = _crop(jax.tree.map(lambda x: x[index], static), owner.pos, radius)
    boxes = jax.tree.map(
        lambda x, y: jnp.where((gap[index] < jnp.float32(MAX_SLOT_DISTANCE))[:, None], x, y), nearest, parked_boxes(num)
    )
    return boxes, index, jnp.sum((gap < 0).astype(jnp.int32)) > num


def parked_boxes(num: int) -> OrientedBoxes:
    """Return `num` boxes of half extents `PARKED_SIZE`, all `PARKED_HEIGHT` below the world's origin, out of reach."""

    def rows(*row: float) -> Array:
        """Repeat one row `num` times."""
        return jnp.tile(jnp.array([row], jnp.float32), (num, 1))

    return OrientedBoxes(
        rows(0.0, 0.0, -PARKED_HEIGHT), rows(1.0, 0.0, 0.0, 0.0), rows(PARKED_SIZE, PARKED_SIZE, PARKED_SIZE)
    )


def _crop(boxes: OrientedBoxes, center: Float[Array, "3"], radius: Float[Array, ""]) -> OrientedBoxes:
    """Return the part of each box in a cube around `center`, aligned with the box, of half extent `radius` [m].

    `center` is one point for all boxes. A part's half extents are at least 1 mm. Along an axis on which the cube misses
    the box, the part is centred in the gap between them, so outside the box.
    """
    axes, pos = boxes.axes, _components(boxes.pos)
    between = [c - p for c, p in zip(_components(center), pos, strict=True)]
    middle, half = [], []
    for axis, size in zip(axes, _components(boxes.half), strict=True):
        local = _dot(axis, between)
        low, high = jnp.maximum(-size, local - radius), jnp.minimum(size, local + radius)
        middle.append((low + high) / 2)
        half.append(jnp.maximum((high - low) / 2, jnp.float32(1e-3)))
    pos = [pos[i] + _dot([axis[i] for axis in axes], middle) for i in range(3)]
    return boxes.replace(pos=jnp.stack(pos, axis=-1), half=jnp.stack(half, axis=-1))


def _components(vectors: Float[Array, "*n 3"]) -> Vector:
    """Split vectors along their last axis into the arrays of x, y and z."""
    return [vectors[..., i] for i in range(3)]


def _dot(a: Vector, b: Vector) -> Array:
    """Return scalar products of vectors given by components."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
