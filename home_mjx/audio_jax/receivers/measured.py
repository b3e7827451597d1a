"""Heads from measurements: what two ears hear from scattered directions becomes a table over all of them.

Each response is split into a delay and a filter without it. Both run evenly from direction to direction, as responses
with their delays do not; so they are what is interpolated: on the host between the measured directions, to the nodes
of an even grid, and inside `jit` between these.
"""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Complex, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Head
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.base.shapes import shapes
from home_mjx.audio_jax.receivers.aligned import lags, minimum_phase, spectrum
from home_mjx.audio_jax.receivers.grid import areas, grid_weights, mixed
from home_mjx.audio_jax.receivers.hrtf import ear_table, nearest_sums, shape_responses
from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError

PHASES, LEVELS = ("minimum", "measured"), ("file", "sphere")
MARGIN = 1e-4  # [s], by which measured filters begin before the delay that is split off
CHUNK = 64  # directions that are handled at once
LATEST = 1e-3  # [s]: no ear hears sound by more earlier or later than the middle of the head
ENERGY_SIZE = 1024  # samples, whose frequencies energies are means of
LEVEL_BAND = 2  # the octave of 500 Hz, in which heads are about as loud as a sphere


def measured_head(
    direction: Float[np.ndarray, "m 3"],
    response: Float[np.ndarray, "m 2 n"],
    rate: float,
    config: AudioConfig,
    delay: Float[np.ndarray, "m 2"] | None = None,
    phase: str = "minimum",
    level: str = "file",
) -> Head:
    """A head from impulse responses of its two ears, all at one distance, re the free field at the head's middle.

    Delays are those that make responses most alike to their minimum-phase parts, as in Nam, Abel and Smith (A method
    for estimating interaural time difference for binaural synthesis, 125th AES Convention, 2008); their mean over all
    directions and both ears is the middle of the head.

    Args:
        direction: Unit vectors to the sources, in the frame of the head: +x right, +y up, looking along -z.
        response: Of the left and right ear.
        rate: Sample rate of the responses [Hz].
        config: The options with which it will be heard.
        delay: By which responses begin later than they are written [s].
        phase: "minimum": of each response its delay and the filter of least phase. "measured": with its own phase.
        level: "file": as it is. "sphere": in the octave of 500 Hz, mean of all directions, as loud as a rigid sphere.

    Raises:
        ConfigError: The responses are no finite numbers or silent, too few or in one plane, of too low a sample rate,
            or their ears hear sound at times at which no head does.

    Example:
        >>> head = measured_head(direction, response, 44_100, AudioConfig())  # doctest: +SKIP
        >>> Listener(ears, quat, head=head)  # doctest: +SKIP
    """
    check_known("phase", [phase], PHASES)
    check_known("level", [level], LEVELS)
    _check(direction, response, rate, config)
    share = grid_weights(direction)
    wanted, _ = shape_responses(config.sample_rate)
    fine = np.minimum(np.fft.rfftfreq(ENERGY_SIZE, 1 / config.sample_rate), rate / 2)
    parts = [_split(response[i : i + CHUNK], rate, wanted, fine, config, phase) for i in range(0, len(response), CHUNK)]
    late, filters, energy = (np.concatenate(x) for x in zip(*parts, strict=True))
    late = mixed(share, late if delay is None else late + delay)
    late -= np.average(late.mean(axis=-1), weights=areas())
    if np.abs(late).max() + MARGIN > LATEST:
        text = f"an ear hears sound {1000 * np.abs(late).max():.2f} ms from the middle of the head"
        raise ConfigError(text, hint=f"No head is wider than {1000 * LATEST:.0f} ms; are responses aligned in time?")
    gain, energy = 1.0, mixed(share, energy)
    if level == "sphere":
        gain = math.sqrt(_sphere_level(config) / np.average(energy.mean(axis=2)[..., LEVEL_BAND], weights=areas()))
    value = gain * _fitted(mixed(share, filters), config.sample_rate)
    begin = late - MARGIN if phase == "measured" else late
    delay, real, imag, energy = (jnp.asarray(x, jnp.float32) for x in (begin, value.real, value.imag, gain**2 * energy))
    return Head(delay, real, imag, energy, sample_rate=config.sample_rate)


def _check(direction: np.ndarray, response: np.ndarray, rate: float, config: AudioConfig) -> None:
    if not np.isfinite(response).all():
        raise ConfigError("responses of a head must be finite")
    if not np.any(response, axis=-1).all():
        where = np.argwhere(~np.any(response, axis=-1))[0]
        raise ConfigError(f"response {where[0]} of the {('left', 'right')[where[1]]} ear is silent")
    if not 0.45 * config.sample_rate <= rate / 2 < math.inf:
        text = f"responses of {rate:g} Hz have nothing for sound of {config.sample_rate} Hz"
        raise ConfigError(text, hint="Take a lower `sample_rate`, or a head that was measured at a higher one.")
    length = np.linalg.norm(direction, axis=1)
    if not np.allclose(length, 1, atol=1e-3):
        raise ConfigError("directions of a head must be unit vectors")


def _sphere_level(config: AudioConfig) -> float:
    """Mean energy of a rigid sphere in the octave of 500 Hz over all directions."""
    table = ear_table(ENERGY_SIZE, config.sample_rate, config.head_radius, config.speed_of_sound)
    return float(np.average(table.energy[:, LEVEL_BAND], weights=np.sin(np.linspace(0, np.pi, len(table.energy)))))


def _split(
    response: Float[np.ndarray, "m 2 n"],
    rate: float,
    wanted: Float[np.ndarray, " f"],
    fine: Float[np.ndarray, " k"],
    config: AudioConfig,
    phase: str,
) -> tuple[Float[np.ndarray, "m 2"], Complex[np.ndarray, "m 2 f"], Float[np.ndarray, "m 2 bands"]]:
    """Delays [s], filters without them, and energies per octave."""
    least = minimum_phase(response)
    late = lags(response, least) / rate
    whole = spectrum(response, rate, fine)
    gains = octave_gains(np.fft.rfftfreq(ENERGY_SIZE, 1 / config.sample_rate))
    energy = np.abs(whole) ** 2 @ gains.T / np.maximum(gains.sum(axis=1), 1e-9)
    if phase == "minimum":
        # Mirrored zeros are as many: the filter of least phase is no longer than the response.
        return late, spectrum(least[..., : response.shape[-1]], rate, wanted), energy
    turn = np.exp(2j * np.pi * (late - MARGIN)[..., None] * wanted)
    return late, spectrum(response, rate, wanted) * turn, energy


def _fitted(wanted: Complex[np.ndarray, "v h 2 f"], sample_rate: int) -> Complex[np.ndarray, "v h 2 s"]:
    """Sums of `shapes` that are nearest to filters: their values at the frequencies of these."""
    table, (_, response) = shapes(sample_rate), shape_responses(sample_rate)
    rows = [nearest_sums(response, row.reshape(-1, row.shape[-1])) @ table.value for row in wanted]
    return np.stack(rows).reshape(*wanted.shape[:3], -1)
