"""Reachability of hands, to pick up and to put down: for generators of tasks and for experts."""

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix
from home_mjx.physics.hands import LOW
from home_mjx.physics.kinematic.footprints import Footprints
from home_mjx.physics.mjx.slots import Boxes
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import normals
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.sensors.sight import as_it_begins

ACROSS = np.linspace(-0.85, 0.85, 5)  # aim points across an object [half extents]
GRID = np.linspace(-1.0, 1.0, 10)  # candidate spots across a surface [half extents]
STEEPEST = 1.0  # [rad], maximum angle below horizontal at which hands reach; lower objects need more distance
ABOVE = 0.6  # [m], height above furniture from which rays find its top; headroom over a spot
FAR = 1000.0  # [m], coordinate of unused boxes
APART = 0.03  # [m], minimum gap between an object that is put down and its neighbours
FLAT = 0.015  # [m], maximum height difference between a box's top and the surface that rays find
OVER = 0.75  # [half extents], maximum required distance from a box's edge to the centre of an object on it
LEVEL = 0.7  # minimum z component of the normal of a surface
REST = 0.03  # [m], tolerance of the height of an object's top
SLACK = 0.03  # [m], tolerance of the distance to a visible point
SPOTS = 6  # minimum number of spots in reach; a single one may be visible only through the gap of a door
SEEN = 6  # number of points of an object that must be visible; hands miss objects in narrow gaps

Distance = Float[Array, ""] | float  # [m]


def plan_radius(size: Float[Array, "3"], quat: Float[Array, "4"]) -> Float[Array, ""]:
    """Return the radius of a box about its centre in the plan, for any rotation about the vertical [m].

    Args:
        size: Half extents [m].
        quat: Orientation (wxyz).
    """
    upward = quat_matrix(quat)[2]
    return jnp.sqrt(jnp.sum(size * size * (1 - upward * upward)))


def take_points(eye: Float[Array, "3"], box: Float[Array, "2 3"]) -> Float[Array, "p 3"]:
    """Return aim points on an object with these bounds: on the vertical plane through its centre facing the eye [m]."""
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    way = middle - eye
    across = jnp.stack([-way[1], way[0]])
    across = across / jnp.maximum(jnp.linalg.norm(across), 1e-6)
    side, up = (jnp.asarray(x.reshape(-1), jnp.float32) for x in np.meshgrid(ACROSS, ACROSS))
    wide = jnp.sum(jnp.abs(across) * half[:2])
    return middle + jnp.concatenate([side[:, None] * across * wide, up[:, None] * half[2]], axis=1)


def within_reach(eye: Float[Array, "3"], points: Float[Array, "p 3"], reach: Distance) -> Bool[Array, " p"]:
    """Return which points a hand reaches from below an eye, looking down at most by `STEEPEST`."""
    offset = points - eye
    away = jnp.linalg.norm(offset[:, :2], axis=-1)
    steep = offset[:, 2] < -jnp.tan(jnp.float32(STEEPEST)) * away
    return jnp.all(jnp.isfinite(offset), axis=-1) & (away <= jnp.float32(reach)) & (offset[:, 2] < 0.1) & ~steep


def free_spots(
    scene: Scene, box: Float[Array, "2 3"], meant: Bool[Array, " i"], radius: Float[Array, ""], carried: Int[Array, ""]
) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
    """Return points on the top of furniture [m], and which of them have room.

    Rays find the top; physics, whose geoms are boxes, must support objects there as well.

    Args:
        scene: The environment.
        box: Bounds of the furniture [m].
        meant: Mask of its instances.
        radius: Radius of the object to put there [m].
        carried: Object that rays ignore; -1 none.
    """
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    inner = half[:2] - jnp.minimum(radius, 0.8 * half[:2])  # minimizes overhang
    side, far = (jnp.asarray(x.reshape(-1), jnp.float32) for x in np.meshgrid(GRID, GRID))
    plan = middle[:2] + jnp.stack([side, far], axis=-1) * inner
    start = jnp.concatenate([plan, jnp.full((len(plan), 1), box[1, 2] + ABOVE)], axis=1)
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), start.shape)
    hit = cast(scene, start, down, exclude=jnp.broadcast_to(carried, start.shape[:1]))
    own = (hit.instance >= 0) & jnp.take(meant, jnp.clip(hit.instance, 0, meant.shape[0] - 1))
    own = own & (hit.instance < meant.shape[0]) & (normals(scene, down, hit)[:, 2] > LEVEL)
    height = jnp.where(own, start[:, 2] - hit.t, middle[2])
    high = own & (height >= middle[2]) & (height <= box[1, 2] + REST)
    bears, apart = room_at(footprints(scene, carried), plan, height, radius + APART)
    return jnp.concatenate([plan, height[:, None]], axis=1), high & bears & apart


def footprints(scene: Scene, carried: Int[Array, ""]) -> Footprints:
    """Return footprints of all obstacles: static boxes, and bounds of movable bodies and leaves, not of `carried`."""
    physics, moving, bank = scene.bank.physics, scene.moving, scene.bank
    parts = (x[scene.house] for x in (physics.collider_pos, physics.collider_quat, physics.collider_size))
    count = bank.spec.num_bodies + bank.spec.num_doors
    box = moving.box[:count]
    there = (moving.instance[:count] >= 0) & ((moving.object_id[:count] != carried) | (carried < 0))
    box = jnp.where(there[:, None, None], box, -FAR)
    middle, half, one = box.mean(axis=1), (box[:, 1] - box[:, 0]) / 2, jnp.ones(count, jnp.float32)
    own = Footprints(middle[:, 0], middle[:, 1], one, 0 * one, half[:, 0], half[:, 1], box[:, 0, 2], box[:, 1, 2])
    return jax.tree.map(lambda *x: jnp.concatenate(x), Footprints.of(Boxes(*parts)), own)


def plan_gaps(boxes: Footprints, plan: Float[Array, "n 2"]) -> Float[Array, "n b"]:
    """Return distances of positions to boxes in the plan [m]; 0 inside."""
    u, v = _beyond_sides(boxes, plan)
    return jnp.hypot(jnp.maximum(u, 0), jnp.maximum(v, 0))


def _beyond_sides(boxes: Footprints, plan: Float[Array, "n 2"]) -> tuple[Float[Array, "n b"], Float[Array, "n b"]]:
    """Return signed distances of positions beyond the sides of boxes, along both of their axes [m]; negative inside."""
    x, y = plan[:, :1] - boxes.x, plan[:, 1:] - boxes.y
    u = jnp.abs(boxes.cos * x + boxes.sin * y) - boxes.half_u
    return u, jnp.abs(boxes.cos * y - boxes.sin * x) - boxes.half_v


def room_at(
    boxes: Footprints, plan: Float[Array, "n 2"], height: Float[Array, " n"], radius: Float[Array, ""]
) -> tuple[Bool[Array, " n"], Bool[Array, " n"]]:
    """Return at which positions a box supports an object that is put there, and at which it would touch no box.

    The object must be inside the box's edges if the box is large enough. Hands release objects up to 3 cm from a spot,
    and an object with its centre near an edge slides off.

    Args:
        boxes: Footprints of all obstacles.
        plan: The positions [m].
        height: Height of the surface at each position [m].
        radius: Radius of the object [m].
    """
    u, v = _beyond_sides(boxes, plan)
    away = jnp.hypot(jnp.maximum(u, 0), jnp.maximum(v, 0))
    inner = (u <= -jnp.minimum(radius, OVER * boxes.half_u)) & (v <= -jnp.minimum(radius, OVER * boxes.half_v))
    bears = inner & (jnp.abs(boxes.top - height[:, None]) < FLAT)
    meets = (away < radius) & (boxes.top > height[:, None] + FLAT) & (boxes.bottom < height[:, None] + ABOVE)
    return jnp.any(bears, axis=1), ~jnp.any(meets, axis=1)


@jax.jit
def taken_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    instance: Int[Array, ""],
    box: Float[Array, "2 3"],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return below which eyes a hand can pick up an instance with these bounds; initial house, doors open."""
    scene = as_it_begins(bank, house)

    def one(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        way = take_points(eye, box) - eye
        way = way / jnp.linalg.norm(way, axis=-1, keepdims=True)
        hit = cast(scene, jnp.broadcast_to(eye, way.shape), way)
        own = (hit.instance == instance) & within_reach(eye, eye + way * hit.t[:, None], reach)
        return jnp.sum(own) > SEEN

    return jax.vmap(one)(eyes)


@jax.jit
def gaps_carrying(
    bank: HouseBank, house: Int[Array, ""], eyes: Float[Array, "n 3"], half: Float[Array, ""], carried: Int[Array, ""]
) -> Float[Array, " n"]:
    """Return distances of eyes in the plan to the nearest box at carrying height, in the initial house [m].

    Args:
        bank: The houses.
        house: Index of the house.
        eyes: Eyes of agents [m].
        half: Half height of the carried object [m].
        carried: Its object id.
    """
    boxes = footprints(as_it_begins(bank, house), carried)
    middle = eyes[:, 2:] - jnp.float32(LOW)
    meets = (boxes.top > middle - half) & (boxes.bottom < middle + half)
    return jnp.min(jnp.where(meets, plan_gaps(boxes, eyes[:, :2]), jnp.inf), axis=1)


@jax.jit
def put_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    instance: Int[Array, ""],
    box: Float[Array, "2 3"],
    radius: Float[Array, ""],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return below which eyes a hand can put an object of a radius [m] on an instance, in the initial house."""
    scene, nothing = as_it_begins(bank, house), jnp.full((), -1, jnp.int32)
    meant = jnp.arange(bank.spec.num_instances, dtype=jnp.int32) == instance
    points, free = free_spots(scene, box, meant, radius, nothing)

    def one(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        return jnp.sum(free & within_reach(eye, points, reach) & in_sight(scene, eye, points)) >= SPOTS

    return jax.vmap(one)(eyes)


def in_sight(scene: Scene, eye: Float[Array, "3"], points: Float[Array, "p 3"]) -> Bool[Array, " p"]:
    """Return which points of surfaces are visible; agents in the scene would block the view."""
    way = points - eye
    length = jnp.linalg.norm(way, axis=-1)
    hit = cast(scene, jnp.broadcast_to(eye, way.shape), way / length[:, None])
    return hit.t >= length - SLACK
