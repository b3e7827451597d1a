"""The sound bank of bodies, synthesised: what each kind of blow and of sliding sounds like at 1 m from it.

A model, no measurement. Pressures are relative to speech, whose RMS is 0.1 as that of every clip.

- Footsteps have two bands, as Ekimov and Sabatier measured (J. Acoust. Soc. Am. 120, 762, 2006): up to 500 Hz from the
  force along the floor's normal, above it from friction; and two parts, heel and toe, 0.13 s apart. Soft floors take
  the high band away, wooden ones ring low.
- Blows are damped modes, of a free bar, whose decay is 1 / (π f tan φ): the internal friction φ is what materials are
  told by, after van den Doel and Pai, The sounds of physical shapes, Presence 7, 382, 1998.
- Sliding is noise through the same modes, a creak is a train of such blows: stick and slip.
"""

import functools
from typing import NamedTuple

import numpy as np
from jaxtyping import Float

from home_mjx.audio_jax.base.filters import octave_gains
from home_mjx.schema.compiled import BANDS

SPEECH = 0.1  # RMS at 1 m
SECONDS = 0.4  # of a blow
LOOP_SECONDS = 2.0  # of sliding
SOFT_END = 0.05  # [s]
VARIANTS = 4  # of each footstep, so that no two in succession are equal
TOE = 0.13  # [s], after the heel
BAR = np.array([1.0, 2.756, 5.404, 8.933])  # modes of a free bar re the lowest


class Floor(NamedTuple):
    """How it takes a step."""

    level: float  # [dB] re speech, RMS of the first 0.1 s at 1 m/s
    ringing: float  # [Hz] of its lowest mode
    decay: float  # [s]
    friction: float  # [Hz], up to which friction is heard
    share: float  # of friction in the pressure


class Stuff(NamedTuple):
    """How a body of some material rings when struck."""

    level: float  # [dB] re speech for a blow of 1 N s
    lowest: float  # [Hz]
    loss: float  # tan φ


FLOORS = {
    "hard": Floor(-8.0, 160.0, 0.015, 5000.0, 0.7),
    "wood": Floor(-6.0, 95.0, 0.030, 2500.0, 0.4),
    "soft": Floor(-20.0, 80.0, 0.020, 600.0, 0.3),
}
STUFFS = {
    "wood": Stuff(0.0, 350.0, 0.02),
    "metal": Stuff(4.0, 700.0, 0.0015),
    "hard": Stuff(3.0, 1300.0, 0.004),
    "plastic": Stuff(-2.0, 450.0, 0.05),
    "soft": Stuff(-14.0, 110.0, 0.2),
}
# Kinds of material that are hard or of wood underfoot, and what is struck; whatever is not named is soft, and wooden.
FLOOR_KINDS = {
    "hard": ("bricks", "ceramic", "concrete", "decoration stone", "facing stone", "glass", "metal", "stone", "tile"),
    "wood": ("laminate", "linoleum", "paint", "plastic", "potang", "wood"),
}
STUFF_KINDS = {
    "metal": ("metal",),
    "hard": (*FLOOR_KINDS["hard"][:6], "stone", "stucco", "tile"),
    "plastic": ("linoleum", "plastic"),
    "soft": ("carpet", "grass", "ground", "leather", "linen", "paper", "plant", "textile"),
}
STRIKES = (*(f"step_{name}_{i}" for name in FLOORS for i in range(VARIANTS)), *(f"hit_{s}" for s in STUFFS), "thud")
RUBS = (*(f"scrape_{s}" for s in STUFFS), "creak")


@functools.cache
def strike_bank(sample_rate: int) -> Float[np.ndarray, "strikes n"]:
    """Pressure at 1 m of each of `STRIKES`: of a step at 1 m/s, of a blow of 1 N s, of a leaf stopped from 1 rad/s.

    Example:
        >>> strike_bank(16000).shape == (len(STRIKES), 6400)
        True
    """
    steps = [_step(floor, i, sample_rate) for floor in FLOORS.values() for i in range(VARIANTS)]
    blows = [_scaled(_modes(stuff, SECONDS, sample_rate), stuff.level, sample_rate) for stuff in STUFFS.values()]
    thud = _scaled(_modes(Stuff(0, 90.0, 0.08), SECONDS, sample_rate), 2.0, sample_rate)
    return _kept(np.stack([*steps, *blows, thud]))


@functools.cache
def rub_bank(sample_rate: int) -> Float[np.ndarray, "rubs n"]:
    """Pressure at 1 m of each of `RUBS`, loops: of 1 W of friction, of a leaf that turns by 1 rad/s.

    Example:
        >>> rub_bank(16000).shape == (len(RUBS), 32000)
        True
    """
    return _kept(np.stack([*(_scrape(stuff, sample_rate) for stuff in STUFFS.values()), _creak(sample_rate)]))


def bank_power(bank: Float[np.ndarray, "c n"], sample_rate: int, size: int) -> Float[np.ndarray, "c bins bands"]:
    """Power of a bank's sounds in time bins of `size` samples, per octave.

    As many bins as it takes to hold them; what filters ring before and after them is in the first and the last.
    """
    count, length = bank.shape
    bins = -(-length // size)
    whole = 3 * bins * size  # the sound is its middle part
    padded = np.pad(bank, [(0, 0), (bins * size, whole - bins * size - length)])
    gains = np.sqrt(octave_gains(np.fft.rfftfreq(whole, 1 / sample_rate)))  # energies of octaves add up
    bands = np.fft.irfft(np.fft.rfft(padded)[:, None] * gains[None], whole)
    power = np.mean(bands.reshape(count, len(BANDS), 3 * bins, size) ** 2, axis=-1)
    kept = power[:, :, bins : 2 * bins]
    kept[:, :, 0] += power[:, :, :bins].sum(axis=2)
    kept[:, :, -1] += power[:, :, 2 * bins :].sum(axis=2)
    return np.ascontiguousarray(np.swapaxes(kept, 1, 2), np.float32)


def _kept(bank: Float[np.ndarray, "c n"]) -> Float[np.ndarray, "c n"]:
    bank = bank.astype(np.float32)
    bank.flags.writeable = False
    return bank


def _time(seconds: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    return np.arange(round(seconds * sample_rate)) / sample_rate


def _scaled(sound: Float[np.ndarray, " n"], level: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    """With this level over its first 0.1 s, and a soft end."""
    time = np.arange(sound.size) / sample_rate
    sound = sound * np.clip((time[-1] - time) / SOFT_END, 0, 1)
    rms = np.sqrt(np.mean(sound[: round(0.1 * sample_rate)] ** 2))
    return sound * (SPEECH * 10 ** (level / 20) / rms)


def _below(noise: Float[np.ndarray, " n"], corner: float, sample_rate: int, low: float = 0.0) -> np.ndarray:
    """Noise that falls by 12 dB per octave above a corner, and by 6 below another."""
    frequency = np.fft.rfftfreq(noise.size, 1 / sample_rate)
    rise = frequency / np.hypot(frequency, low) if low else 1.0
    return np.fft.irfft(np.fft.rfft(noise) * rise / (1 + (frequency / corner) ** 2), noise.size)


def _step(floor: Floor, variant: int, sample_rate: int) -> Float[np.ndarray, " n"]:
    """A heel, then a toe that is softer and has more friction."""
    rng = np.random.default_rng([17, variant])
    time = _time(SECONDS, sample_rate)
    ringing, decay = (x * rng.uniform(0.9, 1.1) for x in (floor.ringing, floor.decay))
    sound = np.zeros_like(time)
    for begin, loudness, share in ((0.0, 1.0, floor.share), (TOE, 0.4, min(1.0, 1.3 * floor.share))):
        since = time - begin
        envelope = np.where(since >= 0, np.exp(-np.maximum(since, 0) / decay), 0.0)
        modes = np.sin(2 * np.pi * ringing * since) + 0.5 * np.sin(2 * np.pi * 2.1 * ringing * since)
        rubbing = _below(rng.normal(size=time.size), floor.friction, sample_rate, low=400.0)
        sound += loudness * envelope * ((1 - share) * modes + share * rubbing / np.std(rubbing))
    return _scaled(sound, floor.level, sample_rate)


def _modes(stuff: Stuff, seconds: float, sample_rate: int) -> Float[np.ndarray, " n"]:
    """What a blow leaves ringing."""
    time = _time(seconds, sample_rate)
    frequency = stuff.lowest * BAR
    frequency = frequency[frequency < 0.45 * sample_rate][:, None]
    return np.sum(np.sin(2 * np.pi * frequency * time) * np.exp(-np.pi * frequency * stuff.loss * time), axis=0)


def _scrape(stuff: Stuff, sample_rate: int) -> Float[np.ndarray, " n"]:
    """Noise through the modes of what slides, around a loop."""
    length = round(LOOP_SECONDS * sample_rate)
    noise = np.random.default_rng(23).normal(size=length)
    ringing = _modes(stuff._replace(loss=max(stuff.loss, 0.02)), SECONDS, sample_rate)
    dull = _below(noise, 4 * stuff.lowest, sample_rate, low=stuff.lowest / 4)
    ringing = np.fft.irfft(np.fft.rfft(noise) * np.fft.rfft(ringing, length), length)
    sound = dull / np.std(dull) + 0.5 * ringing / np.std(ringing)
    return sound * (SPEECH * 10 ** ((stuff.level - 10) / 20) / np.sqrt(np.mean(sound**2)))


def _creak(sample_rate: int) -> Float[np.ndarray, " n"]:
    """Stick and slip: 60 small blows a second on wood, none like the one before."""
    length, rng = round(LOOP_SECONDS * sample_rate), np.random.default_rng(29)
    pulses = np.zeros(length)
    at = np.cumsum(rng.uniform(0.7, 1.3, round(LOOP_SECONDS * 60)) / 60 * sample_rate).astype(int)
    pulses[at[at < length]] = rng.uniform(0.4, 1.0, np.count_nonzero(at < length))
    ringing = _modes(Stuff(0, 520.0, 0.03), SECONDS, sample_rate)
    sound = np.fft.irfft(np.fft.rfft(pulses) * np.fft.rfft(ringing, length), length)
    return sound * (SPEECH * 10 ** (-16 / 20) / np.sqrt(np.mean(sound**2)))
