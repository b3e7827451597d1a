"""Delay-line reads of a frame's paths, mixed with gains per path, as `delay_reads.mix_paths`.

Delays hardly change from sample to sample, so neighbouring samples are mostly read at neighbouring places, in vectors.
Signals have twice their rate, with even and odd half samples in separate arrays.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import NamedTuple, no_type_check

import numpy as np

from home_mjx.audio_jax.base.delays import FIRST_READ, HALF_WIDTH, NUM_READ, interpolation_polynomials, windowed_sinc
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import offset_pointer
from home_mjx.core.native.simd import LANES, broadcast, load, multiply_add, store

BLOCK_SAMPLES = 512  # samples per block
PATH_VALUES = 3  # values of a path before those of its ears: lengths at both ends, bend
ZERO, ONE, TWO, FOUR = (np.float32(x) for x in (0.0, 1.0, 2.0, 4.0))
MIN_DIVISOR = np.float32(1e-6)  # [m], minimum divisor
TAPS = tuple(np.float32(x) for x in windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5))
READ_POLYNOMIALS = tuple(tuple(np.float32(x) for x in row) for row in interpolation_polynomials())  # lowest power first
compiled = compile_inner()
inlined = compile_inner(forceinline=True)


class EarlySizes(NamedTuple):
    """Sizes of the arrays of one environment."""

    sources: np.int64
    length: np.int64  # samples of a source
    filtered: np.int64  # samples of the first path's filtered signal
    rows: np.int64  # paths to a head
    ears: np.int64  # ears with their own delays; 1: all channels share them
    channels: np.int64
    shapes: np.int64  # buses per channel, at least `LANES`
    count: np.int64  # samples of a bus
    frame: np.int64
    before: np.int64  # samples of a bus before the frame


@compiled
@no_type_check
def upsample(signal, count, padded, on, between):
    """Write `count` samples of `signal` to `on`, those half a sample later to `between`, as `upsample_twice`.

    `count` is at least `LANES`. `padded` is scratch of `count` + 2 `HALF_WIDTH` + `LANES` values.
    """
    for i in range(HALF_WIDTH):
        padded[i] = ZERO
    for i in range(count):
        on[i] = signal[i]
        padded[HALF_WIDTH + i] = signal[i]
    for i in range(HALF_WIDTH + count, 2 * HALF_WIDTH + count + LANES):
        padded[i] = ZERO
    for first in range(0, count, LANES):
        i = max(min(first, count - LANES), 0)  # a signal has more samples than a vector
        value = broadcast(ZERO)
        for t in range(2 * HALF_WIDTH):
            value = multiply_add(TAPS[t], load(padded, i + t + 1), value)
        store(between, i, value)


@compiled
@no_type_check
def read_block(way, ear, rate, places, signal, begin, count, size, base, rest, heard):
    """Overwrite `heard` with a path's signal, delayed for one ear: `count` samples from index `begin` of the buses on.

    `way`: row of `pack_paths`; `rate`: samples per metre; `places`: half sample at zero delay, and lowest and highest
    half sample that a read may begin with; `signal`: results of `upsample`; `base` and `rest`: scratch.
    """
    _delays(way, ear, rate, places, begin, count, size, base, rest)
    k = 0
    while k < count:
        stop, here = k + 1, base[k]
        while stop < count and base[stop] == here:
            stop += 1
        place = here + 2 * (begin + k)
        _read_run(signal, place, offset_pointer(rest, k), stop - k, offset_pointer(heard, k))
        k = stop


@compiled
@no_type_check
def _delays(way, ear, rate, places, begin, count, size, base, rest):
    """Write to `base`, per bus sample, the first half sample read minus twice the bus index; to `rest` the fraction.

    Other arguments are those of `read_block`. Reads are clamped to begin within `places`.
    """
    old, change, bend = way[0], way[1] - way[0], way[2]
    first, middle, last = (
        way[PATH_VALUES + ear],
        way[PATH_VALUES + size.ears + ear],
        way[PATH_VALUES + 2 * size.ears + ear],
    )
    curved, turned = FOUR * (middle - (first + last) / TWO), last - first
    start, lowest, highest = places
    for k in range(count):
        number = begin + k
        time = np.float32(number - size.before) / np.float32(size.frame)
        curve = time * (ONE - time)
        line, across = old + time * change, curve * bend
        root = np.sqrt(max(line * line - across, ZERO))
        samples = (line - across / max(line + root, MIN_DIVISOR)) * rate
        whole = np.floor(samples)
        back = -TWO * (samples - whole + first + time * turned + curve * curved)
        low = np.floor(back)
        place = start + np.int32(low) + FIRST_READ + 2 * (number - np.int32(whole))
        base[k] = np.int32(min(max(place, lowest), highest) - 2 * number)
        rest[k] = back - low


@compiled
@no_type_check
def _read_run(signal, place, rest, count, heard):
    """Interpolate `count` samples into `heard`: sample k from the `NUM_READ` half samples from `place` + 2 k on.

    `signal`: results of `upsample`; `rest`: fraction between the fourth and the fifth of them, per sample.
    """
    on, between = signal
    odd, i = place & 1, place >> 1
    if odd:
        even, uneven = offset_pointer(between, i), offset_pointer(on, i + 1)
    else:
        even, uneven = offset_pointer(on, i), offset_pointer(between, i)
    if count >= LANES:
        for first in range(0, count, LANES):
            k = min(first, count - LANES)
            store(heard, k, _read(even, uneven, k, load(rest, k)))
    else:
        for k in range(count):
            heard[k] = _read_one(even, uneven, k, rest[k])


@inlined
@no_type_check
def _read(even, uneven, k, rest):
    """Interpolate `LANES` samples at index `k` between half samples, `even` and `uneven` ones; `rest`: fractions."""
    value = _weight(0, rest) * load(even, k)
    value = multiply_add(_weight(1, rest), load(uneven, k), value)
    value = multiply_add(_weight(2, rest), load(even, k + 1), value)
    value = multiply_add(_weight(3, rest), load(uneven, k + 1), value)
    value = multiply_add(_weight(4, rest), load(even, k + 2), value)
    value = multiply_add(_weight(5, rest), load(uneven, k + 2), value)
    value = multiply_add(_weight(6, rest), load(even, k + 3), value)
    return multiply_add(_weight(7, rest), load(uneven, k + 3), value)


@inlined
@no_type_check
def _weight(i, rest):
    """Evaluate the interpolation weight of half sample `i` at `LANES` fractions `rest`, by `READ_POLYNOMIALS`."""
    a, b, c, d, e, f = READ_POLYNOMIALS[i]
    value = multiply_add(rest, broadcast(f), broadcast(e))
    value = multiply_add(rest, value, broadcast(d))
    value = multiply_add(rest, value, broadcast(c))
    value = multiply_add(rest, value, broadcast(b))
    return multiply_add(rest, value, broadcast(a))


@compiled
@no_type_check
def _read_one(even, uneven, k, rest):
    """Interpolate one value from the 8 half samples even[k], uneven[k], .. uneven[k + 3], as `_read` does.

    `rest`: fraction 0..1 between the fourth and the fifth of them.
    """
    value = ZERO
    for i in range(NUM_READ):
        weight = ZERO
        for j in range(len(READ_POLYNOMIALS[0])):
            weight = weight * rest + READ_POLYNOMIALS[i][len(READ_POLYNOMIALS[0]) - 1 - j]
        value += weight * (uneven[k + i // 2] if i & 1 else even[k + i // 2])
    return value


@compiled
@no_type_check
def mix_block(heard, share, which, far, begin, count, size, sums):
    """Overwrite rows `begin` .. of the buses `sums` (sample, bus) with `count` mixed samples.

    `heard`: signals of paths, at a stride of `BLOCK_SAMPLES`; `share`: gains of paths into each bus at the frame's
    start, and their linear change until its end, at a stride of `far`; `which`: number of audible paths, then their
    indices. Samples before the frame have the gains of its start.
    """
    shapes = size.shapes
    for k in range(count):
        time = np.float32(begin + k - size.before) / np.float32(size.frame)
        fade = min(max(time, ZERO), ONE)
        to = (begin + k) * shapes
        for first in range(0, shapes, LANES):
            lane = min(first, shapes - LANES)
            at_first, coming = broadcast(ZERO), broadcast(ZERO)
            for i in range(which[0]):
                way = which[1 + i]
                value, weights = heard[way * BLOCK_SAMPLES + k], way * far + lane
                at_first = multiply_add(value, load(share, weights), at_first)
                coming = multiply_add(value, load(share, weights + shapes), coming)
            store(sums, to + lane, multiply_add(fade, coming, at_first))
