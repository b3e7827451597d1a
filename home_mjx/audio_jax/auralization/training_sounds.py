"""Kinds of sounds to train with: each function draws its parameters and synthesizes a seamless loop.

Arguments are those of `sound_parts.ClipFamily`. There are no voices, cries, barks, sirens, beeps or whistles
among them: those are the kinds of `held_out_sounds`.
"""

import numpy as np

from home_mjx.audio_jax.auralization.sound_parts import (
    Random,
    Samples,
    add_events,
    band_gain,
    draw_log,
    harmonic_tone,
    make_variants,
    modal_strike,
    noise_burst,
    num_events,
    oscillator_phase,
    random_times,
    shaped_noise,
    slow_curve,
)

NUM_VARIANTS = 6  # clips of each kind
SCALE = (0, 2, 4, 7, 9, 12, 14, 16)  # [semitones], pentatonic


def engine(length: int, rate: int, random: Random) -> Samples:
    """Synthesize an engine: harmonics of an unsteady rotation of 20 to 120 Hz, and noise."""
    pitch = draw_log(random, 20, 120) * (1 + 0.03 * slow_curve(length, random, 12).clip(-3, 3))
    amplitudes = random.uniform(0.2, 1, 60) / np.arange(1, 61) ** random.uniform(0.3, 1.2)
    tone = harmonic_tone(oscillator_phase(pitch, rate), pitch.max(), rate, amplitudes)
    noise = shaped_noise(length, rate, random, band_gain(100, draw_log(random, 800, 4000)), 1.0)
    return tone / tone.std() + random.uniform(0.2, 1) * noise


def fan(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a fan: broad noise, and harmonics of its blades at 60 to 250 Hz."""
    pitch = draw_log(random, 60, 250) * (1 + 0.003 * slow_curve(length, random, 6))
    blades = harmonic_tone(oscillator_phase(pitch, rate), pitch.max(), rate, 1 / np.arange(1, 9) ** 1.5)
    noise = shaped_noise(length, rate, random, band_gain(draw_log(random, 50, 300), draw_log(random, 600, 5000), 1), 1)
    return noise + random.uniform(0.1, 0.8) * blades / blades.std()


def motor(length: int, rate: int, random: Random) -> Samples:
    """Synthesize an electric motor under changing load: a bright buzz of 90 to 400 Hz with a resonance."""
    load = slow_curve(length, random, int(random.integers(3, 16))).clip(-2, 2)
    pitch = draw_log(random, 90, 400) * (1 + random.uniform(0.02, 0.15) * load)
    order, peak = np.arange(1, 50), draw_log(random, 3, 15)
    amplitudes = (1 / order + np.exp(-(((order - peak) / 2) ** 2))) * random.uniform(0.3, 1, order.size)
    tone = harmonic_tone(oscillator_phase(pitch, rate), pitch.max(), rate, amplitudes)
    return tone / tone.std() * (1 + 0.2 * load) + 0.3 * shaped_noise(length, rate, random, band_gain(800, 6000), 1)


def _strikes(
    length: int, rate: int, random: Random, frequencies: Samples, decays: Samples, times: np.ndarray
) -> Samples:
    """Return strikes of one body at times, each with other shares of its modes."""
    seconds = float(min(5 / decays.min(), 3.0))

    def strike(_: int) -> Samples:
        """Return one strike."""
        shares = random.uniform(0.1, 1, frequencies.size) * random.uniform(0.5, 1)
        return modal_strike(seconds, rate, frequencies, decays, shares)

    return add_events(length, times, strike)


def wood(length: int, rate: int, random: Random) -> Samples:
    """Synthesize blows on wood: two to six modes from 120 to 1500 Hz that decay within a tenth of a second."""
    modes = np.sort(np.exp(random.uniform(np.log(120), np.log(1500), random.integers(2, 7))))
    times = random_times(length, random, num_events(length, rate, draw_log(random, 1.5, 7)), random.uniform(0.2, 1))
    return _strikes(length, rate, random, modes, 25 + 0.05 * modes * random.uniform(0.5, 1.5), times)


def metal(length: int, rate: int, random: Random) -> Samples:
    """Synthesize pans and cutlery: inharmonic modes from 300 to 6000 Hz that ring for a second or less."""
    modes = draw_log(random, 300, 1200) * np.cumprod(np.append(1, random.uniform(1.15, 1.9, random.integers(4, 9))))
    times = random_times(length, random, num_events(length, rate, draw_log(random, 1.5, 6)), 1.0)
    return _strikes(length, rate, random, modes, draw_log(random, 3, 20) * (1 + modes / 4000), times)


def glass(length: int, rate: int, random: Random) -> Samples:
    """Synthesize glasses and dishes: modes from 1500 to 6500 Hz."""
    modes = draw_log(random, 1500, 3000) * np.append(1, np.cumprod(random.uniform(1.1, 1.5, random.integers(2, 5))))
    times = random_times(length, random, num_events(length, rate, draw_log(random, 2, 9)), 1.0)
    return _strikes(length, rate, random, modes, draw_log(random, 8, 40) * (1 + modes / 5000), times)


def church_bell(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a bell of 200 to 1300 Hz, struck every second or two, with the partials of bells, detuned."""
    modes = draw_log(random, 200, 1300) * np.array([0.5, 1, 1.2, 1.5, 2, 2.5, 2.67, 3, 4]) * random.normal(1, 0.01, 9)
    times = random_times(length, random, num_events(length, rate, draw_log(random, 0.6, 3)), 0.3)
    return _strikes(length, rate, random, modes, draw_log(random, 1.2, 4) * modes / modes[1], times)


def wind_chimes(length: int, rate: int, random: Random) -> Samples:
    """Synthesize wind chimes: tubes with partials 1, 2.76 and 5.4, struck at random."""
    tubes = draw_log(random, 500, 1200) * 2 ** (random.choice(SCALE, 5, replace=False) / 12)
    decay = draw_log(random, 2, 6)

    def strike(_: int) -> Samples:
        """Return a strike of a random tube."""
        modes, decays = random.choice(tubes) * np.array([1, 2.76, 5.4]), decay * np.array([1, 2, 4])
        return modal_strike(1.5, rate, modes, decays, random.uniform(0.2, 1) * np.array([1, 0.6, 0.3]))

    return add_events(length, random_times(length, random, num_events(length, rate, draw_log(random, 2, 8))), strike)


def telephone(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a telephone: two tones of 350 to 900 Hz with some harmonics, in a cadence of one of three kinds."""
    low = draw_log(random, 350, 700)
    pitches, time = low * np.array([1, random.uniform(1.05, 1.4)]), np.arange(length) / rate
    amplitudes = np.array([1, random.uniform(0, 0.5), random.uniform(0, 0.4)])
    tones = [harmonic_tone(oscillator_phase(np.full(length, f), rate), f, rate, amplitudes) for f in pitches]
    period = length / rate / random.integers(3, 8)
    on = (time % period) / period < random.uniform(0.4, 0.7)
    split = random.integers(1, 4)
    on = on & ((time % (period / split)) / (period / split) < (1.0 if split == 1 else 0.7))
    gate = np.convolve(np.pad(on.astype(float), 80, mode="wrap"), np.hanning(81) / np.hanning(81).sum(), "same")[80:-80]
    return (tones[0] + tones[1]) * gate


def songbird(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a bird: motifs of short glides between 1.5 and 6.5 kHz."""
    motif = [(random.uniform(1500, 6500), random.uniform(-0.4, 0.5), random.uniform(0.04, 0.2)) for _ in range(4)]

    def glide(number: int) -> Samples:
        """Return one note of the motif."""
        pitch, bend, seconds = motif[number % len(motif)]
        share = np.linspace(0, 1, round(seconds * rate))
        track = np.clip(pitch * 2 ** (bend * share + 0.03 * np.sin(40 * share)), 800, 0.45 * rate)
        return np.sin(2 * np.pi * np.cumsum(track) / rate) * np.sin(np.pi * share) ** 0.5

    times = random_times(length, random, num_events(length, rate, draw_log(random, 2, 8)), 0.5)
    return add_events(length, times, glide)


def cricket(length: int, rate: int, random: Random) -> Samples:
    """Synthesize insects: trills of a tone of 2.5 to 6 kHz, 20 to 60 pulses a second."""
    pitch = draw_log(random, 2500, 6000) * (1 + 0.01 * slow_curve(length, random, 20))
    pulses = oscillator_phase(np.full(length, draw_log(random, 20, 60)), rate)
    trill = 1 / (1 + np.exp(-6 * (slow_curve(length, random, int(random.integers(8, 30))) + 0.3)))
    return np.sin(oscillator_phase(pitch, rate)) * np.clip(np.sin(pulses), 0, 1) * trill


def _bubbles(length: int, rate: int, random: Random, count: int, small: float, large: float) -> Samples:
    """Return bubbles of radii [m] at random times, see `clip_synthesis.water`; their pitch rises a little."""
    time = np.arange(round(0.12 * rate)) / rate

    def bubble(_: int) -> Samples:
        """Return one bubble."""
        radius = draw_log(random, small, large)
        decay, pitch = 0.13 / radius + 0.0072 / radius**1.5, min(3 / radius, 0.4 * rate)
        track = 2 * np.pi * pitch * time * (1 + random.uniform(0, 0.1) * decay * time)
        return np.sin(track) * np.exp(-decay * time) * random.uniform(0.1, 1) * radius

    return add_events(length, random.integers(0, length, count), bubble)


def pouring(length: int, rate: int, random: Random) -> Samples:
    """Synthesize pouring water: 60 to 500 bubbles a second, and spray."""
    sound = _bubbles(length, rate, random, num_events(length, rate, draw_log(random, 60, 500)), 0.0006, 0.006)
    spray = shaped_noise(length, rate, random, band_gain(1500, 7000))
    return sound / sound.std() + random.uniform(0.05, 0.6) * spray


def dripping(length: int, rate: int, random: Random) -> Samples:
    """Synthesize drops: 2 to 12 bubbles a second."""
    return _bubbles(length, rate, random, num_events(length, rate, draw_log(random, 2, 12)), 0.001, 0.008)


def shower(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a shower or rain: bright noise with ripples, and drops on a surface."""
    noise = shaped_noise(length, rate, random, band_gain(draw_log(random, 400, 2500), 7500, 1), 1.0)
    times = random.integers(0, length, num_events(length, rate, draw_log(random, 10, 60)))
    return noise + 1.5 * add_events(length, times, lambda _: noise_burst(0.02, rate, random, 500, 4000, 200))


def plucked_strings(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a melody on plucked strings: harmonics that decay faster the higher they are."""
    root, order = draw_log(random, 110, 350), np.arange(1, 16)
    decay, bright = draw_log(random, 1, 5), random.uniform(0.5, 1.6)
    beats = num_events(length, rate, float(random.choice([2, 3, 4, 6])))

    def note(_: int) -> Samples:
        """Return one note of the scale."""
        modes = root * 2 ** (random.choice(SCALE) / 12) * order * np.sqrt(1 + 0.0002 * order**2)
        return modal_strike(1.5, rate, modes, decay * (1 + 0.3 * order), random.uniform(0.4, 1) / order**bright, 0.004)

    return add_events(length, random_times(length, random, beats, 0.05), note)


def organ(length: int, rate: int, random: Random) -> Samples:
    """Synthesize chords of an organ or accordion, which change once or twice a second."""
    root, stops = draw_log(random, 130, 300), random.uniform(0, 1, 8) / np.arange(1, 9) ** 0.7
    count = num_events(length, rate, float(random.choice([1, 1.5, 2])))
    seconds = length / rate / count
    shape = np.sin(np.pi * np.linspace(0, 1, round(1.15 * seconds * rate))) ** 0.3

    def chord(_: int) -> Samples:
        """Return three voices of the scale."""
        pitches = root * 2 ** (random.choice(SCALE, 3, replace=False) / 12)
        tracks = [2 * np.pi * f * np.arange(shape.size) / rate for f in pitches]
        return shape * np.sum([harmonic_tone(x, f, rate, stops) for x, f in zip(tracks, pitches, strict=True)], axis=0)

    return add_events(length, np.round(np.arange(count) * length / count).astype(int), chord)


def drums(length: int, rate: int, random: Random) -> Samples:
    """Synthesize drums in a random pattern: a skin of 50 to 120 Hz, a snare and a hi-hat."""
    step, skin = num_events(length, rate, float(random.choice([4, 6, 8]))), draw_log(random, 50, 120)
    pattern, modes = random.choice(3, size=8, p=[0.35, 0.25, 0.4]), skin * np.array([1, 1.6, 2.3])
    drum, body = (
        modal_strike(0.3, rate, np.array(pitches, float), np.array(decays, float), np.array(shares, float))
        for pitches, decays, shares in ((modes, (12, 18, 25), (2, 1, 0.6)), ((190, 330), (25, 30), (1, 1)))
    )
    kinds = (
        lambda: drum,
        lambda: body + np.pad(0.6 * noise_burst(0.2, rate, random, 400, 6000, 25), (0, body.size))[: body.size],
        lambda: 0.4 * noise_burst(0.08, rate, random, 4000, 7500, 70),
    )
    return add_events(length, random_times(length, random, step, 0.05), lambda i: kinds[pattern[i % 8]]())


def clatter(length: int, rate: int, random: Random) -> Samples:
    """Synthesize typing, footfalls or toys: short bursts of noise in bands of their own."""
    low = draw_log(random, 200, 2500)
    decay, rough = draw_log(random, 30, 150), random.uniform(0.3, 1)
    times = random_times(length, random, num_events(length, rate, draw_log(random, 3, 12)), rough)
    return add_events(
        length, times, lambda _: random.uniform(0.4, 1) * noise_burst(0.12, rate, random, low, 3 * low, decay)
    )


def fire(length: int, rate: int, random: Random) -> Samples:
    """Synthesize a fire: crackles of 20 to 80 a second over a low rustle."""
    rustle = shaped_noise(length, rate, random, band_gain(60, draw_log(random, 400, 1500)), 1.0)
    times = random.integers(0, length, num_events(length, rate, draw_log(random, 20, 80)))
    loudness = random.pareto(2.0, times.size) + 0.2
    return rustle + add_events(length, times, lambda i: loudness[i] * noise_burst(0.015, rate, random, 1000, 7000, 300))


def scraping(length: int, rate: int, random: Random) -> Samples:
    """Synthesize sawing, brushing or sweeping: noise in strokes, one to five a second."""
    low = draw_log(random, 200, 2500)
    noise = shaped_noise(length, rate, random, band_gain(low, low * draw_log(random, 2, 6)), 1.0)
    pitch = draw_log(random, 1, 5) * (1 + 0.2 * slow_curve(length, random, 10).clip(-2, 2))
    return noise * (0.5 - 0.5 * np.cos(oscillator_phase(pitch, rate))) ** random.uniform(0.5, 2)


def wind(length: int, rate: int, random: Random) -> Samples:
    """Synthesize wind at a window: noise in a low and a high band whose levels rise and fall."""
    parts = [shaped_noise(length, rate, random, band_gain(f, 2 * f)) for f in np.exp(random.uniform(4.6, 7.6, 3))]
    return np.sum([part * np.exp(0.8 * slow_curve(length, random, 16)) for part in parts], axis=0)


FAMILIES = (
    *(engine, fan, motor, wood, metal, glass, church_bell, wind_chimes, telephone, songbird, cricket, pouring),
    *(dripping, shower, plucked_strings, organ, drums, clatter, fire, scraping, wind),
)
TRAINING_CLIPS = make_variants(FAMILIES, NUM_VARIANTS, seed=42)
