"""Moving sound as compiled for CPUs, against the same in operations of XLA."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from moving_sound import moving, some_late, some_reads
from numba import njit

from home_mjx.audio_jax import AudioConfig
from home_mjx.audio_jax.base.options import Ambisonics, Motion
from home_mjx.audio_jax.kernels.cpu.fft import fast_size, transform
from home_mjx.audio_jax.kernels.cpu.operands import float_pointer
from home_mjx.audio_jax.kernels.cpu.xla_calls import supports_late
from home_mjx.audio_jax.kernels.fft_plan import RADICES
from home_mjx.audio_jax.kernels.late_tail import render_late_by_xla
from home_mjx.audio_jax.moving_sources.dispatch import (
    KERNEL,
    render_early_frame,
    render_early_xla,
    render_late_frame,
)
from home_mjx.core.native.memory import address_of

pytestmark = pytest.mark.cpu


@njit
def run_transform(size, lanes, turns, values, spare):
    def pair(x):
        return float_pointer(x.ctypes.data), float_pointer(x.ctypes.data + 4 * x.size // 2)

    made = transform(size, lanes, pair(turns), pair(values), pair(spare))
    return address_of(made[0]) == spare.ctypes.data


@pytest.mark.parametrize(
    ("size", "lanes"), [(1, 16), (2, 17), (3, 16), (4, 31), (5, 20), (8, 16), (360, 20), (2560, 20)]
)
def test_transforms_are_those_of_numpy(rng, size, lanes):
    values = rng.normal(size=(2, size, lanes)).astype(np.float32)
    wanted = np.fft.fft(values[0] + 1j * values[1], axis=0)
    turn = np.exp(-2j * np.pi * np.arange(size) / size)
    spare = np.zeros_like(values)
    turns = np.stack([turn.real, turn.imag]).astype(np.float32)
    got = spare if run_transform(size, lanes, turns, values, spare) else values
    np.testing.assert_allclose(got[0] + 1j * got[1], wanted, rtol=0, atol=4e-6 * np.std(wanted))


def test_a_size_is_made_of_radices_and_is_no_smaller():
    for count in (1, 7, 11, 97, 1009, 2143, 6143, 20011):
        size = fast_size(count)
        assert count <= size < 1.4 * count + 2
        for radix in RADICES:
            while size % radix == 0:
                size //= radix
        assert size == 1


@pytest.mark.parametrize(
    ("rate", "receiver", "sources"),
    [(16000, "binaural", 3), (16000, "omni", 2), (16000, "array", 1), (48000, "binaural", 1),
     *(pytest.param(*case, marks=pytest.mark.slow)
       for case in [(16000, "binaural", 1), (16000, "ambisonics", 1), (8000, "binaural", 1)])],
)  # fmt: skip
def test_paths_are_heard_as_by_xla(rng, rate, receiver, sources):
    """More environments than one chunk has, near and far paths, some silent, and channels that make no pair."""
    config = moving(receiver, 0.0, rate)
    reads = jax.tree.map(lambda *x: jnp.stack(x), *(some_reads(rng, sources, config) for _ in range(3)))
    reads = jax.tree.map(lambda x: jnp.concatenate([x, x[::-1], x, x[:1]]), reads)
    wanted = jax.jit(jax.vmap(lambda x: render_early_xla(x, config)))(reads)
    got = jax.jit(jax.vmap(lambda x: render_early_frame(x, config)))(reads)
    assert KERNEL.is_usable("cpu")
    assert not np.array_equal(got, wanted)  # so it was the other code
    # Delays of thousands of samples are rounded to some 1e-4 of a sample, in other places than XLA does.
    most = 1e-3 * max(rate / 16000, 1) * np.std(wanted)
    np.testing.assert_allclose(got, wanted, rtol=0, atol=most)
    assert np.std(got - wanted) < 0.1 * most
    np.testing.assert_array_equal(got[:3], got[5:2:-1])  # whatever else is in the chunk


@pytest.mark.parametrize(
    ("rate", "receiver", "sources", "seconds"),
    [(16000, "binaural", 1, 1.5), (16000, "binaural", 2, 0.15), (16000, "binaural", 1, 0.0), (16000, "omni", 1, 0.4),
     (16000, "array", 2, 0.3), (8000, "binaural", 1, 0.4), (48000, "binaural", 1, 0.2)],
)  # fmt: skip
def test_late_sound_is_heard_as_by_xla(rng, rate, receiver, sources, seconds):
    """No echoes of the second part, odd and even numbers of them, more environments than a chunk, late onsets."""
    config = moving(receiver, seconds, rate)
    given = some_late(rng, 11, sources, config)
    assert supports_late(given[1], config)
    wanted = jax.jit(jax.vmap(lambda *x: render_late_by_xla(*x, config)))(*given)
    got = jax.jit(jax.vmap(lambda *x: render_late_frame(*x, config)))(*given)
    assert not np.array_equal(got, wanted)
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-5 * np.std(wanted))


def test_noises_with_something_in_common_are_made_by_xla(rng):
    config = AudioConfig(response_seconds=0.2, motion=Motion(tail_seconds=0.0), receiver=Ambisonics())
    signals, sound = jax.tree.map(lambda x: x[0], some_late(rng, 1, 1, config))
    assert not supports_late(sound, config)
    wanted = jax.jit(lambda *x: render_late_by_xla(*x, config))(signals, sound)
    np.testing.assert_array_equal(jax.jit(lambda *x: render_late_frame(*x, config))(signals, sound), wanted)


GARBAGE = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 1e9, -5], np.float32)


def spoilt(rng, x):
    x, bad = np.array(x), rng.random(x.shape) < 0.1
    x[bad] = rng.choice([-(2**31), 2**31 - 1, -70] if x.dtype == np.int32 else GARBAGE, bad.sum())
    return x


@pytest.mark.parametrize("make", [render_early_frame, render_late_frame])
def test_numbers_from_nowhere_stay_in_their_environment(rng, make):
    """Infinite delays, places far outside: none is read there, and no other environment hears of it."""
    config = AudioConfig(response_seconds=0.2, motion=Motion(tail_seconds=0.15))
    if make is render_early_frame:
        good = (some_reads(rng, 1, config),)
    else:
        good = jax.tree.map(lambda x: x[0], some_late(rng, 1, 1, config))
    program = jax.jit(jax.vmap(lambda *x: make(*x, config)))
    three = [jax.tree.map(lambda x: jnp.stack([x, x, x]), good)]
    for _ in range(5):
        three.append(jax.tree.map(lambda x: jnp.stack([spoilt(rng, x), x, x]), good))
    heard = [program(*x) for x in three]
    for other in heard[1:]:
        np.testing.assert_array_equal(other[1:], heard[0][1:])
    assert not np.isfinite(heard[1][0]).all()


def test_there_are_gradients(rng):
    """Those of XLA's operations."""
    config = AudioConfig(response_seconds=0.1, motion=Motion(tail_seconds=0.0))
    reads = some_reads(rng, 1, config)
    slopes = [
        jax.jit(jax.grad(lambda x, make=make: jnp.sum(make(reads.replace(source=x), config) ** 2)))(reads.source)
        for make in (render_early_frame, render_early_xla)
    ]
    np.testing.assert_allclose(*slopes, rtol=0, atol=1e-3 * np.std(slopes[1]))
