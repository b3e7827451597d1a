"""The fused step: all physics steps of a control step in one compiled function, chosen by platform at lowering.

The same model as the template's: contacts where C MuJoCo puts them, its regularisation, its convex problem, solved
exactly. Where there is no such function MJX steps.
"""

from typing import Any

import jax
import jax.numpy as jnp
from jax.custom_batching import custom_vmap
from jax.extend.backend import backends
from jaxtyping import Array, Float, Int

from home_mjx.bank.records import Physics
from home_mjx.physics.base.state import PhysicsState
from home_mjx.physics.cpu import cpu_available, step_cpu
from home_mjx.physics.cuda.launch import cuda_available, step_cuda
from home_mjx.physics.native.numbers import numbers_of
from home_mjx.physics.reference.lost import Lost
from home_mjx.physics.reference.slots import FLAT, Boxes
from home_mjx.physics.reference.step import step_mjx
from home_mjx.physics.reference.template import Template

NUM_SHARED = 9  # arrays that all environments share: the house's, and the template's numbers


def step_fused(
    template: Template, physics: Physics, house: Int[Array, ""], state: PhysicsState, action: Float[Array, "a 3"]
) -> tuple[PhysicsState, Lost]:
    """One control step; see `dynamics.step_checked`. It has no gradient."""

    def mjx(*_: Array) -> tuple[PhysicsState, Lost]:
        return step_mjx(template, physics, house, state, action)

    def native(*_: Array) -> tuple[PhysicsState, Lost]:
        return _step_native(template, physics, house, state, action)

    branches = dict.fromkeys(_platforms(), native)
    names = {"gpu": "cuda"}  # JAX's name of a backend -> that of the platform programs are lowered for
    default = None if {names.get(name, name) for name in backends()} <= set(branches) else mjx
    return jax.lax.platform_dependent(house, default=default, **branches)


def _step_native(
    template: Template, physics: Physics, house: Array, state: PhysicsState, action: Array
) -> tuple[PhysicsState, Lost]:
    numbers = jnp.asarray(numbers_of(template.config, template.yaw_inertia), jnp.float32)
    own = (house, state.qpos, state.qvel, state.qacc, action)
    shared = (*_house_arrays(physics), numbers)
    batch = jax.tree.map(lambda x: x[None], own)
    results = _folded(*map(jax.lax.stop_gradient, (*shared, *batch)))
    qpos, qvel, qacc, touched, lost = (x[0] for x in results)
    no = jnp.zeros((), bool)
    state = PhysicsState(qpos=qpos, qvel=qvel, qacc=qacc, touched=touched)
    return state, Lost(static_boxes=lost[0] > 0, contact_pairs=no, contact_points=lost[1] > 0)


def _house_arrays(physics: Physics) -> tuple[Array, ...]:
    """In the order of `native.handler`; boxes that do not rise above the floor get a negative size."""
    boxes = Boxes(physics.collider_pos, physics.collider_quat, physics.collider_size)
    above = boxes.top > physics.floor[:, None] + jnp.float32(FLAT)
    half = jnp.where(above[..., None], physics.collider_size, jnp.float32(-1.0))
    valid = physics.body_valid.astype(jnp.int32)
    bodies = (valid, physics.body_size, physics.body_mass, physics.body_inertia)
    return (physics.collider_pos, physics.collider_quat, half, *bodies, physics.floor)


@custom_vmap
def _folded(*operands: Array) -> tuple[Array, ...]:
    """Environments (e ...) that share the first arrays; `vmap` adds to e."""
    special = {"cpu": step_cpu, "cuda": step_cuda}
    return jax.lax.platform_dependent(*operands, **{name: special[name] for name in _platforms()})


def _platforms() -> list[str]:
    """Those with a fused step that works here."""
    return ["cpu"] * cpu_available() + ["cuda"] * cuda_available()


@_folded.def_vmap
def _fold(size: int, batched: Any, *operands: Array) -> Any:
    many = [True] * 5
    if any(batched[:NUM_SHARED]):
        spread = [
            x if b else jnp.broadcast_to(x[None], (size, *x.shape)) for x, b in zip(operands, batched, strict=True)
        ]
        return jax.lax.map(lambda x: _folded(*x), tuple(spread)), tuple(many)
    own = []
    for x, is_batched in zip(operands[NUM_SHARED:], batched[NUM_SHARED:], strict=True):
        x = x if is_batched else jnp.broadcast_to(x[None], (size, *x.shape))
        own.append(x.reshape(size * x.shape[1], *x.shape[2:]))
    results = _folded(*operands[:NUM_SHARED], *own)
    return tuple(x.reshape(size, x.shape[0] // size, *x.shape[1:]) for x in results), tuple(many)
