"""Decomposition of ear responses into a delay and a minimum-phase filter."""

import math

import numpy as np
from jaxtyping import Complex, Float

MIN_RELATIVE_AMPLITUDE = 1e-5  # minimum amplitude of a spectrum re its maximum, before the logarithm
DELAY_OVERSAMPLING = 8  # oversampling factor of the search for delays


def minimum_phase(response: Float[np.ndarray, "*m n"]) -> Float[np.ndarray, "*m s"]:
    """Compute minimum-phase responses with the same magnitude spectra, by folding the cepstrum."""
    size = 2 ** math.ceil(math.log2(8 * response.shape[-1]))
    amplitude = np.abs(np.fft.rfft(response, size))
    level = np.log(np.maximum(amplitude, MIN_RELATIVE_AMPLITUDE * amplitude.max(axis=-1, keepdims=True)))
    fold = np.r_[1.0, np.full(size // 2 - 1, 2.0), 1.0, np.zeros(size // 2 - 1)]
    return np.fft.irfft(np.exp(np.fft.rfft(np.fft.irfft(level, size) * fold)), size)


def estimate_delays(response: Float[np.ndarray, "*m n"], least: Float[np.ndarray, "*m s"]) -> Float[np.ndarray, "*m"]:
    """Estimate the delays of responses re others [samples], at the maximum of their cross-correlation."""
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
    """Evaluate the spectra of responses at arbitrary frequencies [Hz]."""
    turn = 2 * np.pi * np.outer(np.arange(response.shape[-1]) / rate, frequency)
    rows = response.reshape(-1, response.shape[-1])
    return (rows @ np.cos(turn) - 1j * (rows @ np.sin(turn))).reshape(*response.shape[:-1], -1)
