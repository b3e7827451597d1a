"""What a hand could take and where it could put something down: the same for generators of tasks and for experts."""

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

ACROSS = np.linspace(-0.85, 0.85, 5)  # where a thing is aimed at, in half extents
GRID = np.linspace(-1.0, 1.0, 10)  # spots of a surface
STEEPEST = 1.0  # [rad], below level: what is lower than that is looked down at from farther away
ABOVE = 0.6  # [m], over a piece of furniture, from where its top is looked for
FAR = 1000.0  # [m]
APART = 0.03  # [m], at least, between what is put down and what stands there
FLAT = 0.015  # [m]
OVER = 0.75  # of half a surface that is narrower than what is put there, or hardly wider: its edge is farther than that
LEVEL = 0.7  # least upward part of the normal of a surface
REST = 0.03  # [m]: what is so much above the top of something still lies on it
SLACK = 0.03  # [m]
SPOTS = 6  # of a surface that must be in reach: one alone may show through the gap of a door
SEEN = 6  # points of a thing that must be seen: hands miss what shows in a narrow gap

Distance = Float[Array, ""] | float  # [m]


def plan_radius(size: Float[Array, "3"], quat: Float[Array, "4"]) -> Float[Array, ""]:
    """How far a box reaches from its middle in the plan, however it is turned about the vertical [m].

    Args:
        size: Half extents [m].
        quat: Orientation (wxyz).
    """
    upward = quat_matrix(quat)[2]
    return jnp.sqrt(jnp.sum(size * size * (1 - upward * upward)))


def take_points(eye: Float[Array, "3"], box: Float[Array, "2 3"]) -> Float[Array, "p 3"]:
    """Where an eye aims at what has these bounds, on the upright plane through its middle that faces the eye [m]."""
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    way = middle - eye
    across = jnp.stack([-way[1], way[0]])
    across = across / jnp.maximum(jnp.linalg.norm(across), 1e-6)
    side, up = (jnp.asarray(x.reshape(-1), jnp.float32) for x in np.meshgrid(ACROSS, ACROSS))
    wide = jnp.sum(jnp.abs(across) * half[:2])
    return middle + jnp.concatenate([side[:, None] * across * wide, up[:, None] * half[2]], axis=1)


def within_reach(eye: Float[Array, "3"], points: Float[Array, "p 3"], reach: Distance) -> Bool[Array, " p"]:
    """Which points a hand reaches from below an eye, looking down no steeper than `STEEPEST`."""
    offset = points - eye
    away = jnp.linalg.norm(offset[:, :2], axis=-1)
    steep = offset[:, 2] < -jnp.tan(jnp.float32(STEEPEST)) * away
    return jnp.all(jnp.isfinite(offset), axis=-1) & (away <= jnp.float32(reach)) & (offset[:, 2] < 0.1) & ~steep


def free_spots(
    scene: Scene, box: Float[Array, "2 3"], meant: Bool[Array, " i"], radius: Float[Array, ""], carried: Int[Array, ""]
) -> tuple[Float[Array, "n 3"], Bool[Array, " n"]]:
    """Points of the top of a piece of furniture [m], and on which of them there is room.

    Rays see the top, and physics, which has boxes, must bear things there, too.

    Args:
        scene: The environment.
        box: Bounds of the furniture [m].
        meant: Instances that it consists of.
        radius: Of what is to be put there [m].
        carried: Object that rays pass through; -1 none.
    """
    middle, half = box.mean(axis=0), (box[1] - box[0]) / 2
    inner = half[:2] - jnp.minimum(radius, 0.8 * half[:2])  # as little over the edge as possible
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
    """All that things meet: static boxes, and the bounds of movable bodies and leaves but for what is carried."""
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
    """From places to boxes in the plan [m]; 0 inside."""
    u, v = _beyond_sides(boxes, plan)
    return jnp.hypot(jnp.maximum(u, 0), jnp.maximum(v, 0))


def _beyond_sides(boxes: Footprints, plan: Float[Array, "n 2"]) -> tuple[Float[Array, "n b"], Float[Array, "n b"]]:
    """How far places are beyond the sides of boxes, along both of their axes [m]; negative inside."""
    x, y = plan[:, :1] - boxes.x, plan[:, 1:] - boxes.y
    u = jnp.abs(boxes.cos * x + boxes.sin * y) - boxes.half_u
    return u, jnp.abs(boxes.cos * y - boxes.sin * x) - boxes.half_v


def room_at(
    boxes: Footprints, plan: Float[Array, "n 2"], height: Float[Array, " n"], radius: Float[Array, ""]
) -> tuple[Bool[Array, " n"], Bool[Array, " n"]]:
    """At which places of a height [m] a box bears what is put there, and where it would touch none.

    It lies within the box's edges, so far as the box is large enough for that: hands let go 3 cm from a spot, and what
    has its middle near an edge slides and falls.

    Args:
        boxes: All that things meet.
        plan: The places [m].
        height: Of what is beneath [m].
        radius: Of what is put there [m].
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
    """From below which eyes a hand can take an instance with these bounds, as the house begins with doors open."""
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
    """From below eyes to the nearest box that is as high as agents carry something, as the house begins [m].

    Args:
        bank: The houses.
        house: Index of the house.
        eyes: Of agents [m].
        half: Height of what is carried, half of it [m].
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
    """From below which eyes a hand can put something of a radius [m] on an instance, as the house begins."""
    scene, nothing = as_it_begins(bank, house), jnp.full((), -1, jnp.int32)
    meant = jnp.arange(bank.spec.num_instances, dtype=jnp.int32) == instance
    points, free = free_spots(scene, box, meant, radius, nothing)

    def one(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        return jnp.sum(free & within_reach(eye, points, reach) & in_sight(scene, eye, points)) >= SPOTS

    return jax.vmap(one)(eyes)


def in_sight(scene: Scene, eye: Float[Array, "3"], points: Float[Array, "p 3"]) -> Bool[Array, " p"]:
    """Which points of surfaces can be seen, with nobody about."""
    way = points - eye
    length = jnp.linalg.norm(way, axis=-1)
    hit = cast(scene, jnp.broadcast_to(eye, way.shape), way / length[:, None])
    return hit.t >= length - SLACK
