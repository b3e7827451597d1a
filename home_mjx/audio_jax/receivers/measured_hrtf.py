"""Measured heads: responses of two ears at scattered directions, resampled to a table over a regular grid.

Each response is split into a delay and a delay-free filter, because these vary smoothly with direction and delayed
responses do not. Both are interpolated on the host to the nodes of the grid, and inside `jit` between nodes.
"""

import math

import jax.numpy as jnp
import numpy as np
from jaxtyping import Complex, Float

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import MeasuredHead
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.audio_jax.receivers.direction_grid import grid_weights, interpolate_to_grid, node_areas
from home_mjx.audio_jax.receivers.spherical_head import basis_responses, ear_table, fit_basis_weights
from home_mjx.core.checks import check_known
from home_mjx.errors import ConfigError

PHASES, LEVELS = ("minimum", "measured"), ("file", "sphere")
PRE_DELAY_SECONDS = 1e-4  # [s], time before the extracted delay that filters with measured phase retain
DIRECTIONS_PER_CHUNK = 64  # directions processed at once, which bounds memory
MAX_EAR_DELAY = 1e-3  # [s], maximum arrival-time offset of an ear from the head centre
ENERGY_TRANSFORM_SIZE = 1024  # samples of the transform whose frequencies energies are averaged over
LEVEL_BAND_INDEX = 2  # index of the 500 Hz octave, in which heads have about the level of a sphere
MIN_RELATIVE_AMPLITUDE = 1e-5  # minimum amplitude of a spectrum re its maximum, before the logarithm
DELAY_OVERSAMPLING = 8  # oversampling factor of the search for delays


def make_measured_head(
    direction: Float[np.ndarray, "m 3"],
    response: Float[np.ndarray, "m 2 n"],
    rate: float,
    config: AudioConfig,
    delay: Float[np.ndarray, "m 2"] | None = None,
    phase: str = "minimum",
    level: str = "file",
) -> MeasuredHead:
    """Make a head from impulse responses of two ears at one distance, re the free field at the head centre.

    Delays maximize the cross-correlation of responses with their minimum-phase parts, as in Nam, Abel and Smith (A
    method for estimating interaural time difference for binaural synthesis, 125th AES Convention, 2008). Their mean
    over all directions and both ears defines the head centre.

    Args:
        direction: Unit vectors to the sources, in the head frame: +x right, +y up, looking along -z.
        response: Impulse responses of the left and right ear.
        rate: Sample rate of the responses [Hz].
        config: Options of the simulation that will use the head.
        delay: Additional delay of each response [s]; None: 0.
        phase: "minimum": delay and minimum-phase filter of each response. "measured": its measured phase.
        level: "file": levels as measured. "sphere": scaled so that the mean energy of the 500 Hz octave over all
            directions is that of a rigid sphere.

    Raises:
        ConfigError: `level` is "sphere" and the receiver is not `Binaural`. Responses are not finite, silent, or of too
            low a sample rate. Directions are not unit vectors, too few, or in one plane. A delay exceeds the size of a
            head.

    Example:
        >>> head = make_measured_head(direction, response, 44_100, AudioConfig())  # doctest: +SKIP
        >>> Listener(ears, quat, head=head)  # doctest: +SKIP
    """
    check_known("phase", [phase], PHASES)
    check_known("level", [level], LEVELS)
    _check_responses(direction, response, rate, config)
    share = grid_weights(direction)
    wanted, _ = basis_responses(config.sample_rate)
    fine = np.minimum(np.fft.rfftfreq(ENERGY_TRANSFORM_SIZE, 1 / config.sample_rate), rate / 2)
    parts = [
        _split_delays(response[i : i + DIRECTIONS_PER_CHUNK], rate, wanted, fine, config, phase)
        for i in range(0, len(response), DIRECTIONS_PER_CHUNK)
    ]
    late, filters, energy = (np.concatenate(x) for x in zip(*parts, strict=True))
    late = interpolate_to_grid(share, late if delay is None else late + delay)
    late -= np.average(late.mean(axis=-1), weights=node_areas())
    if np.abs(late).max() + PRE_DELAY_SECONDS > MAX_EAR_DELAY:
        text = f"sound arrives at an ear {1000 * np.abs(late).max():.2f} ms from the head centre"
        raise ConfigError(
            text, hint=f"Expected at most {1000 * MAX_EAR_DELAY:.0f} ms; are the responses aligned in time?"
        )
    gain, energy = 1.0, interpolate_to_grid(share, energy)
    if level == "sphere":
        gain = math.sqrt(
            _sphere_level(config) / np.average(energy.mean(axis=2)[..., LEVEL_BAND_INDEX], weights=node_areas())
        )
    value = gain * _fit_basis(interpolate_to_grid(share, filters), config.sample_rate)
    begin = late - PRE_DELAY_SECONDS if phase == "measured" else late
    delay, real, imag, energy = (jnp.asarray(x, jnp.float32) for x in (begin, value.real, value.imag, gain**2 * energy))
    return MeasuredHead(delay, real, imag, energy, sample_rate=config.sample_rate)


def _check_responses(direction: np.ndarray, response: np.ndarray, rate: float, config: AudioConfig) -> None:
    """Raise `ConfigError` if a response is silent or not finite, or a direction is not a unit vector.

    Do so as well if half of `rate` [Hz] is below 0.45 of the simulation's sample rate.
    """
    if not np.isfinite(response).all():
        raise ConfigError("responses of a head must be finite")
    if not np.any(response, axis=-1).all():
        where = np.argwhere(~np.any(response, axis=-1))[0]
        raise ConfigError(f"response {where[0]} of the {('left', 'right')[where[1]]} ear is silent")
    if not 0.45 * config.sample_rate <= rate / 2 < math.inf:
        text = f"responses of {rate:g} Hz do not cover the frequencies of sound of {config.sample_rate} Hz"
        raise ConfigError(text, hint="Use a lower `sample_rate`, or a head measured at a higher one.")
    length = np.linalg.norm(direction, axis=1)
    if not np.allclose(length, 1, atol=1e-3):
        raise ConfigError("directions of a head must be unit vectors")


def _sphere_level(config: AudioConfig) -> float:
    """Compute the mean energy gain at an ear of the rigid sphere in the 500 Hz octave over all directions."""
    table = ear_table(ENERGY_TRANSFORM_SIZE, config.sample_rate, config.binaural.head_radius, config.speed_of_sound)
    return float(
        np.average(table.energy[:, LEVEL_BAND_INDEX], weights=np.sin(np.linspace(0, np.pi, len(table.energy))))
    )


def _split_delays(
    response: Float[np.ndarray, "m 2 n"],
    rate: float,
    wanted: Float[np.ndarray, " f"],
    fine: Float[np.ndarray, " k"],
    config: AudioConfig,
    phase: str,
) -> tuple[Float[np.ndarray, "m 2"], Complex[np.ndarray, "m 2 f"], Float[np.ndarray, "m 2 bands"]]:
    """Separate head-related impulse responses into delays, re their minimum-phase parts, and filters.

    Args:
        response: Responses of m directions and two ears.
        rate: Sample rate of the responses [Hz].
        wanted: Frequencies of the filters [Hz].
        fine: Frequencies at which octave energies are averaged [Hz].
        config: Options.
        phase: "minimum" for minimum-phase filters, "measured" to retain the phase after the delay is removed.

    Returns:
        Delays [s], spectra of the filters at `wanted`, and mean energies per octave. With "measured", the filters are
        `PRE_DELAY_SECONDS` late.
    """
    least = minimum_phase(response)
    late = estimate_delays(response, least) / rate
    whole = response_spectra(response, rate, fine)
    gains = octave_gains(np.fft.rfftfreq(ENERGY_TRANSFORM_SIZE, 1 / config.sample_rate))
    energy = np.abs(whole) ** 2 @ gains.T / np.maximum(gains.sum(axis=1), 1e-9)
    if phase == "minimum":
        # Reflecting zeros into the unit circle keeps their number: the minimum-phase filter has the response's length.
        return late, response_spectra(least[..., : response.shape[-1]], rate, wanted), energy
    turn = np.exp(2j * np.pi * (late - PRE_DELAY_SECONDS)[..., None] * wanted)
    return late, response_spectra(response, rate, wanted) * turn, energy


def _fit_basis(wanted: Complex[np.ndarray, "v h 2 f"], sample_rate: int) -> Complex[np.ndarray, "v h 2 s"]:
    """Fit sums of `filter_basis` to filters at the frequencies of `basis_responses`; return values at the knots."""
    table, (_, response) = filter_basis(sample_rate), basis_responses(sample_rate)
    rows = [fit_basis_weights(response, row.reshape(-1, row.shape[-1])) @ table.value for row in wanted]
    return np.stack(rows).reshape(*wanted.shape[:3], -1)


def minimum_phase(response: Float[np.ndarray, "*m n"]) -> Float[np.ndarray, "*m s"]:
    """Compute minimum-phase responses with the same magnitude spectra, by folding the cepstrum.

    Magnitudes are at least `MIN_RELATIVE_AMPLITUDE` re their maximum. The length s is a power of two, at least 8 n.
    """
    size = 2 ** math.ceil(math.log2(8 * response.shape[-1]))
    amplitude = np.abs(np.fft.rfft(response, size))
    level = np.log(np.maximum(amplitude, MIN_RELATIVE_AMPLITUDE * amplitude.max(axis=-1, keepdims=True)))
    fold = np.r_[1.0, np.full(size // 2 - 1, 2.0), 1.0, np.zeros(size // 2 - 1)]
    return np.fft.irfft(np.exp(np.fft.rfft(np.fft.irfft(level, size) * fold)), size)


def estimate_delays(response: Float[np.ndarray, "*m n"], least: Float[np.ndarray, "*m s"]) -> Float[np.ndarray, "*m"]:
    """Estimate delays of responses re `least` [samples], possibly negative, at the maxima of their cross-correlations.

    These are oversampled by `DELAY_OVERSAMPLING` and interpolated by a parabola at the maximum.
    """
    size = least.shape[-1]
    cross = np.fft.rfft(response, size) * np.conj(np.fft.rfft(least))
    alike = np.fft.irfft(cross, DELAY_OVERSAMPLING * size)
    peak = np.argmax(alike, axis=-1)[..., None]
    before, here, after = (
        np.take_along_axis(alike, (peak + i) % (DELAY_OVERSAMPLING * size), axis=-1)[..., 0] for i in (-1, 0, 1)
    )
    place = peak[..., 0] + (before - after) / np.minimum(2 * (before - 2 * here + after), -1e-30)
    place = np.where(place > DELAY_OVERSAMPLING * size / 2, place - DELAY_OVERSAMPLING * size, place)
    return place / DELAY_OVERSAMPLING


def response_spectra(
    response: Float[np.ndarray, "*m n"], rate: float, frequency: Float[np.ndarray, " f"]
) -> Complex[np.ndarray, "*m f"]:
    """Evaluate spectra of responses, which begin at time 0 with `rate` [Hz], at `frequency` [Hz]."""
    turn = 2 * np.pi * np.outer(np.arange(response.shape[-1]) / rate, frequency)
    rows = response.reshape(-1, response.shape[-1])
    return (rows @ np.cos(turn) - 1j * (rows @ np.sin(turn))).reshape(*response.shape[:-1], -1)
