"""Operands and results of the compiled code; `frame` is the address of XLA's call frame, `index` an operand."""
# ruff: noqa: ANN001, ANN201  (Numba infers the types)

from typing import no_type_check

from numba import types

from home_mjx.core.native import ffi
from home_mjx.core.native.ffi import NUMBER
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import pointer_to

ENVS_PER_CHUNK = 8  # environments per task of a thread
CONSTANTS = 0  # operand: kind of frame, and sizes that no shape contains
KIND = 0  # constant: kind of frame
EARLY, LATE = range(2)  # kinds of frames
float_pointer, int_pointer, word_pointer = map(pointer_to, (types.float32, types.int32, types.int64))
compiled = compile_inner()


@compiled
@no_type_check
def constant(frame, index):
    """Return element `index` (`KIND` or a size) of the integer operand `CONSTANTS` of XLA's call frame."""
    return int_pointer(ffi.data(frame, ffi.OPERANDS, CONSTANTS))[index]


@compiled
@no_type_check
def table(frame, index):
    """Return a pointer to the float operand `index`, which all environments share."""
    return float_pointer(ffi.data(frame, ffi.OPERANDS, index))


@compiled
@no_type_check
def complex_table(frame, index, count):
    """Return pointers to `count` real and as many imaginary parts of operand `index`, which all environments share."""
    return complex_pair(ffi.data(frame, ffi.OPERANDS, index), count)


@compiled
@no_type_check
def complex_pair(address, count):
    """Return pointers to `count` real parts at an address and to the imaginary parts after them."""
    return float_pointer(address), float_pointer(address + NUMBER * count)
