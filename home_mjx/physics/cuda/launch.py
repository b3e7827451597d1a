"""CUDA backend of the fused step: one warp per environment, compiled on first use."""

from collections.abc import Sequence
from pathlib import Path

import jax
import jax.numpy as jnp
from jaxtyping import Array

from home_mjx.core.native.kernel import compile_sources, launch_ptx
from home_mjx.core.native.vmap_call import traced_constant
from home_mjx.physics.numba.data.limits import BODY_DOFS, MAX_NEAR_BOXES, POINTS_PER_BODY
from home_mjx.physics.numba.data.operands import ACTION, BODY_VALID, COLLIDER_POS, DOOR, RAMP

FILES = ("base.cuh", "shapes.cuh", "contact.cuh", "contacts.cuh", "solver.cuh", "forces.cuh", "sleep.cuh", "step.cu")
SOURCES = tuple(Path(__file__).with_name(name) for name in FILES)
WARP = 32
CONTACT_WORDS, SMALL_ISLAND = 52, 6  # as in base.cuh
PAIRS_PER_BODY = 16  # as in base.cuh
SHARED_REALS, SHARED_INTS = 47, 11 + POINTS_PER_BODY  # words of shared memory per dynamic body, as in step.cu


def step_cuda(operands: Sequence[Array], results: Sequence[jax.ShapeDtypeStruct]) -> Sequence[Array]:
    """Step environments (e ...) by one control step; operands and results are ordered as in `numba.data.operands`."""
    houses, statics = operands[COLLIDER_POS].shape[:2]
    bodies, doors, ramps = (operands[i].shape[1] for i in (BODY_VALID, DOOR, RAMP))
    envs, agents = operands[ACTION].shape[:2]
    mobiles = agents + bodies + doors
    words = (MAX_NEAR_BOXES + 12 + PAIRS_PER_BODY + CONTACT_WORDS * POINTS_PER_BODY) * mobiles + _newton_words(mobiles)
    scratch = jax.ShapeDtypeStruct((envs, words), jnp.float32)
    sizes = (envs, houses, statics, bodies, agents, doors, ramps, 4 * words)
    shared = 4 * ((SHARED_REALS + SHARED_INTS) * mobiles + _newton_words(SMALL_ISLAND) + 2)
    given = *operands, traced_constant(sizes)
    return launch_ptx("step_physics", compile_kernel(), (envs,), WARP, shared, given, (*results, scratch))[:-1]


def _newton_words(mobiles: int) -> int:
    """Return the words of memory for an island: lower triangle of its Hessian, gradient and search direction."""
    size = BODY_DOFS * mobiles
    return size * (size + 1) // 2 + 2 * size


def compile_kernel() -> str:
    """Compile PTX that all GPUs of this process can run."""
    return compile_sources(*SOURCES)
