"""Batched complex FFTs of one size in SIMD vectors, by Stockham's algorithm, which needs no bit reversal.

Values of all transforms at one index are contiguous, with real and imaginary parts in separate arrays. Each pass reads
one pair of arrays and writes another. See Van Loan, Computational Frameworks for the Fast Fourier Transform, 1.7.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

import functools
from typing import no_type_check

import numpy as np

from home_mjx.audio_jax.kernels.fft_plan import num_passes
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.simd import LANES, load, multiply_add, store

HALF = np.float32(np.sqrt(0.5))
THIRD = np.float32(np.sqrt(0.75))  # sine of 2 π / 3
COS_1, SIN_1, COS_2, SIN_2 = (np.float32(f(2 * np.pi * k / 5)) for k in (1, 2) for f in (np.cos, np.sin))
compiled = compile_inner()
inlined = compile_inner(forceinline=True)


@functools.cache
def fast_size(count: int) -> int:
    """Return the size, a product of 2, 3 and 5, of the cheapest `transform` of at least `count` values.

    The cost is size (passes + 1); of equally cheap sizes, the smallest is returned.

    Example:
        >>> fast_size(2143), fast_size(6143)
        (2560, 6144)
    """
    sizes = [size for size in range(count, 2 * count + 2) if num_passes(size)]
    return min(sizes, key=lambda size: size * (num_passes(size) + 1))


@compiled
@no_type_check
def transform(size, lanes, turns, values, spare):
    """Compute forward FFTs of `values`, real and imaginary parts (size, lanes); both arguments are overwritten.

    Return the result, in `values` or the equally large `spare`. `lanes` is the number of transforms, at least `LANES`;
    `turns` are the twiddle factors exp(-2 pi i j / size), real and imaginary parts. Prime factors of `size`: 2, 3, 5.
    """
    left, stride = size, lanes
    here, there = values, spare
    while left > 1:
        if left % 8 == 0:
            _pass_8(size, left, stride, turns, here, there)
            left, stride = left // 8, stride * 8
        elif left % 5 == 0:
            _pass_5(size, left, stride, turns, here, there)
            left, stride = left // 5, stride * 5
        elif left % 4 == 0:
            _pass_4(size, left, stride, turns, here, there)
            left, stride = left // 4, stride * 4
        elif left % 3 == 0:
            _pass_3(size, left, stride, turns, here, there)
            left, stride = left // 3, stride * 3
        else:
            _pass_2(size, left, stride, turns, here, there)
            left, stride = left // 2, stride * 2
        here, there = there, here
    return here


@inlined
@no_type_check
def _get(values, at):
    """Load `LANES` complex values from index `at` on of arrays (real, imaginary)."""
    return load(values[0], at), load(values[1], at)


@inlined
@no_type_check
def _put(values, at, value):
    """Store `LANES` complex values from index `at` on in arrays (real, imaginary)."""
    store(values[0], at, value[0])
    store(values[1], at, value[1])


@inlined
@no_type_check
def _turned(value, turns, k):
    """Return complex values times twiddle factor `k` of `turns`."""
    cosine, sine = turns[0][k], turns[1][k]
    re, im = value
    return multiply_add(cosine, re, -sine * im), multiply_add(cosine, im, sine * re)


@inlined
@no_type_check
def _add(a, b):
    """Return a + b of complex pairs (real, imaginary)."""
    return a[0] + b[0], a[1] + b[1]


@inlined
@no_type_check
def _sub(a, b):
    """Return a - b of complex pairs (real, imaginary)."""
    return a[0] - b[0], a[1] - b[1]


@inlined
@no_type_check
def _sub_turned(a, b):
    """Return -i (a - b) of complex pairs (real, imaginary)."""
    return a[1] - b[1], b[0] - a[0]


@inlined
@no_type_check
def _dft_4(a, b, c, d):
    """Return the forward DFT of four complex values."""
    even, odd = _add(a, c), _sub(a, c)
    plus, minus = _add(b, d), _sub_turned(b, d)
    return _add(even, plus), _add(odd, minus), _sub(even, plus), _sub(odd, minus)


@inlined
@no_type_check
def _step_8(here, at, far, there, to, stride, turns, turn):
    """Transform `LANES` sets of 8 values, `far` apart from index `at` of `here` on, see `_make_pass`.

    Value j of the result, times twiddle factor j `turn`, goes to index `to` + j `stride` of `there`.
    """
    a0, a4 = _get(here, at), _get(here, at + 4 * far)
    a1, a5 = _get(here, at + far), _get(here, at + 5 * far)
    a2, a6 = _get(here, at + 2 * far), _get(here, at + 6 * far)
    a3, a7 = _get(here, at + 3 * far), _get(here, at + 7 * far)
    b0, b4 = _add(a0, a4), _sub(a0, a4)
    b1, b5 = _add(a1, a5), _sub(a1, a5)
    b2, b6 = _add(a2, a6), _sub_turned(a2, a6)
    b3, b7 = _add(a3, a7), _sub(a3, a7)
    b5 = HALF * (b5[0] + b5[1]), HALF * (b5[1] - b5[0])
    b7 = HALF * (b7[1] - b7[0]), HALF * (b7[0] + b7[1]) * np.float32(-1)
    y0, y2, y4, y6 = _dft_4(b0, b1, b2, b3)
    y1, y3, y5, y7 = _dft_4(b4, b5, b6, b7)
    _put(there, to, y0)
    _put(there, to + stride, _turned(y1, turns, turn))
    _put(there, to + 2 * stride, _turned(y2, turns, 2 * turn))
    _put(there, to + 3 * stride, _turned(y3, turns, 3 * turn))
    _put(there, to + 4 * stride, _turned(y4, turns, 4 * turn))
    _put(there, to + 5 * stride, _turned(y5, turns, 5 * turn))
    _put(there, to + 6 * stride, _turned(y6, turns, 6 * turn))
    _put(there, to + 7 * stride, _turned(y7, turns, 7 * turn))


@inlined
@no_type_check
def _step_4(here, at, far, there, to, stride, turns, turn):
    """Transform `LANES` sets of 4 values, `far` apart from index `at` of `here` on, to `there`, as `_step_8`."""
    a0, a1 = _get(here, at), _get(here, at + far)
    y0, y1, y2, y3 = _dft_4(a0, a1, _get(here, at + 2 * far), _get(here, at + 3 * far))
    _put(there, to, y0)
    _put(there, to + stride, _turned(y1, turns, turn))
    _put(there, to + 2 * stride, _turned(y2, turns, 2 * turn))
    _put(there, to + 3 * stride, _turned(y3, turns, 3 * turn))


@inlined
@no_type_check
def _step_2(here, at, far, there, to, stride, turns, turn):
    """Transform `LANES` sets of 2 values, `far` apart from index `at` of `here` on, to `there`, as `_step_8`."""
    a0, a1 = _get(here, at), _get(here, at + far)
    _put(there, to, _add(a0, a1))
    _put(there, to + stride, _turned(_sub(a0, a1), turns, turn))


@inlined
@no_type_check
def _step_3(here, at, far, there, to, stride, turns, turn):
    """Transform `LANES` sets of 3 values, `far` apart from index `at` of `here` on, to `there`, as `_step_8`."""
    a0, a1, a2 = _get(here, at), _get(here, at + far), _get(here, at + 2 * far)
    plus, minus = _add(a1, a2), _sub_turned(a1, a2)
    half = multiply_add(np.float32(-0.5), plus[0], a0[0]), multiply_add(np.float32(-0.5), plus[1], a0[1])
    side = THIRD * minus[0], THIRD * minus[1]
    _put(there, to, _add(a0, plus))
    _put(there, to + stride, _turned(_add(half, side), turns, turn))
    _put(there, to + 2 * stride, _turned(_sub(half, side), turns, 2 * turn))


@inlined
@no_type_check
def _step_5(here, at, far, there, to, stride, turns, turn):
    """Transform `LANES` sets of 5 values, `far` apart from index `at` of `here` on, to `there`, as `_step_8`."""
    a0, a1, a2 = _get(here, at), _get(here, at + far), _get(here, at + 2 * far)
    a3, a4 = _get(here, at + 3 * far), _get(here, at + 4 * far)
    outer, inner = _add(a1, a4), _add(a2, a3)
    outside, inside = _sub_turned(a1, a4), _sub_turned(a2, a3)
    near, far_ = _mix(a0, COS_1, outer, COS_2, inner), _mix(a0, COS_2, outer, COS_1, inner)
    near_side = _both(SIN_1, outside, SIN_2, inside)
    far_side = _both(SIN_2, outside, -SIN_1, inside)
    _put(there, to, _add(a0, _add(outer, inner)))
    _put(there, to + stride, _turned(_add(near, near_side), turns, turn))
    _put(there, to + 2 * stride, _turned(_add(far_, far_side), turns, 2 * turn))
    _put(there, to + 3 * stride, _turned(_sub(far_, far_side), turns, 3 * turn))
    _put(there, to + 4 * stride, _turned(_sub(near, near_side), turns, 4 * turn))


@inlined
@no_type_check
def _mix(a, x, b, y, c):
    """Return a + x b + y c for real x, y and complex pairs."""
    return (
        multiply_add(x, b[0], multiply_add(y, c[0], a[0])),
        multiply_add(x, b[1], multiply_add(y, c[1], a[1])),
    )


@inlined
@no_type_check
def _both(x, b, y, c):
    """Return x b + y c for real x, y and complex pairs."""
    return multiply_add(x, b[0], y * c[0]), multiply_add(x, b[1], y * c[1])


@no_type_check
def _make_pass(radix, step):
    """Compile one Stockham pass of a radix from `here` to `there`, `run(size, left, stride, turns, here, there)`.

    `left` is the length of the transforms that remain. `stride` is the distance between values at successive indices;
    its product with `left` is `size` times the lanes. `step` transforms one vector of sets, see `_step_8`.
    """

    @compiled
    @no_type_check
    def run(size, left, stride, turns, here, there):
        """Run the pass, in vectors; the last vector of a stride may overlap the one before."""
        part = left // radix
        for p in range(part):
            for first in range(0, stride, LANES):
                q = min(first, stride - LANES)
                to = radix * p * stride + q
                step(here, p * stride + q, part * stride, there, to, stride, turns, p * (size // left))

    return run


_pass_2, _pass_3, _pass_4 = _make_pass(2, _step_2), _make_pass(3, _step_3), _make_pass(4, _step_4)
_pass_5, _pass_8 = _make_pass(5, _step_5), _make_pass(8, _step_8)
