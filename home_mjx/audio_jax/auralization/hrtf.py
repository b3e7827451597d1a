"""Ears on a rigid sphere: what a head does to sound from each direction.

The head frame is MuJoCo's camera frame: +x right, +y up, looking along -z. An `EarTable` holds the response of one ear
over the angle between the source and the ear's axis; a measured set would be a second maker of such tables over
directions, and `ear_spectrum` its only reader.
"""

import functools
import math
from typing import NamedTuple

import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float
from scipy.special import eval_legendre, spherical_jn, spherical_yn

from home_mjx.audio_jax.base.delays import HALF_WIDTH, WIDTH, windowed_sinc
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.core.transforms import quat_matrix

NUM_ANGLES = 181  # every degree
FINER = 4  # times the sample rate, at which the head's response has next to nothing left to ring with
EAR_SECONDS = 0.007  # after which a sphere no longer answers at all
EAR_WIDTH = WIDTH + 24  # of an ear's kernel [samples]: within 0.2 % of the series up to 7 kHz
ENDING = 21  # [samples], in which kernels fade out
PHASES = 16  # per sample, between which kernels are interpolated: within 2e-3 of each other
KERNEL_ANGLES = 369  # about every half degree; few round angles lie in the middle between two


class EarTable(NamedTuple):
    """Response of one ear re the free field at the head's centre, by angle between the source and the ear's axis."""

    spectrum: Complex[np.ndarray, "a f"]  # without its delay
    delay: Float[np.ndarray, " a"]  # [s]; negative on the source's side
    energy: Float[np.ndarray, "a bands"]  # mean |spectrum|² per octave


def sphere_spectrum(
    frequency: Float[np.ndarray, " f"], angle: Float[np.ndarray, " a"], radius: float, speed: float
) -> Complex[np.ndarray, "a f"]:
    """Pressure on a rigid sphere in a plane wave, re the free field at its centre.

    The series of Rayleigh for a distant source, as in Duda and Martens, Range dependence of the response of a spherical
    head model, JASA 104 (1998): H = i / μ² Σ (-i)^m (2m + 1) P_m(cos θ) / h'_m(μ), μ = 2 π f a / c, conjugated for the
    time convention exp(+iωt) of FFTs.

    Args:
        frequency: [Hz].
        angle: Between the direction of the source and the point on the sphere [rad].
        radius: [m].
        speed: Speed of sound [m/s].

    Returns:
        Complex gains.
    """
    mu = np.maximum(2 * np.pi * frequency * radius / speed, 1e-3)
    order = np.arange(int(mu.max() * 1.2) + 20)
    legendre = np.array([eval_legendre(m, np.cos(angle)) for m in order])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        hankel = np.array([spherical_jn(m, mu, True) + 1j * spherical_yn(m, mu, True) for m in order])
        terms = np.nan_to_num((-1j) ** (order % 4)[:, None] * (2 * order + 1)[:, None] / hankel)
    return np.conj(1j / mu**2 * (legendre.T @ terms))


def sphere_delay(angle: Float[np.ndarray, " a"], radius: float, speed: float) -> Float[np.ndarray, " a"]:
    """Arrival time at a point on a sphere re its centre [s], by Woodworth: straight, then along the surface."""
    return radius / speed * np.where(angle < np.pi / 2, -np.cos(angle), angle - np.pi / 2)


def diffuse_coherence(
    frequency: Float[np.ndarray, " f"], angle: float, radius: float, speed: float
) -> Float[np.ndarray, " f"]:
    """Coherence of the pressures at two points of a rigid sphere in a diffuse field.

    Both are sums over all directions of what `sphere_spectrum` gives, so by the addition theorem of Legendre's
    polynomials it is Σ w_m P_m(cos angle) / Σ w_m, w_m = (2m + 1) / |h'_m(μ)|²; real for any two points.

    Args:
        frequency: [Hz].
        angle: Between the two points, seen from the middle [rad].
        radius: [m].
        speed: Speed of sound [m/s].

    Example:
        >>> diffuse_coherence(np.array([20.0, 500.0]), np.pi, 0.0875, 343.2).round(2).tolist()
        [1.0, 0.18]
    """
    mu = np.maximum(2 * np.pi * frequency * radius / speed, 1e-3)
    order = np.arange(int(mu.max() * 1.2) + 20)
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        size = np.array([spherical_jn(m, mu, True) ** 2 + spherical_yn(m, mu, True) ** 2 for m in order])
        weight = np.nan_to_num((2 * order + 1)[:, None] / size)
    legendre = np.array([eval_legendre(m, np.cos(angle)) for m in order])
    return legendre @ weight / weight.sum(axis=0)


@functools.cache
def ear_table(taps: int, sample_rate: int, radius: float, speed: float) -> EarTable:
    """The table of a spherical head.

    Args:
        taps: Samples of the kernels that will use it.
        sample_rate: [Hz].
        radius: [m].
        speed: Speed of sound [m/s].
    """
    frequency = np.fft.rfftfreq(taps, 1 / sample_rate)
    angle = np.linspace(0, np.pi, NUM_ANGLES)
    delay = sphere_delay(angle, radius, speed)
    spectrum = sphere_spectrum(frequency, angle, radius, speed)
    gains = octave_gains(frequency)
    energy = np.abs(spectrum) ** 2 @ gains.T / np.maximum(gains.sum(axis=1), 1e-9)
    aligned = spectrum * np.exp(2j * np.pi * delay[:, None] * frequency)
    return EarTable(aligned.astype(np.complex64), delay.astype(np.float32), energy.astype(np.float32))


def ear_kernel(
    table: Float[np.ndarray, "a d two t"], angle: Float[Array, "*n"], delay: Float[Array, "*n"]
) -> Float[Array, "*n t"]:
    """Response of an ear to a pulse that comes a fraction of a sample late, in its delay of 0 .. 2 samples.

    Args:
        table: From `ear_kernels`; of its angles the nearest one is taken.
        angle: Between the source and the ear's axis [rad].
        delay: [samples].

    Returns:
        Taps from -HALF_WIDTH + 1 samples on.
    """
    angles, delays = table.shape[:2]
    nearest = jnp.clip(jnp.round(angle * jnp.float32((angles - 1) / math.pi)).astype(jnp.int32), 0, angles - 1)
    position = delay * PHASES
    low = jnp.clip(jnp.floor(position), 0, delays - 1)
    rows = jnp.asarray(table).reshape(angles * delays, *table.shape[2:])[nearest * delays + low.astype(jnp.int32)]
    return rows[..., 0, :] + (position - low)[..., None] * rows[..., 1, :]


@functools.cache
def ear_kernels(sample_rate: int, radius: float, speed: float) -> Float[np.ndarray, "a d two t"]:
    """Impulse responses of one ear for each angle and each delay of 0 .. 2 samples, and what leads to the next delay.

    The series is summed up to `FINER` times the sample rate and then limited in band by a short filter, so that nothing
    rings for longer than that before the sound comes.

    Args:
        sample_rate: [Hz].
        radius: [m].
        speed: Speed of sound [m/s].
    """
    last = round(EAR_SECONDS * sample_rate)
    size = 4 * FINER * (HALF_WIDTH + last)
    angle = np.linspace(0, np.pi, KERNEL_ANGLES)
    frequency = np.fft.rfftfreq(size, 1 / (FINER * sample_rate))
    ahead = sphere_delay(angle, radius, speed)[:, None]
    aligned = sphere_spectrum(frequency, angle, radius, speed) * np.exp(2j * np.pi * ahead * frequency)
    place = np.arange(size) / FINER
    low_pass = np.fft.rfft(windowed_sinc(np.minimum(place, size / FINER - place)))
    finer = PHASES // FINER
    fine = np.fft.irfft(aligned * low_pass, size * finer) * finer
    tap, delay = np.arange(EAR_WIDTH) - HALF_WIDTH + 1, np.arange(2 * PHASES + 1)[:, None]
    left = EAR_WIDTH - HALF_WIDTH - (tap - delay / PHASES)  # samples until it ends
    kernel = fine[:, (PHASES * tap - delay) % fine.shape[1]] * np.sin(np.pi / 2 * np.clip(left / ENDING, 0, 1)) ** 2
    return np.stack([kernel[:, :-1], np.diff(kernel, axis=1)], axis=2).astype(np.float32)


def to_head(direction: Float[Array, "n 3"], quat: Float[Array, "4"]) -> Float[Array, "n 3"]:
    """World directions in the frame of a head whose orientation is `quat` (wxyz)."""
    return jnp.matmul(direction, quat_matrix(quat), precision="highest")  # the transpose turns back


def ear_angles(direction: Float[Array, "n 3"], ear_angle: float) -> Float[Array, "n 2"]:
    """Angle between each direction in the head frame and the axis of the left and right ear [rad]."""
    side, back = math.sin(math.radians(ear_angle)), -math.cos(math.radians(ear_angle))
    ears = jnp.array([[-side, 0.0, back], [side, 0.0, back]], jnp.float32)
    return jnp.arccos(jnp.clip(jnp.matmul(direction, ears.T, precision="highest"), -1.0, 1.0))


def ear_spectrum(table: EarTable, angle: Float[Array, "*n"]) -> tuple[Complex[Array, "*n f"], Float[Array, "*n"]]:
    """Spectrum without delay, and delay [s], of the ear for each angle, between the two nearest entries."""
    return _interpolate(table.spectrum, angle), _interpolate(table.delay, angle)


def ear_energy(table: EarTable, angle: Float[Array, "*n"]) -> Float[Array, "*n bands"]:
    """Energy gain of the ear per octave for each angle."""
    return _interpolate(table.energy, angle)


def _interpolate(rows: np.ndarray, angle: Float[Array, "*n"]) -> Array:
    position = angle * jnp.float32((NUM_ANGLES - 1) / math.pi)
    low = jnp.clip(position.astype(jnp.int32), 0, NUM_ANGLES - 2)
    rest = (position - low.astype(jnp.float32)).reshape(angle.shape + (1,) * (rows.ndim - 1)).astype(rows.dtype)
    table = jnp.asarray(rows)
    return table[low] * (1 - rest) + table[low + 1] * rest
