"""The compiled loop as a handler that XLA calls directly: no Python, no interpreter lock, no copies.

XLA hands over the address of an `XLA_FFI_CallFrame`. The word offsets below follow `xla/ffi/api/c_api.h`, which jaxlib
ships (`jax.ffi.include_dir()`); they are the same from its version 0.3 (jax 0.9 and 0.10) to 0.5 (jax 0.12).

Rays are cast in chunks. The calling thread takes chunks until none is left; tasks on XLA's own thread pool do the
same. It waits only for chunks that are being computed, never for a task to start, so a busy, tiny or dead pool costs
speed but cannot hang. A task that starts late finds no chunk left and touches nothing except the job.
"""
# ruff: noqa: ANN001, ANN202  (Numba infers the types)

import hashlib
from pathlib import Path
from typing import Any, no_type_check

import llvmlite.binding
import numpy as np
from numba import cfunc, njit, types

from home_mjx.raycast_render.executors.native import intersect as native_intersect
from home_mjx.raycast_render.executors.native import lanes
from home_mjx.raycast_render.executors.native import memory as native_memory
from home_mjx.raycast_render.executors.native import packet as native_packet
from home_mjx.raycast_render.executors.native import traverse as native
from home_mjx.raycast_render.executors.native.memory import (
    address_of,
    call,
    fetch_add,
    pointer_to,
    stack_of,
    symbol_address,
)
from home_mjx.raycast_render.scene import constants as limits

API_VERSION = 0 | 3 << 32  # major and minor as they lie in memory
FRAME_EXTENSION, FRAME_API, FRAME_CONTEXT, FRAME_STAGE = 1, 2, 3, 4
FRAME_OPERANDS, FRAME_RESULTS, FRAME_ATTRIBUTES = 9, 14, 20  # their arrays of pointers
EXTENSION_TYPE, EXTENSION_METADATA, METADATA_VERSION = 1, 3, 3
METADATA, EXECUTE = 1, 3  # type of extension, stage
ANY_HIT, WIDTH = 0, 1  # attributes, in the order of their names
BUFFER_DATA, BUFFER_DIMS, SCALAR_VALUE = 3, 5, 1
API_DESTROY_ERROR, API_SCHEDULE, API_NUM_THREADS = 8, 17, 18

NUM_OPERANDS, NUM_RESULTS = 24, 6
INSTANCE_MODEL, MOVING_INSTANCE = 6, 12  # operands whose shapes tell how many there are of each
NUM_RAY_FIELDS = NUM_OPERANDS - native_packet.FIRST_RAY
CHUNK = 16  # packets that a thread takes at once
JOB_NEXT, JOB_DONE, JOB_USERS, JOB_CHUNKS, JOB_FRAME = range(5)
WORD = 8  # [bytes]
TASK = "home_mjx_cast_task"

words, halves = pointer_to(types.int64), pointer_to(types.int32)
operand_words, result_words = stack_of(types.int64, NUM_OPERANDS), stack_of(types.int64, NUM_RESULTS)
ray_words = stack_of(types.int64, NUM_RAY_FIELDS)
argument_words = stack_of(types.int64, 5)
task_address = symbol_address(TASK)
allocate = types.ExternalFunction("malloc", types.intp(types.intp))
release = types.ExternalFunction("free", types.void(types.intp))
give_way = types.ExternalFunction("sched_yield", types.int32())
compiled = njit(error_model="numpy")


def build_handler() -> tuple[Any, Any]:
    """The task and the handler, compiled or loaded from Numba's cache on disk; keep both as long as XLA may call."""
    # The cache watches this file only. That the functions name the digest makes it tell versions of the rest apart.
    parts: tuple[Any, ...] = (lanes, limits, native, native_intersect, native_memory, native_packet)
    digest = _digest(*(part.__file__ for part in parts))

    @cfunc(types.intp(types.intp), cache=True)
    @no_type_check
    def task(job):
        _ = digest
        _work(job)
        _leave(job)
        return 0

    llvmlite.binding.add_symbol(TASK, task.address)

    @cfunc(types.intp(types.intp), cache=True)
    @no_type_check
    def handler(frame):
        _ = digest
        extension = words(frame)[FRAME_EXTENSION]
        if extension != 0 and halves(extension + WORD * EXTENSION_TYPE)[0] == METADATA:
            words(words(extension)[EXTENSION_METADATA])[METADATA_VERSION] = API_VERSION
        elif halves(frame + WORD * FRAME_STAGE)[0] == EXECUTE:
            _execute(frame)
        return 0

    return task, handler


def _digest(*paths: str) -> int:
    text = b"".join(Path(path).read_bytes() for path in paths)
    return int.from_bytes(hashlib.sha256(text).digest()[:7], "little")


@compiled
@no_type_check
def _execute(frame):
    chunks = -(-_num_packets(frame) // CHUNK)
    helpers = min(_num_threads(frame), chunks) - 1
    job = allocate(5 * WORD)
    state = words(job)
    state[JOB_NEXT], state[JOB_DONE], state[JOB_USERS] = 0, 0, 1 + max(helpers, 0)
    state[JOB_CHUNKS], state[JOB_FRAME] = chunks, frame
    for _ in range(helpers):
        if not _schedule(frame, job):
            _leave(job)  # in the task's place
    _work(job)
    while fetch_add(job + WORD * JOB_DONE, 0) < chunks:
        give_way()
    _leave(job)


@compiled
@no_type_check
def _work(job):
    """Casts chunks until none is left."""
    state = words(job)
    while True:
        chunk = fetch_add(job + WORD * JOB_NEXT, 1)
        if chunk >= state[JOB_CHUNKS]:
            return
        _cast_chunk(state[JOB_FRAME], chunk)
        fetch_add(job + WORD * JOB_DONE, 1)


@compiled
@no_type_check
def _leave(job):
    """The last user frees the job."""
    if fetch_add(job + WORD * JOB_USERS, -1) == 1:
        release(job)


@compiled
@no_type_check
def _cast_chunk(frame, chunk):
    operands, counts, results = operand_words(), ray_words(), result_words()
    for i in range(NUM_OPERANDS):
        operands[i] = words(_buffer(frame, FRAME_OPERANDS, i))[BUFFER_DATA]
    for i in range(NUM_RAY_FIELDS):
        counts[i] = _dim(frame, FRAME_OPERANDS, native_packet.FIRST_RAY + i, 1)
    for i in range(NUM_RESULTS):
        results[i] = words(_buffer(frame, FRAME_RESULTS, i))[BUFFER_DATA]
    instances = _dim(frame, FRAME_OPERANDS, INSTANCE_MODEL, 1)
    moving = _dim(frame, FRAME_OPERANDS, MOVING_INSTANCE, 1)
    tiles, any_hit = _tiling(frame), _attribute(frame, ANY_HIT) != 0
    for packet in range(chunk * CHUNK, min((chunk + 1) * CHUNK, _num_packets(frame))):
        native.cast_packet(operands, counts, results, instances, moving, tiles, any_hit, packet)


@compiled
@no_type_check
def _num_packets(frame):
    return _dim(frame, FRAME_RESULTS, 0, 0) * _tiling(frame).packets


@compiled
@no_type_check
def _tiling(frame):
    return native_packet.tiling(_dim(frame, FRAME_RESULTS, 0, 1), np.int64(_attribute(frame, WIDTH)))


@compiled
@no_type_check
def _attribute(frame, index):
    return halves(words(words(words(frame)[FRAME_ATTRIBUTES])[index])[SCALAR_VALUE])[0]


@compiled
@no_type_check
def _dim(frame, kind, index, axis):
    return words(words(_buffer(frame, kind, index))[BUFFER_DIMS])[axis]


@compiled
@no_type_check
def _buffer(frame, kind, index):
    return words(words(frame)[kind])[index]


@compiled
@no_type_check
def _num_threads(frame):
    """Threads in XLA's pool; 1 if it has none."""
    answer = argument_words()  # struct_size, extension, context, address of the count, the count
    answer[4] = 1
    address = address_of(answer)
    answer[0], answer[1], answer[2], answer[3] = 4 * WORD, 0, words(frame)[FRAME_CONTEXT], address + 4 * WORD
    _call_api(frame, API_NUM_THREADS, address)
    return answer[4]


@compiled
@no_type_check
def _schedule(frame, job):
    """Puts a task on XLA's pool; returns whether that worked."""
    ask = argument_words()  # struct_size, extension, context, task, its argument
    ask[0], ask[1], ask[2], ask[3], ask[4] = 5 * WORD, 0, words(frame)[FRAME_CONTEXT], task_address(), job
    return _call_api(frame, API_SCHEDULE, address_of(ask))


@compiled
@no_type_check
def _call_api(frame, function, arguments):
    """Calls a function of XLA's interface; an error is discarded and gives False."""
    api = words(frame)[FRAME_API]
    error = call(words(api)[function], arguments)
    if error == 0:
        return True
    destroy = argument_words()  # struct_size, extension, error
    destroy[0], destroy[1], destroy[2] = 3 * WORD, 0, error
    call(words(api)[API_DESTROY_ERROR], address_of(destroy))
    return False
