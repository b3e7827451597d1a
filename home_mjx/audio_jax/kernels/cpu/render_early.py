"""Early sound of a chunk of environments: paths mixed into buses and filtered, as `render_early_xla`."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

from home_mjx.audio_jax.base.delays import HALF_WIDTH, NUM_READ
from home_mjx.audio_jax.kernels.cpu.fft import transform
from home_mjx.audio_jax.kernels.cpu.operands import (
    complex_pair,
    complex_table,
    constant,
    float_pointer,
    int_pointer,
    table,
)
from home_mjx.audio_jax.kernels.cpu.path_mixing import (
    BLOCK_SAMPLES,
    PATH_VALUES,
    ZERO,
    EarlySizes,
    mix_block,
    read_block,
    upsample,
)
from home_mjx.audio_jax.kernels.delay_reads import NUM_FILTERED
from home_mjx.core.native import ffi
from home_mjx.core.native.ffi import NUMBER, float_result, float_row, int_row, operand_dim
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, offset_pointer
from home_mjx.core.native.simd import LANES, broadcast, load, multiply_add, sum_lanes

_, SPECTRA, TURNS, RATE, SOURCE, FILTERS, START, WAYS, SHARE = range(9)  # operands
_, FRAME_BEGIN, BEFORE, COUNT = range(4)  # constants
compiled = compile_inner()


class EarlyScratch(NamedTuple):
    """Scratch memory of a thread."""

    even: Any  # (sources, samples of all signals)
    odd: Any
    padded: Any  # (samples of a signal)
    rest: Any  # (BLOCK)
    heard: Any  # (ways, BLOCK)
    values: Any  # real and imaginary parts (points, shapes)
    spare: Any
    spectra: Any  # of one pair of channels per environment (points, LANES)
    unused: Any
    base: Any  # (BLOCK)
    which: Any  # (1 + ways)


@compiled
@no_type_check
def render_early_chunk(frame, first, end):
    """Render early sound of environments `first` to `end` (exclusive, at most `LANES`); `frame`: XLA's call frame."""
    size, points = _sizes(frame), operand_dim(frame, TURNS, 1)
    room = _allocate(size, points)
    turns = complex_table(frame, TURNS, points)
    for left in range(0, size.channels, 2):
        for i in range(points * LANES):
            room.spectra[0][i], room.spectra[1][i] = ZERO, ZERO
        for env in range(first, end):
            _upsample_all(frame, env, size, room)
            for side in range(2):
                _mix_channel(frame, env, left + side, size, points, room, room.values[side])
            _filter(frame, points, size, turns, env - first, room)
        made = transform(points, LANES, turns, room.spectra, room.unused)
        for env in range(first, end):
            _write(frame, env, left, env - first, size, made)
    ffi.release(address_of(room.even))


@compiled
@no_type_check
def _upsample_all(frame, env, size, room):
    """Upsample signals by two into `room.even` and `room.odd`; per source, the filtered ones precede the unfiltered."""
    sources, filtered = float_row(frame, SOURCE, env), float_row(frame, FILTERS, env)
    each = NUM_FILTERED * size.filtered + size.length
    for source in range(size.sources):
        for part in range(NUM_FILTERED + 1):
            at = source * each + part * size.filtered
            if part < NUM_FILTERED:
                signal, count = offset_pointer(filtered, (source * NUM_FILTERED + part) * size.filtered), size.filtered
            else:
                signal, count = offset_pointer(sources, source * size.length), size.length
            upsample(signal, count, room.padded, offset_pointer(room.even, at), offset_pointer(room.odd, at))


@compiled
@no_type_check
def _mix_channel(frame, env, channel, size, points, room, sums):
    """Write a channel's mixed buses to `sums` (points, buses), zero-padded; zeros if there is no such channel."""
    begun = 0
    if channel < size.channels:
        share, far = float_row(frame, SHARE, env), 2 * size.channels * size.shapes
        share = offset_pointer(share, 2 * channel * size.shapes)
        _find_audible(share, far, size, room.which)
        for begin in range(0, size.count, BLOCK_SAMPLES):
            count = min(BLOCK_SAMPLES, size.count - begin)
            _read_all(frame, env, min(channel, size.ears - 1), begin, count, size, room)
            mix_block(room.heard, share, room.which, far, begin, count, size, sums)
        begun = size.count * size.shapes
    for i in range(begun, points * size.shapes):
        sums[i] = ZERO


@compiled
@no_type_check
def _find_audible(share, far, size, which):
    """Write to `which` the number of paths that one channel hears, then their indices.

    A path is heard if any of its 2 `size.shapes` gains is nonzero. `share` points to the channel's gains of
    path 0; those of the next path are `far` values on.
    """
    which[0] = 0
    for way in range(size.sources * size.rows):
        for i in range(way * far, way * far + 2 * size.shapes):
            if share[i] != ZERO:
                which[0] += 1
                which[which[0]] = way
                break


@compiled
@no_type_check
def _read_all(frame, env, ear, begin, count, size, room):
    """Read `count` bus samples from `begin` on of paths `room.which`, for one ear, to their rows of `room.heard`."""
    ways, starts, rate = float_row(frame, WAYS, env), int_row(frame, START, env), table(frame, RATE)[0]
    each = NUM_FILTERED * size.filtered + size.length
    for i in range(room.which[0]):
        number = room.which[1 + i]
        source, part = number // size.rows, min(number % size.rows, NUM_FILTERED)
        lowest = 2 * part * size.filtered
        highest = lowest + 2 * (size.filtered if part < NUM_FILTERED else size.length) - NUM_READ
        signal = offset_pointer(room.even, source * each), offset_pointer(room.odd, source * each)
        way, start = (
            offset_pointer(ways, number * (PATH_VALUES + 3 * size.ears)),
            starts[source * (NUM_FILTERED + 1) + part],
        )
        places = start, lowest, highest
        heard = offset_pointer(room.heard, number * BLOCK_SAMPLES)
        read_block(way, ear, rate, places, signal, begin, count, size, room.base, room.rest, heard)


@compiled
@no_type_check
def _filter(frame, points, size, turns, lane, room):
    """Filter and add up the buses of two channels, the real and imaginary parts of `room.values`.

    The conjugate spectrum of the sum overwrites column `lane` of `room.spectra`.
    """
    filters = complex_table(frame, SPECTRA, points * size.shapes)
    re, im = transform(points, size.shapes, turns, room.values, room.spare)
    whole = size.shapes // LANES * LANES
    for k in range(points):
        first, real, imaginary = k * size.shapes, broadcast(ZERO), broadcast(ZERO)
        for at in range(first, first + whole, LANES):
            a, b, c, d = load(re, at), load(im, at), load(filters[0], at), load(filters[1], at)
            real = multiply_add(a, c, real) - b * d
            imaginary = multiply_add(a, d, multiply_add(b, c, imaginary))
        sum_re, sum_im = sum_lanes(real), sum_lanes(imaginary)
        for at in range(first + whole, first + size.shapes):
            sum_re += re[at] * filters[0][at] - im[at] * filters[1][at]
            sum_im += re[at] * filters[1][at] + im[at] * filters[0][at]
        room.spectra[0][k * LANES + lane], room.spectra[1][k * LANES + lane] = sum_re, -sum_im


@compiled
@no_type_check
def _write(frame, env, left, lane, size, made):
    """Write result channels `left`, `left` + 1 (if any): real, negated imaginary parts of column `lane` of `made`."""
    out, begin = float_result(frame, 0, env), constant(frame, FRAME_BEGIN)
    for k in range(size.frame):
        out[left * size.frame + k] = made[0][(begin + k) * LANES + lane]
    if left + 1 < size.channels:
        for k in range(size.frame):
            out[(left + 1) * size.frame + k] = -made[1][(begin + k) * LANES + lane]


@compiled
@no_type_check
def _sizes(frame):
    """Read the sizes from shapes and constants of XLA's call frame."""
    return EarlySizes(
        operand_dim(frame, SOURCE, 1),
        operand_dim(frame, SOURCE, 2),
        operand_dim(frame, FILTERS, 3),
        operand_dim(frame, WAYS, 2),
        (operand_dim(frame, WAYS, 3) - PATH_VALUES) // 3,
        operand_dim(frame, SHARE, 3),
        operand_dim(frame, SHARE, 5),
        constant(frame, COUNT),
        ffi.dim(frame, ffi.RESULTS, 0, 2),
        constant(frame, BEFORE),
    )


@compiled
@no_type_check
def _allocate(size, points):
    """Allocate all scratch as one block of memory, released by the address of `even`."""
    signals, ways = size.sources * (NUM_FILTERED * size.filtered + size.length), size.sources * size.rows
    longest, whole, lanes = max(size.filtered, size.length), points * size.shapes, points * LANES
    counts = (signals, signals, longest + 2 * HALF_WIDTH + LANES, BLOCK_SAMPLES, ways * BLOCK_SAMPLES)
    at = ffi.allocate(NUMBER * (sum(counts) + 4 * whole + 4 * lanes + BLOCK_SAMPLES + 1 + ways))
    ends = at + NUMBER * sum(counts)
    between = at + NUMBER * signals
    padded = between + NUMBER * signals
    rest = padded + NUMBER * counts[2]
    ints = ends + NUMBER * 4 * (whole + lanes)
    return EarlyScratch(
        float_pointer(at),
        float_pointer(between),
        float_pointer(padded),
        float_pointer(rest),
        float_pointer(rest + NUMBER * BLOCK_SAMPLES),
        complex_pair(ends, whole),
        complex_pair(ends + 2 * NUMBER * whole, whole),
        complex_pair(ends + 4 * NUMBER * whole, lanes),
        complex_pair(ends + 4 * NUMBER * whole + 2 * NUMBER * lanes, lanes),
        int_pointer(ints),
        int_pointer(ints + NUMBER * BLOCK_SAMPLES),
    )
