"""Shortest diffraction paths ("taut strings") from a source over edges of boxes to a listener."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.geometry.wedge import WedgeGeometry
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import sum3
from home_mjx.geometry.diffraction_edges import edge_number

MIN_EDGE_DISTANCE = 0.01  # [m], minimum distance from edges


class BarrierBoxes(Pytree):
    """Oriented boxes that may block direct sound; some have a leading axis of houses."""

    center: Float[Array, "*h n 3"]  # [m]
    axis: Float[Array, "*h n 3 3"]  # unit vectors, one per row
    half: Float[Array, "*h n 3"]  # [m]
    exposed: Bool[Array, "*h n edges"]  # edges surrounded by air, in the order of `schema.edges`
    object_id: Int[Array, "*h n"]  # -1 architecture


class EdgePaths(Pytree):
    """Shortest paths over one edge, or over two parallel edges."""

    wedge: WedgeGeometry
    infinite_edge_detour: Float[Array, " e"]  # [m], excess over the straight line for an infinite edge
    # [m], excess over the straight line for the finite edge; inf if there is no such path
    finite_edge_detour: Float[Array, " e"]
    blocked: Bool[Array, " e"]  # whether the straight line intersects the box
    source_side_point: Float[Array, "e 3"]  # [m], world, diffraction point on the source's side, offset from the box
    # [m], world, diffraction point on the listener's side, offset from the box
    listener_side_point: Float[Array, "e 3"]
    apex: Float[Array, "e 3"]  # [m], world, diffraction point of an infinite edge
    edge_extent: Float[Array, "e 2"]  # [m], along the edge from the apex of an infinite edge to both ends of the edge
    second_turn: Float[Array, " e"]  # [rad], at the second edge
    second_edge_reach: Float[Array, " e"]  # [m], argument `reach` of `second_edge_factor`


class _EdgeFrame(NamedTuple):
    """Source and listener in edge coordinates: u across a face from -half to half, v above it, z along the edge."""

    source: Float[Array, "n e 3"]
    listener: Float[Array, "n e 3"]
    half: Float[Array, "n e 3"]  # of the box: u, v, z
    axes: Float[Array, "n e 3 3"]  # unit vectors u, v, z in the world
    middle: Float[Array, "n e 3"]  # of the face, in the world
    exposed: Bool[Array, "n e 2"]  # edges at -half and half


# Crossings of the six faces in both directions of two axes: axis u and its direction, axis v and its side.
_FACE_CROSSINGS = np.array(
    [(u, d, v, s) for v in range(3) for s in (-1, 1) for u in range(3) if u != v for d in (-1, 1)]
)
_SIDES = np.array([[edge_number(u, side * d, v, s) for side in (-1, 1)] for u, d, v, s in _FACE_CROSSINGS.tolist()])


class _EdgeContacts(NamedTuple):
    """Edges of a face that a path touches; `possible`: whether there is such a path."""

    first: Array  # u of the first edge touched
    last: Array  # u of the last edge touched
    twice: Array  # whether the path turns at both edges
    on_first: Array  # whether a path that turns at one edge turns at the first
    possible: Array


def find_edge_paths(boxes: BarrierBoxes, source: Float[Array, "3"], listener: Float[Array, "3"]) -> EdgePaths:
    """Compute diffraction paths over the exposed edges of boxes, also of boxes that do not block the straight path.

    A path crosses a face between two opposite sides of the box and touches one or both of its edges. Alternatively it
    runs from one side to a listener above the face. Positions are in the world.

    Returns:
        24 rows per box, box by box; `finite_edge_detour` is inf where there is no path or an edge is not exposed. Other
        fields are undefined there.
    """
    frame = _edge_frame(boxes, source, listener)
    course = _edge_contacts(frame)
    (su, sv, sz), (lu, lv, lz) = (jnp.moveaxis(x, -1, 0) for x in (frame.source, frame.listener))
    near, far = jnp.hypot(course.first - su, sv), jnp.hypot(lu - course.last, lv)
    between, deep = course.last - course.first, frame.half[..., 2]
    whole = near + between + far
    rising = (lz - sz) / jnp.maximum(whole, MIN_EDGE_DISTANCE)
    z_first, z_last = sz + rising * near, lz - rising * far
    crossing = z_first
    beyond = jnp.stack([-deep, deep], axis=-1) - ((z_first + z_last) / 2)[..., None]
    z_first, z_last = jnp.clip(z_first, -deep, deep), jnp.clip(z_last, -deep, deep)
    length = jnp.hypot(near, z_first - sz) + jnp.hypot(between, z_last - z_first) + jnp.hypot(far, lz - z_last)
    straight = jnp.linalg.norm(source - listener)
    edges = frame.exposed[..., 0], frame.exposed[..., 1]
    exposed = jnp.where(course.twice, edges[0] & edges[1], jnp.where(course.on_first, *edges))
    reach = jnp.where(course.possible & exposed, length - straight, jnp.inf)
    bend, turn, depth = _edge_geometry(frame, course, near, far, 1 / jnp.sqrt(1 + rising**2))

    def place(u: Array, z: Array) -> Array:
        """Return world positions of edge coordinates (u, z), `MIN_EDGE_DISTANCE` above and beyond the edge."""
        local = jnp.stack([u + MIN_EDGE_DISTANCE * jnp.sign(u), jnp.full_like(u, MIN_EDGE_DISTANCE), z], axis=-1)
        return frame.middle + sum3(jnp.swapaxes(frame.axes * local[..., None], -1, -2))

    met = jnp.broadcast_to(_is_blocked(frame)[:, None], reach.shape)
    places = place(course.first, z_first), place(course.last, z_last), place(course.first, crossing)
    found = bend, jnp.hypot(whole, lz - sz) - straight, reach, met, *places, beyond, turn, depth
    return EdgePaths(*jax.tree.map(lambda x: x.reshape(-1, *x.shape[2:]), found))


def _is_blocked(frame: _EdgeFrame) -> Bool[Array, " n"]:
    """Return for each box whether the segment from source to listener passes through its inside, beyond a touch."""
    half = frame.half[:, 0]
    lift = jnp.stack([jnp.zeros_like(half[:, 1]), half[:, 1], jnp.zeros_like(half[:, 1])], axis=1)  # from box centre
    start, end = frame.source[:, 0] + lift, frame.listener[:, 0] + lift
    way = end - start
    way = jnp.where(jnp.abs(way) < 1e-6, 1e-6, way)
    low, high = (-half - start) / way, (half - start) / way
    enter, leave = jnp.max(jnp.minimum(low, high), axis=1), jnp.min(jnp.maximum(low, high), axis=1)
    return jnp.maximum(enter, 0.0) < jnp.minimum(leave, 1.0)


def _edge_contacts(frame: _EdgeFrame) -> _EdgeContacts:
    """Find at which of the two edges of each crossed face the shortest path turns, and whether there is such a path.

    There is one if the source is before the face (u < -half) and the listener beyond it, or above it with v > 0. In the
    second case the source is beside the box. A path turns twice if both ends are at most as high as the face. Else it
    turns at the edge that is farther above the straight line, the first if equal.
    """
    (su, sv, _), (lu, lv, _) = (jnp.moveaxis(x, -1, 0) for x in (frame.source, frame.listener))
    half, high = frame.half[..., 0], frame.half[..., 1]
    across = lu > half
    above = (lu > -half) & ~across & (lv > 0) & (sv < 0) & (sv > -2 * high)
    rise = (lv - sv) / jnp.maximum(lu - su, MIN_EDGE_DISTANCE)
    twice = across & (sv <= 0) & (lv <= 0)
    on_first = ~across | (sv + rise * (-half - su) <= sv + rise * (half - su))
    first = jnp.where(on_first | twice, -half, half)
    return _EdgeContacts(
        first, jnp.where(on_first & ~twice, -half, half), twice, on_first, (su < -half) & (across | above)
    )


def _edge_geometry(
    frame: _EdgeFrame, course: _EdgeContacts, near: Array, far: Array, slope: Array
) -> tuple[WedgeGeometry, Float[Array, "n e"], Float[Array, "n e"]]:
    """Compute the `WedgeGeometry` of each path, and `turn` and `reach` of its second edge, see `second_edge_factor`.

    Both turns over a thin box combine into one, as at the edge of a screen; over a deep box they act separately. `near`
    and `far` are distances in the plane across the edges [m], `slope` the sine of the incidence. The wedge's edge is
    that with the larger turn, the source's if equal; the other is the second edge.
    """
    (su, sv, _), (lu, lv, _) = (jnp.moveaxis(x, -1, 0) for x in (frame.source, frame.listener))
    half, between, twice = frame.half[..., 0], course.last - course.first, course.twice
    up, down = jnp.arctan2(-sv, course.first - su), jnp.arctan2(-lv, lu - course.last)
    s, r, w = jnp.hypot(-half - su, sv), jnp.hypot(lu - half, lv), 2 * half
    depth = jnp.sqrt(w * (w + s + r) / jnp.maximum((w + s) * (w + r), MIN_EDGE_DISTANCE**2))
    depth = jnp.where(lu > half, depth, 1.0)
    smaller = jnp.where(twice, jnp.minimum(up, down), 0.0)
    turn = jnp.where(twice, jnp.maximum(up, down) + (1 - depth) * smaller, up + down)
    at_first = jnp.where(twice, up >= down, course.on_first)
    face = jnp.pi / 2 - jnp.where(at_first, up, down)
    own = jnp.where(at_first, far, near)  # distance at the edge with the smaller turn
    reach = 2 * between * own / jnp.maximum(between + own, MIN_EDGE_DISTANCE)
    source_side, listener_side = near + jnp.where(at_first, 0.0, between), far + jnp.where(at_first, between, 0.0)
    legs = jnp.maximum(source_side, MIN_EDGE_DISTANCE), jnp.maximum(listener_side, MIN_EDGE_DISTANCE)
    return WedgeGeometry(*legs, face, turn, 2 - 0.5 * depth, slope), smaller, reach


def _edge_frame(boxes: BarrierBoxes, source: Float[Array, "3"], listener: Float[Array, "3"]) -> _EdgeFrame:
    """Return source and listener in `_EdgeFrame` coordinates of the 24 face crossings of each box.

    The origin is the centre of the face. A crossing is one of 6 faces with one of 4 directions, from -u to u.
    """
    u, d, v, s = _FACE_CROSSINGS.T
    order = np.stack([u, v, 3 - u - v], axis=1)
    sign = jnp.asarray(np.stack([d, s, np.ones_like(d)], axis=1), jnp.float32)
    axes = boxes.axis[:, order] * sign[None, :, :, None]
    half = boxes.half[:, order]
    middle = boxes.center[:, None] + axes[:, :, 1] * half[:, :, 1, None]

    def local(point: Float[Array, "3"]) -> Float[Array, "n e 3"]:
        """Return a point in the coordinates of all crossings."""
        return sum3(axes * (point[None, None] - middle)[:, :, None])

    return _EdgeFrame(local(source), local(listener), half, axes, middle, boxes.exposed[:, _SIDES])
