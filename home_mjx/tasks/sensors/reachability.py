"""Reachability of hands, to pick up and to put down: for generators of tasks and for experts."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics.hand_control import CARRY_HEIGHT_BELOW_EYES
from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.physics.mjx.contact_slots import OrientedBoxes
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.raycast_render.scene.surface import face_normals
from home_mjx.raycast_render.scene.types import Scene

AIM_OFFSETS = np.linspace(-0.85, 0.85, 5)  # aim points across an object [half extents]
SPOT_OFFSETS = np.linspace(-1.0, 1.0, 10)  # candidate spots across a surface [half extents]
MAX_HAND_ANGLE = 1.0  # [rad], maximum angle below horizontal at which hands reach; lower objects need more distance
HEADROOM = 0.6  # [m], height above furniture from which rays find its top; headroom over a spot
UNUSED_BOX_COORDINATE = 1000.0  # [m], coordinate of unused boxes
MIN_PLACE_GAP = 0.03  # [m], minimum gap between an object that is put down and its neighbours
MAX_SUPPORT_OFFSET = 0.015  # [m], maximum height difference between a box's top and the surface that rays find
MAX_EDGE_MARGIN = 0.75  # [half extents], maximum required distance from a box's edge to the centre of an object on it
MIN_SURFACE_NORMAL_Z = 0.7  # minimum z component of the normal of a surface
MAX_TOP_OFFSET = 0.03  # [m], tolerance of the height of an object's top
RAY_TOLERANCE = 0.03  # [m], tolerance of the distance to a visible point
MIN_SPOTS = 6  # minimum number of spots in reach; a single one may be visible only through the gap of a door
MIN_VISIBLE_POINTS = 6  # number of points of an object that must be visible; hands miss objects in narrow gaps

Distance = Float[Array, ""] | float  # [m]


def plan_radius(size: Float[Array, "3"], quat: Float[Array, "4"]) -> Float[Array, ""]:
    """Return an upper bound of a box's plan radius about its centre [m], for any rotation about the vertical.

    It has the half extents `size` [m] and the orientation `quat` (wxyz).
    """
    upward = quat_matrix(quat)[2]
    return jnp.sqrt(jnp.sum(size * size * (1 - upward * upward)))


def pick_points(eye: Float[Array, "3"], box: Float[Array, "2 3"]) -> Float[Array, "p 3"]:
    """Return 5 x 5 aim points [m] on an object with bounds `box`, at most 0.85 half extents from its centre.

    They are on the vertical plane through the centre that faces the eye.
    """
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    way = middle - eye
    across = jnp.stack([-way[1], way[0]])
    across = across / jnp.maximum(jnp.linalg.norm(across), 1e-6)
    side, up = (jnp.asarray(x.reshape(-1), jnp.float32) for x in np.meshgrid(AIM_OFFSETS, AIM_OFFSETS))
    wide = jnp.sum(jnp.abs(across) * half[:2])
    return middle + jnp.concatenate([side[:, None] * across * wide, up[:, None] * half[2]], axis=1)


def is_reachable(eye: Float[Array, "3"], points: Float[Array, "p 3"], reach: Distance) -> Bool[Array, " p"]:
    """Return which points a hand reaches: at most `reach` [m] away in plan, and less than 0.1 m above the eye.

    They are at most `MAX_HAND_ANGLE` below horizontal. Points that are not finite are out of reach.
    """
    offset = points - eye
    away = jnp.linalg.norm(offset[:, :2], axis=-1)
    steep = offset[:, 2] < -jnp.tan(jnp.float32(MAX_HAND_ANGLE)) * away
    return jnp.all(jnp.isfinite(offset), axis=-1) & (away <= jnp.float32(reach)) & (offset[:, 2] < 0.1) & ~steep


def is_in_hand_reach(
    scene: Scene, eye: Float[Array, "3"], instance: Int[Array, ""], box: Float[Array, "2 3"], reach: Distance
) -> Bool[Array, ""]:
    """Return whether at least `MIN_VISIBLE_POINTS` of the `pick_points` of an instance are visible and within reach.

    The bounds of the instance are `box` [m]; `reach` is in [m].
    """
    way = pick_points(eye, box) - eye
    way = way / jnp.linalg.norm(way, axis=-1, keepdims=True)
    hit = cast(scene, jnp.broadcast_to(eye, way.shape), way)
    own = (hit.instance == instance) & is_reachable(eye, eye + way * hit.t[:, None], reach)
    return jnp.sum(own) >= MIN_VISIBLE_POINTS


def free_spots(
    scene: Scene,
    box: Float[Array, "2 3"],
    selected: Bool[Array, " i"],
    radius: Float[Array, ""],
    ignored_id: Int[Array, ""],
) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
    """Return a 10 x 10 grid of points on top of furniture [m], and at which an object can be put: supported and clear.

    The grid ends `radius`, at most 0.8 half extents, inside the bounds. Rays find the top; boxes of physics, which
    support objects, must be there as well. Points without a top have the height of the furniture's middle.

    Args:
        scene: The environment.
        box: Bounds of the furniture [m].
        selected: Mask of its instances.
        radius: Radius of the object to put there [m].
        ignored_id: Object that rays ignore; -1 none.
    """
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    inner = half[:2] - jnp.minimum(radius, 0.8 * half[:2])  # minimizes overhang
    side, far = (jnp.asarray(x.reshape(-1), jnp.float32) for x in np.meshgrid(SPOT_OFFSETS, SPOT_OFFSETS))
    plan = middle[:2] + jnp.stack([side, far], axis=-1) * inner
    start = jnp.concatenate([plan, jnp.full((len(plan), 1), box[1, 2] + HEADROOM)], axis=1)
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), start.shape)
    hit = cast(scene, start, down, exclude=jnp.broadcast_to(ignored_id, start.shape[:1]))
    own = (hit.instance >= 0) & jnp.take(selected, jnp.clip(hit.instance, 0, selected.shape[0] - 1))
    own = own & (hit.instance < selected.shape[0]) & (face_normals(scene, down, hit)[:, 2] > MIN_SURFACE_NORMAL_Z)
    height = jnp.where(own, start[:, 2] - hit.t, middle[2])
    high = own & (height >= middle[2]) & (height <= box[1, 2] + MAX_TOP_OFFSET)
    bears, apart = check_placement(obstacle_footprints(scene, ignored_id), plan, height, radius + MIN_PLACE_GAP)
    return jnp.concatenate([plan, height[:, None]], axis=1), high & bears & apart


def obstacle_footprints(scene: Scene, carried: Int[Array, ""]) -> Footprints:
    """Return present footprints of static boxes, movable bodies and leaves, without object id `carried` (-1 none).

    Agents are no obstacles. Bodies and leaves have their upright world bounds. Padding and the carried object are boxes
    far away.
    """
    physics, moving, bank = scene.bank.physics, scene.moving, scene.bank
    parts = (x[scene.house] for x in (physics.collider_pos, physics.collider_quat, physics.collider_size))
    count = bank.spec.num_bodies + bank.spec.num_doors
    box = moving.box[:count]
    there = (moving.instance[:count] >= 0) & ((moving.object_id[:count] != carried) | (carried < 0))
    box = jnp.where(there[:, None, None], box, -UNUSED_BOX_COORDINATE)
    middle, half, one = box.mean(axis=1), (box[:, 1] - box[:, 0]) / 2, jnp.ones(count, jnp.float32)
    own = Footprints(middle[:, 0], middle[:, 1], one, 0 * one, half[:, 0], half[:, 1], box[:, 0, 2], box[:, 1, 2])
    return jax.tree.map(lambda *x: jnp.concatenate(x), Footprints.from_boxes(OrientedBoxes(*parts)), own)


def box_distances(boxes: Footprints, plan: Float[Array, "n 2"]) -> Float[Array, "n b"]:
    """Return plan distances of positions (x, y) to boxes [m]; 0 inside."""
    u, v = _side_distances(boxes, plan)
    return jnp.hypot(jnp.maximum(u, 0), jnp.maximum(v, 0))


def _side_distances(boxes: Footprints, plan: Float[Array, "n 2"]) -> tuple[Float[Array, "n b"], Float[Array, "n b"]]:
    """Return signed distances of positions beyond the sides of boxes, along their axes u and v [m]; negative inside."""
    x, y = plan[:, :1] - boxes.x, plan[:, 1:] - boxes.y
    u = jnp.abs(boxes.cos * x + boxes.sin * y) - boxes.half_u
    return u, jnp.abs(boxes.cos * y - boxes.sin * x) - boxes.half_v


def check_placement(
    boxes: Footprints, plan: Float[Array, "n 2"], height: Float[Array, " n"], radius: Float[Array, ""]
) -> tuple[Bool[Array, " n"], Bool[Array, " n"]]:
    """Return at which positions a box supports an object that is put there, and at which it would touch no box.

    A supporting box's top is less than `MAX_SUPPORT_OFFSET` from the surface. The position is inside its edges by
    `radius`, or by `MAX_EDGE_MARGIN` half extents if that is less: an object with its centre near an edge slides off.
    Boxes that end at the surface, begin `HEADROOM` above it, or are `radius` away are not touched.

    Args:
        boxes: Footprints of all obstacles.
        plan: The positions [m].
        height: Height of the surface at each position [m].
        radius: Radius of the object [m].
    """
    u, v = _side_distances(boxes, plan)
    away = jnp.hypot(jnp.maximum(u, 0), jnp.maximum(v, 0))
    inner = (u <= -jnp.minimum(radius, MAX_EDGE_MARGIN * boxes.half_u)) & (
        v <= -jnp.minimum(radius, MAX_EDGE_MARGIN * boxes.half_v)
    )
    bears = inner & (jnp.abs(boxes.top - height[:, None]) < MAX_SUPPORT_OFFSET)
    meets = (
        (away < radius)
        & (boxes.top > height[:, None] + MAX_SUPPORT_OFFSET)
        & (boxes.bottom < height[:, None] + HEADROOM)
    )
    return jnp.any(bears, axis=1), ~jnp.any(meets, axis=1)


@jax.jit
def can_pick_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    instance: Int[Array, ""],
    box: Float[Array, "2 3"],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return at which eye positions [m] a hand can pick up an instance with these bounds; initial house, doors open.

    At least `MIN_VISIBLE_POINTS` of its `pick_points` must be visible and within `reach` [m].
    """
    scene = make_open_scene(bank, house)
    return jax.vmap(lambda eye: is_in_hand_reach(scene, eye, instance, box, reach))(eyes)


@jax.jit
def carry_obstacles(bank: HouseBank, house: Int[Array, ""], carried: Int[Array, ""]) -> Footprints:
    """Return footprints of the initial house with open doors, without those of object id `carried`."""
    return obstacle_footprints(make_open_scene(bank, house), carried)


@jax.jit
def carry_gaps(boxes: Footprints, eyes: Float[Array, "n 3"], half: Float[Array, ""]) -> Float[Array, " n"]:
    """Return plan distances of eyes to the nearest box at carrying height [m]; inf if none.

    `half` is half the height of the carried object [m], `boxes` are the `carry_obstacles`.
    """
    middle = eyes[:, 2:] - jnp.float32(CARRY_HEIGHT_BELOW_EYES)
    meets = (boxes.top > middle - half) & (boxes.bottom < middle + half)
    return jnp.min(jnp.where(meets, box_distances(boxes, eyes[:, :2]), jnp.inf), axis=1)


@jax.jit
def can_place_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    instance: Int[Array, ""],
    box: Float[Array, "2 3"],
    radius: Float[Array, ""],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return at which eye positions [m] a hand can put an object of a radius [m] on an instance.

    At least `MIN_SPOTS` free spots on its top must be visible and within `reach`; initial house, doors open.
    """
    scene, nothing = make_open_scene(bank, house), jnp.full((), -1, jnp.int32)
    meant = jnp.arange(bank.spec.num_instances, dtype=jnp.int32) == instance
    points, free = free_spots(scene, box, meant, radius, nothing)

    def one(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        """Return the result of one eye."""
        return jnp.sum(free & is_reachable(eye, points, reach) & is_visible(scene, eye, points)) >= MIN_SPOTS

    return jax.vmap(one)(eyes)


def is_visible(scene: Scene, eye: Float[Array, "3"], points: Float[Array, "p 3"]) -> Bool[Array, " p"]:
    """Return which points of surfaces [m] are visible from an eye: no hit more than `RAY_TOLERANCE` before them.

    Agents in the scene would block the view.
    """
    way = points - eye
    length = jnp.linalg.norm(way, axis=-1)
    hit = cast(scene, jnp.broadcast_to(eye, way.shape), way / length[:, None])
    return hit.t >= length - RAY_TOLERANCE
