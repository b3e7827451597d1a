"""The fused step: all physics steps of a control step in one compiled function, chosen by platform at lowering.

It uses the template's model with C MuJoCo's contact points and regularisation, and solves MuJoCo's convex problem to
convergence. On platforms without a kernel, MJX steps.
"""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.core.native.fork_guard import check_not_forked
from home_mjx.core.native.kernel import Kernel, call_native, compile_sources, launch_ptx
from home_mjx.core.native.vmap_call import Step, batch_kernel, forbid_gradient, traced_constant
from home_mjx.physics.base.config import PhysicsSetup
from home_mjx.physics.base.doors import TRAY_ROWS, DoorLeaves, door_table, tray_table
from home_mjx.physics.base.state import BodyScale, PhysicsState
from home_mjx.physics.base.surfaces import body_surfaces
from home_mjx.physics.mjx.contact_slots import half_above_floor
from home_mjx.physics.mjx.mjx_step import step_mjx
from home_mjx.physics.mjx.overflow import Overflow
from home_mjx.physics.mjx.template import Template
from home_mjx.physics.numba.params import (
    ACTION,
    BODY_DOFS,
    BODY_VALID,
    COLLIDER_POS,
    DOOR,
    GOAL,
    MAX_NEAR_BOXES,
    NUM_RESULTS,
    NUM_SHARED,
    POINTS_PER_BODY,
    QACC,
    QVEL,
    RAMP,
    reference_surfaces,
    step_params,
)

NUM_OVERFLOWS = 2  # overflow flags: static boxes, contact points
FILES = ("base.cuh", "shapes.cuh", "contact.cuh", "contacts.cuh", "solver.cuh", "forces.cuh", "sleep.cuh", "step.cu")
SOURCES = tuple(Path(__file__).with_name("cuda") / name for name in FILES)
WARP = 32
CONTACT_WORDS, SMALL_ISLAND, SHARED_CONTACTS = 52, 3, 10  # as in base.cuh
PAIRS_PER_BODY = 16  # as in base.cuh
SHARED_BYTES = 4 * 35 + 2 * 7 + 4  # shared memory per dynamic body: numbers, indices and flags, as in step.cu
SCRATCH_WORDS = MAX_NEAR_BOXES + 12 + 12 + PAIRS_PER_BODY + POINTS_PER_BODY // 2 + CONTACT_WORDS * POINTS_PER_BODY
NUM_COUNTS = 3  # as in base.cuh


def step_cuda(operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> Sequence[Array]:
    """Run the GPU kernel; return its results without the scratch memory.

    `operands` are in the order of `numba.params`: `NUM_SHARED` of all houses, then one row per environment (e, ...).
    There must be at least one environment and one agent, see `_run`. Indices of houses and held bodies must be valid.
    """
    houses, statics = operands[COLLIDER_POS].shape[:2]
    bodies, doors, ramps = (operands[i].shape[1] for i in (BODY_VALID, GOAL, RAMP))
    trays = (operands[DOOR].shape[1] - doors) // TRAY_ROWS
    envs, agents = operands[ACTION].shape[:2]
    mobiles = agents + bodies + doors
    words = SCRATCH_WORDS * mobiles + _newton_words(mobiles)
    scratch = jax.ShapeDtypeStruct((envs, words), jnp.float32)
    sizes = (envs, houses, statics, bodies, agents, doors, ramps, 4 * words, trays)
    common = _newton_words(SMALL_ISLAND) + CONTACT_WORDS * SHARED_CONTACTS + NUM_COUNTS
    shared = SHARED_BYTES * mobiles + 4 * common
    given = *operands, _start_order(operands[QVEL], operands[QACC]), traced_constant(sizes)
    return launch_ptx("step_physics", compile_kernel(), (envs,), WARP, shared, given, (*results, scratch))[:-1]


def _start_order(qvel: Float[Array, "e v"], qacc: Float[Array, "e v"]) -> Int[Array, " e"]:
    """Return the indices of environments by number of moving DoFs, most first: the longest should not start last.

    A DoF moves if its velocity or acceleration is not 0; those of agents count, too. Equal environments keep their
    order.
    """
    return jnp.argsort(-jnp.sum((qvel != 0) | (qacc != 0), axis=1))


def _newton_words(mobiles: int) -> int:
    """Return the number of 4-byte words for an island of `mobiles` bodies: Hessian triangle, gradient and search.

    All kinds of dynamic bodies, doors too, count with `BODY_DOFS` degrees of freedom.
    """
    size = BODY_DOFS * mobiles
    return size * (size + 1) // 2 + 2 * size


def compile_kernel() -> str:
    """Return the PTX of the CUDA sources, compiled for all GPUs of this process; there must be at least one.

    Raises:
        BackendError: NVRTC was not found, or it rejects a source.
    """
    return compile_sources(*SOURCES)


def _compile_chunks() -> tuple[Any, Any]:
    """Return the CPU functions `count` and `work` of `numba.chunks.compile_chunks`.

    The module is imported only here since Numba loads slowly.
    """
    from home_mjx.physics.numba.chunks import compile_chunks

    return compile_chunks()


KERNEL = Kernel("home_mjx_step", "falling back to slower MJX physics", cpu=_compile_chunks, cuda=compile_kernel)
STEPS = {"cpu": functools.partial(call_native, KERNEL.name), "cuda": step_cuda}


def step_fused(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Overflow]:
    """Advance the state by one control step, by the kernel of the platform of lowering, else by MJX.

    MJX runs where there is no kernel, or where it does not work, which is warned of once; see `dynamics.step_checked`.
    `house` must be a valid index: native code does not check bounds, and `step_checked` clips it.

    Raises:
        ConfigError: A gradient of the kernel is requested; where MJX runs, this error is not raised.
        BackendError: This is a forked child of a process that has made houses, cast rays or stepped physics. Or a
            program is lowered for a CPU that is not the default platform, and the kernel has a fault there.
    """
    check_not_forked("step physics")

    def mjx(house: Array, state: PhysicsState, action: Array) -> tuple[PhysicsState, Overflow]:
        """Step with MJX, where no kernel exists or it is not usable."""
        return step_mjx(template, physics, house, state, action)

    native = {platform: functools.partial(_step_native, platform, template, physics) for platform in STEPS}
    return KERNEL.select(mjx, native, house, state, action)


def _step_native(
    platform: str, template: Template, physics: Physics, house: Array, state: PhysicsState, action: Array
) -> tuple[PhysicsState, Overflow]:
    """Step with the kernel of `platform`, "cpu" or "cuda"; return the new state and the overflow flags.

    `held` is clipped to the bank's bodies, since native code does not check bounds; `house` is not. The new state has
    the old `held`. The kernel tests all pairs, so that `contact_pairs` is False.
    """
    numbers = jnp.asarray(step_params(template.config), jnp.float32)
    scale = (state.scale or BodyScale()).factors
    held = jnp.clip(state.held, -1, physics.body_valid.shape[1] - 1)  # native code does not check bounds
    own = (house, state.qpos, state.qvel, state.qacc, action, held, state.grip, state.door_goal, scale)
    shared = (*_house_arrays(template.config, physics), jnp.asarray(template.agents, jnp.float32), numbers)
    batch = jax.tree.map(lambda x: x[None], own)
    results = _batched(platform)(*shared, *batch)
    qpos, qvel, qacc, touched, lost, push, other = (x[0] for x in results)
    no = jnp.zeros((), bool)
    pushed = {"contact_impulse": push[:, 0], "contact_pos": push[:, 1:], "contact_partner": other}
    pushed = _keep_sleeping_contacts(template, state, (qvel, qacc), pushed)
    state = state.replace(qpos=qpos, qvel=qvel, qacc=qacc, num_contacts=touched, **pushed)
    return state, Overflow(static_boxes=lost[0] > 0, contact_pairs=no, contact_points=lost[1] > 0)


def _keep_sleeping_contacts(
    template: Template, before: PhysicsState, rates: tuple[Array, Array], pushed: dict[str, Array]
) -> dict[str, Array]:
    """Return contact reports in which bodies asleep after the step keep those of `before` if their impulse is 0.

    A body that slept before the step reports at least its earlier impulse, since the kernel covered only the time after
    it woke. `rates` is (qvel, qacc) after the step, `pushed` has the contact fields of `PhysicsState` by name.
    """
    slept, sleeps = _is_asleep(template, before.qvel, before.qacc), _is_asleep(template, *rates)
    kept = sleeps & (pushed["contact_impulse"] == 0)
    old = {name: getattr(before, name) for name in pushed}
    now = jax.tree.map(lambda a, b: jnp.where(kept.reshape(-1, *[1] * (b.ndim - 1)), a, b), old, pushed)
    least = jnp.where(slept, before.contact_impulse, jnp.float32(0.0))
    return now | {"contact_impulse": jnp.maximum(now["contact_impulse"], least)}


def _is_asleep(template: Template, qvel: Array, qacc: Array) -> Array:
    """Return whether each dynamic body sleeps: all its velocities and accelerations are 0. Agents never do.

    `PhysicsConfig.sleep` is not used. Unused bodies and doors are tested likewise.
    """
    layout, moves = template.layout, (qvel != 0) | (qacc != 0)
    free = moves[layout.body_qvel].reshape(-1, 6).any(axis=-1)
    return ~jnp.concatenate([jnp.ones(layout.num_agents, bool), free, moves[layout.door_qvel]])


def _house_arrays(config: PhysicsSetup, physics: Physics) -> tuple[Array, ...]:
    """Return the arrays of all houses, ordered as `numba.params`; boxes not above the floor get half extents of -1.

    That is the ground floor. Padding is included: bodies are not parked, doors have half extents of -1. Rows of
    trays, if any, follow those of the doors. Factors of `BodyScale` are not applied.
    """
    half = half_above_floor(physics)
    valid = physics.body_valid.astype(jnp.int32)
    bodies = (valid, physics.body_size, physics.body_mass, physics.body_inertia)
    surfaces = reference_surfaces(body_surfaces(config, physics))
    doors = door_table(DoorLeaves.from_physics(physics))
    if physics.tray_size.shape[2]:
        doors = jnp.concatenate([doors, tray_table(physics)], axis=1)
    return (physics.collider_pos, physics.collider_quat, half, *bodies, surfaces, doors, physics.ramp, physics.floor)


@functools.cache
def _batched(platform: str) -> Step:
    """Return the kernel call of a platform; `vmap` batches it, and gradients raise `ConfigError`.

    Operands after the first `NUM_SHARED`, and all results, have a leading environment axis even without `vmap`.
    """
    run = functools.partial(_run, STEPS[platform])
    return forbid_gradient(batch_kernel(run, NUM_SHARED, NUM_RESULTS), "the fused physics step")


def _run(step: Callable[..., Sequence[Array]], *operands: Array) -> tuple[Array, ...]:
    """Call `step` with operands as in `numba.params` and its result shapes.

    Without environments or agents, `step` is not called and all results are zeros, poses too.
    """
    _, qpos, qvel, qacc, action, _, _, goal, _ = operands[NUM_SHARED:]
    envs, agents = action.shape[:2]
    mobiles = agents + operands[BODY_VALID].shape[1] + goal.shape[1]
    results = [jax.ShapeDtypeStruct(x.shape, jnp.float32) for x in (qpos, qvel, qacc)]
    results += [jax.ShapeDtypeStruct((envs, size), jnp.int32) for size in (agents, NUM_OVERFLOWS)]
    results += [jax.ShapeDtypeStruct((envs, mobiles, 4), jnp.float32), jax.ShapeDtypeStruct((envs, mobiles), jnp.int32)]
    if 0 in (envs, agents):
        return tuple(jnp.zeros(x.shape, x.dtype) for x in results)
    return tuple(step(operands, results))
