"""Acoustic state of a receiver at one instant, split into the parts that frames interpolate separately."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.audio_jax.auralization.response import direct_onset, late_energy
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.base.options import Ambisonics
from home_mjx.audio_jax.kernels.late_tail import LateResponse, tail_gains
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.paths import Paths
from home_mjx.audio_jax.receivers.diffuse_noise import NoiseDraw, draw_noise, num_noises
from home_mjx.audio_jax.receivers.noise_gains import noise_gains
from home_mjx.core.pytree import Pytree
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

MIN_DECAY_RATIO = 1e-3  # energy ratio, -30 dB


class ReceiverState(Pytree):
    """Early paths and late energy from one source to one receiver."""

    paths: Paths
    quat: Float[Array, "4"]  # of the head, wxyz
    energy: Float[Array, "k e bands"]  # late energy per time bin and channel, without the paths; see `late_energy`
    draw: NoiseDraw  # of the noise that renders it


def render_receiver_state(
    scene: Scene, source: SoundSource, listener: Listener, key: Array, config: AudioConfig
) -> ReceiverState:
    """Compute the parts of `impulse_response` that `render_frame` renders.

    Keep `key` while a listener moves, so that successive states are coherent.

    Returns:
        `config.num_paths` early paths, late energies and the noise draw.

    Raises:
        ConfigError: As of `impulse_response`.

    Example:
        >>> heard = render_receiver_state(
        ...     scene, SoundSource(radio), Listener(ears, quat), jax.random.key(0), config
        ... )  # doctest: +SKIP
        >>> heard.energy.shape  # doctest: +SKIP
        (125, 2, 7)
    """
    trace_key, noise_key = jax.random.split(key)
    paths = early_paths(scene, source, listener, config)
    energy = late_energy(scene, source, listener, trace_key, config)
    return pack_receiver_state(paths, energy, listener.quat, noise_key, config)


def pack_receiver_state(
    paths: Paths, energy: Float[Array, "k e bands"], head_quat: Float[Array, "4"], key: Array, config: AudioConfig
) -> ReceiverState:
    """Return a state of late energies and of `config.num_paths` paths, see `pad_paths`; `key` draws the noise."""
    return ReceiverState(pad_paths(paths, config.num_paths), head_quat, energy, draw_noise(key, config))


def late_state(heard: ReceiverState, config: AudioConfig) -> LateResponse:
    """Compute the late response of a state: `NoiseGains`, the onset of direct sound, and `tail_gains`."""
    shares = noise_gains(heard.energy, heard.draw, heard.quat, config)
    return LateResponse(shares, direct_onset(heard.paths, config), tail_gains(heard.energy, config))


def silent_state(config: AudioConfig) -> ReceiverState:
    """Return a `ReceiverState` with the shapes of `config`, zero gains and energies, and path names of -1.

    Paths are 1 m long, and the head has the identity orientation.
    """
    count, bands = config.num_paths, len(BANDS)
    distance, name = jnp.ones(count, jnp.float32), jnp.full(count, -1, jnp.int32)
    ahead = jnp.broadcast_to(jnp.array([1.0, 0.0, 0.0], jnp.float32), (count, 3))
    return ReceiverState(
        paths=Paths(distance, jnp.zeros((count, bands), jnp.float32), ahead, name),
        quat=jnp.array([1.0, 0.0, 0.0, 0.0], jnp.float32),
        energy=jnp.zeros((config.num_bins, config.num_late_channels, bands), jnp.float32),
        draw=NoiseDraw(jnp.zeros((), jnp.int32), jnp.ones((num_noises(config), bands), jnp.float32)),
    )


def pad_paths(paths: Paths, count: int) -> Paths:
    """Keep the first path and the strongest others in their order, or append silent paths (name -1), to `count`.

    The strength is the sum of squared gains. Appended paths have length 1 m and direction 0. Without names, paths are
    named by index. `departure` must be None, as of `early_paths`.
    """
    more = count - paths.distance.size
    name = jnp.arange(paths.distance.size, dtype=jnp.int32) if paths.name is None else paths.name
    paths = paths.replace(name=name)
    if more <= 0:
        _, strongest = jax.lax.top_k(jnp.sum(paths.gain**2, axis=1).at[0].set(jnp.inf), count)
        kept = jnp.sort(strongest)
        return paths if more == 0 else jax.tree.map(lambda x: x[kept], paths)
    padding = [(0, more)]
    return Paths(
        distance=jnp.pad(paths.distance, padding, constant_values=1.0),
        gain=jnp.pad(paths.gain, [*padding, (0, 0)]),
        direction=jnp.pad(paths.direction, [*padding, (0, 0)]),
        name=jnp.pad(name, padding, constant_values=-1),
    )


def is_truncated(heard: ReceiverState, config: AudioConfig) -> Bool[Array, ""]:
    """Return whether energy at the response's end is within 30 dB of its loudest bin or path, for white noise.

    Energies are summed over channels. With a tail, only the end of the tail counts. The result is False in silence.
    """
    share = jnp.asarray(white_noise_band_shares(config))
    energy = heard.energy[:, : config.num_channels]
    bins = jnp.sum(energy @ share, axis=1)
    # Energy of a path summed over channels: in ambisonics W has all of it, and Y, Z and X together have it once more.
    times = 2 if isinstance(config.receiver, Ambisonics) else config.num_channels
    loudest = jnp.maximum(jnp.max(bins), times * jnp.max(heard.paths.gain**2 @ share))
    if config.num_tail_repeats == 0:
        return bins[-1] > MIN_DECAY_RATIO * loudest
    last = jnp.sum(energy[-1], axis=0) * tail_gains(heard.energy, config)[-1] ** 2
    return last @ share > MIN_DECAY_RATIO * loudest


@functools.cache
def white_noise_band_shares(config: AudioConfig) -> Float[np.ndarray, " bands"]:
    """Compute the share of white noise's energy in each octave; 0 above half the sample rate."""
    return octave_gains(np.linspace(0, config.sample_rate / 2, 4001)).mean(axis=1).astype(np.float32)
