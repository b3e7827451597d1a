"""Late sound of moving frames on GPUs."""

import math

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.kernels.cuda import ptx as cuda
from home_mjx.audio_jax.kernels.late_tail import LateResponse, late_frame_begin, octave_table, source_window_width
from home_mjx.audio_jax.receivers.diffuse_noise import octave_noise
from home_mjx.core.native.kernel import launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes
from home_mjx.core.native.vmap_call import call_kernel, traced_constant
from home_mjx.schema.compiled import BANDS

# Per block: rows, bins, floats per row, threads, as in noise_responses.cu
NOISE_ROWS, NOISE_BINS, NOISE_AMPLITUDES, NOISE_THREADS = 64, 5, 32, 64


def supports_late(config: AudioConfig) -> bool:
    """Return whether a transform size exists that fits the shared memory of all GPUs."""
    size = cuda.transform_size(source_window_width(config))
    return size is not None and _bytes(size) <= max_shared_bytes()


def late_frame(sources: Float[Array, "n w"], late: LateResponse, config: AudioConfig) -> Float[Array, "e s"]:
    """Render a frame of late sound, summed over sources, by two CUDA kernels; `supports_late` must be True.

    Arguments and result are those of `late_tail.render_late_by_xla`: it crossfades between both frame ends.
    """
    share = late.shares
    given = sources, share.power, share.mix, share.shared_power, share.start_bin, late.onset, late.tail
    return call_kernel(launch_late_frames, (config,), late_tables(config), given)


def late_tables(
    config: AudioConfig,
) -> tuple[Float[Array, "own c bands n"], Float[Array, "bands f"], Float[Array, "turns two"]]:
    """Return `octave_noise` (own: 1 if shared), `octave_table` (zeros without tail), twiddles (real, imaginary)."""
    size = cuda.transform_size(source_window_width(config))
    assert size is not None
    gains = (
        octave_table(config, size) if config.num_tail_repeats else jnp.zeros((len(BANDS), size // 2 + 1), jnp.float32)
    )
    whole = jnp.asarray(octave_noise(config))
    return whole.reshape(-1, *whole.shape[-3:]), jnp.asarray(gains), cuda.twiddle_factors(size)


def launch_late_frames(config: AudioConfig, *given: Array) -> tuple[Array, ...]:
    """Launch the kernels for `late_tables`, then the operands of `late_frame` (e ...); return ((e channels frame),)."""
    table, octaves, turns, sources, power, mix, common, begun, onset, tail = given
    responses = launch_noise(config, table, power, mix, common, begun)
    (envs, count, length), channels, size = sources.shape, config.num_channels, 2 * (octaves.shape[1] - 1)
    first, half = config.response_length - config.tail_period, config.tail_period
    start = config.memory_length - first - config.num_tail_ringing
    sizes = (count, length, channels, config.response_length, first, half, config.num_tail_repeats, start)
    sizes = (*sizes, source_window_width(config), late_frame_begin(config), config.frame)
    operands = sources, responses, begun * config.bin_samples, onset, tail, octaves, turns, traced_constant(sizes)
    result = jax.ShapeDtypeStruct((envs, channels, config.frame), jnp.float32)
    ptx, grid, threads = cuda.ptx_of(cuda.LATE_SOURCES, size), (envs, -(-channels // 2)), size // cuda.PER_THREAD
    return launch_ptx("late_frames", ptx, grid, threads, _bytes(size), operands, (result,))


def launch_noise(
    config: AudioConfig,
    table: Float[Array, "own c bands n"],
    power: Float[Array, "*n k e bands"],
    mix: Float[Array, "*n e c bands"],
    common: Float[Array, "*n k x bands"],
    start: Int[Array, "*n"],
) -> Float[Array, "*n e l"]:
    """Generate noise responses from `octave_noise` and fields of `NoiseGains`; bin 0 is that of the noise.

    So a response begins at bin `start` and continues periodically. Samples before its onset are not zeroed.
    """
    (*ends, bins, channels, bands), (own, noises, *_) = power.shape, table.shape
    sizes = (math.prod(ends), bins, channels, config.bin_samples, common.shape[-2], own)
    result = jax.ShapeDtypeStruct((*ends, channels, config.response_length), jnp.float32)
    pieces, weights = -(-config.bin_samples // (2 * NOISE_THREADS)), -(-noises * bands // 4) * 4
    grid = channels * -(-sizes[0] // NOISE_ROWS), -(-bins // NOISE_BINS) * pieces
    shared = 4 * NOISE_ROWS * (weights + NOISE_AMPLITUDES * (2 if sizes[4] else 1))
    ptx, operands = cuda.ptx_of(cuda.NOISE_SOURCES, noises), (table, power, mix, common, start, traced_constant(sizes))
    return launch_ptx("shape_noise", ptx, grid, NOISE_THREADS, shared, operands, (result,))[0]


def _bytes(size: int) -> int:
    """Return the shared memory of a block [bytes]: a transform of `size`, and three spectra of real signals."""
    return cuda.transform_bytes(size) + 3 * 8 * (size // 2 + 1)
