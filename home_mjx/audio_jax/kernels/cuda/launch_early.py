"""Early sound of moving frames on GPUs: paths are mixed into buses, and the buses are filtered."""

import math

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, windowed_sinc
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.kernels.cuda import ptx as cuda
from home_mjx.audio_jax.kernels.delay_reads import DelayReads, filter_history, frame_begin, pack_paths, sample_times
from home_mjx.core.native.kernel import launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes
from home_mjx.core.native.vmap_call import call_kernel, traced_constant

WINDOW_SECONDS = 0.08  # [s], source window in shared memory beyond the length of a frame
BUSES_PER_THREAD, MIX_THREADS = 20, 384  # buses per thread at a time, and threads per block, as in path_mixing.cu


def supports_early(reads: DelayReads, config: AudioConfig) -> bool:
    """Return whether a transform size exists, and one block's shared memory, on all GPUs, suffices for these arrays."""
    size, most = cuda.transform_size(sample_times(config).shape[0]), max_shared_bytes()
    fits = size is not None and filter_bytes(size) <= most
    return fits and _mix_bytes(config, *(x[None] for x in read_operands(reads))) <= most


def early_frame(reads: DelayReads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render a frame of early sound, summed over sources, by two CUDA kernels; `supports_early` must be True.

    The leading axis of `reads` is sources. The result is pressure per channel.
    """
    shapes, ears = reads.gain.shape[3], reads.paths.ear_delays.shape[-1]
    buses = call_kernel(launch_mix, (config, shapes, ears), (), read_operands(reads))
    tables = filter_tables(filter_basis(config.sample_rate).kernel, buses.shape[-1])
    return call_kernel(launch_filter, (frame_begin(config), config.frame), tables, (buses,))


def read_operands(reads: DelayReads) -> tuple[Array, ...]:
    """Return source, filtered signals, start, `pack_paths`, and gains, buses padded to `BUSES_PER_THREAD` multiples."""
    share = jnp.pad(reads.gain, [(0, 0)] * 3 + [(0, -reads.gain.shape[3] % BUSES_PER_THREAD), (0, 0)])
    return reads.source, reads.filtered, reads.start, pack_paths(reads.paths), share


def launch_mix(config: AudioConfig, shapes: int, ears: int, *given: Array) -> tuple[Array, ...]:
    """Launch the mixing kernel for `read_operands` of environments (e ...); return buses ((e channels shapes count),).

    `shapes`: buses per channel without padding; `ears`: number of ears with delays of their own; `count`: samples of a
    bus, at `sample_times`.
    """
    source, filtered, _, way, share = given
    channels, count = share.shape[3], sample_times(config).shape[0]
    sizes = (*source.shape[1:], filtered.shape[3], way.shape[2], ears, channels, shapes, count)
    taps = windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5).tolist()
    rate = config.sample_rate / config.speed_of_sound
    tables = traced_constant(taps, jnp.float32), traced_constant([rate], jnp.float32)
    operands = (*given, *tables, traced_constant((*sizes, config.frame, filter_history(config), _window(config))))
    result = jax.ShapeDtypeStruct((source.shape[0], channels, shapes, count), jnp.float32)
    ptx, grid = cuda.ptx_of(cuda.MIX_SOURCES, 0), (source.shape[0],)
    return launch_ptx("mix_paths", ptx, grid, MIX_THREADS, _mix_bytes(config, *given), operands, (result,))


def _window(config: AudioConfig) -> int:
    """Return the source samples in shared memory at a time; enough for paths whose lengths differ by at most 25 m."""
    return sample_times(config).shape[0] + math.ceil(WINDOW_SECONDS * config.sample_rate)


def _mix_bytes(config: AudioConfig, source: Array, filtered: Array, _: Array, way: Array, share: Array) -> int:
    """Return the shared memory of a block [bytes] for `read_operands` (e ...): signals, paths, read plan, gains."""
    signals = 2 * (filtered[0, 0].size + _window(config)) + 3 * 2 * HALF_WIDTH
    return 4 * (signals + way[0, 0].size + share[0, 0].size + 2 * HALF_WIDTH + 4 * way.shape[2] + 2)


def filter_tables(
    kernels: Float[np.ndarray, "s t"], count: int
) -> tuple[Float[Array, "s size two"], Float[Array, "turns two"]]:
    """Return spectra of filters divided by their size, `transform_size(count)`, and `twiddle_factors`, all as pairs."""
    size = cuda.transform_size(count)
    assert size is not None
    return cuda.as_pairs(np.fft.fft(kernels.astype(np.float64), size) / size), cuda.twiddle_factors(size)


def launch_filter(begin: int, frame: int, *given: Array) -> tuple[Array, ...]:
    """Launch the kernel for `filter_tables`, then buses (e channels shapes samples); return ((e channels frame),).

    Filtered buses of a channel are added.

    `begin`: first sample of the frame in the filtered buses; `frame`: number of samples.
    """
    spectra, turns, sums = given
    envs, channels, shapes, count = sums.shape
    size = spectra.shape[1]
    operands = sums, spectra, turns, traced_constant((channels, shapes, count, begin, frame))
    result = jax.ShapeDtypeStruct((envs, channels, frame), jnp.float32)
    ptx, grid, threads = cuda.ptx_of(cuda.FILTER_SOURCES, size), (envs, -(-channels // 2)), size // cuda.PER_THREAD
    return launch_ptx("filter_buses", ptx, grid, threads, filter_bytes(size), operands, (result,))


def filter_bytes(size: int) -> int:
    """Return the shared memory of a block of `launch_filter` for a transform of `size` samples [bytes]."""
    return cuda.transform_bytes(size)
