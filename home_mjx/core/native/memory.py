"""Numba intrinsics for pointers from addresses, small stack arrays, atomics and calls of C functions."""
# ruff: noqa: ANN001, ANN202  (Numba's extension interface)

from typing import Any, no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@no_type_check
def pointer_to(item: types.Type) -> Any:
    """Create an intrinsic `f(address)` that casts an integer address to a pointer to `item`."""

    @intrinsic
    @no_type_check
    def pointer(typing_context, address):
        """Cast an integer address to a pointer."""
        return types.CPointer(item)(types.intp), _lower_pointer

    return pointer


@no_type_check
def _lower_pointer(context, builder, signature, args):
    """Emit the conversion of an integer to a pointer."""
    return builder.inttoptr(args[0], context.get_value_type(signature.return_type))


@no_type_check
def stack_of(item: types.Type, count: int) -> Any:
    """Create an intrinsic `f()` that returns a pointer to `count` uninitialized items on the caller's stack.

    They are valid until the caller returns. A call in a loop yields the same memory each time.
    """

    @intrinsic
    @no_type_check
    def array(typing_context):
        """Return a pointer to memory on the caller's stack."""

        @no_type_check
        def lower(context, builder, signature, args):
            """Emit the allocation at the function's entry."""
            return cgutils.alloca_once(builder, context.get_value_type(item), ir.Constant(ir.IntType(64), count))

        return types.CPointer(item)(), lower

    return array


@intrinsic
@no_type_check
def address_of(typing_context, pointer) -> Any:
    """Return the integer address that a pointer points to."""

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit the conversion of a pointer to an integer."""
        return builder.ptrtoint(args[0], ir.IntType(64))

    return types.intp(pointer), lower


@intrinsic
@no_type_check
def fetch_add(typing_context, address, amount) -> Any:
    """Add `amount` atomically to the 64-bit word at an integer address and return its previous value."""

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit the sequentially consistent atomic addition."""
        return builder.atomic_rmw("add", builder.inttoptr(args[0], ir.IntType(64).as_pointer()), args[1], "seq_cst")

    return types.intp(types.intp, types.intp), lower


@intrinsic
@no_type_check
def call(typing_context, function, argument) -> Any:
    """Call the C function at an integer address with one 64-bit integer and return its 64-bit result."""

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit the indirect call."""
        word = ir.IntType(64)
        return builder.call(builder.inttoptr(args[0], ir.FunctionType(word, [word]).as_pointer()), [args[1]])

    return types.intp(types.intp, types.intp), lower


@intrinsic(prefer_literal=True)
@no_type_check
def symbol_address(typing_context, name) -> Any:
    """Return the integer address of a symbol that was added to LLVM; its name is a compile-time constant string."""
    if not isinstance(name, types.StringLiteral):
        return None

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit the address of an external function with the symbol's name."""
        word = ir.IntType(64)
        kind, symbol = ir.FunctionType(word, [word]), signature.args[0].literal_value
        return builder.ptrtoint(cgutils.get_or_insert_function(builder.module, kind, symbol), word)

    return types.intp(name), lower


@intrinsic
@no_type_check
def unlikely(typing_context, condition) -> Any:
    """Return `condition` unchanged, marked as rarely true, so that LLVM favours the registers of the other branch."""

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit LLVM's intrinsic that marks a condition."""
        bit = ir.IntType(1)
        expect = cgutils.get_or_insert_function(builder.module, ir.FunctionType(bit, [bit, bit]), "llvm.expect.i1")
        return builder.call(expect, [args[0], ir.Constant(bit, 0)])

    return types.boolean(types.boolean), lower


@intrinsic
@no_type_check
def offset_pointer(typing_context, pointer, count) -> Any:
    """Return the pointer advanced by `count` items (not bytes)."""

    @no_type_check
    def lower(context, builder, signature, args):
        """Emit the address of item `count`."""
        return builder.gep(args[0], [args[1]])

    return pointer(pointer, types.intp), lower
