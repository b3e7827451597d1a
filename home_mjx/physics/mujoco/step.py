"""A control step with C MuJoCo: JAX computes the forces, a host call per physics step integrates the motion."""

import functools
from collections.abc import Sequence

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.native.vmap_call import Step, batch_kernel, forbid_gradient
from home_mjx.errors import ConfigError
from home_mjx.physics.base.layout import Layout
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.mjx.applied_forces import applied_forces
from home_mjx.physics.mjx.contact_impulses import ContactImpulses, combine_substeps
from home_mjx.physics.mjx.contact_slots import half_above_floor
from home_mjx.physics.mjx.house_model import house_doors, movable_bodies
from home_mjx.physics.mjx.mjx_step import apply_state_limits
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.mujoco.house_mjcf import HouseRows
from home_mjx.physics.mujoco.house_models import MujocoHouses, PrebuiltHouses, shared_house_models
from home_mjx.physics.mujoco.mujoco_model import call_host, check_platform

NUM_RESULTS = 9
MOTOR_DOFS = (0, 1, 3)  # actuated elements of an agent's x, y, z and yaw


def step_mujoco(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Advance the state by one control step; see `dynamics.step_checked`. There is no gradient.

    Contacts that MuJoCo drops set the flag `contact_points`; the other flags are False. `num_contacts` is the maximum
    over the physics steps. `house` must be a valid index; the caller clips it.

    Raises:
        ConfigError: The program is compiled for a platform other than CPU, or `state.scale` is not None. Or an
            exported template has another number of houses than the bank.
        BackendError: This is a forked child of a process that has already stepped.
    """
    check_platform()
    if state.scale is not None:
        raise ConfigError('impl="c" does not scale bodies', hint="Leave `BodyScale` out, or use another `impl`.")
    bodies, leaves = movable_bodies(physics, house), house_doors(physics, house)
    parts, layout = (bodies, leaves, physics.ramp[house]), template.layout
    find, move = _calls(_houses(template, physics))
    tables = physics.replace(collider_size=half_above_floor(physics))
    (number,) = find(*(getattr(tables, name) for name in HouseRows._fields), house[None])

    def substep(carry: tuple[Array, ...], _: None) -> tuple[tuple[Array, ...], tuple[Array, ContactImpulses, Array]]:
        """Do one physics step; emit contact counts, impulses, and whether contacts were dropped."""
        motors, applied = applied_forces(template, parts, state, action, carry[0], carry[1])
        applied = applied.at[_motor_dofs(layout)].add(motors.reshape(-1))
        moved = move(number, *(x[None] for x in (*carry, applied)))
        qpos, qvel, qacc, count, impulse, strongest, place, other, full = (x[0] for x in moved)
        qpos, qvel = apply_state_limits(template, bodies, leaves, state, (qpos, qvel))
        pushes = ContactImpulses(impulse=impulse, strongest=strongest, contact_pos=place, contact_partner=other)
        return (qpos, qvel, qacc), (count, pushes, full)

    first = state.qpos, state.qvel, state.qacc
    length = template.config.timing.substeps
    (qpos, qvel, qacc), (count, pushes, full) = jax.lax.scan(substep, first, None, length=length)
    whole, no = combine_substeps(pushes), jnp.zeros((), bool)
    pushed = {name: getattr(whole, name) for name in ("contact_pos", "contact_partner")}
    pushed |= {"contact_impulse": whole.impulse, "num_contacts": count.max(axis=0)}
    after = state.replace(qpos=qpos, qvel=qvel, qacc=qacc, **pushed)
    return after, Overflow(static_boxes=no, contact_pairs=no, contact_points=jnp.any(full))


def _motor_dofs(layout: Layout) -> Int[np.ndarray, " n"]:
    """Return the indices in `qvel` of all agents' x, y and yaw, agent by agent."""
    return np.add.outer(4 * np.arange(layout.num_agents), MOTOR_DOFS).reshape(-1)


def _houses(template: Template, physics: Physics) -> MujocoHouses:
    """Return the models to step: those of an `ExportedTemplate`, else the store of models built from banks.

    Of `physics`, only the number of houses is used.

    Raises:
        ConfigError: An exported template has another number of houses than the bank.
    """
    exported = getattr(template, "houses", None)  # of an `ExportedTemplate`, which is not imported for the others
    if not isinstance(exported, PrebuiltHouses):
        return shared_house_models(template.config, template.layout)
    if len(exported) != physics.floor.shape[0]:
        raise ConfigError(
            f"the template has {len(exported)} exported houses, the bank has {physics.floor.shape[0]}",
            element="ExportedTemplate",
            hint="Use the template's bank, `template.bank`.",
        )
    return exported


@functools.cache
def _calls(houses: MujocoHouses) -> tuple[Step, Step]:
    """Return the batched host calls `find` and `move`; see `MujocoHouses` for operands and results.

    `find` takes all houses' rows and house indices to model numbers, and builds missing models. `move` does one
    physics step of environments with these numbers.
    """

    def find(*operands: Array) -> tuple[Array, ...]:
        """Map house indices (e), the last operand, to numbers of models (e)."""
        house = operands[-1].astype(jnp.int32)
        return call_host(houses.find_target, (*operands[:-1], house), [jax.ShapeDtypeStruct(house.shape, jnp.int32)])

    def move(*operands: Array) -> tuple[Array, ...]:
        """Step environments by one physics step; operands and results as `MujocoHouses.step_target`."""
        number, *state = operands
        given = (number, *(x.astype(jnp.float32) for x in state))
        return call_host(houses.step_target, given, _results(houses.layout, given[1:4]))

    step = forbid_gradient(batch_kernel(move, 0, NUM_RESULTS), "C MuJoCo")
    return batch_kernel(find, len(HouseRows._fields), 1), step


def _results(layout: Layout, state: Sequence[Array]) -> list[jax.ShapeDtypeStruct]:
    """Return the result shapes of `MujocoHouses.step_target`; `state` is qpos, qvel and qacc, each (e, ...)."""
    envs, agents, mobiles = state[0].shape[0], layout.num_agents, layout.num_dynamic
    shapes = [(x.shape, jnp.float32) for x in state]
    shapes += [((envs, agents), jnp.int32), ((envs, mobiles), jnp.float32), ((envs, mobiles), jnp.float32)]
    shapes += [((envs, mobiles, 3), jnp.float32), ((envs, mobiles), jnp.int32), ((envs,), jnp.bool_)]
    return [jax.ShapeDtypeStruct(*shape) for shape in shapes]
