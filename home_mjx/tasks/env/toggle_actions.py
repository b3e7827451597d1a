"""Toggling of the lamp or appliance that a hand points at."""

import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx.raycast_render.scene.types import Hit
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.hand_actions import MIN_COMMAND, aim_directions, cast_past_hand, is_in_reach
from home_mjx.tasks.sensors.cameras import eye_position

NOTHING = -1


def switch_indices(snapshot: Snapshot, hit: Hit) -> Int[Array, "a n"]:
    """Return the row in the bank's `switches` of what each ray of each agent hits; -1 none."""
    instance = snapshot.bank.switches.instance[snapshot.house]
    same = (instance == hit.instance[..., None]) & (instance >= 0)
    return jnp.max(jnp.where(same, jnp.arange(instance.shape[0], dtype=jnp.int32), NOTHING), axis=-1)


def pointed_switches(config: EnvConfig, snapshot: Snapshot) -> Int[Array, " a"]:
    """Return the row in the bank's `switches` that each agent's hand points at; -1: none within reach.

    It is the nearest to the view centre, as of other targets of hands; see `EnvConfig.max_aim_angle`.
    """
    eyes, view = eye_position(config, snapshot.pose), aim_directions(config, snapshot.pose)
    hit = cast_past_hand(config, snapshot, eyes, view)
    point = eyes[:, None] + view * jnp.where(hit.instance >= 0, hit.t, jnp.float32(1e6))[..., None]
    row = switch_indices(snapshot, hit)
    fits = (row >= 0) & is_in_reach(config, snapshot, point)
    first = jnp.take_along_axis(row, jnp.argmax(fits, axis=1)[:, None], axis=1)[:, 0]
    return jnp.where(jnp.any(fits, axis=1), first, NOTHING)


def toggle_switches(
    config: EnvConfig, snapshot: Snapshot, command: Float[Array, " a"], on: Bool[Array, " s"]
) -> Bool[Array, " s"]:
    """Return the states after the agents' commands; a command that points at nothing is ignored.

    Args:
        config: Options.
        snapshot: The environment before the step.
        command: The element `toggle`. Continuous: above 0.5 switches on, below -0.5 off; of two agents `off` counts.
            Discrete: above 0.5 reverses the state, twice if two agents do so.
        on: States before.
    """
    target = pointed_switches(config, snapshot)
    row = (target[:, None] == jnp.arange(on.shape[0])) & (jnp.abs(command) > MIN_COMMAND)[:, None]
    if config.discrete is not None:
        return on ^ (jnp.sum(row, axis=0) % 2 == 1)
    lights, darkens = (jnp.any(row & which[:, None], axis=0) for which in (command > 0, command < 0))
    return (on | lights) & ~darkens
