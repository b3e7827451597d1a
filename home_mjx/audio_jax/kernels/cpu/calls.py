"""JAX calls of the CPU kernels for moving frames, compiled on first use."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.shapes import shapes
from home_mjx.audio_jax.kernels.cpu.fft import fast_size
from home_mjx.audio_jax.kernels.cpu.operands import EARLY, LATE
from home_mjx.audio_jax.kernels.reads import Reads, before, frame_begin, times, way_rows
from home_mjx.audio_jax.kernels.tail import Late, octave_table, window_width
from home_mjx.audio_jax.kernels.tail import frame_begin as late_begin
from home_mjx.audio_jax.receivers.diffuse import knot_hats, noise
from home_mjx.core.native.fork_guard import note_start
from home_mjx.core.native.platforms import problem_of, works
from home_mjx.core.native.sharding import varying_as
from home_mjx.core.native.simd import LANES
from home_mjx.core.native.vmap_call import batched, numbers
from home_mjx.schema.compiled import BANDS

TARGET = "home_mjx_frames"
NUM_EARLY_TABLES, NUM_LATE_TABLES = 2, 4  # leading operands shared by all environments

_kept: list[object] = []  # compiled functions that XLA may call until the process ends


@functools.cache
def cpu_available() -> bool:
    """Return whether the compiled code works; warn once if there is a CPU backend on which it fails."""
    return works("cpu", problem_of("cpu", _start), "moving sound uses slower XLA operations")


def _start() -> None:
    note_start()
    from home_mjx.audio_jax.kernels.cpu.handler import build_handler

    compiled = build_handler()
    _kept.extend(compiled)
    jax.ffi.register_ffi_target(TARGET, jax.ffi.pycapsule(compiled[-1].ctypes), platform="cpu", api_version=1)


def early_frame(reads: Reads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render `motion.synthesis.early_frame` with the same arguments."""
    share = jnp.moveaxis(reads.share, -1, -2)
    share = jnp.pad(share, [(0, 0)] * 4 + [(0, max(LANES - share.shape[-1], 0))])
    given = reads.source, reads.filtered, reads.start, way_rows(reads.ways), share
    return _early_op(config)(*_early_tables(config), *(x[None] for x in given))[0][0]


def _early_tables(config: AudioConfig) -> tuple[Float[Array, "two size s"], Float[Array, "two size"]]:
    """Return the spectra of the bus filters, padded to at least `LANES` buses, and the FFT twiddle factors."""
    kernels, size = shapes(config.sample_rate).kernel.astype(np.float64), fast_size(times(config).shape[0])
    spectra = np.fft.fft(kernels, size).T / size
    spectra = np.pad(spectra, [(0, 0), (0, max(LANES - spectra.shape[1], 0))])
    return _parts(spectra), _turns(size)


def _turns(size: int) -> Array:
    return _parts(np.exp(-2j * np.pi * np.arange(size) / size))


def _parts(values: np.ndarray) -> Array:
    return jnp.asarray(np.stack([np.real(values), np.imag(values)]), jnp.float32)


@functools.cache
def _early_op(config: AudioConfig) -> Callable[..., tuple[Array, ...]]:
    def run(spectra: Array, turns: Array, *given: Array) -> tuple[Array, ...]:
        sizes = numbers((EARLY, frame_begin(config), before(config), times(config).shape[0]))
        rate = numbers([config.sample_rate / config.speed_of_sound], jnp.float32)
        return _call(config, sizes, spectra, turns, rate, *given)

    return batched(run, NUM_EARLY_TABLES, 1)


def hears(late: Late, config: AudioConfig) -> bool:
    """Return whether the compiled code supports this late sound: no common noise, and bins of at least `LANES`."""
    return late.share.common.shape[-2] == 0 and config.bin_samples >= LANES


def late_frame(sources: Float[Array, "n w"], late: Late, config: AudioConfig) -> Float[Array, "e s"]:
    """Render `motion.synthesis.late_frame` with the same arguments."""
    share = late.share
    given = sources, share.amplitude(), share.mix, share.start, late.onset, late.tail
    return _late_op(config)(*_late_tables(config), *(x[None] for x in given))[0][0]


def _late_tables(config: AudioConfig) -> tuple[Array, ...]:
    """Return the noise, the weights of its amplitude knots, octave gains and FFT twiddle factors."""
    size = fast_size(window_width(config))
    gains = octave_table(config, size) if config.num_tail else np.zeros((len(BANDS), size // 2 + 1))
    tables = (jnp.asarray(x, jnp.float32) for x in (noise(config), knot_hats(config), gains))
    return *tables, _turns(size)


@functools.cache
def _late_op(config: AudioConfig) -> Callable[..., tuple[Array, ...]]:
    first, half = config.response_length - config.half_length, config.half_length
    start = config.memory_length - first - config.tail_ringing
    sizes = (LATE, first, half, config.num_tail, start, window_width(config), late_begin(config))

    def run(*given: Array) -> tuple[Array, ...]:
        return _call(config, numbers(sizes), *given)

    return batched(run, NUM_LATE_TABLES, 1)


def _call(config: AudioConfig, *operands: Array) -> tuple[Array, ...]:
    plain = [x.astype(jnp.int32 if jnp.issubdtype(x.dtype, jnp.integer) else jnp.float32) for x in operands]
    envs, channels = plain[-1].shape[0], config.num_channels
    result = jax.ShapeDtypeStruct((envs, channels, config.frame), jnp.float32)
    return varying_as(operands, jax.ffi.ffi_call(TARGET, (result,))(*plain))
