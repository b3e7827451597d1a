"""Early sound on NVIDIA GPUs, and by XLA's own operations elsewhere; chosen by platform when a program is lowered."""

import functools
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.delays import HALF_WIDTH, windowed_sinc
from home_mjx.audio_jax.motion.reads import Reads, before, sums_of, times
from home_mjx.core.native.batched import batched
from home_mjx.core.native.platforms import PTX_TARGET, devices_of, problem_of, ptx_for_all, works
from home_mjx.core.native.varying import varying_as

FOLDER = Path(__file__).parent
SUMS_SOURCES = (FOLDER / "sums.cu",)
FILTER_SOURCES = (FOLDER / "fft.cuh", FOLDER / "filtered.cu")
SUMS, SUMS_BLOCK = 20, 768  # that a thread keeps at once, and threads, as in sums.cu
PER_THREAD, MOST_THREADS = 8, 768  # values of a transform, as in fft.cuh, and threads, as in filtered.cu
RADICES = (8, 5, 4, 3, 2)  # in the order of fft.cuh
WARP = 32
# Bytes of memory that a block may share, by compute capability; of others it is a safe guess.
SHARED_BYTES = {70: 98_304, 75: 65_536, 80: 166_912, 86: 101_376, 87: 166_912, 89: 101_376, 90: 232_448, 100: 232_448}
LEAST_SHARED_BYTES = 49_152


def add_reads(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
    """`reads.sums_of`, by the kernel where there is one and its memory suffices.

    Args:
        reads: With a leading axis of sources.
        config: Options.
    """
    slow = functools.partial(sums_of, config=config)
    if not cuda_available() or _sums_bytes(reads) > shared_bytes():
        return slow(reads)
    return _chosen(slow, functools.partial(_add_reads_cuda, config=config))(reads)


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
    slow = functools.partial(_filter_sums, kernels=kernels, begin=begin, frame=frame)
    size = transform_size(sums.shape[-1])
    if not cuda_available() or size is None or filter_bytes(size) > shared_bytes():
        return slow(sums)
    return _chosen(slow, functools.partial(_filter_sums_cuda, kernels=kernels, begin=begin, frame=frame))(sums)


@functools.cache
def cuda_available() -> bool:
    """Whether the kernels work here; warns once if there is an NVIDIA GPU and they do not."""
    return works("cuda", problem_of("cuda", _start), "moving sound is made by slower operations of XLA")


@functools.cache
def shared_bytes() -> int:
    """What a block may share on all GPUs of this process."""
    known = (
        SHARED_BYTES.get(int(x.compute_capability.replace(".", "")), LEAST_SHARED_BYTES) for x in devices_of("cuda")
    )
    return min(known, default=LEAST_SHARED_BYTES)


@functools.cache
def transform_size(count: int) -> int | None:
    """Values of the cheapest transform that holds so many and that a block can make; None if there is none."""
    block = PER_THREAD * WARP
    sizes = [size for size in range(block, PER_THREAD * MOST_THREADS + 1, block) if size >= count and _passes(size)]
    return min(sizes, key=lambda size: size * (_passes(size) + 1), default=None)


def _passes(size: int) -> int:
    """Passes of a transform; 0: it has other factors than the radices."""
    passes = 0
    for radix in RADICES:
        while size % radix == 0:
            size, passes = size // radix, passes + 1
    return passes if size == 1 else 0


def _start() -> None:
    _ptx(SUMS_SOURCES)
    _ptx(FILTER_SOURCES, PER_THREAD * WARP)


@functools.cache
def _ptx(sources: tuple[Path, ...], size: int = 0) -> str:
    """PTX that all GPUs of this process can run; `size` is that of its transforms."""
    return ptx_for_all(sources, {"SIZE": size})


def _chosen(slow: Callable[..., Array], fast: Callable[..., Array]) -> Callable[..., Array]:
    """The kernel on GPUs, `slow` elsewhere and for derivatives."""

    @jax.custom_jvp
    def run(given: Any) -> Array:
        return jax.lax.platform_dependent(given, cuda=fast, default=slow)

    @run.defjvp
    def derivative(primals: Any, tangents: Any) -> tuple[Array, Array]:
        return jax.jvp(slow, primals, tangents)

    return run


def _add_reads_cuda(reads: Reads, config: AudioConfig) -> Float[Array, "e s k"]:
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
    numbers = (_numbers(taps, jnp.float32), _numbers([rate], jnp.float32))
    numbers = (*numbers, _numbers((*sizes, config.frame, before(config)), jnp.int32))
    words = 2 * (filtered[0, 0].size + source.shape[2]) + way[0, 0].size + share[0, 0].size + len(taps) + way.shape[2]
    result = jax.ShapeDtypeStruct((source.shape[0], channels, shapes, count), jnp.float32)
    launch = _launch("add_paths", _ptx(SUMS_SOURCES), (source.shape[0], 1), SUMS_BLOCK, 4 * words)
    return varying_as(given, jax.ffi.ffi_call(PTX_TARGET, (result,))(*_plain(given), *numbers, **launch))


def filter_bytes(size: int) -> int:
    """Memory that a block needs for a transform and its table; see `place` in fft.cuh."""
    return 8 * (size + size // 8 + size)


def _sums_bytes(reads: Reads) -> int:
    """Memory that a block needs."""
    halves = 2 * (reads.filtered[0].size + reads.source[0].size)
    rows, channels, shapes = reads.share.shape[1:4]
    ways = 3 * rows + reads.ways.ears[0].size
    return 4 * (halves + ways + 2 * rows * channels * (shapes + -shapes % SUMS) + 2 * HALF_WIDTH + rows)


def _filter_sums(
    sums: Float[Array, "e s k"], kernels: Float[np.ndarray, "s t"], begin: int, frame: int
) -> Float[Array, "e m"]:
    size = sums.shape[-1]
    spectra = jnp.asarray(np.fft.rfft(kernels, size).astype(np.complex64))
    whole = jnp.sum(jnp.fft.rfft(sums, size) * spectra[None], axis=1)
    return jnp.fft.irfft(whole, size)[:, begin : begin + frame]


def _filter_sums_cuda(
    sums: Float[Array, "e s k"], kernels: Float[np.ndarray, "s t"], begin: int, frame: int
) -> Float[Array, "e m"]:
    return _filter_op(begin, frame)(*filter_tables(kernels, sums.shape[-1]), sums[None])[0][0]


def filter_tables(
    kernels: Float[np.ndarray, "s t"], count: int
) -> tuple[Float[Array, "s size two"], Float[Array, "size two"]]:
    """Spectra of filters, and the turns of the transform that is made of so many samples."""
    size = transform_size(count)
    assert size is not None
    spectra, turns = np.fft.fft(kernels.astype(np.float64), size) / size, np.exp(-2j * np.pi * np.arange(size) / size)
    return tuple(jnp.asarray(np.stack([x.real, x.imag], axis=-1), jnp.float32) for x in (spectra, turns))


@functools.cache
def _filter_op(begin: int, frame: int) -> Callable[..., tuple[Array, ...]]:
    return batched(functools.partial(run_filter, begin, frame), 2, 1)


def run_filter(begin: int, frame: int, *given: Array) -> tuple[Array, ...]:
    """The kernel for sums of environments (e ...), the last operand; all share the tables before it."""
    spectra, turns, sums = given
    envs, channels, shapes, count = sums.shape
    size = turns.shape[0]
    sizes = _numbers((channels, shapes, count, begin, frame), jnp.int32)
    result = jax.ShapeDtypeStruct((envs, channels, frame), jnp.float32)
    launch = _launch("filter_sums", _ptx(FILTER_SOURCES, size), (envs, -(-channels // 2)), size // PER_THREAD, filter_bytes(size))
    call = jax.ffi.ffi_call(PTX_TARGET, (result,))
    return varying_as(given, call(*_plain((sums, spectra, turns)), sizes, **launch))


def _plain(given: Sequence[Array]) -> tuple[Array, ...]:
    return tuple(x.astype(jnp.int32 if jnp.issubdtype(x.dtype, jnp.integer) else jnp.float32) for x in given)


def _numbers(values: Sequence[float], dtype: Any) -> Array:
    """An array made inside the program: a partitioned function may not capture arrays."""
    return jnp.concatenate([jnp.full(1, value, dtype) for value in values])


def _launch(name: str, ptx: str, grid: tuple[int, int], threads: int, shared: int) -> dict[str, Any]:
    names = "grid_x", "grid_y", "grid_z", "block_x", "block_y", "block_z", "shared_mem_bytes"
    sizes = (*grid, 1, threads, 1, 1, shared)
    numbers = {name: np.int32(size) for name, size in zip(names, sizes, strict=True)}
    return {"name": name, "kernel_type": "ptx", "kernel_data": ptx, **numbers}
