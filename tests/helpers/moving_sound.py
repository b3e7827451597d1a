"""Paths and late sound of all kinds, as moving frames are made of."""

import functools

import jax
import jax.numpy as jnp
import numpy as np

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.options import Ambisonics, Motion
from home_mjx.audio_jax.kernels import late_tail
from home_mjx.audio_jax.kernels.delay_reads import DelayReads
from home_mjx.audio_jax.kernels.direct_filter import max_path_change
from home_mjx.audio_jax.moving_sources import early
from home_mjx.audio_jax.moving_sources.path_matching import match_paths
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.receivers.diffuse_noise import num_noises
from home_mjx.audio_jax.receivers.noise_gains import NoiseGains
from home_mjx.core.variants import override_fields
from home_mjx.schema.timing import Timing

ARRAY = ((0.1, 0, 0), (0, 0.1, 0), (-0.1, 0, 0))  # [m], microphones


def moving(receiver: str, tail_seconds: float, rate: int = 16000) -> AudioConfig:
    """Options of moving sound with responses of 0.2 s for a receiver by its word; the array has three microphones."""
    options = {"positions": ARRAY} if receiver == "array" else {}
    config = AudioConfig(Timing(sample_rate=rate), response_seconds=0.2, motion=Motion(tail_seconds=tail_seconds))
    return override_fields(config, {"receiver": receiver, **options})


def some_paths(rng, count, away):
    """Paths of all directions, a few of them silent."""
    vector = rng.normal(size=(count, 3))
    gain = rng.uniform(0, 1, (count, 7)) * (rng.random((count, 1)) < 0.8)
    unit = vector / np.linalg.norm(vector, axis=1, keepdims=True)
    return Paths(*(jnp.float32(x) for x in (rng.uniform(*away, count), gain, unit)), jnp.arange(count, dtype=jnp.int32))


def moved(paths, rng):
    """The same a moment later."""
    vector = paths.distance[:, None] * paths.direction + jnp.float32(rng.normal(size=paths.direction.shape) * 0.1)
    distance = jnp.linalg.norm(vector, axis=1)
    return paths.replace(distance=distance, direction=vector / distance[:, None], gain=paths.gain * 0.9)


def some_reads(rng, sources: int, config: AudioConfig) -> DelayReads:
    """What a frame reads of several sources: near and far ones, beyond the end of a response too."""
    old = [some_paths(rng, 6, (0.3, 90.0)) for _ in range(sources)]
    new = [moved(x, rng) for x in old]
    quats = jnp.float32(rng.normal(size=(sources, 2, 4)))
    quats = quats / jnp.linalg.norm(quats, axis=-1, keepdims=True)
    past = config.memory_length - 1
    signal = jnp.float32(rng.normal(size=(sources, past + config.frame + config.num_lookahead)))
    reads = [_read(*each, config) for each in zip(signal, old, new, quats, strict=True)]
    return jax.tree.map(lambda *x: jnp.stack(x), *reads)


@functools.partial(jax.jit, static_argnums=4)
def _read(signal, old, new, quats, config: AudioConfig) -> DelayReads:
    """What a frame reads of one source."""
    pairs = match_paths(old, new, quats[0], quats[1], max_path_change(config))
    return early._source_reads(signal, config.memory_length - 1, pairs, config, None)


def some_late(rng, envs: int, sources: int, config: AudioConfig):
    """Signals and late sound of several environments and sources, with late and early onsets."""
    ends, bands = (envs, sources, 2), 7
    channels = config.num_channels
    common = channels - 1 if isinstance(config.receiver, Ambisonics) else 0
    shares = (config.num_bins, channels, bands), (channels, num_noises(config), bands), (config.num_bins, common, bands)
    power, mix, shared = (jnp.float32(rng.normal(size=(*ends, *shape))) for shape in shares)
    start = jnp.int32(rng.integers(0, config.num_bins, ends))
    sound = late_tail.LateResponse(
        shares=NoiseGains(jnp.abs(power), mix, shared, start),
        onset=jnp.int32(rng.integers(-100, config.response_length // 2, ends)),
        tail=jnp.float32(rng.uniform(0, 1, (*ends, config.num_tail_repeats, 7))),
    )
    width = config.memory_length - 1 + config.frame + config.num_lookahead
    return jnp.float32(rng.normal(size=(envs, sources, width))), sound
