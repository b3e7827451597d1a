"""Early sound of moving frames: paths read and added up, and the sums filtered; kernels on GPUs, XLA elsewhere."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, windowed_sinc
from home_mjx.audio_jax.frames.cuda import kernels as cuda
from home_mjx.audio_jax.frames.reads import Reads, before, sums_of, times
from home_mjx.core.native.batched import batched

SUMS, SUMS_THREADS = 20, 768  # that a thread keeps at once, and threads, as in sums.cu


def add_reads(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
    """`reads.sums_of`, by the kernel where there is one and its memory suffices.

    Args:
        reads: With a leading axis of sources.
        config: Options.
    """
    slow = functools.partial(sums_of, config=config)
    if not cuda.cuda_available() or _sums_bytes(*(x[None] for x in read_operands(reads))) > cuda.shared_bytes():
        return slow(reads)
    return cuda.chosen(slow, functools.partial(_add_reads, config=config))(reads)


def filter_sums(
    sums: Float[Array, "e s k"], kernels: Float[np.ndarray, "s t"], begin: int, frame: int
) -> Float[Array, "e m"]:
    """Each of some sums through its filter, all of them added up.

    Args:
        sums: Per channel.
        kernels: Filters.
        begin: Sample of the results that is wanted first; filters are no longer than the samples before it.
        frame: Samples that are wanted.
    """
    how = {"kernels": kernels, "begin": begin, "frame": frame}
    size = cuda.transform_size(sums.shape[-1])
    if not cuda.cuda_available() or size is None or filter_bytes(size) > cuda.shared_bytes():
        return _filter_by_xla(sums, **how)
    return cuda.chosen(functools.partial(_filter_by_xla, **how), functools.partial(_filter_sums, **how))(sums)


def _add_reads(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
    shapes, ears = reads.share.shape[3], reads.ways.ears.shape[-1]
    return _sums_op(config, shapes, ears)(*(x[None] for x in read_operands(reads)))[0][0]


def read_operands(reads: Reads) -> tuple[Array, ...]:
    """The arrays of one environment that the kernel reads, in its order."""
    ways = reads.ways
    lengths = (x[..., None] for x in (ways.old, ways.new, ways.bend))
    way = jnp.concatenate([*lengths, ways.ears.reshape(*ways.old.shape, -1)], axis=-1)
    share = jnp.pad(reads.share, [(0, 0)] * 3 + [(0, -reads.share.shape[3] % SUMS), (0, 0)])
    return reads.source, reads.filtered, reads.start, way, share


@functools.cache
def _sums_op(config: AudioConfig, shapes: int, ears: int) -> Callable[..., tuple[Array, ...]]:
    return batched(functools.partial(run_sums, config, shapes, ears), 0, 1)


def run_sums(config: AudioConfig, shapes: int, ears: int, *given: Array) -> tuple[Array, ...]:
    """The kernel for environments (e ...); see `read_operands`."""
    source, filtered, _, way, share = given
    channels, count = share.shape[3], times(config).shape[0]
    sizes = (*source.shape[1:], filtered.shape[3], way.shape[2], ears, channels, shapes, count)
    taps = windowed_sinc(np.arange(-HALF_WIDTH, HALF_WIDTH) + 0.5).tolist()
    rate = config.sample_rate / config.speed_of_sound
    tables = cuda.numbers(taps, jnp.float32), cuda.numbers([rate], jnp.float32)
    operands = (*given, *tables, cuda.numbers((*sizes, config.frame, before(config))))
    result = jax.ShapeDtypeStruct((source.shape[0], channels, shapes, count), jnp.float32)
    ptx, grid = cuda.ptx_of(cuda.SUMS_SOURCES, 0), (source.shape[0], 1)
    return cuda.call_kernel("add_paths", ptx, grid, SUMS_THREADS, _sums_bytes(*given), operands, result)


def _sums_bytes(source: Array, filtered: Array, _: Array, way: Array, share: Array) -> int:
    """Memory that a block needs: half samples, paths, and shares."""
    halves = 2 * (filtered[0, 0].size + source.shape[2])
    return 4 * (halves + way[0, 0].size + share[0, 0].size + 2 * HALF_WIDTH + way.shape[2])


def _filter_by_xla(
    sums: Float[Array, "e s k"], kernels: Float[np.ndarray, "s t"], begin: int, frame: int
) -> Float[Array, "e m"]:
    size = sums.shape[-1]
    spectra = jnp.asarray(np.fft.rfft(kernels, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    return jnp.fft.irfft(whole, size)[:, begin : begin + frame]


def _filter_sums(
    sums: Float[Array, "e s k"], kernels: Float[np.ndarray, "s t"], begin: int, frame: int
) -> Float[Array, "e m"]:
    return _filter_op(begin, frame)(*filter_tables(kernels, sums.shape[-1]), sums[None])[0][0]


def filter_tables(
    kernels: Float[np.ndarray, "s t"], count: int
) -> tuple[Float[Array, "s size two"], Float[Array, "size two"]]:
    """Spectra of filters, and the turns of the transform that is made of so many samples."""
    size = cuda.transform_size(count)
    assert size is not None
    return cuda.as_pairs(np.fft.fft(kernels.astype(np.float64), size) / size), cuda.turns_of(size)


@functools.cache
def _filter_op(begin: int, frame: int) -> Callable[..., tuple[Array, ...]]:
    return batched(functools.partial(run_filter, begin, frame), 2, 1)


def run_filter(begin: int, frame: int, *given: Array) -> tuple[Array, ...]:
    """The kernel for sums of environments (e ...), the last operand; all share the tables before it."""
    spectra, turns, sums = given
    envs, channels, shapes, count = sums.shape
    size = turns.shape[0]
    operands = sums, spectra, turns, cuda.numbers((channels, shapes, count, begin, frame))
    result = jax.ShapeDtypeStruct((envs, channels, frame), jnp.float32)
    ptx, grid, threads = cuda.ptx_of(cuda.FILTER_SOURCES, size), (envs, -(-channels // 2)), size // cuda.PER_THREAD
    return cuda.call_kernel("filter_sums", ptx, grid, threads, filter_bytes(size), operands, result)


def filter_bytes(size: int) -> int:
    """Memory that a block needs for a transform and its table."""
    return cuda.values_bytes(size) + 8 * size
