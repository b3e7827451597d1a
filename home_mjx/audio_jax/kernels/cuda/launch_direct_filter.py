"""Octave filters of the first path on GPUs."""

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.filter_basis import octave_levels
from home_mjx.audio_jax.base.filters import causal_octave_log_spectra
from home_mjx.audio_jax.kernels.cuda import ptx as cuda
from home_mjx.audio_jax.kernels.direct_filter import num_filter_samples, num_output_samples
from home_mjx.core.native.kernel import launch_ptx
from home_mjx.core.native.platforms import max_shared_bytes
from home_mjx.core.native.vmap_call import call_kernel, traced_constant

ENDS = 2


def supports_direct(config: AudioConfig) -> bool:
    """Return whether a transform size exists that fits the shared memory of all GPUs."""
    size = _size(config)
    return size is not None and _bytes(size) <= max_shared_bytes()


def filter_direct(
    source: Float[Array, " n"], begin: Int[Array, ""], gain: Float[Array, "ends bands"], config: AudioConfig
) -> Float[Array, "ends m"]:
    """Filter a source with the octave gains of both frame ends by the CUDA kernel; `supports_direct` must be True.

    Arguments and result are those of `direct_filter.filter_direct_by_xla`: m samples from sample `begin` on.
    """
    given = source, begin, *octave_levels(gain)
    return call_kernel(launch_direct, (config,), first_tables(config), given)


def first_tables(config: AudioConfig) -> tuple[Float[Array, "bands f two"], Float[Array, "turns two"]]:
    """Return `causal_octave_log_spectra`, as (real, imaginary), and `ptx.twiddle_factors`, both of the transform size.

    `supports_direct` must be True.
    """
    size = _size(config)
    assert size is not None
    return cuda.as_pairs(causal_octave_log_spectra(size, config.sample_rate)), cuda.twiddle_factors(size)


def launch_direct(config: AudioConfig, *given: Array) -> tuple[Array, ...]:
    """Filter e signals with their octave gains at the start and at the end of the frame; return ((e 2 m),).

    `given`: `first_tables`, then signal, begin and both results of `octave_levels`, each with a leading axis e.
    """
    octaves, turns, source, begin, level, sounds = given
    (count, length), size = source.shape, 2 * (octaves.shape[1] - 1)
    sizes = traced_constant((length, num_filter_samples(config), num_output_samples(config)))
    operands = source, begin, level, sounds, octaves, turns, sizes
    result = jax.ShapeDtypeStruct((count, ENDS, num_output_samples(config)), jnp.float32)
    ptx, threads = cuda.ptx_of(cuda.DIRECT_SOURCES, size), size // cuda.PER_THREAD
    return launch_ptx("filter_direct", ptx, (count,), threads, _bytes(size), operands, (result,))


def _size(config: AudioConfig) -> int | None:
    """Return the transform size, see `ptx.transform_size`; None if none is large enough."""
    return cuda.transform_size(num_filter_samples(config) + num_output_samples(config))


def _bytes(size: int) -> int:
    """Return the shared memory of a block [bytes]: a transform of `size`, and the spectra of two real filters."""
    return cuda.transform_bytes(size) + ENDS * 8 * (size // 2 + 1)
