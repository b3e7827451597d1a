"""State of the story at one step, as read by its script."""

from dataclasses import dataclass, fields

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int

from home_mjx import physics
from home_mjx.core.transforms import quat_matrix
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.household import HouseholdEnv


@dataclass(frozen=True)
class Moment:
    """Two agents, K bodies and H doors at one instant, on the host."""

    pos: Float[np.ndarray, "a 3"]  # [m], middles of agents
    yaw: Float[np.ndarray, " a"]  # [rad]
    pitch: Float[np.ndarray, " a"]  # [rad], up
    held: Int[np.ndarray, " a"]  # body in each hand; -1 none
    door_angle: Float[np.ndarray, " h"]  # [rad], about +z from as placed
    body_pos: Float[np.ndarray, "k 3"]  # [m]
    body_frame: Float[np.ndarray, "k 3 3"]  # axes of each body, as columns
    body_speed: Float[np.ndarray, " k"]  # [m/s] and [rad/s], the largest of all six


def moment_of(core: HouseholdEnv, params: EnvParams, state: State) -> dict[str, jax.Array]:
    """The fields of a `Moment`; pure JAX."""
    snapshot, layout = core.snapshot(params, state), core.template(params.bank).layout
    pos, quat = physics.body_pose(core.template(params.bank), state.physics)
    speed = state.physics.qvel[layout.body_qvel].reshape(-1, 6)
    return {
        "pos": snapshot.pose.pos,
        "yaw": snapshot.pose.yaw,
        "pitch": snapshot.pose.pitch,
        "held": snapshot.held,
        "door_angle": snapshot.door_angle,
        "body_pos": pos,
        "body_frame": jax.vmap(quat_matrix)(quat),
        "body_speed": jnp.max(jnp.abs(speed), axis=-1),
    }


def to_host(values: dict[str, jax.Array]) -> Moment:
    """The moment as NumPy arrays."""
    return Moment(**{field.name: np.asarray(values[field.name]) for field in fields(Moment)})
