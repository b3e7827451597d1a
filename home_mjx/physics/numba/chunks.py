"""The fused step in chunks of environments, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

import numpy as np
from numba import carray, cfunc, njit, types  # pyright: ignore[reportPrivateImportUsage]
from numba.np.unsafe.ndarray import to_fixed_tuple

from home_mjx.core.native import ffi, memory
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.memory import pointer_to
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.physics.base import servo, state
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

float_pointer, int_pointer = pointer_to(types.float32), pointer_to(types.int32)
compiled = njit(error_model="numpy")


def sources_digest() -> int:
    """Return a hash of the source files that the step is compiled from.

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
        _ = digest
        return -(-ffi.dim(frame, ffi.OPERANDS, HOUSE, 0) // CHUNK)

    @cfunc(WORD_FUNCTION, cache=True)
    @no_type_check
    def work(job):
        _ = digest
        ffi.run_chunks(job, _step_chunk)
        return 0

    return count, work


@compiled
@no_type_check
def _step_chunk(frame, chunk):
    """Step the `CHUNK` environments of one chunk in a workspace of its own; reload the house only where it changes."""
    houses, colliders = _operand_dim(frame, COLLIDER_POS, 0), _operand_dim(frame, COLLIDER_POS, 1)
    bodies, agents = _operand_dim(frame, BODY_VALID, 1), _operand_dim(frame, ACTION, 1)
    doors, ramps = _operand_dim(frame, DOOR, 1), _operand_dim(frame, RAMP, 1)
    house = int_pointer(ffi.data(frame, ffi.OPERANDS, HOUSE))
    given, floor = _numbers(_floats(frame, PARAMS, 0)), _floats(frame, FLOOR, 0)
    work = allocate_workspace(agents, bodies, doors, colliders)
    load_agents(work, _floats(frame, AGENT, 0))
    loaded = -1
    for env in range(chunk * CHUNK, min((chunk + 1) * CHUNK, _operand_dim(frame, HOUSE, 0))):
        own = min(max(house[env], 0), houses - 1)
        if own != loaded:
            _load_house(frame, work, own)
            loaded = own
        scale_bodies(
            work, _floats(frame, BODY_MASS, own), _floats(frame, BODY_INERTIA, own), _floats(frame, BODY_SURFACE, own),
            _floats(frame, SCALE, env),
        )  # fmt: skip
        before = _floats(frame, QPOS, env), _floats(frame, QVEL, env), _floats(frame, QACC, env)
        after = _results(frame, NEW_QPOS, env), _results(frame, NEW_QVEL, env), _results(frame, NEW_QACC, env)
        report = (
            _flags(frame, NUM_AGENT_CONTACTS, env),
            _flags(frame, OVERFLOW, env),
            _results(frame, CONTACT_IMPULSE, env),
            _flags(frame, CONTACT_PARTNER, env),
        )
        held = int_pointer(ffi.row(frame, ffi.OPERANDS, HELD, env))
        control = _floats(frame, ACTION, env), held, _floats(frame, GRIP, env), _floats(frame, GOAL, env)
        ground = floor[own], _floats(frame, RAMP, own), ramps
        step_env(work, given, ground, before, control, after, report)
    free_workspace(work)


@compiled
@no_type_check
def _load_house(frame, work, house):
    """Load row `house` of the shared operands into the workspace, see `step.load_house`."""
    static = (
        _floats(frame, COLLIDER_POS, house),
        _floats(frame, COLLIDER_QUAT, house),
        _floats(frame, COLLIDER_HALF, house),
    )
    valid = int_pointer(ffi.row(frame, ffi.OPERANDS, BODY_VALID, house))
    bodies = (
        valid,
        _floats(frame, BODY_SIZE, house),
        _floats(frame, BODY_MASS, house),
        _floats(frame, BODY_INERTIA, house),
        _floats(frame, BODY_SURFACE, house),
    )
    load_house(work, static, bodies, _floats(frame, DOOR, house))


@compiled
@no_type_check
def _operand_dim(frame, index, axis):
    """Return the length of an axis of operand `index`."""
    return ffi.dim(frame, ffi.OPERANDS, index, axis)


@compiled
@no_type_check
def _floats(frame, index, row):
    """Return a pointer to row `row` of the float32 operand `index`."""
    return float_pointer(ffi.row(frame, ffi.OPERANDS, index, row))


@compiled
@no_type_check
def _results(frame, index, row):
    """Return a pointer to row `row` of the float32 result `index`."""
    return float_pointer(ffi.row(frame, ffi.RESULTS, index, row))


@compiled
@no_type_check
def _flags(frame, index, row):
    """Return a pointer to row `row` of the int32 result `index`."""
    return int_pointer(ffi.row(frame, ffi.RESULTS, index, row))


@compiled
@no_type_check
def _numbers(given):
    """Convert a pointer to `NUM_NUMBERS` float32 numbers to the `StepParams` record of float64."""
    return StepParams(*to_fixed_tuple(carray(given, NUM_NUMBERS).astype(np.float64), NUM_NUMBERS))
