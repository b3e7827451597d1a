"""From the part of an action that is for the hands to their commands: what is meant is what the agent looks at."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.physics.hands import Commands
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.surface import normals, object_ids
from home_mjx.raycast_render.scene.types import Hit
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position

PRESSED = 0.5  # from which on a number of an action counts as a command
LEVEL = 0.7  # least upward part of the normal of a surface on which things are put


def hand_commands(config: EnvConfig, snapshot: Snapshot, action: Float[Array, "a 3"]) -> Commands:
    """Commands of all agents.

    Args:
        config: Options.
        snapshot: The environment.
        action: `pick` above 0.5 takes the body in the middle of the view, or puts what the hand holds on the surface
            there; below -0.5 it drops. `throw` above 0.5 throws along the view. `turn` above 0.5 opens the door in the
            middle of the view, below -0.5 closes it.
    """
    bank, house, pose = snapshot.bank, snapshot.house, snapshot.pose
    level = jnp.cos(pose.pitch)
    view = jnp.stack([jnp.cos(pose.yaw) * level, jnp.sin(pose.yaw) * level, jnp.sin(pose.pitch)], axis=-1)
    eyes, (pick, throw, turn) = eye_position(config, pose), action.T
    hit = look_past_hand(config, snapshot, eyes, view)
    fixed = (hit.instance >= 0) & (hit.instance < bank.spec.num_instances)  # no agent
    instance = jnp.where(fixed, hit.instance, 0)
    body = jnp.where(fixed, bank.geometry.instance_body[house, instance], -1)
    leaf = bank.physics.door_valid[house][None] & (bank.physics.door_instance[house][None] == hit.instance[:, None])
    holds = snapshot.held >= 0
    puts = (pick > PRESSED) & holds & fixed & (normals(snapshot.scene, view, hit)[:, 2] > LEVEL)
    number = jnp.where(leaf, jnp.arange(leaf.shape[1], dtype=jnp.int32)[None], -1)
    door = jnp.max(number, axis=-1, initial=-1)  # also of no doors
    return Commands(
        pick=jnp.where((pick > PRESSED) & ~holds, body, -1),
        place=jnp.where(puts[:, None], eyes + view * hit.t[:, None], jnp.inf),
        drop=pick < -PRESSED,
        throw=jnp.where((throw > PRESSED)[:, None], view, 0.0),
        door=jnp.where(jnp.abs(turn) > PRESSED, door, -1),
        open=turn > 0,
    )


def look_past_hand(config: EnvConfig, snapshot: Snapshot, eyes: Float[Array, "a 3"], view: Float[Array, "a 3"]) -> Hit:
    """What is in the middle of each agent's view, without what it carries."""
    hit = cast(snapshot.scene, eyes, view, exclude=agent_ids(snapshot.bank, config.num_agents))
    carried = carried_ids(snapshot)
    covers = (carried >= 0) & (object_ids(snapshot.scene, hit) == carried)
    past = cast(snapshot.scene, eyes, view, t_min=jnp.where(covers, hit.t, 0.0), exclude=carried)
    return jax.tree.map(lambda a, b: jnp.where(covers, a, b), past, hit)


def carried_ids(snapshot: Snapshot) -> Int[Array, " a"]:
    """Object id of what each agent holds; -1 nothing."""
    bank, house, body = snapshot.bank, snapshot.house, jnp.maximum(snapshot.held, 0)
    if not bank.spec.num_bodies:
        return snapshot.held
    ids = bank.geometry.instance_object[house, jnp.maximum(bank.physics.body_instance[house, body], 0)]
    return jnp.where(snapshot.held >= 0, ids, -1)
