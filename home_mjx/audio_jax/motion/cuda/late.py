"""Late sound of moving frames: a kernel on GPUs, XLA elsewhere."""

import functools
from collections.abc import Callable

import jax
import jax.numpy as jnp
from jaxtyping import Array, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.motion.cuda import kernels as cuda
from home_mjx.audio_jax.motion.tail import frame_begin, frame_by_xla, octave_table, window_width
from home_mjx.core.native.batched import batched
from home_mjx.schema.compiled import BANDS


def late_frame(
    sources: Float[Array, "n w"], late: Float[Array, "n 2 e l"], tail: Float[Array, "n 2 m bands"], config: AudioConfig
) -> Float[Array, "e s"]:
    """`tail.frame_by_xla`, by the kernel where there is one and its memory suffices. Arguments as there."""
    slow = functools.partial(frame_by_xla, config=config)
    size = cuda.transform_size(window_width(config))
    if not cuda.cuda_available() or size is None or _bytes(size) > cuda.shared_bytes():
        return slow(sources, late, tail)
    return cuda.chosen(slow, functools.partial(_late_frame, config=config))(sources, late, tail)


def _late_frame(sources: Array, late: Array, tail: Array, config: AudioConfig) -> Float[Array, "e s"]:
    return _op(config)(*late_tables(config), *(x[None] for x in (sources, late, tail)))[0][0]


def late_tables(config: AudioConfig) -> tuple[Float[Array, "bands f"], Float[Array, "size two"]]:
    """Gains of octaves, and the turns of the transform."""
    size = cuda.transform_size(window_width(config))
    assert size is not None
    gains = octave_table(config, size) if config.num_tail else jnp.zeros((len(BANDS), size // 2 + 1), jnp.float32)
    return jnp.asarray(gains), cuda.turns_of(size)


@functools.cache
def _op(config: AudioConfig) -> Callable[..., tuple[Array, ...]]:
    return batched(functools.partial(run_late, config), 2, 1)


def run_late(config: AudioConfig, *given: Array) -> tuple[Array, ...]:
    """The kernel for environments (e ...), whose first two operands all share; see `late_tables`."""
    octaves, turns, sources, late, tail = given
    (envs, count, length), channels, size = sources.shape, late.shape[3], turns.shape[0]
    first, half = config.response_length - config.half_length, config.half_length
    start = config.memory_length - first - config.tail_ringing
    sizes = (count, length, channels, config.response_length, first, half, config.num_tail, start)
    sizes = (*sizes, window_width(config), frame_begin(config), config.frame)
    operands = sources, late, tail, octaves, turns, cuda.numbers(sizes)
    result = jax.ShapeDtypeStruct((envs, channels, config.frame), jnp.float32)
    ptx, grid, threads = cuda.ptx_of(cuda.LATE_SOURCES, size), (envs, -(-channels // 2)), size // cuda.PER_THREAD
    return cuda.call_kernel("late_frames", ptx, grid, threads, _bytes(size), operands, result)


def _bytes(size: int) -> int:
    """Memory that a block needs: a transform, and three spectra of real signals."""
    return cuda.values_bytes(size) + 3 * 8 * (size // 2 + 1)
