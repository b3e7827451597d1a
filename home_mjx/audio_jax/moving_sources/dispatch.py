"""Waveforms of a frame: native kernels on CPU and CUDA where available, XLA operations elsewhere."""

import functools
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.kernels.cpu import xla_calls as cpu
from home_mjx.audio_jax.kernels.cuda import launch_direct_filter as cuda_first
from home_mjx.audio_jax.kernels.cuda import launch_early as cuda_early
from home_mjx.audio_jax.kernels.cuda import launch_late as cuda_late
from home_mjx.audio_jax.kernels.cuda.ptx import compile_kernels
from home_mjx.audio_jax.kernels.delay_reads import DelayReads, frame_begin, mix_paths
from home_mjx.audio_jax.kernels.direct_filter import filter_direct_by_xla
from home_mjx.audio_jax.kernels.late_tail import LateResponse, render_late_by_xla
from home_mjx.core.native.kernel import Kernel
from home_mjx.core.native.platforms import with_fallback_gradient

KERNEL = Kernel(cpu.TARGET, "moving sound uses slower XLA operations", cpu=cpu.compile_chunks, cuda=compile_kernels)


def filter_direct(
    source: Float[Array, " n"], begin: Int[Array, ""], gain: Float[Array, "ends bands"], config: AudioConfig
) -> Float[Array, "ends m"]:
    """Filter `source` causally with the octave gains of each frame end; return m samples from `begin` on.

    Arguments and result are those of `filter_direct_by_xla`.
    """
    fast: dict[str, Callable[..., Array]] = {}
    if KERNEL.is_usable("cuda") and cuda_first.supports_direct(config):
        fast["cuda"] = functools.partial(cuda_first.filter_direct, config=config)
    return with_fallback_gradient(functools.partial(filter_direct_by_xla, config=config), fast)(source, begin, gain)


def render_early_frame(reads: DelayReads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render the early sound of a frame, summed over sources, the leading axis of `reads`.

    Return the pressure per channel, m = `config.frame` samples.
    """
    fast: dict[str, Callable[..., Array]] = {}
    if KERNEL.is_usable("cpu"):
        fast["cpu"] = functools.partial(cpu.early_frame, config=config)
    if KERNEL.is_usable("cuda") and cuda_early.supports_early(reads, config):
        fast["cuda"] = functools.partial(cuda_early.early_frame, config=config)
    return with_fallback_gradient(functools.partial(render_early_xla, config=config), fast)(reads)


def render_early_xla(reads: DelayReads, config: AudioConfig) -> Float[Array, "e m"]:
    """Compute `render_early_frame` with XLA operations: mix paths into buses, then filter and add the buses."""
    sums = mix_paths(reads, config)
    size, begin = sums.shape[-1], frame_begin(config)
    spectra = jnp.asarray(np.fft.rfft(filter_basis(config.sample_rate).kernel, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    return jnp.fft.irfft(whole, size)[:, begin : begin + config.frame]


def render_late_frame(sources: Float[Array, "n w"], late: LateResponse, config: AudioConfig) -> Float[Array, "e s"]:
    """Render a frame of late reverberation, summed over sources; arguments as in `late_tail.render_late_by_xla`."""
    fast: dict[str, Callable[..., Array]] = {}
    if KERNEL.is_usable("cpu") and cpu.supports_late(late, config):
        fast["cpu"] = functools.partial(cpu.late_frame, config=config)
    if KERNEL.is_usable("cuda") and cuda_late.supports_late(config):
        fast["cuda"] = functools.partial(cuda_late.late_frame, config=config)
    return with_fallback_gradient(functools.partial(render_late_by_xla, config=config), fast)(sources, late)
