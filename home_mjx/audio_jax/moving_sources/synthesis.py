"""Waveforms of a frame: native kernels on CPU and CUDA where available, XLA operations elsewhere."""

import functools
from collections.abc import Callable

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.shapes import shapes
from home_mjx.audio_jax.kernels.cpu import calls as cpu
from home_mjx.audio_jax.kernels.cuda import early as cuda_early
from home_mjx.audio_jax.kernels.cuda import first as cuda_first
from home_mjx.audio_jax.kernels.cuda import late as cuda_late
from home_mjx.audio_jax.kernels.first import filtered_by_xla
from home_mjx.audio_jax.kernels.reads import Reads, frame_begin, sums_of
from home_mjx.audio_jax.kernels.tail import Late, frame_by_xla
from home_mjx.core.native.platforms import by_platform


def filtered_first(
    source: Float[Array, " n"], begin: Int[Array, ""], gain: Float[Array, "ends bands"], config: AudioConfig
) -> Float[Array, "ends m"]:
    """Filter the first path's source by its own octave filters; arguments as in `first.filtered_by_xla`."""
    fast: dict[str, Callable[..., Array]] = {}
    if cuda_first.available(config):
        fast["cuda"] = functools.partial(cuda_first.filtered, config=config)
    return by_platform(functools.partial(filtered_by_xla, config=config), fast)(source, begin, gain)


def early_frame(reads: Reads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render the early sound of several sources through moving paths.

    Args:
        reads: Delay-line reads, with a leading axis of sources.
        config: Options.

    Returns:
        Pressure per channel, `config.frame` samples.
    """
    fast: dict[str, Callable[..., Array]] = {}
    if cpu.cpu_available():
        fast["cpu"] = functools.partial(cpu.early_frame, config=config)
    if cuda_early.available(reads, config):
        fast["cuda"] = functools.partial(cuda_early.early_frame, config=config)
    return by_platform(functools.partial(early_by_xla, config=config), fast)(reads)


def early_by_xla(reads: Reads, config: AudioConfig) -> Float[Array, "e m"]:
    """Render early sound with XLA operations; arguments as in `early_frame`."""
    sums = sums_of(reads, config)
    size, begin = sums.shape[-1], frame_begin(config)
    spectra = jnp.asarray(np.fft.rfft(shapes(config.sample_rate).kernel, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    return jnp.fft.irfft(whole, size)[:, begin : begin + config.frame]


def late_frame(sources: Float[Array, "n w"], late: Late, config: AudioConfig) -> Float[Array, "e s"]:
    """Render the late reverberation of several sources; arguments as in `tail.frame_by_xla`."""
    fast: dict[str, Callable[..., Array]] = {}
    if cpu.cpu_available() and cpu.hears(late, config):
        fast["cpu"] = functools.partial(cpu.late_frame, config=config)
    if cuda_late.available(config):
        fast["cuda"] = functools.partial(cuda_late.late_frame, config=config)
    return by_platform(functools.partial(frame_by_xla, config=config), fast)(sources, late)
