"""Reachability of fronts of furniture, and of what is behind them: for generators of tasks."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import quat_matrix
from home_mjx.navigation.compartments import compartment_at, stored_pose
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.sensors.reachability import is_in_hand_reach
from home_mjx.tasks.sensors.visibility import EYE_OFFSETS, is_unobstructed, look_points

NUM_OPENINGS = 8  # number of openings of a front at which agents must be clear of it
MIN_TURN, MIN_SLIDE = 1.0, 0.15  # minimum range of a front that agents open: [rad], [m] of drawers
MAX_PULL_ANGLE = 0.8  # [rad], maximum angle to the normal of a front at which a hand pulls something out
MIN_APPARENT_ANGLE = 0.044  # [rad], minimum height and width of what is taken out: hands test rays 2.5° apart
FRONT_CLEARANCE = 0.1  # [m], minimum gap between an agent and a front that it opens


def is_openable(bank: HouseBank, house: Int[Array, ""] | int) -> Bool[Array, " fronts"]:
    """Return which of the bank's `fronts` of a house open by `MIN_TURN` or `MIN_SLIDE`; False in padding."""
    physics, leaf = bank.physics, bank.fronts.leaf[house]
    row = jnp.maximum(leaf, 0)
    span = jnp.abs(jnp.asarray(physics.door_fully_open[house])[row] - jnp.asarray(physics.door_closed[house])[row])
    slides = jnp.any(jnp.asarray(physics.door_slide[house])[row] != 0, axis=-1)
    return (leaf >= 0) & (span >= jnp.where(slides, jnp.float32(MIN_SLIDE), jnp.float32(MIN_TURN)))


def front_box(leaves: DoorLeaves, leaf: Int[Array, ""], coordinate: Float[Array, ""]) -> Float[Array, "2 3"]:
    """Return the world bounds of a leaf without its tray, at a joint coordinate [m]; `leaves` are those of a house."""
    own = jax.tree.map(lambda x: x[leaf], leaves)
    pos, quat = own.pose_at(coordinate)
    half = jnp.abs(quat_matrix(quat)) @ own.size
    return jnp.stack([pos - half, pos + half])


@jax.jit
def can_open_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    leaf: Int[Array, ""],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return at which eye positions [m] a hand reaches a shut front, and an agent is clear of it while it opens.

    At least `MIN_VISIBLE_POINTS` of the `pick_points` of the front must be visible and within `reach` [m]. Bodies are
    at their initial poses, doors between rooms open.
    """
    physics = bank.physics
    leaves = jax.tree.map(lambda x: x[house], DoorLeaves.from_physics(physics))
    closed, wide = physics.door_closed[house, leaf], physics.door_fully_open[house, leaf]
    scene, instance = _scene(bank, house, closed, leaf), physics.door_instance[house, leaf]
    box = front_box(leaves, leaf, closed)
    way = jnp.linspace(0.0, 1.0, NUM_OPENINGS, dtype=jnp.float32) * (wide - closed) + closed
    apart = jnp.min(jax.vmap(lambda at: _leaf_gaps(leaves, leaf, at, eyes))(way), axis=0)
    reached = jax.vmap(lambda eye: is_in_hand_reach(scene, eye, instance, box, reach))(eyes)
    return reached & (apart > jnp.float32(bank.spec.agent_radius + FRONT_CLEARANCE))


@jax.jit
def can_take_out_from(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    body: Int[Array, ""],
    compartment: Int[Array, ""],
    reach: Float[Array, ""],
) -> Bool[Array, " n"]:
    """Return at which eye positions [m] a hand can take a body out of a compartment with an open front.

    The body stands there as `stored_pose` says. It must be hidden while the front is shut. Agents do not stop exactly
    at a position, so the hand must reach it from all of `EYE_OFFSETS` around, and its `apparent_size` must be at least
    `MIN_APPARENT_ANGLE`. Hands pull bodies straight: from an angle above `MAX_PULL_ANGLE` to the normal of a hinged
    front they would pull it against the side wall. The middle of its mesh, which may be a few centimetres from that of
    its box, must be in the compartment and in no other one.
    """
    physics, leaf = bank.physics, bank.compartments.door[house, compartment]
    instance = physics.body_instance[house, body]
    ends = (physics.door_closed[house, leaf], physics.door_fully_open[house, leaf])
    shut, wide = (_scene(bank, house, at, leaf, (body, compartment)) for at in ends)
    boxes = (shut.moving.box[body], wide.moving.box[body])

    def shows(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        """Return whether an eye sees the body although the front is shut."""
        return jnp.any(is_unobstructed(shut, eye, boxes[0], look_points(eye, boxes[0]), jnp.full((), -1, jnp.int32)))

    def takes(eye: Float[Array, "3"]) -> Bool[Array, ""]:
        """Return whether a hand takes the body through the open front."""
        large = jnp.min(apparent_size(eye, boxes[1])) >= jnp.float32(MIN_APPARENT_ANGLE)
        return large & is_in_hand_reach(wide, eye, instance, boxes[1], reach)

    reached = jax.vmap(jax.vmap(takes))(eyes[:, None] + jnp.asarray(EYE_OFFSETS, jnp.float32))
    ahead = _pull_angles(bank, house, eyes, boxes[1].mean(axis=0), leaf) < jnp.float32(MAX_PULL_ANGLE)
    slides = jnp.any(physics.door_slide[house, leaf] != 0)
    angle = bank.fronts.open_doors(physics, house).at[leaf].set(ends[0])
    within = compartment_at(bank, house, angle, boxes[0].mean(axis=0)[None])[0] == compartment
    return within & jnp.all(reached, axis=1) & (ahead | slides) & ~jax.vmap(shows)(eyes)


def apparent_size(eye: Float[Array, "3"], box: Float[Array, "2 3"]) -> Float[Array, "2"]:
    """Return the width and the height of a box with these bounds [m] in the view of an eye outside of it [rad]."""
    corner = jnp.stack([x.reshape(-1) for x in jnp.meshgrid(*box.T, indexing="ij")], axis=-1) - eye
    middle = box.mean(axis=0)[:2] - eye[:2]
    along, across = corner[:, :2] @ middle, corner[:, 1] * middle[0] - corner[:, 0] * middle[1]
    turn = jnp.arctan2(across, along)
    tilt = jnp.arctan2(corner[:, 2], jnp.linalg.norm(corner[:, :2], axis=-1))
    return jnp.stack([jnp.ptp(turn), jnp.ptp(tilt)])


def _pull_angles(
    bank: HouseBank,
    house: Int[Array, ""],
    eyes: Float[Array, "n 3"],
    place: Float[Array, "3"],
    leaf: Int[Array, ""],
) -> Float[Array, " n"]:
    """Return the plan angle between the ways from a place [m] to eyes and the outward normal of a shut leaf [rad]."""
    own = jax.tree.map(lambda x: x[house, leaf], DoorLeaves.from_physics(bank.physics))
    middle, quat = own.pose_at(bank.physics.door_closed[house, leaf])
    normal = jnp.take(quat_matrix(quat)[:2], jnp.argmin(own.size[:2]), axis=1)  # along the thickness of the leaf
    normal = normal * jnp.sign(jnp.sum(normal * (middle - place)[:2]))
    way = eyes[:, :2] - place[:2]
    away = jnp.maximum(jnp.linalg.norm(way, axis=-1), 1e-6)
    return jnp.arccos(jnp.clip(jnp.sum(way * normal, axis=-1) / away, -1.0, 1.0))


def _scene(
    bank: HouseBank,
    house: Int[Array, ""],
    coordinate: Float[Array, ""],
    leaf: Int[Array, ""],
    stored: tuple[Int[Array, ""], Int[Array, ""]] | None = None,
) -> Scene:
    """Return the scene with one front at a coordinate, the others shut, doors open, and a body in a compartment."""
    physics = bank.physics
    angle = bank.fronts.open_doors(physics, house).at[leaf].set(coordinate)
    pos, quat = physics.body_pos[house], physics.body_quat[house]
    if stored is not None:
        there, turned = stored_pose(bank, house, angle, *stored)
        pos, quat = pos.at[stored[0]].set(there), quat.at[stored[0]].set(turned)
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(bank, house, pos, quat, *nobody, door_angle=angle)


def _leaf_gaps(
    leaves: DoorLeaves, leaf: Int[Array, ""], coordinate: Float[Array, ""], eyes: Float[Array, "n 3"]
) -> Float[Array, " n"]:
    """Return plan distances of positions to a leaf at a joint coordinate [m]; 0 inside."""
    own = jax.tree.map(lambda x: x[leaf], leaves)
    pos, quat = own.pose_at(coordinate)
    local = (eyes - pos) @ quat_matrix(quat)
    return jnp.linalg.norm(jnp.maximum(jnp.abs(local[:, :2]) - own.size[:2], 0.0), axis=-1)
