"""The kernels of moving sound without a GPU: compiled as C++ for the CPU they do what XLA's operations do."""

import dataclasses
import functools
import re

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from compiled_kernels import block_program, blocks_instead, nvrtc_ptx, shared_library
from moving_sound import moving, some_late, some_reads
from sanitized import Program

from home_mjx.audio_jax import AudioConfig
from home_mjx.audio_jax.base import delays
from home_mjx.audio_jax.base.filter_basis import filter_basis, octave_levels, octave_spectra
from home_mjx.audio_jax.base.options import Motion
from home_mjx.audio_jax.kernels import direct_filter, late_tail
from home_mjx.audio_jax.kernels.cuda import launch_direct_filter as cuda_first
from home_mjx.audio_jax.kernels.cuda import launch_early as sums
from home_mjx.audio_jax.kernels.cuda import launch_late, ptx
from home_mjx.audio_jax.kernels.delay_reads import frame_begin, mix_paths
from home_mjx.core.native.platforms import local_devices

KERNELS = {
    "filter_direct": (
        ptx.DIRECT_SOURCES,
        "(float*)p[0], (int*)p[1], (float*)p[2], (float*)p[3], (float2*)p[4], (float2*)p[5], (int*)p[6], (float*)p[7]",
    ),
    "mix_paths": (
        ptx.MIX_SOURCES,
        "(float*)p[0], (float*)p[1], (int*)p[2], (float*)p[3], (float2*)p[4], (float*)p[5], (float*)p[6], (int*)p[7], "
        "(float*)p[8]",
    ),
    "filter_buses": (
        ptx.FILTER_SOURCES,
        "(float*)p[0], (float2*)p[1], (float2*)p[2], (int*)p[3], (float*)p[4]",
    ),
    "shape_noise": (
        ptx.NOISE_SOURCES,
        "(float*)p[0], (float*)p[1], (float*)p[2], (float*)p[3], (int*)p[4], (int*)p[5], (float*)p[6]",
    ),
    "late_frames": (
        ptx.LATE_SOURCES,
        "(float*)p[0], (float*)p[1], (int*)p[2], (int*)p[3], (float*)p[4], (float*)p[5], (float2*)p[6], (int*)p[7], "
        "(float*)p[8]",
    ),
}


def program_text(name, size):
    """C++ of a kernel for transforms of that size, or so many noises."""
    sources, arguments = KERNELS[name]
    return block_program(sources, {"SIZE": size}, name, arguments)


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """Makes a kernel a function that runs one block of it, for transforms of a size."""
    return functools.cache(lambda name, size: shared_library(tmp_path_factory.mktemp(name), program_text(name, size)))


def compiled_for(name, given, threads):
    """What a kernel's SIZE is: how many noises there are, or values of a transform."""
    return given[0].shape[1] if name == "shape_noise" else threads * ptx.PER_THREAD


@pytest.fixture
def here(library, monkeypatch):
    """Calls of XLA run those functions instead."""
    if local_devices("cuda"):
        pytest.skip("a GPU runs them itself")
    monkeypatch.setattr(ptx, "ptx_of", lambda sources, size: "")
    monkeypatch.setattr(
        jax.ffi,
        "ffi_call",
        blocks_instead(lambda name, given, threads: library(name, compiled_for(name, given, threads))),
    )


@pytest.mark.parametrize("receiver", ["binaural", "omni", "ambisonics"])
@pytest.mark.parametrize("sources", [1, 3])
def test_paths_are_read_and_added_as_by_xla(here, rng, receiver, sources):
    """Of near and far ones, beyond the end of a response too, of several sources and two environments."""
    config = moving(receiver, 0.0)
    envs = [some_reads(rng, sources, config) for _ in range(2)]
    wanted = jnp.stack([jax.jit(lambda x: mix_paths(x, config))(reads) for reads in envs])
    given = [jnp.stack(x) for x in zip(*(sums.read_operands(reads) for reads in envs), strict=True)]
    shape, ears = envs[0].gain.shape[3], envs[0].paths.ear_delays.shape[-1]
    (got,) = sums.launch_mix(config, shape, ears, *given)
    assert got.shape == wanted.shape
    # Delays of thousands of samples are rounded to some 1e-4 of a sample, in other places than XLA does.
    np.testing.assert_allclose(got, wanted, rtol=0, atol=1e-3 * np.std(wanted))
    assert np.std(got - wanted) < 1e-4 * np.std(wanted)


def test_the_first_path_is_filtered_as_by_convolution(here, rng):
    """Before a source begins, within it and after its end; one end or both without a sound. So it is by XLA."""
    config = AudioConfig(response_seconds=0.2, motion=Motion(tail_seconds=0.0))
    source = jnp.float32(rng.normal(size=(5, 6000)))
    gain = jnp.float32(10 ** rng.uniform(-1.5, 0, (5, 2, 7))).at[1, 0].set(0.0).at[2].set(0.0)
    begin = jnp.int32([-direct_filter.delay_margin(config), 300, 1000, 5000, 6000])
    levels = jax.vmap(octave_levels)(gain)
    (got,) = cuda_first.launch_direct(config, *cuda_first.first_tables(config), source, begin, *levels)
    by_xla = jax.vmap(lambda *one: direct_filter.filter_direct_by_xla(*one, config))(source, begin, gain)
    size, ahead, (*_, made) = 1 << 15, 1 << 14, got.shape
    filters = np.fft.irfft(octave_spectra(gain.reshape(10, 7), size, config.sample_rate), size).reshape(5, 2, size)
    wanted = np.zeros(got.shape)
    for i, signal in enumerate(np.pad(source, [(0, 0), (ahead, ahead)])):
        part = signal[ahead + begin[i] - direct_filter.num_filter_samples(config) :][
            : direct_filter.num_filter_samples(config) + made
        ]
        for end in range(2):
            wanted[i, end] = np.convolve(part, filters[i, end])[direct_filter.num_filter_samples(config) :][:made]
    for each, most in ((got, 1e-5), (by_xla, 1e-3)):  # filters ring out within what XLA transforms, but for that much
        np.testing.assert_allclose(each, wanted, rtol=0, atol=most * np.std(wanted))
    assert not np.any(got[2])


def check_late_sound(rng, sources, config):
    """Against XLA's."""
    signals, sound = some_late(rng, 2, sources, config)
    wanted = jax.vmap(lambda *one: late_tail.render_late_by_xla(*one, config))(signals, sound)
    share = sound.shares
    given = signals, share.power, share.mix, share.shared_power, share.start_bin, sound.onset, sound.tail
    (got,) = launch_late.launch_late_frames(config, *launch_late.late_tables(config), *given)
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-5 * np.std(wanted))


@pytest.mark.parametrize(
    ("sources", "receiver", "seconds"),
    [(1, "binaural", 0.0), (1, "binaural", 0.4), (2, "array", 0.15), (1, "ambisonics", 0.15), (1, "omni", 0.15),
     pytest.param(1, "binaural", 0.15, marks=pytest.mark.slow),
     *(pytest.param(*case, seconds, marks=pytest.mark.slow)
       for case in [(2, "array"), (1, "ambisonics"), (1, "omni")] for seconds in (0.0, 0.4))],
)  # fmt: skip
def test_late_sound_is_heard_as_by_xla(here, rng, seconds, sources, receiver):
    """With no echoes of the second part, two and four, an odd number of channels, late and early onsets."""
    check_late_sound(rng, sources, moving(receiver, seconds))


@pytest.mark.parametrize("bin_seconds", [0.0005, 0.00625, 0.02])
def test_bins_may_be_short_and_long(here, rng, bin_seconds):
    """Shorter than a warp, and longer than a block has threads; numbers of bins that no block divides."""
    check_late_sound(rng, 1, dataclasses.replace(moving("binaural", 0.0), bin_seconds=bin_seconds))


@pytest.mark.parametrize(("count", "channels"), [(2143, 2), (250, 3), (700, 1), (1000, 4), (4500, 2)])
def test_sums_are_filtered_as_by_numpy(here, rng, count, channels):
    """Transforms of several sizes, all radices among them; also odd numbers of channels."""
    filters, begin = rng.normal(size=(5, 40)).astype(np.float32), 39
    signals = rng.normal(size=(2, channels, 5, count)).astype(np.float32)
    (got,) = sums.launch_filter(begin, count - begin, *sums.filter_tables(filters, count), jnp.asarray(signals))
    pairs = [[zip(c, filters, strict=True) for c in e] for e in signals]
    wanted = [[sum(np.convolve(x, k)[begin:count] for x, k in c) for c in e] for e in pairs]
    np.testing.assert_allclose(got, wanted, rtol=0, atol=2e-5 * np.std(wanted))


GARBAGE = np.array([np.nan, np.inf, -np.inf, 1e30, -1e30, 1e9, 0, -5], np.float32)
WHOLE = (-(2**31), 2**31 - 1, 10**6, -70, 3)


def spoilt(rng, x):
    """Some of its numbers are none, or what no path and no noise has."""
    x, bad = np.array(x), rng.random(x.shape) < 0.3
    x[bad] = rng.choice(WHOLE if x.dtype == np.int32 else GARBAGE, bad.sum())
    return jnp.asarray(x)


@pytest.mark.parametrize("name", ["filter_direct", "mix_paths", "shape_noise", "late_frames"])
def test_whatever_it_is_given_a_kernel_stays_within_its_arrays(tmp_path, monkeypatch, rng, name):
    """AddressSanitizer sees each block, with numbers from nowhere in all arrays but their sizes."""
    config, program = AudioConfig(response_seconds=0.2, motion=Motion(tail_seconds=0.15)), []

    def ffi_call(target, results):
        def call(*operands, **sizes):
            threads, words = (int(sizes[key]) for key in ("block_x", "shared_mem_bytes"))
            given, result = [np.asarray(x) for x in operands], np.zeros(results[0].shape, np.float32)
            if sizes["name"] != name:
                return (jnp.asarray(result),)
            if not program:
                each = f"for (int i = 0; i < a * b; ++i) run(p, i % a, i / a, {threads}, {words // 4})"
                program.append(Program(tmp_path, program_text(name, compiled_for(name, given, threads)), each))
            program[0].add([*given, result], int(sizes["grid_x"]), int(sizes["grid_y"]))
            return (jnp.asarray(result),)

        return call

    monkeypatch.setattr(ptx, "ptx_of", lambda sources, size: "")
    monkeypatch.setattr(jax.ffi, "ffi_call", ffi_call)
    ends = 1, 2, 2
    for _ in range(3):
        if name == "filter_direct":
            signal, begin = jnp.float32(rng.normal(size=(2, 2000))), jnp.int32(rng.integers(-500, 2000, 2))
            given = signal, begin, *(jnp.float32(rng.normal(size=shape)) for shape in ((2, 2, 7), (2, 2)))
            cuda_first.launch_direct(config, *cuda_first.first_tables(config), *(spoilt(rng, x) for x in given))
        elif name == "mix_paths":
            given = (1, 2, 2000), (1, 2, 2, 900), (1, 2, 3), (1, 2, 5, 9), (1, 2, 5, 2, 20, 2)
            given = [jnp.float32(rng.normal(size=shape)) for shape in given]
            given[2] = jnp.int32(rng.integers(0, 9000, (1, 2, 3)))
            sums.launch_mix(config, 20, 2, *(spoilt(rng, x) for x in given))
        else:
            share = (config.num_bins, 2, 7), (2, 5, 7), (config.num_bins, 1, 7)
            share = [jnp.float32(rng.normal(size=(*ends, *shape))) for shape in share]
            signal = jnp.float32(
                rng.normal(size=(1, 2, config.memory_length - 1 + config.frame + config.num_lookahead))
            )
            whole = [jnp.int32(rng.integers(0, config.response_length, ends)) for _ in range(2)]
            levels = jnp.float32(rng.normal(size=(*ends, config.num_tail_repeats, 7)))
            given = signal, *share, *whole, levels
            launch_late.launch_late_frames(config, *launch_late.late_tables(config), *(spoilt(rng, x) for x in given))
    program[0].run()


def test_sizes_of_transforms_have_all_radices():
    """So the test above has seen each of them."""
    sizes = [ptx.transform_size(count) for count in (2143, 250, 700, 1000, 4500)]
    assert sizes == [2560, 256, 768, 1024, 4608]
    assert ptx.transform_size(7000) is None


def test_filters_of_the_engine_ring_out_before_the_frame():
    """What a transform brings from its end is never in the frame."""
    config = AudioConfig(motion=Motion())
    assert filter_basis(config.sample_rate).kernel.shape[1] <= frame_begin(config) + 1


def test_weights_in_cuda_are_those_of_python():
    """Sixty rounded numbers that nobody compares by eye."""
    text = ptx.MIX_SOURCES[0].read_text()
    rows = re.findall(r"^ +\{(-?\d.*)\},$", text, re.MULTILINE)
    table = np.array([[np.float32(x.strip("f ")) for x in row.split(",")] for row in rows], np.float32)
    np.testing.assert_array_equal(table, delays.interpolation_polynomials())
    for name, value in {
        "TAPS": 2 * delays.HALF_WIDTH,
        "READ": delays.NUM_READ,
        "FIRST": delays.FIRST_READ,
        "SUMS": sums.BUSES_PER_THREAD,
    }.items():
        assert re.search(rf"constexpr int {name} = {value};", text)


def test_nvrtc_compiles_them():
    """If it is here."""
    for sources, _ in KERNELS.values():
        assert ".entry" in nvrtc_ptx(sources, 90, {"SIZE": 2560})
