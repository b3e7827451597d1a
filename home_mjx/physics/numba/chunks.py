"""The fused step in chunks of environments, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import numpy as np
from numba import carray, cfunc  # pyright: ignore[reportPrivateImportUsage]
from numba.np.unsafe.ndarray import to_fixed_tuple

from home_mjx.core.native import ffi, memory
from home_mjx.core.native.ffi import float_result, float_row, int_result, int_row, operand_dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.physics.base import doors as base_doors
from home_mjx.physics.base import servo, state
from home_mjx.physics.base.doors import TRAY_ROWS
from home_mjx.physics.numba import (
    box_box,
    capsule,
    constraint,
    contact_detection,
    integration,
    params,
    sleep,
    smooth_acceleration,
    solver,
    step,
    workspace,
)
from home_mjx.physics.numba.params import (
    ACTION,
    AGENT,
    BODY_INERTIA,
    BODY_MASS,
    BODY_SIZE,
    BODY_SURFACE,
    BODY_VALID,
    COLLIDER_HALF,
    COLLIDER_POS,
    COLLIDER_QUAT,
    CONTACT_IMPULSE,
    CONTACT_PARTNER,
    DOOR,
    FLOOR,
    GOAL,
    GRIP,
    HELD,
    HOUSE,
    NEW_QACC,
    NEW_QPOS,
    NEW_QVEL,
    NUM_AGENT_CONTACTS,
    OVERFLOW,
    PARAMS,
    QACC,
    QPOS,
    QVEL,
    RAMP,
    SCALE,
    StepParams,
)
from home_mjx.physics.numba.step import load_agents, load_house, scale_bodies, step_env
from home_mjx.physics.numba.workspace import allocate_workspace, free_workspace

CHUNK = 16  # environments per chunk of work
NUM_NUMBERS = len(StepParams._fields)

compiled = compile_inner()


def sources_digest() -> int:
    """Return a 56-bit hash of the source files that the step is compiled from, except this one.

    Numba's cache checks only the file of the compiled function. That function refers to the hash, so that a change of
    the other files invalidates the cache as well.
    """
    parts: tuple[Any, ...] = (
        ffi,
        memory,
        box_box,
        capsule,
        constraint,
        contact_detection,
        smooth_acceleration,
        integration,
        params,
        sleep,
        solver,
        step,
        workspace,
        base_doors,
        servo,
        state,
    )
    return ffi.hash_sources(*(part.__file__ for part in parts))


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk."""
    digest = sources_digest()

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def count(frame):
        """Return the number of chunks of a call, `CHUNK` environments each, the last maybe fewer."""
        _ = digest
        return -(-operand_dim(frame, HOUSE, 0) // CHUNK)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        """Step chunks of a job until none is left; return 0."""
        _ = digest
        ffi.run_chunks(job, _step_chunk)
        return 0

    return count, work


@compiled
@no_type_check
def _step_chunk(frame, chunk):
    """Step the environments of one chunk, at most `CHUNK`, in a workspace of its own.

    House indices are clipped, those of held bodies are not checked. A house is loaded only where it differs from that
    of the environment before.
    """
    houses, colliders = operand_dim(frame, COLLIDER_POS, 0), operand_dim(frame, COLLIDER_POS, 1)
    bodies, agents = operand_dim(frame, BODY_VALID, 1), operand_dim(frame, ACTION, 1)
    doors, ramps = operand_dim(frame, GOAL, 1), operand_dim(frame, RAMP, 1)
    trays = (operand_dim(frame, DOOR, 1) - doors) // TRAY_ROWS
    house = int_row(frame, HOUSE, 0)
    given, floor = _numbers(float_row(frame, PARAMS, 0)), float_row(frame, FLOOR, 0)
    work = allocate_workspace(agents, bodies, doors, colliders, trays)
    load_agents(work, float_row(frame, AGENT, 0))
    loaded = -1
    for env in range(chunk * CHUNK, min((chunk + 1) * CHUNK, operand_dim(frame, HOUSE, 0))):
        own = min(max(house[env], 0), houses - 1)
        if own != loaded:
            _load_house(frame, work, own)
            loaded = own
        scale_bodies(
            work, float_row(frame, BODY_MASS, own), float_row(frame, BODY_INERTIA, own),
            float_row(frame, BODY_SURFACE, own), float_row(frame, SCALE, env),
        )  # fmt: skip
        before = float_row(frame, QPOS, env), float_row(frame, QVEL, env), float_row(frame, QACC, env)
        after = (
            float_result(frame, NEW_QPOS, env),
            float_result(frame, NEW_QVEL, env),
            float_result(frame, NEW_QACC, env),
        )
        report = (
            int_result(frame, NUM_AGENT_CONTACTS, env),
            int_result(frame, OVERFLOW, env),
            float_result(frame, CONTACT_IMPULSE, env),
            int_result(frame, CONTACT_PARTNER, env),
        )
        held = int_row(frame, HELD, env)
        control = float_row(frame, ACTION, env), held, float_row(frame, GRIP, env), float_row(frame, GOAL, env)
        ground = floor[own], float_row(frame, RAMP, own), ramps, float_row(frame, COLLIDER_QUAT, own)
        step_env(work, given, ground, before, control, after, report)
    free_workspace(work)


@compiled
@no_type_check
def _load_house(frame, work, house):
    """Load row `house` of the shared operands into the workspace, see `step.load_house`; the index is not checked."""
    static = float_row(frame, COLLIDER_POS, house), float_row(frame, COLLIDER_HALF, house)
    valid = int_row(frame, BODY_VALID, house)
    bodies = (
        valid,
        float_row(frame, BODY_SIZE, house),
        float_row(frame, BODY_MASS, house),
        float_row(frame, BODY_INERTIA, house),
        float_row(frame, BODY_SURFACE, house),
    )
    load_house(work, static, bodies, float_row(frame, DOOR, house))


@compiled
@no_type_check
def _numbers(given):
    """Convert a pointer to `NUM_NUMBERS` float32 numbers to the `StepParams` record of float64."""
    return StepParams(*to_fixed_tuple(carray(given, NUM_NUMBERS).astype(np.float64), NUM_NUMBERS))
