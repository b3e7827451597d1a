"""Settling of bodies by the physics, and detection of bodies that do not rest where they were placed."""

import functools

import jax
import jax.numpy as jnp
from jaxtyping import Array, Bool, Float, Int

from home_mjx import physics
from home_mjx.bank.bank import HouseBank
from home_mjx.core.progress import track
from home_mjx.navigation.doors import door_angles
from home_mjx.physics import PhysicsConfig, PhysicsState, Template

SETTLE_SECONDS = 10  # [s], simulated time for bodies to come to rest
AGENT_OFFSET = -10.0  # [m], position of the unused agent in x and y re a corner of the house
MAX_SHIFT, MAX_TURN = 0.01, 0.03  # [m], [rad], maximum displacement of bodies that rest where they were placed


def settle_bodies(
    bank: HouseBank, progress: bool | None = None
) -> tuple[Float[Array, "h p k 7"], Bool[Array, "h p k"]]:
    """Simulate all arrangements for `SETTLE_SECONDS` with open doors; return poses and which bodies are at rest.

    The bank's arrangements are the initial poses (xyz [m], wxyz). At rest is a velocity of exactly 0, as of sleeping
    bodies. Rows of padding mean nothing.
    """
    template = Template(PhysicsConfig(), bank.spec)
    houses, arrangements = bank.physics.arrangement_pose.shape[:2]
    each, number = jnp.meshgrid(jnp.arange(houses), jnp.arange(arrangements), indexing="ij")
    house = each.reshape(-1).astype(jnp.int32)
    state = _reset_states(template, bank, house, number.reshape(-1).astype(jnp.int32))
    for _ in track(range(SETTLE_SECONDS), "settling objects", "s", progress):
        state = jax.block_until_ready(_step_second(template, bank, house, state))
    pose = state.qpos[:, template.layout.body_qpos].reshape(houses, arrangements, -1, 7)
    speed = state.qvel[:, template.layout.body_qvel].reshape(houses, arrangements, -1, 6)
    return pose, jnp.all(speed == 0, axis=-1)  # bodies at rest are asleep, with velocity 0


@functools.partial(jax.jit, static_argnums=0)
def _reset_states(
    template: Template, bank: HouseBank, house: Int[Array, " e"], number: Int[Array, " e"]
) -> PhysicsState:
    """Return states with all bodies as in arrangement `number` of each house, doors open, and the agent outside."""

    def one(house: Array, number: Array) -> PhysicsState:
        """Return the state of one house with one arrangement."""
        corner = bank.navigation.origin[house] + jnp.float32(AGENT_OFFSET)
        agent = jnp.append(corner, bank.physics.floor[house])[None]
        angle = door_angles(bank, house, "open", jax.random.key(0))
        return physics.reset(template, bank, house, agent, jnp.zeros(1, jnp.float32), angle, number)

    return jax.vmap(one)(house, number)


@functools.partial(jax.jit, static_argnums=0)
def _step_second(template: Template, bank: HouseBank, house: Int[Array, " e"], state: PhysicsState) -> PhysicsState:
    """Return the physics states (one per entry of `house`) after one simulated second with idle agents."""

    def step(state: PhysicsState, _: None) -> tuple[PhysicsState, None]:
        """Advance all states by one control step; no outputs."""
        idle = jnp.zeros((1, 3), jnp.float32)
        return jax.vmap(lambda h, s: physics.step(template, bank, h, s, idle))(house, state), None

    return jax.lax.scan(step, state, None, length=round(1 / template.config.timing.ctrl_dt))[0]


def has_moved(before: Float[Array, "*n 7"], after: Float[Array, "*n 7"]) -> Bool[Array, "*n"]:
    """Return whether poses (position, quaternion) differ by more than `MAX_SHIFT` or, in angle, `MAX_TURN`."""
    shift = jnp.linalg.norm(after[..., :3] - before[..., :3], axis=-1)
    cosine = jnp.abs(jnp.sum(after[..., 3:] * before[..., 3:], axis=-1))  # cosine of half the angle between them
    return (shift > jnp.float32(MAX_SHIFT)) | (cosine < jnp.cos(jnp.float32(MAX_TURN / 2)))
