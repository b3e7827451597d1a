"""Late sound of a chunk of environments: noise responses and convolution, as `late_tail.render_late_by_xla`."""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np

from home_mjx.audio_jax.kernels.cpu.fft import transform
from home_mjx.audio_jax.kernels.cpu.operands import (
    complex_pair,
    complex_table,
    constant,
    float_pointer,
    table,
    word_pointer,
)
from home_mjx.core.native import ffi
from home_mjx.core.native.ffi import NUMBER, WORD, float_result, float_row, int_row, operand_dim
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, offset_pointer
from home_mjx.core.native.simd import LANES, broadcast, load, multiply_add, store

_, NOISE, HATS, OCTAVES, TURNS, SOURCE, AMPLITUDE, MIX, BEGUN, ONSET, TAIL = range(11)  # operands
_, FIRST, HALF, ECHOES, START, WIDTH, FRAME_BEGIN = range(7)  # constants
VECTORS_PER_STEP = 4  # vectors per step, for instruction-level parallelism
ENDS, PARTS = 2, 2  # start and end of the frame; parts of a response
ZERO, ONE, ONE_HALF = np.float32(0), np.float32(1), np.float32(0.5)
compiled = compile_inner()


class LateSizes(NamedTuple):
    """Sizes of the arrays of one environment."""

    sources: np.int64
    length: np.int64  # samples of a source
    channels: np.int64
    bins: np.int64
    bin: np.int64  # samples of a bin
    knots: np.int64  # amplitude knots per bin
    noises: np.int64
    bands: np.int64
    first: np.int64  # samples of a response's first part
    half: np.int64  # samples of its second half
    echoes: np.int64  # repetitions of the second half in the tail
    start: np.int64  # first source sample of the first part's window
    width: np.int64  # samples of a window
    begin: np.int64  # first sample of the frame in the transforms' output
    frame: np.int64
    points: np.int64  # size of transforms
    transforms_per_env: np.int64  # transforms per environment
    envs_per_batch: np.int64  # environments per batch of transforms


class LateScratch(NamedTuple):
    """Scratch memory of a thread."""

    responses: Any  # (envs_per_batch, ends, two channels, first and half)
    padded: Any  # (envs_per_batch, samples), zero-padded sources
    levels: Any  # (ends, echoes, points / 2 + 1)
    values: Any  # real and imaginary parts (points, envs_per_batch * transforms_per_env)
    spare: Any
    spectra: Any  # (points, LANES), lanes are environments and ends
    unused: Any
    streams: Any  # (envs_per_batch * transforms_per_env, two), addresses of signals for real and imaginary parts
    lengths: Any  # (envs_per_batch * transforms_per_env), lengths of these signals


@compiled
@no_type_check
def render_late_chunk(frame, first, end):
    """Render late sound of environments `first` to `end` (exclusive, at most `LANES / 2`); `frame`: XLA call frame."""
    size = _sizes(frame)
    room = _allocate(size)
    turns = complex_table(frame, TURNS, size.points)
    for left in range(0, size.channels, 2):
        for i in range(size.points * LANES):
            room.spectra[0][i], room.spectra[1][i] = ZERO, ZERO
        for begin in range(first, end, size.envs_per_batch):
            count = min(size.envs_per_batch, end - begin)
            for source in range(size.sources):
                for i in range(count):
                    _prepare(frame, begin + i, source, left, i, size, room)
                _interleave(count, size, room)
                lanes = size.envs_per_batch * size.transforms_per_env
                heard = transform(size.points, lanes, turns, room.values, room.spare)
                for i in range(count):
                    lane, to = i * size.transforms_per_env, 2 * (begin - first + i)
                    _add_spectra(frame, begin + i, source, lane, to, heard, size, room)
        made = transform(size.points, LANES, turns, room.spectra, room.unused)
        for env in range(first, end):
            _write(frame, env, left, 2 * (env - first), made, size)
    ffi.release(address_of(room.responses))


@compiled
@no_type_check
def _prepare(frame, env, source, left, place, size, room):
    """Prepare the transforms of a source in row `place` of a batch; write the addresses of their signals to `streams`.

    They are the responses of channels `left`, `left` + 1 (zeros if there is none), and the windows of the source that
    convolve with their parts.
    """
    number = env * size.sources + source
    most = size.first + size.half
    responses = offset_pointer(room.responses, place * ENDS * 2 * most)
    for end in range(ENDS):
        for side in range(2):
            to = offset_pointer(responses, (2 * end + side) * most)
            if left + side < size.channels:
                _make_response(frame, ENDS * number + end, left + side, to, size)
            else:
                _zero(to, most)
            for part in range(PARTS):
                stream = place * size.transforms_per_env + PARTS * end + part
                room.streams[2 * stream + side] = address_of(to) + NUMBER * size.first * part
                room.lengths[stream] = size.half if part else size.first
    ahead, whole = _padding(size)
    padded = offset_pointer(room.padded, place * whole)
    _zero(padded, whole)
    signal = offset_pointer(float_row(frame, SOURCE, env), source * size.length)
    for i in range(size.length):
        padded[ahead + i] = signal[i]
    for window in range(2 * (size.transforms_per_env - ENDS * PARTS)):
        stream = place * size.transforms_per_env + ENDS * PARTS + window // 2
        back = size.first + (window - 1) * size.half if window else 0
        there = window < 2 + size.echoes
        begin = ahead + size.start - back if there else size.length + ahead  # zeros
        room.streams[2 * stream + window % 2] = address_of(padded) + NUMBER * begin
        room.lengths[stream] = size.width


@compiled
@no_type_check
def _padding(size):
    """Return the number of zeros before a source, for windows that begin before it, and the padded length [samples]."""
    ahead = max(size.first + size.echoes * size.half - size.start, 0)
    return ahead, ahead + max(size.length, size.start + size.width) + size.width


@compiled
@no_type_check
def _zero(values, count):
    """Set the first `count` values to 0."""
    for i in range(count):
        values[i] = ZERO


@compiled
@no_type_check
def _make_response(frame, number, channel, response, size):
    """Write a channel's noise times amplitudes, 0 before onset; `number` runs over (environment, source, frame end).

    Bin b of the response has the periodic noise's bin `BEGUN` + b. Onsets are clamped to the response.
    """
    bands, noises = size.bands, size.noises
    own = channel if ffi.num_dims(frame, ffi.OPERANDS, NOISE) == 4 else 0
    length = size.bins * size.bin
    noise = offset_pointer(table(frame, NOISE), own * noises * bands * length)
    hats = table(frame, HATS)
    mix = offset_pointer(float_row(frame, MIX, 0), (number * size.channels + channel) * noises * bands)
    amplitudes = offset_pointer(
        float_row(frame, AMPLITUDE, 0), (number * size.bins * size.channels + channel) * size.knots * bands
    )
    begun = int_row(frame, BEGUN, 0)[number]
    onset = min(max(int_row(frame, ONSET, 0)[number], 0), length)
    for i in range(onset):
        response[i] = ZERO
    for b in range(onset // size.bin, size.bins):
        k = (b + begun) % size.bins
        amplitude = offset_pointer(amplitudes, b * size.channels * size.knots * bands)
        for first in range(0, size.bin, VECTORS_PER_STEP * LANES):
            here, to = offset_pointer(noise, k * size.bin), offset_pointer(response, b * size.bin)
            _make_piece(amplitude, mix, here, hats, first, size, to)
    for i in range(onset // size.bin * size.bin, onset):
        response[i] = ZERO


@compiled
@no_type_check
def _make_piece(amplitude, mix, noise, hats, first, size, response):
    """Write four vectors (`LANES` samples) of a bin's response, from sample `first` on; the last ones may overlap.

    Each octave's noises, weighted by `mix`, are multiplied by its `amplitude` at knots, interpolated by `hats`.
    """
    bands, length, last = size.bands, size.bins * size.bin, size.bin - LANES
    at = min(first, last), min(first + LANES, last), min(first + 2 * LANES, last), min(first + 3 * LANES, last)
    a = b = c = d = broadcast(ZERO)
    for band in range(bands):
        e = f = g = h = broadcast(ZERO)
        for number in range(size.noises):
            share, place = mix[number * bands + band], offset_pointer(noise, (number * bands + band) * length)
            e, f = multiply_add(share, load(place, at[0]), e), multiply_add(share, load(place, at[1]), f)
            g, h = multiply_add(share, load(place, at[2]), g), multiply_add(share, load(place, at[3]), h)
        i = j = k = m = broadcast(ZERO)
        for knot in range(size.knots):
            loud, hat = amplitude[knot * bands + band], offset_pointer(hats, knot * size.bin)
            i, j = multiply_add(loud, load(hat, at[0]), i), multiply_add(loud, load(hat, at[1]), j)
            k, m = multiply_add(loud, load(hat, at[2]), k), multiply_add(loud, load(hat, at[3]), m)
        a, b, c, d = multiply_add(e, i, a), multiply_add(f, j, b), multiply_add(g, k, c), multiply_add(h, m, d)
    store(response, at[0], a)
    store(response, at[1], b)
    store(response, at[2], c)
    store(response, at[3], d)


@compiled
@no_type_check
def _interleave(count, size, room):
    """Pack the signals of `count` environments into `room.values` (sample, transform); zeros beyond their ends."""
    lanes, used = size.envs_per_batch * size.transforms_per_env, count * size.transforms_per_env
    for i in range(size.points):
        to = i * lanes
        for stream in range(used):
            re, im = ZERO, ZERO
            if i < room.lengths[stream]:
                re = float_pointer(room.streams[2 * stream])[i]
                im = float_pointer(room.streams[2 * stream + 1])[i]
            room.values[0][to + stream], room.values[1][to + stream] = re, im
        for stream in range(used, lanes):
            room.values[0][to + stream], room.values[1][to + stream] = ZERO, ZERO


@compiled
@no_type_check
def _find_gains(frame, env, source, size, levels):
    """Write to `levels` (end, repetition, frequency) the gain of each tail repetition at both ends of the frame.

    It is the sum over octaves of the tail gain (operand `TAIL`) times the octave's gain at the frequency (`OCTAVES`).
    """
    half, octaves = size.points // 2 + 1, table(frame, OCTAVES)
    number = (env * size.sources + source) * ENDS * size.echoes * size.bands
    given = offset_pointer(float_row(frame, TAIL, 0), number)
    for echo in range(ENDS * size.echoes):
        for first in range(0, half, LANES):
            at = min(first, half - LANES)
            level = broadcast(ZERO)
            for band in range(size.bands):
                level = multiply_add(given[echo * size.bands + band], load(octaves, band * half + at), level)
            store(levels, echo * half + at, level)


@compiled
@no_type_check
def _add_spectra(frame, env, source, lane, to, heard, size, room):
    """Add a source's conjugate products of response and signal spectra, of two channels, to `room.spectra`.

    `heard` has their spectra from column `lane` on; columns `to` and `to + 1` are the frame's start and end. The first
    part meets its window; the second part meets its own plus those of repetitions, times `_find_gains`.
    """
    _find_gains(frame, env, source, size, room.levels)
    lanes, half, points = size.envs_per_batch * size.transforms_per_env, size.points // 2 + 1, size.points
    far = size.echoes * half
    for f in range(half):
        g = (points - f) % points
        here, there = f * lanes + lane, g * lanes + lane
        now, later_re, later_im = _split(heard, here + ENDS * PARTS, there + ENDS * PARTS)
        old_re, old_im, new_re, new_im = later_re, later_im, later_re, later_im
        for pair in range(1, size.transforms_per_env - ENDS * PARTS):
            even, odd_re, odd_im = _split(heard, here + ENDS * PARTS + pair, there + ENDS * PARTS + pair)
            echo = (2 * pair - 2) * half + f
            old, new = room.levels[echo], room.levels[far + echo]
            old_re, old_im = old_re + old * even[0], old_im + old * even[1]
            new_re, new_im = new_re + new * even[0], new_im + new * even[1]
            if 2 * pair - 1 < size.echoes:
                old, new = room.levels[echo + half], room.levels[far + echo + half]
                old_re, old_im = old_re + old * odd_re, old_im + old * odd_im
                new_re, new_im = new_re + new * odd_re, new_im + new * odd_im
        _add_products(heard, here, now, (old_re, old_im), (new_re, new_im), room.spectra, f * LANES + to)
        if g != f:
            past, before, after = (now[0], -now[1]), (old_re, -old_im), (new_re, -new_im)
            _add_products(heard, there, past, before, after, room.spectra, g * LANES + to)


@compiled
@no_type_check
def _split(heard, here, there):
    """Separate two real signals transformed as one, at `here` (f), `there` (-f): the first (re, im), second re, im."""
    a, b, c, d = heard[0][here], heard[1][here], heard[0][there], heard[1][there]
    even = ONE_HALF * (a + c), ONE_HALF * (b - d)
    return even, ONE_HALF * (b + d), ONE_HALF * (c - a)


@compiled
@no_type_check
def _add_products(heard, at, now, old, new, spectra, to):
    """Add conjugate products at one frequency for both frame ends: first part by `now`, second by `old` or `new`."""
    for end in range(ENDS):
        later = new if end else old
        a, b = heard[0][at + PARTS * end], heard[1][at + PARTS * end]
        c, d = heard[0][at + PARTS * end + 1], heard[1][at + PARTS * end + 1]
        spectra[0][to + end] += now[0] * a - now[1] * b + later[0] * c - later[1] * d
        spectra[1][to + end] -= now[0] * b + now[1] * a + later[0] * d + later[1] * c


@compiled
@no_type_check
def _write(frame, env, left, lane, made, size):
    """Write result channels `left`, `left` + 1 (if any): crossfades, linear, of column `lane` of `made` to the next."""
    out, scale = float_result(frame, 0, env), ONE / np.float32(size.points)
    for k in range(size.frame):
        fade = np.float32(k + 1) / np.float32(size.frame)
        at = (size.begin + k) * LANES + lane
        old, new = made[0][at], made[0][at + 1]
        out[left * size.frame + k] = scale * (old + fade * (new - old))
        if left + 1 < size.channels:
            old, new = made[1][at], made[1][at + 1]
            out[(left + 1) * size.frame + k] = -scale * (old + fade * (new - old))


@compiled
@no_type_check
def _sizes(frame):
    """Read the sizes from shapes and constants of XLA's call frame."""
    each = ENDS * PARTS + 1 + (constant(frame, ECHOES) + 1) // 2
    return LateSizes(
        operand_dim(frame, SOURCE, 1),
        operand_dim(frame, SOURCE, 2),
        operand_dim(frame, AMPLITUDE, 4),
        operand_dim(frame, AMPLITUDE, 3),
        operand_dim(frame, HATS, 1),
        operand_dim(frame, HATS, 0),
        operand_dim(frame, MIX, 4),
        operand_dim(frame, MIX, 5),
        constant(frame, FIRST),
        constant(frame, HALF),
        constant(frame, ECHOES),
        constant(frame, START),
        constant(frame, WIDTH),
        constant(frame, FRAME_BEGIN),
        ffi.dim(frame, ffi.RESULTS, 0, 2),
        operand_dim(frame, TURNS, 1),
        each,
        -(-LANES // each),
    )


@compiled
@no_type_check
def _allocate(size):
    """Allocate all scratch as one block of memory, released by the address of `responses`."""
    lanes = size.envs_per_batch * size.transforms_per_env
    responses = size.envs_per_batch * ENDS * 2 * (size.first + size.half) + 2 * LANES
    padded = size.envs_per_batch * _padding(size)[1]
    levels = ENDS * size.echoes * (size.points // 2 + 1)
    whole, kept = size.points * lanes, size.points * LANES
    at = ffi.allocate(NUMBER * (responses + padded + levels + 4 * whole + 4 * kept) + WORD * 3 * (lanes + 1))
    pads = at + NUMBER * responses
    loud = pads + NUMBER * padded
    values = loud + NUMBER * levels
    spectra = values + 4 * NUMBER * whole
    words = (spectra + 4 * NUMBER * kept + WORD - 1) // WORD * WORD
    return LateScratch(
        float_pointer(at),
        float_pointer(pads),
        float_pointer(loud),
        complex_pair(values, whole),
        complex_pair(values + 2 * NUMBER * whole, whole),
        complex_pair(spectra, kept),
        complex_pair(spectra + 2 * NUMBER * kept, kept),
        word_pointer(words),
        word_pointer(words + 2 * WORD * lanes),
    )
