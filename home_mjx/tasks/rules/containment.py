"""Containment of objects in furniture: the value of a condition, and the bodies that begin in a compartment."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.navigation.compartments import compartment_at, stored_pose
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.rules.enums import Feature
from home_mjx.tasks.rules.program import TaskProgram
from home_mjx.tasks.rules.resolve import ResolvedTargets


def compartments_of_targets(snapshot: Snapshot, targets: ResolvedTargets) -> Float[Array, "d d"]:
    """Return for descriptors [i, j] the compartment of a target of j that a target of i is in; -1 if none is.

    It is the index along the house's compartments, the largest of several. The middle of a movable object counts, of
    fixed objects nothing.
    """
    within = jnp.where(snapshot.bank.physics.body_valid[snapshot.house], body_compartments(snapshot), -1)
    item = targets.instance[:, jnp.maximum(snapshot.bank.physics.body_instance[snapshot.house], 0)]
    owner = compartment_owners(snapshot, targets)
    counts = item[:, None] & (within >= 0)[None, None] & owner[:, jnp.maximum(within, 0)][None]
    return jnp.max(jnp.where(counts, within[None, None], -1), axis=-1, initial=-1).astype(jnp.float32)


def body_compartments(snapshot: Snapshot) -> Int[Array, " k"]:
    """Return the compartment that the middle of each movable body is in; -1 none. Of padding it has no meaning."""
    box = snapshot.scene.moving.box[: snapshot.bank.spec.num_bodies]
    return compartment_at(snapshot.bank, snapshot.house, snapshot.door_angle, box.mean(axis=1))


def compartment_owners(snapshot: Snapshot, targets: ResolvedTargets) -> Bool[Array, "d c"]:
    """Return which compartments of the house are in a target of each descriptor; False in padding."""
    door = snapshot.bank.compartments.door[snapshot.house]
    leaf = snapshot.bank.physics.door_instance[snapshot.house, jnp.maximum(door, 0)]
    return targets.instance[:, jnp.maximum(leaf, 0)] & (door >= 0)[None]


def start_compartments(snapshot: Snapshot, program: TaskProgram, targets: ResolvedTargets) -> Int[Array, " k"]:
    """Return the compartment in which each movable body begins the episode; -1: at its place.

    A condition CONTAINED whose minimum and maximum are the same compartment, of a target of its second descriptor,
    says so for the first target of its first one.
    """
    physics, house, kind = snapshot.bank.physics, snapshot.house, program.feature == Feature.CONTAINED
    owner = compartment_owners(snapshot, targets)
    number = program.minimum.astype(jnp.int32)
    at = jnp.clip(number, 0, owner.shape[1] - 1)
    known = kind & (program.minimum == program.maximum) & (number == at) & owner[jnp.maximum(program.second, 0), at]
    item = targets.instance[:, jnp.maximum(physics.body_instance[house], 0)] & physics.body_valid[house][None]
    first = jnp.maximum(program.first, 0)
    body = jnp.where(known & jnp.any(item, axis=1)[first], jnp.argmax(item, axis=1)[first], item.shape[1])
    return jnp.full(item.shape[1], -1, jnp.int32).at[body].set(at, mode="drop")


def stored_poses(snapshot: Snapshot, compartment: Int[Array, " k"]) -> tuple[Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Return poses of bodies in compartments, see `stored_pose`; where `compartment` is -1 they have no meaning."""
    bodies = jnp.arange(compartment.shape[0], dtype=jnp.int32)
    place = jax.vmap(stored_pose, (None, None, None, 0, 0))
    return place(snapshot.bank, snapshot.house, snapshot.door_angle, bodies, jnp.maximum(compartment, 0))


def start_poses(
    snapshot: Snapshot, compartment: Int[Array, " k"]
) -> tuple[Bool[Array, " k"], Float[Array, "k 3"], Float[Array, "k 4"]]:
    """Return the bodies that begin at other poses because some begin in compartments, and these poses.

    Others in one of these compartments, as `EnvConfig.stored_bodies` may put there, are at their initial poses of the
    house.

    Args:
        snapshot: The environment.
        compartment: Compartment in which each body begins, see `start_compartments`; -1: in none.

    Returns:
        A mask, positions [m] and orientations (wxyz); those that are not masked have no meaning.
    """
    physics, house, now = snapshot.bank.physics, snapshot.house, body_compartments(snapshot)
    goes, taken = compartment >= 0, jnp.any(now[:, None] == jnp.where(compartment >= 0, compartment, -2), axis=1)
    pos, quat = stored_poses(snapshot, compartment)
    pos, quat = (
        jnp.where(goes[:, None], x, initial[house])
        for x, initial in ((pos, physics.body_pos), (quat, physics.body_quat))
    )
    return (goes | taken) & physics.body_valid[house], pos, quat


def start_positions(snapshot: Snapshot, program: TaskProgram, targets: ResolvedTargets) -> Float[Array, "k 3"]:
    """Return where each movable body was at the start [m]; where it is now, while it is in its first compartment."""
    initial = snapshot.bank.physics.body_pos[snapshot.house]
    if snapshot.bank.compartments.is_empty:
        return initial
    first = start_compartments(snapshot, program, targets)
    now = snapshot.scene.moving.box[: first.shape[0]].mean(axis=1)
    then = jnp.where((body_compartments(snapshot) == first)[:, None], now, stored_poses(snapshot, first)[0])
    return jnp.where((first >= 0)[:, None], then, initial)
