"""SIMD vector types with a fixed number of lanes for Numba: code for one ray casts sixteen.

Numba relies on LLVM's loop vectorization, which fails for a tree traversal. Here vectors are types: `+ - * /`,
comparisons and `& | ~` apply per lane, and scalars are broadcast to all lanes. LLVM maps a vector to the
processor's registers: one AVX-512 register, two of AVX, four of SSE or NEON.
"""
# ruff: noqa: ANN001, ANN202  (Numba's extension interface)

import operator
from collections.abc import Callable
from typing import Any, no_type_check

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

LANES = 16


class Lanes(types.Type):
    """A vector of `LANES` items of a scalar type."""

    def __init__(self, item: types.Type) -> None:
        self.item = item
        super().__init__(name=f"Lanes({item}, {LANES})")


@register_model(Lanes)
class _LanesModel(models.PrimitiveModel):
    @no_type_check
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, ir.VectorType(manager.lookup(kind.item).get_value_type(), LANES))


FLOATS, INTS, FLAGS = Lanes(types.float32), Lanes(types.int32), Lanes(types.boolean)


@no_type_check
def _spread(builder, value):
    """Broadcast a scalar to all lanes; return vectors unchanged."""
    if isinstance(value.type, ir.VectorType):
        return value
    empty = ir.Constant(ir.VectorType(value.type, LANES), ir.Undefined)
    first = builder.insert_element(empty, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, empty, ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES))


@no_type_check
def _define(operation, emit, kind, result) -> None:
    """Define an operator from vectors of type `kind`, one of which may be a scalar, to vectors of type `result`."""
    cases = [(kind, kind), (kind, kind.item), (kind.item, kind)]
    for case in cases:

        @lower_builtin(operation, *case)
        @no_type_check
        def lower(context, builder, sig, args):
            """Emit the operation after broadcasting a scalar operand."""
            return emit(builder, *(_spread(builder, x) for x in args))

    infer_global(operation)(
        type("LanesOperator", (ConcreteTemplate,), {"key": operation, "cases": [signature(result, *c) for c in cases]})
    )


@no_type_check
def _compare(method: str, sign: str) -> Callable[..., Any]:
    """Return a function that emits an LLVM comparison such as `fcmp_ordered` with the operator `sign`."""
    return lambda builder, a, b: getattr(builder, method)(sign, a, b)


def _define_all() -> None:
    """Define arithmetic for `FLOATS`, comparisons except `!=` for all types, `&` and `|` for `FLAGS` and `INTS`."""
    build = ir.IRBuilder
    for operation, emit in {
        operator.add: build.fadd,
        operator.sub: build.fsub,
        operator.mul: build.fmul,
        operator.truediv: build.fdiv,
    }.items():
        _define(operation, emit, FLOATS, FLOATS)
    for sign in ("<", "<=", ">", ">=", "=="):
        operation = {"<": operator.lt, "<=": operator.le, ">": operator.gt, ">=": operator.ge, "==": operator.eq}[sign]
        _define(operation, _compare("fcmp_ordered", sign), FLOATS, FLAGS)
        _define(operation, _compare("icmp_signed", sign), INTS, FLAGS)
        _define(operation, _compare("icmp_unsigned", sign), FLAGS, FLAGS)
    for operation, emit in {operator.and_: build.and_, operator.or_: build.or_}.items():
        _define(operation, emit, FLAGS, FLAGS)
        _define(operation, emit, INTS, INTS)


_define_all()


@lower_builtin(operator.invert, FLAGS)
@no_type_check
def _lower_invert(context, builder, sig, args):
    """Emit the logical negation of each lane of a mask."""
    return builder.not_(args[0])


class _Invert(ConcreteTemplate):
    key = operator.invert
    cases = (signature(FLAGS, FLAGS),)


infer_global(operator.invert)(_Invert)  # pyright: ignore[reportOptionalCall]


@intrinsic
@no_type_check
def select(typing_context, mask, a, b) -> Any:
    """Return per lane `a` where the mask (`FLAGS`) is set, else `b`; one of them, but not both, may be a scalar."""
    kind = a if isinstance(a, Lanes) else b

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit a selection after broadcasting a scalar operand."""
        return builder.select(args[0], *(_spread(builder, x) for x in args[1:]))

    return kind(mask, *(x if isinstance(x, Lanes) else kind.item for x in (a, b))), lower


@no_type_check
def _extreme(sign: str) -> Any:
    """Return an intrinsic f(a, b), per float32 lane: `b` if it compares as `sign` to `a`, else `a`."""

    @intrinsic
    @no_type_check
    def extreme(typing_context, a, b):
        """Return `b` where it compares to `a`, else `a`."""

        @no_type_check
        def lower(context, builder, sig, args):
            """Emit an ordered comparison, false for NaN, and a selection."""
            a, b = (_spread(builder, x) for x in args)
            return builder.select(builder.fcmp_ordered(sign, b, a), b, a)

        return FLOATS(a, b), lower

    return extreme


# As in Python: return the first operand if the two cannot be compared (NaN).
minimum, maximum = _extreme("<"), _extreme(">")


@intrinsic
@no_type_check
def absolute(typing_context, x) -> Any:
    """Return the absolute value of each float32 lane."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit LLVM's `fabs`."""
        kind = ir.FunctionType(args[0].type, [args[0].type])
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.fabs.v{LANES}f32"), args)

    return FLOATS(x), lower


@intrinsic
@no_type_check
def multiply_add(typing_context, a, b, c) -> Any:
    """Compute a * b + c per float32 lane, rounded once where the processor can; `a` and `b` may be scalars."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit LLVM's `fmuladd` after broadcasting scalar operands."""
        a, b, c = (_spread(builder, x) for x in args)
        kind = ir.FunctionType(c.type, [c.type] * 3)
        function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fmuladd.v{LANES}f32")
        return builder.call(function, [a, b, c])

    return FLOATS(*(x if isinstance(x, Lanes) else FLOATS.item for x in (a, b)), c), lower


@intrinsic
@no_type_check
def sum_lanes(typing_context, x) -> Any:
    """Return the scalar sum of all float32 lanes, by repeatedly adding the upper half to the lower half."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit four additions of halves."""
        value, width = args[0], LANES
        while width > 1:
            width //= 2
            upper = [ir.Constant(ir.IntType(32), width + i) for i in range(width)]
            lower_ = [ir.Constant(ir.IntType(32), i) for i in range(width)]
            kind = ir.VectorType(ir.IntType(32), width)
            halves = [builder.shuffle_vector(value, value, ir.Constant(kind, x)) for x in (lower_, upper)]
            value = builder.fadd(*halves)
        return builder.extract_element(value, ir.Constant(ir.IntType(32), 0))

    return FLOATS.item(x), lower


@intrinsic
@no_type_check
def broadcast(typing_context, x) -> Any:
    """Broadcast a scalar to all lanes."""
    return Lanes(x)(x), lambda context, builder, sig, args: _spread(builder, args[0])


@intrinsic
@no_type_check
def count_lanes(typing_context, mask) -> Any:
    """Return the number of lanes of a mask (`FLAGS`) that are set, as int32."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit a count of the mask's bits."""
        bits = builder.bitcast(args[0], ir.IntType(LANES))
        return builder.zext(builder.ctpop(bits), ir.IntType(32))

    return types.int32(mask), lower


@intrinsic
@no_type_check
def any_lane(typing_context, mask) -> Any:
    """Return whether any lane of a mask (`FLAGS`) is set, as a scalar."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit a comparison of the mask's bits with 0."""
        bits = builder.bitcast(args[0], ir.IntType(LANES))
        return builder.icmp_unsigned("!=", bits, ir.Constant(bits.type, 0))

    return types.boolean(mask), lower


@intrinsic
@no_type_check
def load(typing_context, pointer, index) -> Any:
    """Load the `LANES` items `pointer[index:index + LANES]` as a vector; `index` counts items."""
    kind = Lanes(pointer.dtype)

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit a load that needs an alignment of four bytes only."""
        return builder.load(_vector_at(context, builder, kind, *args), align=4)

    return kind(pointer, types.intp), lower


@intrinsic
@no_type_check
def store(typing_context, pointer, index, value) -> Any:
    """Store a vector to `pointer[index:index + LANES]`; `index` counts items."""

    @no_type_check
    def lower(context, builder, sig, args):
        """Emit a store that needs an alignment of four bytes only."""
        builder.store(args[2], _vector_at(context, builder, value, *args[:2]), align=4)
        return context.get_dummy_value()

    return types.void(pointer, types.intp, value), lower


@no_type_check
def _vector_at(context, builder, kind, pointer, index):
    """Return a pointer to the vector that begins at item `index` of `pointer`."""
    return builder.bitcast(builder.gep(pointer, [index]), context.get_value_type(kind).as_pointer())
