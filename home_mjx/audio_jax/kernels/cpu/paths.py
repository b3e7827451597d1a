"""Paths of a frame, read at their delays and added up with weights of their own: what `reads.sums_of` does.

Delays hardly change from sample to sample, so that neighbours are mostly read at neighbouring places: in vectors.
Signals are at twice their rate, samples and what lies between them in arrays of their own.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import NamedTuple, no_type_check

import numpy as np
from numba import njit

from home_mjx.audio_jax.base.delays import FIRST, HALF_WIDTH, READ, read_polynomials, windowed_sinc
from home_mjx.core.native.memory import shifted
from home_mjx.core.native.simd import LANES, load, multiply_add, spread, store

BLOCK = 512  # samples at a time
WAY = 3  # numbers of a path before those of its ears: length at both ends, bend
ZERO, ONE, TWO, FOUR = (np.float32(x) for x in (0.0, 1.0, 2.0, 4.0))
LEAST = np.float32(1e-6)
TAPS = tuple(np.float32(x) for x in windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5))
TABLE = tuple(tuple(np.float32(x) for x in row) for row in read_polynomials())  # lowest power first
compiled = njit(error_model="numpy")
inlined = njit(error_model="numpy", forceinline=True)


class Sizes(NamedTuple):
    """Of the arrays of one environment."""

    sources: np.int64
    length: np.int64  # samples of a source
    filtered: np.int64  # and of what one of the first path's filters makes of it
    rows: np.int64  # ways to a head
    ears: np.int64  # that have delays of their own; 1: all channels share them
    channels: np.int64
    shapes: np.int64  # sums of each channel, as many as a vector has lanes at least
    count: np.int64  # samples of a sum
    frame: np.int64
    before: np.int64  # samples of a sum before the frame


@compiled
@no_type_check
def double(signal, count, padded, on, between):
    """A signal's samples, and those between each two of them; silence before and after it."""
    for i in range(HALF_WIDTH):
        padded[i] = ZERO
    for i in range(count):
        on[i] = signal[i]
        padded[HALF_WIDTH + i] = signal[i]
    for i in range(HALF_WIDTH + count, 2 * HALF_WIDTH + count + LANES):
        padded[i] = ZERO
    for first in range(0, count, LANES):
        i = max(min(first, count - LANES), 0)  # a signal has more samples than a vector
        value = spread(ZERO)
        for t in range(2 * HALF_WIDTH):
            value = multiply_add(TAPS[t], load(padded, i + t + 1), value)
        store(between, i, value)


@compiled
@no_type_check
def hear_block(way, ear, rate, places, signal, begin, count, size, base, rest, heard):
    """What a way brings to one ear, `count` samples from number `begin` of the sums on.

    `places`: half sample that is heard without delay, and those that may be read first; `signal`: its samples and those
    between them.
    """
    _delays(way, ear, rate, places, begin, count, size, base, rest)
    k = 0
    while k < count:
        stop, here = k + 1, base[k]
        while stop < count and base[stop] == here:
            stop += 1
        place = here + 2 * (begin + k)
        _read_run(signal, place, shifted(rest, k), stop - k, shifted(heard, k))
        k = stop


@compiled
@no_type_check
def _delays(way, ear, rate, places, begin, count, size, base, rest):
    """First half sample that is read for each sample, less twice its number, and how much later the value lies."""
    old, change, bend = way[0], way[1] - way[0], way[2]
    first, middle, last = way[WAY + ear], way[WAY + size.ears + ear], way[WAY + 2 * size.ears + ear]
    curved, turned = FOUR * (middle - (first + last) / TWO), last - first
    start, lowest, highest = places
    for k in range(count):
        number = begin + k
        time = np.float32(number - size.before) / np.float32(size.frame)
        curve = time * (ONE - time)
        line, across = old + time * change, curve * bend
        root = np.sqrt(max(line * line - across, ZERO))
        samples = (line - across / max(line + root, LEAST)) * rate
        whole = np.floor(samples)
        back = -TWO * (samples - whole + first + time * turned + curve * curved)
        low = np.floor(back)
        place = start + np.int32(low) + FIRST + 2 * (number - np.int32(whole))
        base[k] = np.int32(min(max(place, lowest), highest) - 2 * number)
        rest[k] = back - low


@compiled
@no_type_check
def _read_run(signal, place, rest, count, heard):
    """Samples that are read at places two half samples apart each."""
    on, between = signal
    odd, i = place & 1, place >> 1
    if odd:
        even, uneven = shifted(between, i), shifted(on, i + 1)
    else:
        even, uneven = shifted(on, i), shifted(between, i)
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
    a, b, c, d, e, f = TABLE[i]
    value = multiply_add(rest, spread(f), spread(e))
    value = multiply_add(rest, value, spread(d))
    value = multiply_add(rest, value, spread(c))
    value = multiply_add(rest, value, spread(b))
    return multiply_add(rest, value, spread(a))


@compiled
@no_type_check
def _read_one(even, uneven, k, rest):
    value = ZERO
    for i in range(READ):
        weight = ZERO
        for j in range(len(TABLE[0])):
            weight = weight * rest + TABLE[i][len(TABLE[0]) - 1 - j]
        value += weight * (uneven[k + i // 2] if i & 1 else even[k + i // 2])
    return value


@compiled
@no_type_check
def add_block(heard, share, which, far, begin, count, size, sums):
    """Ways with weights that run from those at the frame's start to those at its end, `count` samples of their sums.

    `heard`: of each way, `BLOCK` values apart; `share`: of each way, `far` apart, what it has at the start in each of
    the sums, and what comes until the end; `which`: numbers of ways that sound, after how many they are.
    """
    shapes = size.shapes
    for k in range(count):
        time = np.float32(begin + k - size.before) / np.float32(size.frame)
        fade = min(max(time, ZERO), ONE)
        to = (begin + k) * shapes
        for first in range(0, shapes, LANES):
            lane = min(first, shapes - LANES)
            at_first, coming = spread(ZERO), spread(ZERO)
            for i in range(which[0]):
                way = which[1 + i]
                value, weights = heard[way * BLOCK + k], way * far + lane
                at_first = multiply_add(value, load(share, weights), at_first)
                coming = multiply_add(value, load(share, weights + shapes), coming)
            store(sums, to + lane, multiply_add(fade, coming, at_first))
