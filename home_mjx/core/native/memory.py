"""What Numba lacks: pointers from addresses, small arrays on the stack, atomics, calls of C functions."""
# ruff: noqa: ANN001, ANN202  (Numba's extension interface)

from typing import Any, no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic


@no_type_check
def pointer_to(item: types.Type) -> Any:
    """A function for compiled code that turns an address into a pointer."""

    @intrinsic
    @no_type_check
    def pointer(typing_context, address):
        return types.CPointer(item)(types.intp), _lower_pointer

    return pointer


@no_type_check
def _lower_pointer(context, builder, signature, args):
    return builder.inttoptr(args[0], context.get_value_type(signature.return_type))


@no_type_check
def stack_of(item: types.Type, count: int) -> Any:
    """A function for compiled code that gives it a small array which lasts until the caller returns."""

    @intrinsic
    @no_type_check
    def array(typing_context):
        @no_type_check
        def lower(context, builder, signature, args):
            return cgutils.alloca_once(builder, context.get_value_type(item), ir.Constant(ir.IntType(64), count))

        return types.CPointer(item)(), lower

    return array


@intrinsic
@no_type_check
def address_of(typing_context, pointer) -> Any:
    """The address of a pointer."""

    @no_type_check
    def lower(context, builder, signature, args):
        return builder.ptrtoint(args[0], ir.IntType(64))

    return types.intp(pointer), lower


@intrinsic
@no_type_check
def fetch_add(typing_context, address, amount) -> Any:
    """Adds to the word at an address, atomically; returns what it was."""

    @no_type_check
    def lower(context, builder, signature, args):
        return builder.atomic_rmw("add", builder.inttoptr(args[0], ir.IntType(64).as_pointer()), args[1], "seq_cst")

    return types.intp(types.intp, types.intp), lower


@intrinsic
@no_type_check
def call(typing_context, function, argument) -> Any:
    """Calls the C function at an address with one word; returns its word."""

    @no_type_check
    def lower(context, builder, signature, args):
        word = ir.IntType(64)
        return builder.call(builder.inttoptr(args[0], ir.FunctionType(word, [word]).as_pointer()), [args[1]])

    return types.intp(types.intp, types.intp), lower


@no_type_check
def symbol_address(name: str) -> Any:
    """A function for compiled code that gives the address of a symbol known to LLVM."""

    @intrinsic
    @no_type_check
    def address(typing_context):
        @no_type_check
        def lower(context, builder, signature, args):
            word = ir.IntType(64)
            function = cgutils.get_or_insert_function(builder.module, ir.FunctionType(word, [word]), name)
            return builder.ptrtoint(function, word)

        return types.intp(), lower

    return address


@intrinsic
@no_type_check
def shifted(typing_context, pointer, count) -> Any:
    """The pointer `count` items further on."""

    @no_type_check
    def lower(context, builder, signature, args):
        return builder.gep(args[0], [args[1]])

    return pointer(pointer, types.intp), lower
