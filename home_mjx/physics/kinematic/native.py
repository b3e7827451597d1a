"""The kinematic step as a kernel for CPUs, and its choice at lowering."""

import functools
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.native.fork_guard import check_not_forked
from home_mjx.core.native.kernel import Kernel, call_native
from home_mjx.core.native.vmap_call import Step, batch_kernel
from home_mjx.physics.base.doors import DoorLeaves, door_table, with_trays
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.kinematic.kinematic_step import num_substeps, step_in_jax
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template

# Numbers of operands that all environments share, and of results; `chunks` has their order.
NUM_SHARED, NUM_RESULTS = 10, 3


def step_kinematic(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Step agents, doors and held or released bodies by one control step, see `kinematic_step.step_in_jax`.

    On CPUs a kernel does so, which agrees with it within rounding; gradients are those of `step_in_jax` everywhere.

    Raises:
        BackendError: This is a forked child of a process that has made houses, cast rays or stepped physics.
    """
    check_not_forked("step physics")
    in_jax = functools.partial(step_in_jax, template)

    @jax.custom_jvp
    def native(physics: Physics, house: Array, state: PhysicsState, action: Array) -> tuple[PhysicsState, Overflow]:
        """Step with the kernel."""
        return _step_native(template, physics, house, state, action)

    native.defjvp(lambda primals, tangents: jax.jvp(in_jax, primals, tangents))
    return KERNEL.select(in_jax, {"cpu": native}, physics, house, state, action)


def _step_native(
    template: Template, physics: Physics, house: Array, state: PhysicsState, action: Array
) -> tuple[PhysicsState, Overflow]:
    """Step with the kernel; held bodies that do not exist count as none, since native code does not check bounds."""
    config, bodies = template.config, physics.body_size.shape[1]
    times = jnp.asarray((config.timing.ctrl_dt, num_substeps(config), config.allow_sliding), jnp.float32)
    held = jnp.where(state.held < bodies, state.held, -1)
    static = physics.collider_pos, physics.collider_quat, physics.collider_size
    shared = (*static, physics.ramp_collider, physics.ramp, physics.floor, physics.body_size)
    leaves = with_trays(DoorLeaves.from_physics(physics), physics)
    shared = (*shared, door_table(leaves), jnp.asarray(template.agents, jnp.float32), times)
    own = (house, state.qpos, state.qvel, action, held, state.grip, state.door_goal)
    qpos, qvel, touched = (x[0] for x in _batched()(*shared, *(x[None] for x in own)))
    no = jnp.zeros((), bool)
    moved = state.replace(qpos=qpos, qvel=qvel, qacc=jnp.zeros_like(qvel), num_contacts=touched)
    return moved, Overflow(no, no, no)


@functools.cache
def _batched() -> Step:
    """Return the kernel call, which `vmap` batches: own operands and results have a leading environment axis."""
    return batch_kernel(_run, NUM_SHARED, NUM_RESULTS)


def _run(*operands: Array) -> tuple[Array, ...]:
    """Call the kernel for at least one environment; without any, return results without elements."""
    _, qpos, qvel, action, *_ = operands[NUM_SHARED:]
    results = [jax.ShapeDtypeStruct(x.shape, jnp.float32) for x in (qpos, qvel)]
    results.append(jax.ShapeDtypeStruct(action.shape[:2], jnp.int32))
    if action.shape[0] == 0:
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    return tuple(call_native(KERNEL.name, operands, results))


def _compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk.

    Numba is imported only here, because it loads slowly.
    """
    from home_mjx.physics.kinematic.chunks import compile_chunks

    return compile_chunks()


KERNEL = Kernel("home_mjx_kinematic_step", "falling back to slower kinematic physics", cpu=_compile_chunks)
