"""Applied forces of motors, hands, door drives and ramps."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.physics.base.control import MASS, motor_forces
from home_mjx.physics.base.doors import DoorLeaves
from home_mjx.physics.base.servo import (
    GRAVITY,
    HeldBody,
    door_acceleration,
    hand_accelerations,
    hand_time_constant,
    ramp_acceleration,
)
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.mjx.house_model import MovableBodies
from home_mjx.physics.mjx.template import Template


def applied_forces(
    template: Template,
    house: tuple[MovableBodies, DoorLeaves, Float[Array, "r 8"]],
    state: PhysicsState,
    action: Float[Array, "a 3"],
    qpos: Float[Array, " q"],
    qvel: Float[Array, " v"],
) -> tuple[Float[Array, "a 3"], Float[Array, " v"]]:
    """Compute the forces that drive agents, doors and held bodies at the positions and velocities `qpos`, `qvel`.

    `house` has the house's bodies, doors and ramps. Of `state`, only `held`, `grip` and `door_goal` are used, not its
    `qpos` and `qvel`. Gravity, contacts and door damping are left out; the force of a hand includes the weight that it
    lifts.

    Returns:
        Forces on the agents, along world x and y [N], torque about z [N m]: `motor_forces`, plus mass times
        `ramp_acceleration`, plus hand reactions. Forces on all other degrees of freedom, as MuJoCo's `qfrc_applied`:
        inertia times `door_acceleration`, and hands; 0 for those of agents, and without hand or drive.
    """
    bodies, leaves, ramps = house
    layout, table = template.layout, jnp.asarray(template.agents, jnp.float32)
    pos, velocity = (x[layout.agent_qpos].reshape(-1, 4) for x in (qpos, qvel))
    motors = jax.vmap(lambda *x: motor_forces(template.config, *x))(table, action, pos[:, 3], velocity)
    uphill = jax.vmap(lambda agent, at: ramp_acceleration(ramps, agent, at[:3]))(table, pos)
    motors = motors.at[:, :2].add(uphill * table[:, MASS, None])
    applied = jnp.zeros_like(qvel)
    if layout.num_doors:
        place, rate = qpos[layout.door_qpos], qvel[layout.door_qvel]
        drive = door_acceleration(place, rate, state.door_goal, leaves.inertia, hand_time_constant(template.config))
        applied = applied.at[layout.door_qvel].add(drive * leaves.inertia)
    if layout.num_bodies:
        for a in range(layout.num_agents):
            applied, back = _add_hand_force(template, bodies, state, a, (qpos, qvel), applied)
            motors = motors.at[a, :2].add(back)
    return motors, applied


def _add_hand_force(
    template: Template,
    bodies: MovableBodies,
    state: PhysicsState,
    a: int,
    now: tuple[Float[Array, " q"], Float[Array, " v"]],
    applied: Float[Array, " v"],
) -> tuple[Float[Array, " v"], Float[Array, "2"]]:
    """Add the force of agent `a`'s hand on its body to `applied`; nothing if the hand is empty. `now` is (qpos, qvel).

    The force is mass times (acceleration of `hand_accelerations` minus gravity). The torque is inertia times angular
    acceleration, plus the gyroscopic torque, so that MuJoCo's terms cancel.

    Returns:
        A copy of `applied` with the force added, and the reaction on the agent along world x and y [N]. That is 0 if
        the hand is empty. The agent has no vertical reaction and no torque.
    """
    layout, body, (qpos, qvel) = template.layout, jnp.maximum(state.held[a], 0), now
    pos, velocity = qpos[layout.body_qpos].reshape(-1, 7)[body], qvel[layout.body_qvel].reshape(-1, 6)[body]
    agent, speed = qpos[4 * a : 4 * a + 4], qvel[4 * a : 4 * a + 4]
    mass, inertia = bodies.mass[body], bodies.inertia[body]
    held = HeldBody(
        pos=pos[:3],
        quat=pos[3:] / jnp.linalg.norm(pos[3:]),
        velocity=velocity[:3],
        spin=velocity[3:],
        mass=mass,
        agent_pos=agent[:3],
        agent_yaw=agent[3],
        agent_velocity=speed,
    )
    linear, angular, back = hand_accelerations(template.config, held, state.grip[a])
    gyroscopic = jnp.cross(velocity[3:], inertia * velocity[3:])  # cancels MuJoCo's term: the hand sets the spin
    force = jnp.concatenate(
        [mass * (linear + jnp.array([0.0, 0.0, GRAVITY], jnp.float32)), inertia * angular + gyroscopic]
    )
    holds = state.held[a] >= 0
    rows = layout.body_qvel.start + 6 * body + jnp.arange(6, dtype=jnp.int32)
    return applied.at[rows].add(jnp.where(holds, force, 0.0)), jnp.where(holds, back, 0.0)
