"""Kinds of sounds that are never trained with, to measure generalisation; see `training_sounds`."""

import itertools

import numpy as np

from home_mjx.audio_jax.auralization.sound_parts import (
    Random,
    Samples,
    add_events,
    band_gain,
    draw_log,
    harmonic_tone,
    make_variants,
    num_events,
    oscillator_phase,
    random_times,
    shaped_noise,
    slow_curve,
)

NUM_VARIANTS = 4  # clips of each kind
VOWELS = ((730, 1090, 2440), (270, 2290, 3010), (300, 870, 2240), (530, 1840, 2480), (490, 1350, 1690))  # [Hz]
FORMANT_WIDTH = 90.0  # [Hz]


def _through_formants(sound: Samples, rate: int, formants: Samples) -> Samples:
    """Return a sound through resonances at `formants` [Hz]."""
    frequency = np.fft.rfftfreq(sound.size, 1 / rate)
    gain = np.sum([1 / (1 + ((frequency - f) / FORMANT_WIDTH) ** 2) for f in formants], axis=0)
    return np.fft.irfft(np.fft.rfft(sound) * gain, sound.size)


def _buzz(pitch: Samples, rate: int) -> Samples:
    """Return all harmonics of a gliding pitch [Hz], falling by 6 dB per octave."""
    order = np.arange(1, 60)
    return harmonic_tone(oscillator_phase(pitch, rate), float(pitch.max()), rate, 1 / order)


def talking(length: int, rate: int, random: Random) -> Samples:
    """Synthesize speech without words: vowels of a voice of 90 to 260 Hz, consonants of noise, and pauses."""
    pitch = draw_log(random, 90, 260) * 2 ** (0.15 * slow_curve(length, random, 20))
    size, count = draw_log(random, 0.9, 1.25), num_events(length, rate, random.uniform(3, 5))
    spoken = np.array([_through_formants(_buzz(pitch, rate), rate, size * np.array(vowel)) for vowel in VOWELS])
    hiss = shaped_noise(length, rate, random, band_gain(2500, 7000))
    edges = np.linspace(0, length, count + 1).astype(int)
    sound = np.zeros(length)
    for begin, end in itertools.pairwise(edges):
        share = np.linspace(0, 1, end - begin)
        vowel = spoken[random.integers(len(VOWELS)), begin:end] / spoken.std() * np.sin(np.pi * share) ** 2
        loudness = 0 if random.uniform() < 0.15 else random.uniform(0.5, 1)
        onset = np.exp(-(((share - 0.05) / 0.08) ** 2)) * np.minimum(share / 0.02, 1)
        sound[begin:end] = loudness * (vowel + random.uniform(0, 0.3) * hiss[begin:end] * onset)
    return sound


def crying(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a baby: cries of 0.8 s whose pitch rises to 350 to 600 Hz and falls."""
    top, formants = draw_log(random, 350, 600), np.array([1000, 2500, 4200]) * random.uniform(0.9, 1.1)

    def cry(_: int) -> Samples:
        """Return one cry."""
        share = np.linspace(0, 1, round(random.uniform(0.5, 0.9) * rate))
        pitch = top * (0.7 + 0.3 * np.sin(np.pi * share)) * (1 + 0.01 * np.sin(40 * np.pi * share))
        return _through_formants(_buzz(pitch, rate), rate, formants) * np.sin(np.pi * share) ** 0.5

    return add_events(length, random_times(length, random, num_events(length, rate, 0.9), 0.2), cry)


def barking(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a dog: barks of 0.15 s, harmonics of a falling 200 to 600 Hz and noise."""
    top, formants = draw_log(random, 200, 600), np.array([700, 1400, 2600]) * random.uniform(0.8, 1.3)

    def bark(_: int) -> Samples:
        """Return one bark."""
        share = np.linspace(0, 1, round(random.uniform(0.1, 0.2) * rate))
        voice = _buzz(top * (1 + 0.4 * np.sin(np.pi * share)) * (1 - 0.3 * share), rate)
        rough = voice / voice.std() + random.uniform(0.2, 0.7) * random.normal(size=share.size)
        return _through_formants(rough, rate, formants) * np.sin(np.pi * share) ** 0.7

    return add_events(length, random_times(length, random, num_events(length, rate, draw_log(random, 1, 3))), bark)


def siren(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a siren: a tone with harmonics that sweeps between 500 and 1800 Hz, smoothly or abruptly."""
    low = draw_log(random, 450, 800)
    sweep = oscillator_phase(np.full(length, draw_log(random, 0.3, 4)), rate)
    wave = np.sin(sweep) if random.uniform() < 0.5 else np.tanh(8 * np.sin(sweep))
    pitch = low * 2 ** (random.uniform(0.3, 0.6) * (1 + wave))
    return harmonic_tone(oscillator_phase(pitch, rate), float(pitch.max()), rate, np.array([1, 0, 0.33, 0, 0.2]))


def beeping(length: int, rate: int, random: Random) -> Samples:
    """Synthesize smoke alarms and appliances: beeps of one tone of 900 to 3600 Hz, in groups."""
    pitch, beeps = draw_log(random, 900, 3600), int(random.integers(1, 5))
    period = length / rate / random.integers(4, 10)
    time = (np.arange(length) / rate) % period
    slot = min(period / (beeps + 1), 0.3)
    within = (time % slot) / slot
    gate = np.clip(np.minimum(within, 0.6 - within) / 0.03, 0, 1) * (time < beeps * slot)
    phase = oscillator_phase(np.full(length, pitch), rate)
    return gate * harmonic_tone(phase, pitch, rate, np.array([1, 0, 0.3]))


def whistling(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a whistled tune of 800 to 2500 Hz with breath, or a kettle at the top of its pitch."""
    steps = 2 ** (random.choice([0, 2, 4, 5, 7, 9, 12], num_events(length, rate, random.uniform(1, 4))) / 12)
    place = np.arange(length) / length * steps.size
    glide = np.clip((place % 1 - 0.85) / 0.15, 0, 1)
    now = place.astype(int) % steps.size
    pitch = draw_log(random, 800, 1250) * (steps[now] * (1 - glide) + steps[(now + 1) % steps.size] * glide)
    pitch = pitch * (1 + 0.01 * np.sin(oscillator_phase(np.full(length, 5.5), rate)))
    breath = shaped_noise(length, rate, random, band_gain(800, 5000))
    return np.sin(oscillator_phase(pitch, rate)) + random.uniform(0.02, 0.15) * breath


FAMILIES = (talking, crying, barking, siren, beeping, whistling)
HELD_OUT_CLIPS = make_variants(FAMILIES, NUM_VARIANTS, seed=43)
