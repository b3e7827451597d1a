"""JAX calls of the CPU kernels for moving frames, compiled on first use."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.kernels.cpu.fft import fast_size
from home_mjx.audio_jax.kernels.cpu.operands import EARLY, LATE
from home_mjx.audio_jax.kernels.delay_reads import DelayReads, filter_history, frame_begin, pack_paths, sample_times
from home_mjx.audio_jax.kernels.late_tail import LateResponse, octave_table, source_window_width
from home_mjx.audio_jax.kernels.late_tail import late_frame_begin as late_begin
from home_mjx.audio_jax.receivers.diffuse_noise import amplitude_knot_weights, octave_noise
from home_mjx.core.native.kernel import call_native
from home_mjx.core.native.simd import LANES
from home_mjx.core.native.vmap_call import call_kernel, traced_constant
from home_mjx.schema.compiled import BANDS

TARGET = "home_mjx_frames"


def compile_chunks() -> tuple[Any, Any]:
    """Import and compile the Numba code; return its C functions `count` (chunks of a call) and `work` (of a job)."""
    from home_mjx.audio_jax.kernels.cpu import chunks

    return chunks.compile_chunks()


def early_frame(reads: DelayReads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render a frame of early sound, summed over sources, by the CPU kernel; there is no fallback if it is not usable.

    The leading axis of `reads` is sources. The result is pressure per channel.
    """
    share = jnp.moveaxis(reads.gain, -1, -2)
    share = jnp.pad(share, [(0, 0)] * 4 + [(0, max(LANES - share.shape[-1], 0))])
    given = reads.source, reads.filtered, reads.start, pack_paths(reads.paths), share
    return call_kernel(_call_early, (config,), _early_tables(config), given)


def _early_tables(config: AudioConfig) -> tuple[Float[Array, "two size s"], Float[Array, "two size"]]:
    """Return bus filter spectra divided by their size, and twiddle factors; each real, then imaginary.

    There are at least `LANES` buses; added ones are 0.
    """
    kernels, size = filter_basis(config.sample_rate).kernel.astype(np.float64), fast_size(sample_times(config).shape[0])
    spectra = np.fft.fft(kernels, size).T / size
    spectra = np.pad(spectra, [(0, 0), (0, max(LANES - spectra.shape[1], 0))])
    return _parts(spectra), _twiddles(size)


def _twiddles(size: int) -> Array:
    """Return the factors exp(-2 pi i j / size), real and imaginary parts (2, size)."""
    return _parts(np.exp(-2j * np.pi * np.arange(size) / size))


def _parts(values: np.ndarray) -> Array:
    """Stack real and imaginary parts along a new first axis, float32."""
    return jnp.asarray(np.stack([np.real(values), np.imag(values)]), jnp.float32)


def _call_early(config: AudioConfig, spectra: Array, turns: Array, *given: Array) -> tuple[Array, ...]:
    """Call the early kernel for `_early_tables` and arrays with a first axis of environments, see `_call`."""
    sizes = traced_constant((EARLY, frame_begin(config), filter_history(config), sample_times(config).shape[0]))
    rate = traced_constant([config.sample_rate / config.speed_of_sound], jnp.float32)
    return _call(config, sizes, spectra, turns, rate, *given)


def supports_late(late: LateResponse, config: AudioConfig) -> bool:
    """Return whether the CPU kernel supports this sound: no `shared_power`, and at least `LANES` samples per bin."""
    return late.shares.shared_power.shape[-2] == 0 and config.bin_samples >= LANES


def late_frame(sources: Float[Array, "n w"], late: LateResponse, config: AudioConfig) -> Float[Array, "e s"]:
    """Render a frame of late sound, summed over sources, by the CPU kernel; `supports_late` must be True.

    Arguments and result are those of `late_tail.render_late_by_xla`: it crossfades between both frame ends.
    """
    share = late.shares
    given = sources, share.amplitude(), share.mix, share.start_bin, late.onset, late.tail
    return call_kernel(_call_late, (config,), _late_tables(config), given)


def _late_tables(config: AudioConfig) -> tuple[Array, ...]:
    """Return the octave noise, the weights of amplitude knots, octave gains (zeros without tail), twiddle factors."""
    size = fast_size(source_window_width(config))
    gains = octave_table(config, size) if config.num_tail_repeats else np.zeros((len(BANDS), size // 2 + 1))
    tables = (jnp.asarray(x, jnp.float32) for x in (octave_noise(config), amplitude_knot_weights(config), gains))
    return *tables, _twiddles(size)


def _call_late(config: AudioConfig, *given: Array) -> tuple[Array, ...]:
    """Call the late kernel for `_late_tables` and arrays with a first axis of environments, see `_call`."""
    first, half = config.response_length - config.tail_period, config.tail_period
    start = config.memory_length - first - config.num_tail_ringing
    sizes = (LATE, first, half, config.num_tail_repeats, start, source_window_width(config), late_begin(config))
    return _call(config, traced_constant(sizes), *given)


def _call(config: AudioConfig, *operands: Array) -> tuple[Array, ...]:
    """Call the native code; the result is a tuple of (environments, channels, samples of a frame) float32."""
    envs, channels = operands[-1].shape[0], config.num_channels
    result = jax.ShapeDtypeStruct((envs, channels, config.frame), jnp.float32)
    return call_native(TARGET, operands, (result,))
