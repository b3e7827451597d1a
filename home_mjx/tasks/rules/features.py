"""Feature values that conditions test, for all agents and descriptors at once and without branching on the task."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int, UInt16

from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import transform_bounds
from home_mjx.navigation import geodesic_distance, opening_fractions, room_at_feet
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.containment import compartments_of_targets
from home_mjx.tasks.rules.enums import Attribute, Feature, TargetKind
from home_mjx.tasks.rules.program import TaskProgram
from home_mjx.tasks.rules.resolve import ResolvedTargets
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position
from home_mjx.tasks.sensors.visibility import is_unobstructed, look_points

UNREACHABLE_DISTANCE = 1000.0  # [m] distance to a target that does not exist or is on another storey
MAX_SUPPORT_GAP = 0.03  # [m] maximum gap between an object's underside and the top of its support
TARGETS_PER_ROUND = 8  # targets whose relations to all instances are computed at once
MAX_RISE_ON_STOREY = 1.0  # [m] places farther above or below the feet, and agents above or below, are on another storey


def current_boxes(snapshot: Snapshot) -> Float[Array, "i 2 3"]:
    """Return the current world bounds (minimum, maximum) of all instances of the house [m]; of padding, any."""
    scene, geometry = snapshot.scene, snapshot.bank.geometry
    model = jnp.maximum(geometry.instance_model[scene.house], 0)
    placed = jax.vmap(transform_bounds)(geometry.instance_pose[scene.house], geometry.model_box[model])
    moving = jnp.where(scene.moving.instance < 0, placed.shape[0], scene.moving.instance)
    return placed.at[moving].set(scene.moving.box, mode="drop")


class FeatureValues(Pytree):
    """Feature values used by conditions, plus intermediate results reused by the expert policies; A agents."""

    values: Float[Array, "feature a d d"]  # of agent a, descriptors i and j
    nearest_box: Float[Array, "a d 2 3"]  # [m], bounds of the nearest target
    sight_points: Float[Array, "a d p 3"]  # [m], points on these bounds that each agent inspects
    is_sight_free: Bool[Array, "a d p"]  # line of sight to these points is free


def compute_features(
    snapshot: Snapshot,
    program: TaskProgram,
    targets: ResolvedTargets,
    field: UInt16[Array, "cell f"],
    stage_steps: Int[Array, ""],
) -> FeatureValues:
    """Compute all `Feature` values of all agents and descriptors; `stage_steps` is the number of steps of the stage.

    Truth values are 0 or 1. A feature that does not depend on an axis (agent, i, j) is repeated along it.
    """
    agents, descriptors = snapshot.pose.yaw.shape[0], program.field.shape[0]
    boxes = current_boxes(snapshot)
    straight, nearest = nearest_targets(snapshot, program, targets, boxes)
    points, free = lines_of_sight(snapshot, nearest)
    gap, on = target_relations(targets, boxes)
    rows: dict[Feature, Array] = {
        Feature.TRUE: jnp.ones((agents, 1, 1)),
        Feature.DISTANCE: path_distances(snapshot, program, field, straight)[:, :, None],
        Feature.STRAIGHT: straight[:, :, None],
        Feature.SEEN: jnp.any(is_in_view(snapshot, points) & free, axis=-1)[:, :, None],
        Feature.HELD: is_held(snapshot, targets)[:, :, None],
        Feature.INSIDE: is_in_target_room(snapshot, targets)[:, :, None],
        Feature.BESIDE: gap[None],
        Feature.ON: on[None],
        Feature.OPEN: door_openings(snapshot, targets)[None, :, None],
        Feature.STOPPED: snapshot.stopped[:, None, None],
        Feature.TIME: jnp.broadcast_to(stage_steps, (agents, 1, 1)),
        Feature.TOUCHED: snapshot.in_contact[:, None, None],
        Feature.CLEAR: jnp.any(free, axis=-1)[:, :, None],
        Feature.SAID: snapshot.spoken_token[:, None, None],
    }
    # The last two features: without states, and without compartments, the table ends before them.
    has_compartments = not snapshot.bank.compartments.is_empty
    if snapshot.switch_on is not None or has_compartments:
        rows[Feature.SWITCHED_ON] = is_switched_on(snapshot, targets)[None, :, None]
    if has_compartments:
        rows[Feature.CONTAINED] = compartments_of_targets(snapshot, targets)[None]
    shape = agents, descriptors, descriptors
    values = jnp.stack([jnp.broadcast_to(rows[feature].astype(jnp.float32), shape) for feature in rows])
    return FeatureValues(values=values, nearest_box=nearest, sight_points=points, is_sight_free=free)


def nearest_targets(
    snapshot: Snapshot, program: TaskProgram, targets: ResolvedTargets, boxes: Float[Array, "i 2 3"]
) -> tuple[Float[Array, "a d"], Float[Array, "a d 2 3"]]:
    """Return each agent's distance to the nearest target of each descriptor [m], and that target's world bounds [m].

    Distances are from capsule centres to bounds of objects; to points and agents horizontal, on the same storey only.
    Of equally near targets the first instance counts. They are `UNREACHABLE_DISTANCE` without a target; its bounds are
    then arbitrary, or not finite.
    """
    pos, kind = snapshot.pose.pos, program.descriptor[:, Attribute.KIND]
    away = jax.vmap(
        lambda at: jnp.linalg.norm(jnp.maximum(boxes[:, 0] - at, 0) + jnp.maximum(at - boxes[:, 1], 0), axis=-1)
    )(pos)
    away = jnp.where(targets.instance[None], away[:, None], UNREACHABLE_DISTANCE)
    index = jnp.argmin(away, axis=-1)
    point = jnp.where((kind == TargetKind.AGENT)[:, None], pos[program.descriptor[:, Attribute.AGENT]], program.place)
    offset = jnp.nan_to_num(point[None] - pos[:, None], posinf=UNREACHABLE_DISTANCE, neginf=UNREACHABLE_DISTANCE)
    depth = jnp.where(kind == TargetKind.PLACE, 1.0, 0.0)[None] * (pos - snapshot.feet)[:, 2:]  # places are on floors
    same_storey = jnp.abs(offset[..., 2] + depth) < MAX_RISE_ON_STOREY
    to_point = jnp.where(same_storey, jnp.linalg.norm(offset[..., :2], axis=-1), UNREACHABLE_DISTANCE)
    is_point = (kind == TargetKind.AGENT) | (kind == TargetKind.PLACE)
    least = jnp.where(is_point[None], jnp.minimum(to_point, UNREACHABLE_DISTANCE), jnp.min(away, axis=-1))
    body = jnp.array([(b.radius, b.radius, b.height / 2) for b in snapshot.config.agents], jnp.float32)
    half = jnp.where((kind == TargetKind.AGENT)[:, None], body[program.descriptor[:, Attribute.AGENT]], 0.0)
    whole = jnp.stack([point - half, point + half], axis=1)
    return least, jnp.where(is_point[None, :, None, None], whole[None], boxes[index])


def sound_positions(
    snapshot: Snapshot, program: TaskProgram, targets: ResolvedTargets
) -> tuple[Float[Array, "d 3"], Int[Array, " d"]]:
    """Return where each descriptor emits sound [m], inf if it cannot, and the id of its object or agent; -1 for others.

    Objects emit from the middle of their box (the first of several targets), agents from theirs, places from
    `EnvConfig.source_height` above the floor.
    """
    kind = program.descriptor[:, Attribute.KIND]
    first = jnp.argmax(targets.instance, axis=1)
    middle = jnp.where(jnp.any(targets.instance, axis=1)[:, None], current_boxes(snapshot)[first].mean(axis=1), jnp.inf)
    agent = jnp.clip(program.descriptor[:, Attribute.AGENT], 0, snapshot.pose.yaw.shape[0] - 1)
    someone = snapshot.pose.pos[agent]
    own = agent_ids(snapshot.bank, snapshot.pose.yaw.shape[0])[agent]
    above = program.place.at[:, 2].add(jnp.float32(snapshot.config.source_height))
    point = jnp.where(
        (kind == TargetKind.OBJECT)[:, None], middle, jnp.where((kind == TargetKind.AGENT)[:, None], someone, above)
    )
    thing = snapshot.bank.geometry.instance_object[snapshot.house, first]
    body = jnp.where(kind == TargetKind.OBJECT, thing, jnp.where(kind == TargetKind.AGENT, own, -1))
    return point, body.astype(jnp.int32)


def path_distances(
    snapshot: Snapshot, program: TaskProgram, field: UInt16[Array, "cell f"], straight: Float[Array, "a d"]
) -> Float[Array, "a d"]:
    """Return path lengths from feet to descriptors [m], at most `UNREACHABLE_DISTANCE`; `straight` without a field."""
    column = jnp.maximum(program.field, 0)
    way = jax.vmap(lambda at: geodesic_distance(snapshot.bank, snapshot.house, column, at, field))(snapshot.feet)
    return jnp.where(program.field < 0, straight, jnp.minimum(way, UNREACHABLE_DISTANCE))


def lines_of_sight(
    snapshot: Snapshot, box: Float[Array, "a d 2 3"]
) -> tuple[Float[Array, "a d p 3"], Bool[Array, "a d p"]]:
    """Return the `look_points` of each target's bounds for an agent [m], and which are unoccluded from its eyes."""
    eyes, own = eye_position(snapshot.config, snapshot.pose), agent_ids(snapshot.bank, box.shape[0])

    def one(eye: Array, own: Array, box: Array) -> tuple[Array, Array]:
        """Return points and their visibility for one agent and descriptor."""
        points = look_points(eye, box)
        return points, is_unobstructed(snapshot.scene, eye, box, points, own)

    return jax.vmap(jax.vmap(one, (None, None, 0)))(eyes, own, box)


def is_in_view(snapshot: Snapshot, points: Float[Array, "a d p 3"]) -> Bool[Array, "a d p"]:
    """Return whether points are in view of each agent's head camera, occluded or not; False if not finite."""
    config, pose = snapshot.config, snapshot.pose
    way = points - eye_position(config, pose)[:, None, None]
    known = jnp.all(jnp.isfinite(way), axis=-1)
    ahead, left, up = _camera_coordinates(jnp.where(known[..., None], way, 1.0), pose.yaw, pose.pitch)
    tall = jnp.tan(jnp.deg2rad(jnp.float32(config.fovy)) / 2)
    wide = tall * jnp.float32(config.width / config.height)
    return known & (ahead > 0) & (jnp.abs(left) <= wide * ahead) & (jnp.abs(up) <= tall * ahead)


def _camera_coordinates(
    way: Float[Array, "a d p 3"], yaw: Float[Array, " a"], pitch: Float[Array, " a"]
) -> tuple[Float[Array, "a d p"], Float[Array, "a d p"], Float[Array, "a d p"]]:
    """Return world-frame offsets along the head camera's axes: forward, left and up in the image [m]."""
    cos, sin = jnp.cos(yaw)[:, None, None], jnp.sin(yaw)[:, None, None]
    level, left = cos * way[..., 0] + sin * way[..., 1], cos * way[..., 1] - sin * way[..., 0]
    cos, sin = jnp.cos(pitch)[:, None, None], jnp.sin(pitch)[:, None, None]
    return cos * level + sin * way[..., 2], left, cos * way[..., 2] - sin * level


def is_held(snapshot: Snapshot, targets: ResolvedTargets) -> Bool[Array, "a d"]:
    """Return whether each agent holds a target of each descriptor."""
    body = snapshot.bank.geometry.instance_body[snapshot.house]
    mine = (body[None] == snapshot.held[:, None]) & (snapshot.held[:, None] >= 0)
    return jnp.any(mine[:, None] & targets.instance[None], axis=-1)


def is_in_target_room(snapshot: Snapshot, targets: ResolvedTargets) -> Bool[Array, "a d"]:
    """Return whether each agent's feet are in a target room of each descriptor; False outside of rooms."""
    room = jax.vmap(lambda at: room_at_feet(snapshot.bank, snapshot.house, at))(snapshot.feet)
    return jnp.take(targets.room, jnp.maximum(room, 0), axis=1).T & (room >= 0)[:, None]


def target_relations(
    targets: ResolvedTargets, boxes: Float[Array, "i 2 3"]
) -> tuple[Float[Array, "d d"], Bool[Array, "d d"]]:
    """Return for each pair of descriptors [i, j] how near a target of i is to another of j, and whether it is on it.

    The first is the minimum gap between their bounds [m], `UNREACHABLE_DISTANCE` if there are none. The second is True
    if one rests on the other, see `_is_supported`.

    Only targets are compared with all instances, `TARGETS_PER_ROUND` at a time. A house has hundreds of instances, of
    which a row names a few.
    """
    named = jnp.any(targets.instance, axis=0)
    count, each = jnp.sum(named, dtype=jnp.int32), jnp.arange(TARGETS_PER_ROUND, dtype=jnp.int32)
    place = jnp.where(named, jnp.cumsum(named, dtype=jnp.int32) - 1, len(boxes))
    order = jnp.zeros(len(boxes), jnp.int32).at[place].set(jnp.arange(len(boxes), dtype=jnp.int32), mode="drop")

    def compare(carry: tuple[Array, Array, Array]) -> tuple[Array, Array, Array]:
        """Compare the next targets with all instances."""
        begin, gap, on = carry
        number = begin + each
        one = order[jnp.minimum(number, len(boxes) - 1)]
        other = jnp.arange(len(boxes)) != one[:, None]
        away = jnp.where(other, _box_gaps(boxes[one], boxes), UNREACHABLE_DISTANCE)  # (k, i)
        rests = _is_supported(boxes[one], boxes) & other
        to_second = jnp.min(jnp.where(targets.instance[None], away[:, None], UNREACHABLE_DISTANCE), axis=-1)  # (k, d)
        on_second = jnp.any(targets.instance[None] & rests[:, None], axis=-1)
        own = (targets.instance[:, one] & (number < count))[:, :, None]
        gap = jnp.minimum(gap, jnp.min(jnp.where(own, to_second[None], UNREACHABLE_DISTANCE), axis=1))
        return begin + TARGETS_PER_ROUND, gap, on | jnp.any(own & on_second[None], axis=1)

    shape = (len(targets.instance),) * 2
    begin = jnp.zeros((), jnp.int32), jnp.full(shape, UNREACHABLE_DISTANCE, jnp.float32), jnp.zeros(shape, bool)
    return jax.lax.while_loop(lambda carry: carry[0] < count, compare, begin)[1:]


def _box_gaps(one: Float[Array, "k 2 3"], other: Float[Array, "i 2 3"]) -> Float[Array, "k i"]:
    """Return the gaps between bounds of each pair [m]; 0 where they overlap."""
    gap = jnp.maximum(one[:, None, 0] - other[None, :, 1], other[None, :, 0] - one[:, None, 1])
    return jnp.linalg.norm(jnp.maximum(gap, 0), axis=-1)


def _is_supported(one: Float[Array, "k 2 3"], other: Float[Array, "i 2 3"]) -> Bool[Array, "k i"]:
    """Return whether the first of each pair rests on the second, by their bounds.

    The middle of the first is above the second's footprint or its edge. Its underside is at most `MAX_SUPPORT_GAP`
    above the second's top, and not below the second's middle.
    """
    middle, low, high = one.mean(axis=1)[:, None], other[None, :, 0], other[None, :, 1]
    over = (middle[..., :2] >= low[..., :2]) & (middle[..., :2] <= high[..., :2])
    under = one[:, None, 0, 2]
    carried = (under <= high[..., 2] + MAX_SUPPORT_GAP) & (under >= other.mean(axis=1)[None, :, 2])
    return jnp.all(over, axis=-1) & carried


def switch_targets(snapshot: Snapshot, targets: ResolvedTargets) -> Bool[Array, "d s"]:
    """Return which rows of the bank's `switches` are targets of each descriptor."""
    instance = snapshot.bank.switches.instance[snapshot.house]
    return targets.instance[:, jnp.maximum(instance, 0)] & (instance >= 0)[None]


def is_switched_on(snapshot: Snapshot, targets: ResolvedTargets) -> Bool[Array, " d"]:
    """Return whether any target of each descriptor is on; False without `EnvConfig.switches`."""
    meant = switch_targets(snapshot, targets)
    return jnp.zeros(len(meant), bool) if snapshot.switch_on is None else jnp.any(meant & snapshot.switch_on, axis=1)


def door_openings(snapshot: Snapshot, targets: ResolvedTargets) -> Float[Array, " d"]:
    """Return the widest opening of each descriptor's doors, as a fraction: 0 closed or no door, 1 wide open.

    Doors of furniture are its fronts. See `opening_fractions`.
    """
    physics, house = snapshot.bank.physics, snapshot.house
    part = opening_fractions(snapshot.bank, house, snapshot.door_angle)
    meant = targets.instance[:, jnp.maximum(physics.door_instance[house], 0)] & physics.door_valid[house][None]
    return jnp.max(jnp.where(meant, part[None], 0.0), axis=-1, initial=0.0)
