"""How compiled code reads operands and writes results."""
# ruff: noqa: ANN001, ANN201  (Numba infers the types)

from typing import no_type_check

from numba import njit, types

from home_mjx.core.native import ffi
from home_mjx.core.native.ffi import NUMBER
from home_mjx.core.native.memory import pointer_to

CHUNK = 8  # environments that a thread takes at once
CONSTANTS = 0  # operand: what is to be made, and sizes that no shape tells
WHAT = 0  # constant: what is to be made
EARLY, LATE = range(2)  # what can be
float_pointer, int_pointer, word_pointer = map(pointer_to, (types.float32, types.int32, types.int64))
compiled = njit(error_model="numpy")


@compiled
@no_type_check
def constant(frame, index):
    """One of the operand `CONSTANTS`."""
    return int_pointer(ffi.data(frame, ffi.OPERANDS, CONSTANTS))[index]


@compiled
@no_type_check
def dim(frame, index, axis):
    """Length of an operand's axis."""
    return ffi.dim(frame, ffi.OPERANDS, index, axis)


@compiled
@no_type_check
def table(frame, index):
    """An operand that all environments share."""
    return float_pointer(ffi.data(frame, ffi.OPERANDS, index))


@compiled
@no_type_check
def complex_table(frame, index, count):
    """The same, of real parts and imaginary ones."""
    return complex_pair(ffi.data(frame, ffi.OPERANDS, index), count)


@compiled
@no_type_check
def row(frame, index, env):
    """An operand's numbers of one environment."""
    return float_pointer(ffi.row(frame, ffi.OPERANDS, index, env))


@compiled
@no_type_check
def int_row(frame, index, env):
    """The same of whole numbers."""
    return int_pointer(ffi.row(frame, ffi.OPERANDS, index, env))


@compiled
@no_type_check
def result_row(frame, env):
    """What is made for one environment."""
    return float_pointer(ffi.row(frame, ffi.RESULTS, 0, env))


@compiled
@no_type_check
def complex_pair(address, count):
    """Real parts at an address, and so many imaginary ones after them."""
    return float_pointer(address), float_pointer(address + NUMBER * count)
