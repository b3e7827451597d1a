"""What conditions look at, for every agent and descriptor at once: no branch, whatever the mix of tasks."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import bounds
from home_mjx.navigation import geodesic_distance, room_of
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.meaning import Means
from home_mjx.tasks.rules.program import Program
from home_mjx.tasks.rules.words import Feature, Kind, Word
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.sight import clear, look_points

FAR = 1000.0  # [m]: away from what is nowhere
REST = 0.03  # [m]
BELOW, ABOVE = 2.0, 1.0  # [m]: what is lower or higher, relative to an agent's middle, is on another storey


def boxes_now(snapshot: Snapshot) -> Float[Array, "i 2 3"]:
    """World bounds of all instances where they are now [m]."""
    scene, geometry = snapshot.scene, snapshot.bank.geometry
    model = jnp.maximum(geometry.instance_model[scene.house], 0)
    placed = jax.vmap(bounds)(geometry.instance_pose[scene.house], geometry.model_box[model])
    moving = jnp.where(scene.moving.instance < 0, placed.shape[0], scene.moving.instance)
    return placed.at[moving].set(scene.moving.box, mode="drop")


class Looked(Pytree):
    """What conditions look at, and what was found on the way to it, which experts need; A agents."""

    values: Float[Array, "feature a d d"]  # of agent a, descriptors i and j
    box: Float[Array, "a d 2 3"]  # [m], bounds of the nearest thing that is meant
    points: Float[Array, "a d p 3"]  # [m], where each agent would look for it
    free: Bool[Array, "a d p"]  # nothing is before these


def look(
    snapshot: Snapshot, program: Program, means: Means, field: UInt16[Array, "cell f"], time: Int[Array, ""]
) -> Looked:
    """Values of all features.

    Args:
        snapshot: The environment.
        program: What is to be done.
        means: What its descriptors mean.
        field: Of the task bank.
        time: Steps since the stage began.
    """
    agents, descriptors = snapshot.pose.yaw.shape[0], program.field.shape[0]
    boxes = boxes_now(snapshot)
    straight, nearest = nearest_meant(snapshot, program, means, boxes)
    points, free = sights(snapshot, nearest)
    rows: dict[Feature, Array] = {
        Feature.TRUE: jnp.ones((agents, 1, 1)),
        Feature.DISTANCE: distances(snapshot, program, field, straight)[:, :, None],
        Feature.STRAIGHT: straight[:, :, None],
        Feature.SEEN: jnp.any(in_frame(snapshot, points) & free, axis=-1)[:, :, None],
        Feature.HELD: held(snapshot, means)[:, :, None],
        Feature.INSIDE: inside(snapshot, means)[:, :, None],
        Feature.BESIDE: beside(means, boxes)[None],
        Feature.ON: rests(means, boxes)[None],
        Feature.OPEN: opened(snapshot, means)[None, :, None],
        Feature.STOPPED: snapshot.stopped[:, None, None],
        Feature.TIME: jnp.broadcast_to(time, (agents, 1, 1)),
        Feature.TOUCHED: snapshot.contact[:, None, None],
        Feature.CLEAR: jnp.any(free, axis=-1)[:, :, None],
        Feature.SAID: snapshot.said[:, None, None],
    }
    shape = agents, descriptors, descriptors
    values = jnp.stack([jnp.broadcast_to(rows[feature].astype(jnp.float32), shape) for feature in Feature])
    return Looked(values=values, box=nearest, points=points, free=free)


def nearest_meant(
    snapshot: Snapshot, program: Program, means: Means, boxes: Float[Array, "i 2 3"]
) -> tuple[Float[Array, "a d"], Float[Array, "a d 2 3"]]:
    """Straight distance from each agent's middle to the nearest thing that is meant [m], and that thing's bounds."""
    pos, kind = snapshot.pose.pos, program.descriptor[:, Word.KIND]
    away = jax.vmap(
        lambda at: jnp.linalg.norm(jnp.maximum(boxes[:, 0] - at, 0) + jnp.maximum(at - boxes[:, 1], 0), axis=-1)
    )(pos)
    away = jnp.where(means.instance[None], away[:, None], FAR)
    index = jnp.argmin(away, axis=-1)
    point = jnp.where((kind == Kind.AGENT)[:, None], pos[program.descriptor[:, Word.AGENT]], program.place)
    offset = jnp.nan_to_num(point[None] - pos[:, None], posinf=FAR, neginf=FAR)
    same_storey = (offset[..., 2] > -BELOW) & (offset[..., 2] < ABOVE)
    to_point = jnp.where(same_storey, jnp.linalg.norm(offset[..., :2], axis=-1), FAR)
    is_point = (kind == Kind.AGENT) | (kind == Kind.PLACE)
    least = jnp.where(is_point[None], jnp.minimum(to_point, FAR), jnp.min(away, axis=-1))
    body = jnp.array([(b.radius, b.radius, b.height / 2) for b in snapshot.config.physics.agents], jnp.float32)
    half = jnp.where((kind == Kind.AGENT)[:, None], body[program.descriptor[:, Word.AGENT]], 0.0)
    whole = jnp.stack([point - half, point + half], axis=1)
    return least, jnp.where(is_point[None, :, None, None], whole[None], boxes[index])


def emitters(snapshot: Snapshot, program: Program, means: Means) -> tuple[Float[Array, "d 3"], Int[Array, " d"]]:
    """Where the sound of what each descriptor means comes from [m], inf for what does not sound; and its object id.

    Objects and agents sound in their middle (of several the first does), places so far above the floor as
    `EnvConfig.source_height` says.
    """
    kind = program.descriptor[:, Word.KIND]
    first = jnp.argmax(means.instance, axis=1)
    middle = jnp.where(jnp.any(means.instance, axis=1)[:, None], boxes_now(snapshot)[first].mean(axis=1), jnp.inf)
    agent = jnp.clip(program.descriptor[:, Word.AGENT], 0, snapshot.pose.yaw.shape[0] - 1)
    someone = snapshot.pose.pos[agent]
    own = agent_ids(snapshot.bank, snapshot.pose.yaw.shape[0])[agent]
    above = program.place.at[:, 2].add(jnp.float32(snapshot.config.source_height))
    point = jnp.where((kind == Kind.OBJECT)[:, None], middle, jnp.where((kind == Kind.AGENT)[:, None], someone, above))
    thing = snapshot.bank.geometry.instance_object[snapshot.house, first]
    body = jnp.where(kind == Kind.OBJECT, thing, jnp.where(kind == Kind.AGENT, own, -1))
    return point, body.astype(jnp.int32)


def distances(
    snapshot: Snapshot, program: Program, field: UInt16[Array, "cell f"], straight: Float[Array, "a d"]
) -> Float[Array, "a d"]:
    """Along the shortest path [m]; where a descriptor has no field, straight."""
    column = jnp.maximum(program.field, 0)
    way = jax.vmap(lambda at: geodesic_distance(snapshot.bank, snapshot.house, column, at, field))(snapshot.pose.pos)
    return jnp.where(program.field < 0, straight, jnp.minimum(way, FAR))


def sights(snapshot: Snapshot, box: Float[Array, "a d 2 3"]) -> tuple[Float[Array, "a d p 3"], Bool[Array, "a d p"]]:
    """Where each agent would look for what has these bounds [m], and where nothing is before them."""
    eyes, own = eye_position(snapshot.config, snapshot.pose), agent_ids(snapshot.bank, box.shape[0])

    def one(eye: Array, own: Array, box: Array) -> tuple[Array, Array]:
        points = look_points(eye, box)
        return points, clear(snapshot.scene, eye, box, points, own)

    return jax.vmap(jax.vmap(one, (None, None, 0)))(eyes, own, box)


def in_frame(snapshot: Snapshot, points: Float[Array, "a d p 3"]) -> Bool[Array, "a d p"]:
    """Which points are in each agent's view, if nothing is before them."""
    config, pose = snapshot.config, snapshot.pose
    way = points - eye_position(config, pose)[:, None, None]
    known = jnp.all(jnp.isfinite(way), axis=-1)
    ahead, left, up = _in_view(jnp.where(known[..., None], way, 1.0), pose.yaw, pose.pitch)
    tall = jnp.tan(jnp.deg2rad(jnp.float32(config.fovy)) / 2)
    wide = tall * jnp.float32(config.width / config.height)
    return known & (ahead > 0) & (jnp.abs(left) <= wide * ahead) & (jnp.abs(up) <= tall * ahead)


def _in_view(
    way: Float[Array, "a d p 3"], yaw: Float[Array, " a"], pitch: Float[Array, " a"]
) -> tuple[Float[Array, "a d p"], Float[Array, "a d p"], Float[Array, "a d p"]]:
    """Ways along the optical axis, to the left and up of the image [m]."""
    cos, sin = jnp.cos(yaw)[:, None, None], jnp.sin(yaw)[:, None, None]
    level, left = cos * way[..., 0] + sin * way[..., 1], cos * way[..., 1] - sin * way[..., 0]
    cos, sin = jnp.cos(pitch)[:, None, None], jnp.sin(pitch)[:, None, None]
    return cos * level + sin * way[..., 2], left, cos * way[..., 2] - sin * level


def held(snapshot: Snapshot, means: Means) -> Bool[Array, "a d"]:
    """Whether each agent holds something that is meant."""
    body = snapshot.bank.geometry.instance_body[snapshot.house]
    mine = (body[None] == snapshot.held[:, None]) & (snapshot.held[:, None] >= 0)
    return jnp.any(mine[:, None] & means.instance[None], axis=-1)


def inside(snapshot: Snapshot, means: Means) -> Bool[Array, "a d"]:
    """Whether each agent is in a room that is meant."""
    room = jax.vmap(lambda at: room_of(snapshot.bank, snapshot.house, at))(snapshot.pose.pos)
    return jnp.take(means.room, jnp.maximum(room, 0), axis=1).T & (room >= 0)[:, None]


def beside(means: Means, boxes: Float[Array, "i 2 3"]) -> Float[Array, "d d"]:
    """Least gap between things that two descriptors mean [m]."""
    gap = jnp.maximum(boxes[:, None, 0] - boxes[None, :, 1], boxes[None, :, 0] - boxes[:, None, 1])
    away = jnp.linalg.norm(jnp.maximum(gap, 0), axis=-1)
    away = jnp.where(jnp.eye(len(boxes), dtype=bool), FAR, away)
    to_second = jnp.min(jnp.where(means.instance[None], away[:, None], FAR), axis=-1)  # (i, d)
    return jnp.min(jnp.where(means.instance[:, :, None], to_second[None], FAR), axis=1)


def rests(means: Means, boxes: Float[Array, "i 2 3"]) -> Bool[Array, "d d"]:
    """Whether something that the first descriptor means lies on something that the second means.

    Its middle is above the other's plan, its underside at most `REST` above the other's top or within its upper half.
    """
    middle, low, high = boxes.mean(axis=1), boxes[:, 0], boxes[:, 1]
    over = (middle[:, None, :2] >= low[None, :, :2]) & (middle[:, None, :2] <= high[None, :, :2])
    carried = (low[:, None, 2] <= high[None, :, 2] + REST) & (low[:, None, 2] >= middle[None, :, 2])
    on = jnp.all(over, axis=-1) & carried & ~jnp.eye(len(boxes), dtype=bool)
    on_second = jnp.any(on[:, None] & means.instance[None], axis=-1)  # (i, d)
    return jnp.any(means.instance[:, :, None] & on_second[None], axis=1)


def opened(snapshot: Snapshot, means: Means) -> Float[Array, " d"]:
    """Widest opening of the doors that are meant: 0 shut, 1 wide."""
    physics, house = snapshot.bank.physics, snapshot.house
    closed, wide = physics.door_closed[house], physics.door_wide[house]
    part = jnp.abs(snapshot.door_angle - closed) / jnp.maximum(jnp.abs(wide - closed), 1e-6)
    meant = means.instance[:, jnp.maximum(physics.door_instance[house], 0)] & physics.door_valid[house][None]
    return jnp.max(jnp.where(meant, part[None], 0.0), axis=-1, initial=0.0)
