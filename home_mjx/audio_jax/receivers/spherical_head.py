"""HRTFs of a rigid spherical head.

The head frame is MuJoCo's camera frame: +x right, +y up, looking along -z. An `EarTable` holds the response of one ear
over the angle between the source and the ear's axis. For measured HRTFs see `measured_hrtf.py`.
"""

import functools
import math
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Complex, Float
from scipy.special import eval_legendre, spherical_jn, spherical_yn

from home_mjx.audio_jax.base.delays import HALF_WIDTH
from home_mjx.audio_jax.base.filter_basis import filter_basis
from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.core.transforms import quat_matrix

NUM_ANGLES = 181  # one per degree
NEARNESS_KNOTS = tuple(i * 0.1 for i in range(8))  # tabulated ratios of the head's radius to the source's distance


class EarTable(NamedTuple):
    """Response of one ear re the free field at the head's centre, by angle between the source and the ear's axis."""

    spectrum: Complex[np.ndarray, "a f"]  # without its delay
    delay: Float[np.ndarray, " a"]  # [s], re the head centre; negative on the source's side
    energy: Float[np.ndarray, "a bands"]  # mean |spectrum|² per octave


def sphere_spectrum(
    frequency: Float[np.ndarray, " f"], angle: Float[np.ndarray, " a"], radius: float, speed: float
) -> Complex[np.ndarray, "a f"]:
    """Compute the complex pressure on a rigid sphere in a plane wave, re the free field at its centre.

    Rayleigh's series for a distant source is H = i / μ² Σ (-i)^m (2m + 1) P_m(cos θ) / h'_m(μ), μ = 2 π f a / c. It is
    conjugated for the time convention exp(+iωt) of FFTs. The angle θ [rad] is between the source and the point on the
    sphere; units are Hz, m and m/s. Source: Duda and Martens, Range dependence of the response of a spherical head
    model, JASA 104 (1998).
    """
    mu = np.maximum(2 * np.pi * frequency * radius / speed, 1e-3)
    order = np.arange(int(mu.max() * 1.2) + 20)
    legendre = np.array([eval_legendre(m, np.cos(angle)) for m in order])
    with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
        hankel = np.array([spherical_jn(m, mu, True) + 1j * spherical_yn(m, mu, True) for m in order])
        terms = np.nan_to_num((-1j) ** (order % 4)[:, None] * (2 * order + 1)[:, None] / hankel)
    return np.conj(1j / mu**2 * (legendre.T @ terms))


def near_sphere_spectrum(
    frequency: Float[np.ndarray, " f"], angle: Float[np.ndarray, " a"], distance: float, radius: float, speed: float
) -> Complex[np.ndarray, "a f"]:
    """Compute the complex pressure on a rigid sphere from a point source, re the free field at its centre.

    H = -(ρ / μ) exp(-i μ ρ) Σ (2m + 1) P_m(cos θ) h_m(μ ρ) / h'_m(μ) with ρ = distance / radius > 1 (Duda and Martens).
    Conjugation, angles and units are those of `sphere_spectrum`, which is its limit for large distances of the source
    from the centre.

    Example:
        >>> near, far = near_sphere_spectrum(np.array([500.0]), np.array([0.0, np.pi]), 0.25, 0.0875, 343.2)
        >>> round(float(20 * np.log10(abs(near / far))[0]), 1)  # [dB]
        10.2
    """
    if np.isinf(distance):
        return sphere_spectrum(frequency, angle, radius, speed)
    mu, rho = np.maximum(2 * np.pi * frequency * radius / speed, 1e-3), distance / radius
    total = np.zeros((angle.size, frequency.size), complex)
    # h_m(μ ρ) / h'_m(μ) falls like ρ^-m, while both factors overflow at high orders; such terms are dropped.
    for m in range(int(mu.max() * 1.2) + 60):
        with np.errstate(over="ignore", invalid="ignore", divide="ignore"):
            far = spherical_jn(m, mu * rho) + 1j * spherical_yn(m, mu * rho)
            ratio = far / (spherical_jn(m, mu, True) + 1j * spherical_yn(m, mu, True))
        last = np.where(np.isfinite(ratio), ratio, 0.0)
        total += (2 * m + 1) * np.outer(eval_legendre(m, np.cos(angle)), last)
    return np.conj(-rho / mu * np.exp(-1j * mu * rho) * total)


def sphere_delay(
    angle: Float[np.ndarray, " a"], radius: float, speed: float, distance: float = np.inf
) -> Float[np.ndarray, " a"]:
    """Compute the arrival time at a point on a sphere re its centre [s] (Woodworth: straight, then on the surface).

    `angle` [rad] is between that point and the source, at `distance` [m] from the centre; inf: a plane wave.
    """
    if np.isinf(distance):
        return radius / speed * np.where(angle < np.pi / 2, -np.cos(angle), angle - np.pi / 2)
    straight = np.sqrt(distance**2 + radius**2 - 2 * distance * radius * np.cos(angle))
    edge = np.arccos(radius / distance)
    around = np.sqrt(distance**2 - radius**2) + radius * (angle - edge)
    return (np.where(angle < edge, straight, around) - distance) / speed


def diffuse_coherence(
    frequency: Float[np.ndarray, " f"], angle: float, radius: float, speed: float
) -> Float[np.ndarray, " f"]:
    """Compute the coherence of the pressures at two points of a rigid sphere in a diffuse field.

    It is Σ w_m P_m(cos angle) / Σ w_m with w_m = (2m + 1) / |h'_m(μ)|², which is real. This follows from the addition
    theorem of Legendre polynomials for the integral of `sphere_spectrum` over all directions. The angle [rad] is
    between both points, seen from the centre; units are Hz, m and m/s.

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
    """Compute the ear table of a sphere (`radius` in m, `speed` in m/s) at the `rfft` frequencies of `taps` samples.

    Sound is a plane wave; the `NUM_ANGLES` angles are equally spaced from 0 to pi.
    """
    frequency = np.fft.rfftfreq(taps, 1 / sample_rate)
    angle = np.linspace(0, np.pi, NUM_ANGLES)
    delay = sphere_delay(angle, radius, speed)
    spectrum = sphere_spectrum(frequency, angle, radius, speed)
    gains = octave_gains(frequency)
    energy = np.abs(spectrum) ** 2 @ gains.T / np.maximum(gains.sum(axis=1), 1e-9)
    aligned = spectrum * np.exp(2j * np.pi * delay[:, None] * frequency)
    return EarTable(aligned.astype(np.complex64), delay.astype(np.float32), energy.astype(np.float32))


class EarFilters(NamedTuple):
    """Delay-free filters of one ear: values of causal filters at the knots of `filter_basis`."""

    real: Float[np.ndarray, "d a s"]  # by nearness of the source (`NEARNESS_KNOTS`), and its angle to the ear's axis
    imag: Float[np.ndarray, "d a s"]


@functools.cache
def ear_filters(sample_rate: int, radius: float, speed: float) -> EarFilters:
    """Fit sums of `filter_basis` to a sphere (`radius` in m, `speed` in m/s), from 60 Hz to 0.45 of the sample rate.

    The pressure is that of `near_sphere_spectrum` without the delay of `sphere_delay`.
    """
    table, (frequency, response) = filter_basis(sample_rate), basis_responses(sample_rate)
    angle = np.linspace(0, np.pi, NUM_ANGLES)
    weights = []
    for nearness in NEARNESS_KNOTS:
        distance = radius / nearness if nearness else np.inf
        ear = near_sphere_spectrum(frequency, angle, distance, radius, speed)
        ahead = sphere_delay(angle, radius, speed, distance)[:, None]
        weights.append(fit_basis_weights(response, ear * np.exp(2j * np.pi * ahead * frequency)))
    value = np.stack(weights) @ table.value
    return EarFilters(np.real(value).astype(np.float32), np.imag(value).astype(np.float32))


@functools.cache
def ear_phase_delays(sample_rate: int, radius: float, speed: float) -> Float[np.ndarray, " a"]:
    """Compute the phase delay [s] of a sphere in a plane wave beyond `sphere_delay`, at `NUM_ANGLES` angles 0 to pi.

    It is the least-squares slope through 0 of the phase over frequency, from 60 Hz to 0.45 of the sample rate.
    """
    frequency, _ = basis_responses(sample_rate)
    angle = np.linspace(0, np.pi, NUM_ANGLES)
    ahead = sphere_delay(angle, radius, speed)[:, None]
    ear = sphere_spectrum(frequency, angle, radius, speed) * np.exp(2j * np.pi * ahead * frequency)
    phase = np.unwrap(np.angle(ear), axis=1)
    return (-(phase @ frequency) / (2 * np.pi * frequency @ frequency)).astype(np.float32)


def basis_responses(sample_rate: int) -> tuple[Float[np.ndarray, " f"], Complex[np.ndarray, "f s"]]:
    """Return frequencies [Hz], and there the spectrum of each filter of `filter_basis` divided by the sum of all.

    They are from 60 Hz, with constant ratios up to 1 kHz, to 0.45 of the sample rate, in steps of 100 Hz.
    """
    kernel = filter_basis(sample_rate).kernel
    frequency = np.concatenate([np.geomspace(60, 1000, 30), np.arange(1100.0, 0.45 * sample_rate, 100)])
    time = (np.arange(kernel.shape[1]) - HALF_WIDTH) / sample_rate
    response = kernel @ np.exp(-2j * np.pi * time[:, None] * frequency)
    return frequency, (response / response.sum(axis=0)).T


def fit_basis_weights(
    response: Complex[np.ndarray, "f s"], wanted: Complex[np.ndarray, "a f"]
) -> Float[np.ndarray, "a s"]:
    """Fit real weights, one row per response in `wanted`, of basis responses by least squares of relative errors.

    Errors are re the amplitude of `wanted`, at least 0.1.
    """
    share = 1 / np.maximum(np.abs(wanted), 0.1) ** 2
    count = response.shape[1]
    products = np.real(response.conj()[:, :, None] * response[:, None]).reshape(len(response), -1)
    square = (share @ products).reshape(-1, count, count)
    right = np.real((share * wanted) @ response.conj())
    return np.linalg.solve(square, right[..., None])[..., 0]


def interpolate_ear_filters(
    table: EarFilters, angle: Float[Array, "*n"], nearness: Float[Array, "*n"]
) -> Complex[Array, "*n s"]:
    """Interpolate ear filters bilinearly over the angle between source and ear axis [rad] and nearness.

    Nearness is the ratio of the head's radius to the source's distance, clipped to `NEARNESS_KNOTS`.
    """
    position = angle * jnp.float32((NUM_ANGLES - 1) / math.pi)
    low = jnp.clip(position.astype(jnp.int32), 0, NUM_ANGLES - 2)
    row = jnp.clip(nearness / NEARNESS_KNOTS[1], 0.0, len(NEARNESS_KNOTS) - 1.0)
    near = jnp.clip(row.astype(jnp.int32), 0, len(NEARNESS_KNOTS) - 2)
    along, across = (x[..., None] for x in (position - low.astype(jnp.float32), row - near.astype(jnp.float32)))
    parts = []
    for part in table:
        rows = jnp.asarray(part).reshape(-1, part.shape[-1])
        corners = [rows[(near + i) * NUM_ANGLES + low + j] for i in (0, 1) for j in (0, 1)]
        first, second = (corners[2 * i] * (1 - along) + corners[2 * i + 1] * along for i in (0, 1))
        parts.append(first * (1 - across) + second * across)
    return jax.lax.complex(*parts)


def world_to_head(direction: Float[Array, "n 3"], quat: Float[Array, "4"]) -> Float[Array, "n 3"]:
    """Transform world directions to the frame of a head with orientation `quat` (wxyz)."""
    return jnp.matmul(direction, quat_matrix(quat), precision="highest")  # row vectors: applies the inverse rotation


def ear_angles(direction: Float[Array, "n 3"], ear_angle: float) -> Float[Array, "n 2"]:
    """Compute the angle between each direction and the axis of the left and right ear [rad].

    Args:
        direction: Unit vectors in the head frame: x right, y up, z back.
        ear_angle: Angle between nose and ears [degrees].
    """
    side, back = math.sin(math.radians(ear_angle)), -math.cos(math.radians(ear_angle))
    ears = jnp.array([[-side, 0.0, back], [side, 0.0, back]], jnp.float32)
    return jnp.arccos(jnp.clip(jnp.matmul(direction, ears.T, precision="highest"), -1.0, 1.0))


def ear_spectrum(table: EarTable, angle: Float[Array, "*n"]) -> tuple[Complex[Array, "*n f"], Float[Array, "*n"]]:
    """Interpolate the delay-free spectrum and the delay [s] of an ear at angles [rad] between sound and its axis."""
    return interpolate_angles(table.spectrum, angle), interpolate_angles(table.delay, angle)


def ear_energy(table: EarTable, angle: Float[Array, "*n"]) -> Float[Array, "*n bands"]:
    """Interpolate the energy gain of an ear per octave at angles [rad] between sound and its axis."""
    return interpolate_angles(table.energy, angle)


def interpolate_angles(rows: np.ndarray, angle: Float[Array, "*n"]) -> Array:
    """Interpolate rows linearly at angles [rad]; the `NUM_ANGLES` rows are at equal steps 0 to pi from the ear axis.

    Other angles are extrapolated from the nearest two rows.
    """
    position = angle * jnp.float32((NUM_ANGLES - 1) / math.pi)
    low = jnp.clip(position.astype(jnp.int32), 0, NUM_ANGLES - 2)
    rest = (position - low.astype(jnp.float32)).reshape(angle.shape + (1,) * (rows.ndim - 1)).astype(rows.dtype)
    table = jnp.asarray(rows)
    return table[low] * (1 - rest) + table[low + 1] * rest
