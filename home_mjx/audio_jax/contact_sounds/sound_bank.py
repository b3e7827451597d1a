"""Synthesised bank of contact sounds: pressure at 1 m for each kind of impact and of sliding.

The sounds are modelled, not measured. Pressures are relative to speech, whose RMS is 0.1 as that of every clip.

- Footsteps have two bands, as Ekimov and Sabatier measured (J. Acoust. Soc. Am. 120, 762, 2006): up to 500 Hz from the
  normal force, above from friction. They have two parts, heel and toe, 0.13 s apart. Soft floors lack the high band;
  wooden ones have low modes.
- Impacts are damped modes of a free bar with the decay time 1 / (π f tan φ). The internal friction φ identifies the
  material, after van den Doel and Pai, The sounds of physical shapes, Presence 7, 382, 1998.
- Sliding is noise filtered by the same modes. A creak is a train of small impacts: stick-slip.
"""

import functools
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.schema.compiled import BANDS

SPEECH_RMS = 0.1  # RMS pressure of speech at 1 m, the reference level
TRANSIENT_SECONDS = 0.4  # [s], duration of a transient sound
LOOP_SECONDS = 2.0  # [s], loop of a sustained sound
FADE_OUT_SECONDS = 0.05  # [s], fade-out of transient sounds
STEP_VARIANTS = 4  # variants per footstep, so that successive steps differ
TOE_DELAY = 0.13  # [s], delay of the toe after the heel
BAR_MODE_RATIOS = np.array([1.0, 2.756, 5.404, 8.933])  # mode frequencies of a free bar re the lowest


class FloorModel(NamedTuple):
    """Footstep model of a floor."""

    level: float  # [dB] re speech, RMS of the first 0.1 s at 1 m/s
    lowest_mode: float  # [Hz], lowest mode
    decay: float  # [s], time constant
    friction_corner: float  # [Hz], corner frequency of the friction noise
    friction_share: float  # of the friction noise in the pressure


class ImpactMaterial(NamedTuple):
    """Impact model of a body's material."""

    level: float  # [dB] re speech for an impact of 1 N s
    lowest_mode: float  # [Hz], lowest mode
    loss_factor: float  # loss factor tan φ


FLOORS = {
    "hard": FloorModel(-8.0, 160.0, 0.015, 5000.0, 0.7),
    "wood": FloorModel(-6.0, 95.0, 0.030, 2500.0, 0.4),
    "soft": FloorModel(-20.0, 80.0, 0.020, 600.0, 0.3),
}
IMPACT_MATERIALS = {
    "wood": ImpactMaterial(0.0, 350.0, 0.02),
    "metal": ImpactMaterial(4.0, 700.0, 0.0015),
    "hard": ImpactMaterial(3.0, 1300.0, 0.004),
    "plastic": ImpactMaterial(-2.0, 450.0, 0.05),
    "soft": ImpactMaterial(-14.0, 110.0, 0.2),
}
# Materials of each floor model and of each impact model. Others are soft as floors, and wooden when struck.
FLOOR_KINDS = {
    "hard": ("bricks", "ceramic", "concrete", "decoration stone", "facing stone", "glass", "metal", "stone", "tile"),
    "wood": ("laminate", "linoleum", "paint", "plastic", "potang", "wood"),
}
IMPACT_MATERIAL_KINDS = {
    "metal": ("metal",),
    "hard": (*FLOOR_KINDS["hard"][:6], "stone", "stucco", "tile"),
    "plastic": ("linoleum", "plastic"),
    "soft": ("carpet", "grass", "ground", "leather", "linen", "paper", "plant", "textile"),
}
TRANSIENTS = (
    *(f"step_{name}_{i}" for name in FLOORS for i in range(STEP_VARIANTS)),
    *(f"hit_{s}" for s in IMPACT_MATERIALS),
    "thud",
)
SUSTAINED = (*(f"scrape_{s}" for s in IMPACT_MATERIALS), "creak")


@functools.cache
def transient_bank(sample_rate: int) -> Float[np.ndarray, "strikes n"]:
    """Generate the pressure at 1 m of each of `TRANSIENTS`, 0.4 s long, as a read-only array.

    Reference: a step at 1 m/s, an impact of 1 N s, a leaf stopped from 1 rad/s.

    Example:
        >>> transient_bank(16000).shape == (len(TRANSIENTS), 6400)
        True
    """
    steps = [_step(floor, i, sample_rate) for floor in FLOORS.values() for i in range(STEP_VARIANTS)]
    blows = [
        _set_level(_modes(stuff, TRANSIENT_SECONDS, sample_rate), stuff.level, sample_rate)
        for stuff in IMPACT_MATERIALS.values()
    ]
    thud = _set_level(_modes(ImpactMaterial(0, 90.0, 0.08), TRANSIENT_SECONDS, sample_rate), 2.0, sample_rate)
    return _read_only(np.stack([*steps, *blows, thud]))


@functools.cache
def sustained_bank(sample_rate: int) -> Float[np.ndarray, "rubs n"]:
    """Generate the pressure at 1 m of each of `SUSTAINED`, loops of 2 s, as a read-only array.

    Reference: 1 W of friction, a leaf that turns at 1 rad/s.

    Example:
        >>> sustained_bank(16000).shape == (len(SUSTAINED), 32000)
        True
    """
    return _read_only(
        np.stack([*(_scrape(stuff, sample_rate) for stuff in IMPACT_MATERIALS.values()), _creak(sample_rate)])
    )


def bank_power(bank: Float[np.ndarray, "c n"], sample_rate: int, size: int) -> Float[np.ndarray, "c bins bands"]:
    """Compute the mean power of a bank's sounds per octave, in time bins of `size` samples.

    The bins cover the sounds, which count as silent beyond their end. Energy that filters spread before and after the
    bins is added to the first and last one.
    """
    count, length = bank.shape
    bins = -(-length // size)
    whole = 3 * bins * size  # the sound is in the middle third
    padded = np.pad(bank, [(0, 0), (bins * size, whole - bins * size - length)])
    gains = np.sqrt(octave_gains(np.fft.rfftfreq(whole, 1 / sample_rate)))  # energies of octaves add up
    bands = np.fft.irfft(np.fft.rfft(padded)[:, None] * gains[None], whole)
    power = np.mean(bands.reshape(count, len(BANDS), 3 * bins, size) ** 2, axis=-1)
    kept = power[:, :, bins : 2 * bins]
    kept[:, :, 0] += power[:, :, :bins].sum(axis=2)
    kept[:, :, -1] += power[:, :, 2 * bins :].sum(axis=2)
    return np.ascontiguousarray(np.swapaxes(kept, 1, 2), np.float32)


def _read_only(bank: Float[np.ndarray, "c n"]) -> Float[np.ndarray, "c n"]:
    """Return a read-only float32 copy."""
    bank = bank.astype(np.float32)
    bank.flags.writeable = False
    return bank


def _time(seconds: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Return the time of each sample [s]."""
    return np.arange(round(seconds * sample_rate)) / sample_rate


def _set_level(sound: Float[np.ndarray, " n"], level: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Return a copy faded out over its last 0.05 s, with the RMS `level` [dB re `SPEECH_RMS`] over its first 0.1 s.

    The sound must not be silent there.
    """
    time = np.arange(sound.size) / sample_rate
    sound = sound * np.clip((time[-1] - time) / FADE_OUT_SECONDS, 0, 1)
    rms = np.sqrt(np.mean(sound[: round(0.1 * sample_rate)] ** 2))
    return sound * (SPEECH_RMS * 10 ** (level / 20) / rms)


def _filter_noise(noise: Float[np.ndarray, " n"], corner: float, sample_rate: int, low: float = 0.0) -> np.ndarray:
    """Filter noise circularly with zero phase: 12 dB per octave above `corner` [Hz], 6 below `low` [Hz] unless 0.

    The amplitude gain at f is f / hypot(f, low) / (1 + (f / corner)²).
    """
    frequency = np.fft.rfftfreq(noise.size, 1 / sample_rate)
    rise = frequency / np.hypot(frequency, low) if low else 1.0
    return np.fft.irfft(np.fft.rfft(noise) * rise / (1 + (frequency / corner) ** 2), noise.size)


def _step(floor: FloorModel, variant: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Generate a step: a heel, then a softer toe with more friction; `variant` seeds its noise and detuning.

    Each is two decaying modes plus high-passed friction noise. The level is set by `_set_level`.
    """
    rng = np.random.default_rng([17, variant])
    time = _time(TRANSIENT_SECONDS, sample_rate)
    ringing, decay = (x * rng.uniform(0.9, 1.1) for x in (floor.lowest_mode, floor.decay))
    sound = np.zeros_like(time)
    parts = (0.0, 1.0, floor.friction_share), (TOE_DELAY, 0.4, min(1.0, 1.3 * floor.friction_share))
    for begin, loudness, share in parts:
        since = time - begin
        envelope = np.where(since >= 0, np.exp(-np.maximum(since, 0) / decay), 0.0)
        modes = np.sin(2 * np.pi * ringing * since) + 0.5 * np.sin(2 * np.pi * 2.1 * ringing * since)
        rubbing = _filter_noise(rng.normal(size=time.size), floor.friction_corner, sample_rate, low=400.0)
        sound += loudness * envelope * ((1 - share) * modes + share * rubbing / np.std(rubbing))
    return _set_level(sound, floor.level, sample_rate)


def _modes(stuff: ImpactMaterial, seconds: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Generate the sum of the damped modes of a free bar, sin(2π f t) exp(-π f tan φ t), below 0.45 of the rate."""
    time = _time(seconds, sample_rate)
    frequency = stuff.lowest_mode * BAR_MODE_RATIOS
    frequency = frequency[frequency < 0.45 * sample_rate][:, None]
    return np.sum(np.sin(2 * np.pi * frequency * time) * np.exp(-np.pi * frequency * stuff.loss_factor * time), axis=0)


def _scrape(stuff: ImpactMaterial, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Synthesise a seamless loop of sliding: band-limited noise plus half as loud noise filtered by the body's modes.

    Circular convolution makes the loop seamless. The RMS is `level` - 10 dB re speech. Modes decay with a loss factor
    of at least 0.02.
    """
    length = round(LOOP_SECONDS * sample_rate)
    noise = np.random.default_rng(23).normal(size=length)
    ringing = _modes(stuff._replace(loss_factor=max(stuff.loss_factor, 0.02)), TRANSIENT_SECONDS, sample_rate)
    dull = _filter_noise(noise, 4 * stuff.lowest_mode, sample_rate, low=stuff.lowest_mode / 4)
    ringing = np.fft.irfft(np.fft.rfft(noise) * np.fft.rfft(ringing, length), length)
    sound = dull / np.std(dull) + 0.5 * ringing / np.std(ringing)
    return sound * (SPEECH_RMS * 10 ** ((stuff.level - 10) / 20) / np.sqrt(np.mean(sound**2)))


def _creak(sample_rate: int) -> Float[np.ndarray, " n"]:
    """Generate a loop of stick-slip: 60 random small impacts per second on wood; the RMS is -16 dB re speech."""
    length, rng = round(LOOP_SECONDS * sample_rate), np.random.default_rng(29)
    pulses = np.zeros(length)
    at = np.cumsum(rng.uniform(0.7, 1.3, round(LOOP_SECONDS * 60)) / 60 * sample_rate).astype(int)
    pulses[at[at < length]] = rng.uniform(0.4, 1.0, np.count_nonzero(at < length))
    ringing = _modes(ImpactMaterial(0, 520.0, 0.03), TRANSIENT_SECONDS, sample_rate)
    sound = np.fft.irfft(np.fft.rfft(pulses) * np.fft.rfft(ringing, length), length)
    return sound * (SPEECH_RMS * 10 ** (-16 / 20) / np.sqrt(np.mean(sound**2)))
