"""Upright boxes and capsules in the horizontal plane, and depenetration of agents."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.core.pytree import Pytree
from home_mjx.physics.mjx.contact_slots import OrientedBoxes

DEPENETRATION_ITERATIONS = 3  # depenetration iterations, one obstacle each: a wall, a second one in a corner, a box
MAX_PENETRATION = 1e-3  # [m], maximum penetration after all iterations


class Footprints(Pytree):
    """Boxes with vertical sides; u and v are a box's own axes in the horizontal plane."""

    x: Float[Array, "*n"]  # [m], centre
    y: Float[Array, "*n"]
    cos: Float[Array, "*n"]  # of u's heading
    sin: Float[Array, "*n"]
    half_u: Float[Array, "*n"]  # [m]
    half_v: Float[Array, "*n"]
    bottom: Float[Array, "*n"]  # [m]
    top: Float[Array, "*n"]

    def without_boxes_below(self, height: Float[Array, ""]) -> "Footprints":
        """Return all boxes, with `bottom` = inf for those whose top is at or below `height` [m].

        These are no obstacles any more; `top` is unchanged.
        """
        return self.replace(bottom=jnp.where(self.top <= height, jnp.inf, self.bottom))

    @classmethod
    def from_boxes(cls, boxes: OrientedBoxes) -> "Footprints":
        """Convert oriented boxes, exactly if an axis is vertical.

        Other boxes become the smallest upright box around them, with u along their most level axis, or the first of
        equally level ones. Quaternions must have unit length. Padding is converted as all boxes.
        """
        axes, half = boxes.axes, [boxes.half[..., k] for k in range(3)]
        x, y, steep = axes[0][0], axes[0][1], jnp.abs(axes[0][2])
        for axis in axes[1:]:  # the most level axis defines the heading
            level = jnp.abs(axis[2]) < steep
            x, y = jnp.where(level, axis[0], x), jnp.where(level, axis[1], y)
            steep = jnp.minimum(steep, jnp.abs(axis[2]))
        length = jnp.sqrt(x * x + y * y)
        cos, sin = x / length, y / length
        half_u, half_v, rise = (jnp.zeros_like(cos) for _ in range(3))
        for axis, size in zip(axes, half, strict=True):
            half_u = half_u + jnp.abs(cos * axis[0] + sin * axis[1]) * size
            half_v = half_v + jnp.abs(cos * axis[1] - sin * axis[0]) * size
            rise = rise + jnp.abs(axis[2]) * size
        pos = [boxes.pos[..., k] for k in range(3)]
        return cls(pos[0], pos[1], cos, sin, half_u, half_v, pos[2] - rise, pos[2] + rise)


class AgentCapsules(Pytree):
    """Agents' positions [m] and the index of the moving agent; the others are its obstacles."""

    pos: Float[Array, "a 3"]
    radius: Float[Array, " a"]  # [m]
    half_length: Float[Array, " a"]  # [m], half of the capsule's axis
    index: Int[Array, ""]

    @property
    def size(self) -> tuple[Array, Array]:
        """Radius and half length of the moving agent [m]."""
        return self.radius[self.index], self.half_length[self.index]


def move_and_slide(
    boxes: Footprints, agents: AgentCapsules, old: Float[Array, "3"], way: Float[Array, "3"]
) -> tuple[Float[Array, "3"], Int[Array, ""]]:
    """Move agent `agents.index` from centre `old` by `way` [m]; return its centre and the number of touched obstacles.

    Boxes and other agents that overlap it at `old + way` count as touched, also if it then stays at `old`. Other agents
    are at `agents.pos`; the row of `index` there is ignored. It slides along obstacles, horizontally, by
    `DEPENETRATION_ITERATIONS` displacements out of the deepest one. It stays at `old` if more than `MAX_PENETRATION`
    remains, as in a narrow gap, unless it overlaps more there. `way` must be at most one radius, and there must be at
    least one box.
    """
    pos = old + way
    depth = penetration_depths(boxes, agents, pos)
    count = jnp.sum(depth > 0, dtype=jnp.int32)
    for _ in range(DEPENETRATION_ITERATIONS):
        pos = pos + _depenetration(boxes, agents, pos, depth)
        depth = penetration_depths(boxes, agents, pos)
    # In a gap that is too narrow the agent keeps its old position, unless penetration was deeper there.
    deepest = depth.max()
    stays = (deepest > MAX_PENETRATION) & (penetration_depths(boxes, agents, old).max() <= deepest)
    return jnp.where(stays, old, pos), count


def penetration_depths(boxes: Footprints, agents: AgentCapsules, pos: Float[Array, "3"]) -> Float[Array, " n"]:
    """Return the moving agent's horizontal penetration at `pos` of each box, then of each agent [m].

    Negative values mean apart: -1 for boxes and agents above or below it, and for itself. Other agents count as upright
    cylinders of their total height. A box that begins above the capsule's axis, or ends below it, meets the smaller
    disc of the hemisphere at that height.
    """
    radius, length = agents.size
    above = jnp.maximum(boxes.bottom - (pos[2] + length), pos[2] - length - boxes.top)
    above = jnp.clip(above, 0.0, radius)
    reach = jnp.sqrt(jnp.maximum(radius * radius - above * above, 1e-12))  # capsule radius at the box's height
    in_box = jnp.where(above < radius, reach - _side_distances(boxes, pos)[0], -1.0)
    away = pos[None] - agents.pos
    own = jnp.arange(agents.radius.shape[0], dtype=jnp.int32) == agents.index
    apart = own | (jnp.abs(away[:, 2]) > agents.half_length + agents.radius + length + radius)
    distance = jnp.sqrt(jnp.where(apart, 1.0, jnp.maximum(away[:, 0] ** 2 + away[:, 1] ** 2, 1e-12)))
    return jnp.concatenate([in_box, jnp.where(apart, -1.0, agents.radius + radius - distance)])


def box_gradients(boxes: Footprints, pos: Float[Array, "3"]) -> tuple[Array, Array]:
    """Return the outward unit u and v of `_side_distances`."""
    return _side_distances(boxes, pos)[1:]


def _side_distances(boxes: Footprints, pos: Float[Array, "3"]) -> tuple[Array, Array, Array]:
    """Return one point's horizontal signed distance from each box [m], negative inside, and outward unit u, v.

    Heights are ignored.
    u and v are the components of the distance's gradient along the box's own axes. It points away from the nearest side
    or corner, but from inside towards the nearest side. Both are 0 if the point is inside, exactly half-way between
    the nearest sides.
    """
    x, y = pos[0] - boxes.x, pos[1] - boxes.y
    u, v = boxes.cos * x + boxes.sin * y, boxes.cos * y - boxes.sin * x
    beyond_u, beyond_v = jnp.abs(u) - boxes.half_u, jnp.abs(v) - boxes.half_v
    out_u, out_v = jnp.maximum(beyond_u, 0.0), jnp.maximum(beyond_v, 0.0)
    square = out_u * out_u + out_v * out_v
    inside, along_u = square == 0, jnp.where(beyond_u > beyond_v, 1.0, 0.0)
    distance = jnp.sqrt(jnp.where(inside, 1.0, square))
    toward_u = jnp.sign(u) * jnp.where(inside, along_u, out_u / distance)
    toward_v = jnp.sign(v) * jnp.where(inside, 1.0 - along_u, out_v / distance)
    return jnp.where(inside, jnp.maximum(beyond_u, beyond_v), distance), toward_u, toward_v


def _depenetration(
    boxes: Footprints, agents: AgentCapsules, pos: Float[Array, "3"], depth: Float[Array, " n"]
) -> Array:
    """Return the displacement (x, y, 0) [m] that resolves the deepest `penetration_depths`; 0 if none is positive.

    Of equal depths, the first counts, so boxes before agents. Only one obstacle is resolved. The result is also 0 at a
    point of a box half-way between its nearest sides. So it is for an agent at the same x and y.
    """
    worst, num_boxes = jnp.argmax(depth), boxes.x.shape[0]
    box = jax.tree.map(lambda x: x[jnp.minimum(worst, num_boxes - 1)], boxes)
    _, u, v = _side_distances(box, pos)
    away = pos - agents.pos[jnp.maximum(worst - num_boxes, 0)]
    length = jnp.sqrt(jnp.maximum(away[0] ** 2 + away[1] ** 2, 1e-12))
    from_box = jnp.stack([box.cos * u - box.sin * v, box.sin * u + box.cos * v, jnp.zeros_like(u)])
    from_agent = jnp.stack([away[0] / length, away[1] / length, jnp.zeros_like(u)])
    return jnp.maximum(depth[worst], 0.0) * jnp.where(worst < num_boxes, from_box, from_agent)
