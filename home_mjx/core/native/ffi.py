"""XLA's foreign function interface for Numba code: operands, results, attributes and chunked parallel work.

XLA passes the address of an `XLA_FFI_CallFrame`. The word offsets below follow `xla/ffi/api/c_api.h`, which jaxlib
ships (`jax.ffi.include_dir()`). They are valid for interface versions 0.3 (jax 0.9 and 0.10) to 0.5 (jax 0.12).

Work is divided into chunks. The calling thread and tasks on XLA's thread pool take chunks until no chunk is left.
The caller waits only for chunks in progress, never for a task to start. A busy, tiny or dead pool therefore costs
speed but cannot cause a deadlock. A task that starts late finds no chunk and touches only the job.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

import hashlib
from pathlib import Path
from typing import no_type_check

from numba import types

from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, call, fetch_add, pointer_to, stack_of

API_VERSION = 0 | 3 << 32  # major and minor version as one word in memory
FRAME_EXTENSION, FRAME_API, FRAME_CONTEXT, FRAME_STAGE = 1, 2, 3, 4
OPERANDS, RESULTS, ATTRIBUTES = 9, 14, 20  # words of a frame: arrays of pointers
EXTENSION_TYPE, EXTENSION_METADATA, METADATA_VERSION = 1, 3, 3
METADATA, EXECUTE = 1, 3  # extension type, stage
BUFFER_DATA, BUFFER_RANK, BUFFER_DIMS, SCALAR_VALUE = 3, 4, 5, 1
API_DESTROY_ERROR, API_SCHEDULE, API_NUM_THREADS = 8, 17, 18
JOB_NEXT, JOB_DONE, JOB_USERS, JOB_CHUNKS, JOB_FRAME, JOB_WORK = range(6)
JOB_WORDS = 6
WORD, NUMBER = 8, 4  # [bytes]

words, halves, singles = map(pointer_to, (types.int64, types.int32, types.float32))
argument_words = stack_of(types.int64, 5)
allocate = types.ExternalFunction("malloc", types.intp(types.intp))
release = types.ExternalFunction("free", types.void(types.intp))
yield_thread = types.ExternalFunction("sched_yield", types.int32())
compiled = compile_inner()


def hash_sources(*paths: str) -> int:
    """Return a 56-bit hash of files' contents, since Numba's cache watches only the file that defines a handler."""
    text = b"".join(Path(path).read_bytes() for path in paths)
    return int.from_bytes(hashlib.sha256(text).digest()[:7], "little")


@compiled
@no_type_check
def is_execute_call(frame):
    """Return whether XLA requests execution; into a metadata query (False), write the interface version.

    `frame` is the integer address of an `XLA_FFI_CallFrame`.
    """
    extension = words(frame)[FRAME_EXTENSION]
    if extension != 0 and halves(extension + WORD * EXTENSION_TYPE)[0] == METADATA:
        words(words(extension)[EXTENSION_METADATA])[METADATA_VERSION] = API_VERSION
        return False
    return halves(frame + WORD * FRAME_STAGE)[0] == EXECUTE


@compiled
@no_type_check
def run_job(frame, chunks, work, task):
    """Run chunks of work on the calling thread and on XLA's threads, and wait for all of them.

    Args:
        frame: Address of the call frame.
        chunks: Number of chunks.
        work: Address of a C function of the job, which calls `run_chunks`.
        task: Address of a C function of the job, which calls `run_task`.
    """
    job = _open_job(frame, chunks, work, task)
    call(work, job)
    while fetch_add(job + WORD * JOB_DONE, 0) < chunks:
        yield_thread()
    _release_job(job)


@compiled
@no_type_check
def run_task(job):
    """Run a job's work on a thread of XLA until no chunk is left, and release the job; it may then be freed."""
    call(words(job)[JOB_WORK], job)
    _release_job(job)


@compiled
@no_type_check
def run_chunks(job, run_chunk):
    """Call `run_chunk(frame, chunk)` for chunks of a job, from 0, that no other thread takes, until none is left."""
    while True:
        chunk = fetch_add(job + WORD * JOB_NEXT, 1)
        if chunk >= words(job)[JOB_CHUNKS]:
            return
        run_chunk(words(job)[JOB_FRAME], chunk)  # the frame is valid until the last chunk is done
        fetch_add(job + WORD * JOB_DONE, 1)


@compiled
@no_type_check
def _open_job(frame, chunks, work, task):
    """Allocate a job, schedule its task `min(threads, chunks) - 1` times on XLA's pool and return the job's address.

    The caller and each scheduled task release the job once.
    """
    helpers = min(_num_threads(frame), chunks) - 1
    job = allocate(JOB_WORDS * WORD)
    state = words(job)
    state[JOB_NEXT], state[JOB_DONE], state[JOB_USERS] = 0, 0, 1 + max(helpers, 0)
    state[JOB_CHUNKS], state[JOB_FRAME], state[JOB_WORK] = chunks, frame, work
    for _ in range(helpers):
        if not _schedule(frame, task, job):
            _release_job(job)  # on behalf of the task that did not start
    return job


@compiled
@no_type_check
def _release_job(job):
    """Drop a reference to a job; the last user frees it."""
    if fetch_add(job + WORD * JOB_USERS, -1) == 1:
        release(job)


@compiled
@no_type_check
def attribute(frame, index):
    """Return the value of the int32 attribute at `index` in the alphabetical order of the names."""
    return halves(words(words(words(frame)[ATTRIBUTES])[index])[SCALAR_VALUE])[0]


@compiled
@no_type_check
def data(frame, kind, index):
    """Return the address of the data of operand or result `index`; `kind` is `OPERANDS` or `RESULTS`."""
    return words(_buffer(frame, kind, index))[BUFFER_DATA]


@compiled
@no_type_check
def dim(frame, kind, index, axis):
    """Return the length of an axis of an operand or a result, see `data`; `axis` is not checked."""
    return words(words(_buffer(frame, kind, index))[BUFFER_DIMS])[axis]


@compiled
@no_type_check
def num_dims(frame, kind, index):
    """Return the number of axes of an operand or a result, see `data`."""
    return words(_buffer(frame, kind, index))[BUFFER_RANK]


@compiled
@no_type_check
def row(frame, kind, index, number):
    """Return the address of row `number`, along the first axis, of an operand or a result with four-byte items."""
    size = NUMBER
    for axis in range(1, num_dims(frame, kind, index)):
        size *= dim(frame, kind, index, axis)
    return data(frame, kind, index) + number * size


@compiled
@no_type_check
def operand_dim(frame, index, axis):
    """Return the length of an axis of operand `index`."""
    return dim(frame, OPERANDS, index, axis)


@compiled
@no_type_check
def float_row(frame, index, number):
    """Return a pointer to row `number` of the float32 operand `index`."""
    return singles(row(frame, OPERANDS, index, number))


@compiled
@no_type_check
def int_row(frame, index, number):
    """Return a pointer to row `number` of the int32 operand `index`."""
    return halves(row(frame, OPERANDS, index, number))


@compiled
@no_type_check
def float_result(frame, index, number):
    """Return a pointer to row `number` of the float32 result `index`."""
    return singles(row(frame, RESULTS, index, number))


@compiled
@no_type_check
def int_result(frame, index, number):
    """Return a pointer to row `number` of the int32 result `index`."""
    return halves(row(frame, RESULTS, index, number))


@compiled
@no_type_check
def _buffer(frame, kind, index):
    """Return the address of the `XLA_FFI_Buffer` of operand or result `index`; `kind` as in `data`."""
    return words(words(frame)[kind])[index]


@compiled
@no_type_check
def _num_threads(frame):
    """Return the number of threads in XLA's pool; 1 if it has none or the query fails."""
    answer = argument_words()  # struct_size, extension, context, address of the count, the count
    answer[4] = 1
    address = address_of(answer)
    answer[0], answer[1], answer[2], answer[3] = 4 * WORD, 0, words(frame)[FRAME_CONTEXT], address + 4 * WORD
    _call_api(frame, API_NUM_THREADS, address)
    return answer[4]


@compiled
@no_type_check
def _schedule(frame, task, job):
    """Schedule `task(job)`, both addresses, on XLA's pool and return whether that succeeded."""
    ask = argument_words()  # struct_size, extension, context, task, its argument
    ask[0], ask[1], ask[2], ask[3], ask[4] = 5 * WORD, 0, words(frame)[FRAME_CONTEXT], task, job
    return _call_api(frame, API_SCHEDULE, address_of(ask))


@compiled
@no_type_check
def _call_api(frame, function, arguments):
    """Call XLA's API function at word `function` with its arguments' address; return whether it succeeded."""
    api = words(frame)[FRAME_API]
    error = call(words(api)[function], arguments)
    if error == 0:
        return True
    destroy = argument_words()  # struct_size, extension, error
    destroy[0], destroy[1], destroy[2] = 3 * WORD, 0, error
    call(words(api)[API_DESTROY_ERROR], address_of(destroy))
    return False
