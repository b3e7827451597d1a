"""The kinematic step in chunks of environments, as C functions for `core.native.handler`."""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

from typing import Any, no_type_check

from numba import cfunc

from home_mjx.bank.records import physics as physics_record
from home_mjx.core.native import ffi, memory
from home_mjx.core.native.ffi import float_result, float_row, int_result, int_row, operand_dim
from home_mjx.core.native.handler import WORD_FUNCTION
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.numba_cache import verify_cache
from home_mjx.physics.base import control, servo
from home_mjx.physics.base import doors as base_doors
from home_mjx.physics.kinematic import doors, footprints, kinematic_step, numba_step, support
from home_mjx.physics.kinematic.numba_step import HouseBoxes, allocate_memory, free_memory, step_env
from home_mjx.physics.mjx import template_mjcf
from home_mjx.physics.numba import params

# Operands in order: arrays of all houses, agents and step; then one row per environment. Results.
COLLIDER_POS, COLLIDER_QUAT, COLLIDER_SIZE, RAMP_COLLIDER, RAMP, FLOOR, BODY_SIZE, DOOR, AGENT, TIMES = range(10)
HOUSE, QPOS, QVEL, ACTION, HELD, GRIP, GOAL = range(10, 17)
NEW_QPOS, NEW_QVEL, TOUCHED = range(3)
CHUNK = 16  # environments per chunk of work

compiled = compile_inner()


@verify_cache
def compile_chunks() -> tuple[Any, Any]:
    """Compile the functions `count` and `work` of `handler.build_handler`, or load them from Numba's cache on disk."""
    # Numba's cache checks this file only. The functions refer to the digest, so that a change of others invalidates it.
    parts: Any = (ffi, memory, control, servo, base_doors, physics_record, template_mjcf, params)
    parts += (doors, footprints, kinematic_step, numba_step, support)
    digest = ffi.hash_sources(*(part.__file__ for part in parts))

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
    """Step the environments of one chunk; indices of houses are clipped, those of held bodies are not checked."""
    houses, agents = operand_dim(frame, COLLIDER_POS, 0), operand_dim(frame, ACTION, 1)
    own, times = int_row(frame, HOUSE, 0), float_row(frame, TIMES, 0)
    obstacles, motion = allocate_memory(
        agents, operand_dim(frame, BODY_SIZE, 1), operand_dim(frame, DOOR, 1), operand_dim(frame, COLLIDER_POS, 1)
    )
    for env in range(chunk * CHUNK, min((chunk + 1) * CHUNK, operand_dim(frame, HOUSE, 0))):
        house = _house(frame, min(max(own[env], 0), houses - 1))
        state = float_row(frame, QPOS, env), float_row(frame, QVEL, env)
        commands = (
            float_row(frame, ACTION, env),
            int_row(frame, HELD, env),
            float_row(frame, GRIP, env),
            float_row(frame, GOAL, env),
        )
        result = float_result(frame, NEW_QPOS, env), float_result(frame, NEW_QVEL, env), int_result(frame, TOUCHED, env)
        table = float_row(frame, AGENT, 0)
        step = float(times[0]), int(times[1]), times[2] > 0
        step_env(obstacles, motion, house, step, table, state, commands, result)
    free_memory(obstacles)


@compiled
@no_type_check
def _house(frame, house):
    """Return the rows of a house; the index is not checked."""
    return HouseBoxes(
        float_row(frame, COLLIDER_POS, house),
        float_row(frame, COLLIDER_QUAT, house),
        float_row(frame, COLLIDER_SIZE, house),
        int_row(frame, RAMP_COLLIDER, house),
        operand_dim(frame, RAMP_COLLIDER, 1),
        operand_dim(frame, RAMP, 1),
        float_row(frame, RAMP, house),
        float(float_row(frame, FLOOR, 0)[house]),
        float_row(frame, BODY_SIZE, house),
        float_row(frame, DOOR, house),
    )
