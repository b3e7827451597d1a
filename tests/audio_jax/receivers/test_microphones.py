"""Arrays and ambisonics from one trace: against plane and spherical waves, and fields that come from everywhere."""

import dataclasses
import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from numpy_measures import octave_energies
from scenes import HEAD, scene_of
from scipy.signal import butter as butterworth
from scipy.signal import csd, fftconvolve, sosfilt

from home_mjx.audio_jax import AudioConfig, Listener, Paths, SoundSource, impulse_response, render_receiver_state
from home_mjx.audio_jax.auralization.envelope import energy_envelope
from home_mjx.audio_jax.auralization.response import early_response, late_response
from home_mjx.audio_jax.base.options import Ambisonics, MicrophoneArray, Motion, NoLate, Omni
from home_mjx.audio_jax.moving_sources.frames import render_frame
from home_mjx.audio_jax.moving_sources.receiver_state import is_truncated, late_state, silent_state
from home_mjx.audio_jax.parameters import survey_room
from home_mjx.audio_jax.receivers.channels import late_channel_gains
from home_mjx.core.transforms import camera_quat, quat_matrix
from home_mjx.errors import ConfigError

FOUR = ((0.05, 0.05, 0.05), (0.05, -0.05, -0.05), (-0.05, 0.05, -0.05), (-0.05, -0.05, 0.06))
ARRAY = AudioConfig(response_seconds=0.1, receiver=MicrophoneArray(FOUR))
WIDE = AudioConfig(response_seconds=0.1, receiver=MicrophoneArray(((0.9, 0, 0), (-0.9, 0, 0), (0, 0, 0.8))))
FOA = AudioConfig(response_seconds=0.1, receiver=Ambisonics())
OMNI = AudioConfig(response_seconds=0.1, receiver=Omni())
RATE, SPEED = ARRAY.sample_rate, ARRAY.speed_of_sound
AHEAD = jnp.float32([1, 0, 0, 0])
BAND = np.linspace(500, 5000, 181)
energies = jax.jit(energy_envelope, static_argnums=4)
_early = {c: jax.jit(lambda p, q, c=c: early_response(p, q, c)) for c in (ARRAY, WIDE, FOA, OMNI)}


def render(config, vectors, quat=AHEAD):
    """Paths of pressure 1 / r from images of the source, relative to the middle of the head."""
    vectors = np.atleast_2d(np.asarray(vectors, float))
    distance = np.linalg.norm(vectors, axis=1)
    gain = np.repeat(1 / distance[:, None], 7, axis=1)
    paths = Paths(*(jnp.asarray(x, jnp.float32) for x in (distance, gain, vectors / distance[:, None])))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(_early[config](paths, quat), float)


def arrival(response):
    """Delay [s] and level of each channel, by its phase and amplitude from 500 Hz to 5 kHz."""
    coarse = np.argmax(np.abs(response), axis=1) / RATE
    wave = np.exp(-2j * np.pi * np.outer(np.arange(response.shape[1]) / RATE, BAND))
    transfer = response @ wave * np.exp(2j * np.pi * np.outer(coarse, BAND))
    slope = [np.polyfit(2 * np.pi * BAND, np.unwrap(np.angle(row)), 1)[0] for row in transfer]
    return coarse - np.array(slope), np.mean(np.abs(transfer), axis=1)


@pytest.mark.parametrize("vector", [[30, 0, 0], [-4, 9, -20], [10, -15, 12.0]])
def test_plane_waves_reach_microphones_when_they_should(vector):
    """-r·u / c re the middle within 0.02 samples, from far away; all as loud within 1 %."""
    vector = np.array(vector, float)
    length = np.linalg.norm(vector)
    delay, level = arrival(render(ARRAY, vector))
    exact = (length - np.array(FOUR) @ vector / length) / SPEED
    np.testing.assert_allclose(delay * RATE, exact * RATE, atol=0.02)
    np.testing.assert_allclose(level * length, 1, rtol=0.01)


@pytest.mark.parametrize(
    ("config", "vector"), [(ARRAY, [0.3, 0.1, -0.4]), (ARRAY, [0, 1.2, 1]), (WIDE, [2.0, 0.5, -1])]
)
def test_spherical_waves_of_near_sources(config, vector):
    """Delay and level of the exact way to each microphone."""
    delay, level = arrival(render(config, vector))
    exact = np.linalg.norm(np.array(vector) - np.array(config.receiver.positions), axis=1)
    np.testing.assert_allclose(delay * RATE, exact / SPEED * RATE, atol=0.05)
    np.testing.assert_allclose(level * exact, 1, rtol=0.02)


def test_a_turned_head_takes_its_microphones_along():
    quat, vector = camera_quat(jnp.float32(0.7), jnp.float32(-0.4)), np.array([3.0, -8.0, 2.0])
    delay, _ = arrival(render(ARRAY, vector, quat))
    places = np.array(FOUR) @ np.asarray(quat_matrix(quat)).T
    np.testing.assert_allclose(delay * RATE, np.linalg.norm(vector - places, axis=1) / SPEED * RATE, atol=0.03)


def leads_of(sound, step=1 / 16):
    """[s] by pairs: phase transform, read between samples."""
    size = 2 * sound.shape[1]
    spectra, found = np.fft.rfft(sound, size), {}
    frequency = np.fft.rfftfreq(size, 1 / RATE)
    lags = np.arange(-8, 8, step) / RATE
    use = (frequency > 300) & (frequency < 7000)
    turn = np.exp(2j * np.pi * np.outer(frequency[use], lags))
    for i, j in itertools.combinations(range(len(sound)), 2):
        cross = np.conj(spectra[i]) * spectra[j]
        found[i, j] = lags[np.argmax(np.real((cross / np.abs(cross))[use] @ turn))]
    return found


def test_sources_in_the_open_are_found_within_two_degrees_by_four_microphones(rng):
    noise, worst = rng.normal(size=ARRAY.frame + ARRAY.response_length), 0.0
    for azimuth, elevation in itertools.product(np.radians(np.arange(0, 360, 45) + 7), np.radians([-50, 0, 35])):
        ring = np.cos(elevation)
        unit = np.array([ring * np.sin(azimuth), np.sin(elevation), -ring * np.cos(azimuth)])
        response = render(ARRAY, 6 * unit)
        heard = np.stack([fftconvolve(noise, x)[ARRAY.response_length : noise.size] for x in response])
        leads = leads_of(heard)
        rows = np.array([np.array(FOUR[i]) - FOUR[j] for i, j in leads])
        found = np.linalg.lstsq(rows / SPEED, np.array(list(leads.values())), rcond=None)[0]
        worst = max(worst, np.degrees(np.arccos(found @ unit / np.linalg.norm(found))))
    assert worst <= 2


@pytest.mark.parametrize("vector", [[1, 0, 0], [0.0, 2, 0], [0.5, -3, -4], [-6, 1, 9.0]])
def test_intensity_of_ambisonics_points_to_the_source(vector, rng):
    """W times Y, Z and X, within 0.2 degrees; levels of SN3D; all at once."""
    vector = np.array(vector, float)
    unit = vector / np.linalg.norm(vector)
    w, y, z, x = render(FOA, vector)
    flow = np.array([-w @ y, w @ z, -w @ x])
    assert np.degrees(np.arccos(np.clip(flow @ unit / np.linalg.norm(flow), -1, 1))) < 0.2
    np.testing.assert_allclose([y @ y + z @ z + x @ x], [w @ w], rtol=1e-4)


def test_without_a_late_part_there_are_as_many_channels():
    scene, ends = (
        scene_of(shoebox()),
        (SoundSource(jnp.float32([-1, -1, 1.2])), Listener(jnp.float32([1, 1, 1.6]), HEAD)),
    )
    config = AudioConfig(receiver=Ambisonics(), late=NoLate())
    run = lambda hear: jax.eval_shape(lambda: hear(scene, *ends, jax.random.key(0), config))  # noqa: E731
    assert run(energy_envelope).energy.shape[1] == 4
    assert run(impulse_response).shape == (4, config.response_length)


def test_w_is_the_omnidirectional_receiver():
    """Early sound to the last digits; late sound but for the signs of its octaves, so in level; also in energies."""
    scene, ends = (
        scene_of(shoebox()),
        (SoundSource(jnp.float32([-1, -1, 1.2])), Listener(jnp.float32([1, 1, 1.6]), HEAD)),
    )
    vectors = [[2, 3, -1.0], [-4, 1, 2]]
    np.testing.assert_allclose(render(FOA, vectors)[0], render(OMNI, vectors)[0], atol=1e-6)
    foa, omni = (AudioConfig(receiver=kind()) for kind in (Ambisonics, Omni))
    hear = jax.jit(impulse_response, static_argnums=4)
    ours, even = (np.asarray(hear(scene, *ends, jax.random.key(0), c), float) for c in (foa, omni))
    assert ours.shape == (4, foa.response_length)
    levels = [10 * np.log10(octave_energies(x[0], RATE)) for x in (ours, even)]
    np.testing.assert_allclose(*levels, atol=0.3)
    energy = [energies(scene, *ends, jax.random.key(0), c).energy for c in (foa, omni)]
    np.testing.assert_allclose(energy[0][:, 0], energy[1][:, 0], rtol=1e-4, atol=1e-9)
    whole = np.asarray(energy[0]).sum(axis=(0, 2))
    assert whole[1:].sum() == pytest.approx(whole[0], rel=1e-3)


def late(config, yaw=0.0, keys=6, levels=None):
    levels = np.ones(config.num_channels) if levels is None else np.asarray(levels)
    energy = jnp.asarray(np.broadcast_to(levels[:, None], (config.num_bins, levels.size, 7)), jnp.float32)
    quat = camera_quat(jnp.float32(yaw), jnp.float32(0.0))
    run = jax.jit(lambda key: late_response(energy, key, config, quat))
    return np.concatenate([np.asarray(run(jax.random.key(k)), float) for k in range(keys)], axis=1)


def coherence(a, b):
    """(frequencies, real coherence)."""
    frequency, cross = csd(a, b, RATE, nperseg=512)
    powers = [csd(x, x, RATE, nperseg=512)[1].real for x in (a, b)]
    return frequency, cross.real / np.sqrt(powers[0] * powers[1])


@pytest.mark.parametrize("yaw", [0.0, 1.1])
def test_late_sound_at_microphones_is_as_coherent_as_a_diffuse_field(yaw):
    """sin(kd) / (kd) in each octave from 250 Hz to 4 kHz, all pairs: 0.1."""
    config = AudioConfig(receiver=MicrophoneArray(((0, 0, 0), (0.05, 0, 0), (0, 0.2, 0), (0, 0, -0.12))))
    sound, place = late(config, yaw), np.array(config.receiver.positions)
    for i, j in itertools.combinations(range(4), 2):
        frequency, found = coherence(sound[i], sound[j])
        exact = np.sinc(2 * frequency * np.linalg.norm(place[i] - place[j]) / SPEED)
        for octave in (250, 500, 1000, 2000, 4000):
            inside = (frequency > octave / 2**0.5) & (frequency < octave * 2**0.5)
            assert np.mean(found[inside]) == pytest.approx(np.mean(exact[inside]), abs=0.1), (i, j, octave)


def test_a_turned_array_hears_other_noise_but_for_low_ones():
    config = AudioConfig(receiver=MicrophoneArray(((0.1, 0, 0), (-0.1, 0, 0), (0, 0, 0.1))))
    before, after = (late(config, yaw, keys=4) for yaw in (0.2, 0.2 + np.pi / 2))
    high = butterworth(4, 1500, "high", fs=RATE, output="sos")
    low = butterworth(4, 90, "low", fs=RATE, output="sos")
    for microphone in range(3):
        both = [[sosfilt(s, x[microphone]) for x in (before, after)] for s in (high, low)]
        assert abs(np.corrcoef(*both[0])[0, 1]) < 0.3
        assert np.corrcoef(*both[1])[0, 1] > 0.85


def test_one_microphone_in_the_middle_is_the_omnidirectional_receiver():
    one = AudioConfig(receiver=MicrophoneArray(((0, 0, 0),)))
    np.testing.assert_allclose(late(one)[0], late(AudioConfig(receiver=Omni()))[0], atol=1e-4)


def test_late_ambisonics_of_a_diffuse_field():
    """Y, Z and X have a third of the energy of W, and nothing in common; turned, they turn."""
    config = AudioConfig(receiver=Ambisonics())
    levels = [1, 1 / 3, 1 / 3, 1 / 3]
    sound = late(config, levels=levels)
    power = np.mean(sound**2, axis=1)
    np.testing.assert_allclose(power[1:] / power[0], 1 / 3, rtol=0.1)
    for i, j in itertools.combinations(range(4), 2):
        assert abs(np.corrcoef(sound[i], sound[j])[0, 1]) < 0.1
    turned = late(config, yaw=0.6, levels=levels)  # to the left
    w, y, z, x = sound
    np.testing.assert_allclose(turned[0], w, atol=1e-5)
    np.testing.assert_allclose(turned[2], z, atol=1e-5)
    np.testing.assert_allclose(turned[3], np.cos(0.6) * x + np.sin(0.6) * y, atol=1e-4)
    np.testing.assert_allclose(turned[1], np.cos(0.6) * y - np.sin(0.6) * x, atol=1e-4)


@pytest.mark.parametrize("config", [ARRAY, WIDE, FOA])
def test_frames_of_a_still_source_are_one_convolution(config, rng):
    config = dataclasses.replace(config, motion=Motion(tail_seconds=0.0))
    vectors = np.array([[1.1, 0.4, -1.5], [-3, 2, 2.5], [0.2, 11, 4]])
    distance = np.linalg.norm(vectors, axis=1)
    gain = rng.uniform(0.1, 1, (3, 7))
    paths = Paths(*(jnp.asarray(x, jnp.float32) for x in (distance, gain, vectors / distance[:, None])))
    still = silent_state(config).replace(paths=paths, quat=AHEAD)
    response = np.asarray(jax.jit(lambda p: early_response(p, AHEAD, config))(paths), float)
    noise = rng.normal(size=6 * config.frame)
    run = jax.jit(lambda s: render_frame(s, still, still, config))
    heard = []
    for begin in range(2 * config.frame, 5 * config.frame, config.frame):
        part = noise[begin + 1 - config.memory_length : begin + config.frame + config.num_lookahead]
        heard.append(np.asarray(run(jnp.asarray(part, jnp.float32)), float))
    heard = np.concatenate(heard, axis=1)
    assert heard.shape[0] == config.num_channels
    for channel, sound in zip(response, heard, strict=True):
        whole = fftconvolve(noise, channel)[2 * config.frame : 5 * config.frame]
        assert np.max(np.abs(sound - whole)) < 2e-5 * np.max(np.abs(response)) * np.max(np.abs(whole)) + 5e-5


def test_tones_of_a_source_passed_by_at_microphones_that_turn():
    """Against x(t - r / c) / r at each microphone, 1.4 m/s and 90 degrees a second: error below -35 dB."""
    config = AudioConfig(response_seconds=0.1, receiver=MicrophoneArray(FOUR), motion=Motion(tail_seconds=0.0))
    count, frame, frequency = 8, config.frame, 1500.0
    moments = np.arange(count + 1) * frame / RATE
    middle, span = moments.mean(), np.arange(1 - config.memory_length, frame + config.num_lookahead)
    run = jax.jit(lambda s, a, b: render_frame(s, a, b, config))

    def at(t):
        vector = np.array([1.4 * (t - middle), 0.2, -1.2])
        distance = np.linalg.norm(vector)
        parts = [distance], np.full((1, 7), 1 / distance), [vector / distance]
        paths = Paths(*(jnp.asarray(x, jnp.float32) for x in parts))
        half = np.pi / 4 * (t - middle)
        return silent_state(config).replace(paths=paths, quat=jnp.float32([np.cos(half), 0, np.sin(half), 0]))

    wave = lambda n: np.sin(2 * np.pi * frequency * n / RATE)  # noqa: E731
    heard = [
        run(jnp.asarray(wave(span + i * frame), jnp.float32), at(moments[i]), at(moments[i + 1])) for i in range(count)
    ]
    heard = np.concatenate([np.asarray(h, float) for h in heard], axis=1)
    time = np.arange(count * frame) / RATE
    place = np.stack([1.4 * (time - middle), 0.2 + 0 * time, -1.2 + 0 * time], 1)
    yaw = np.pi / 2 * (time - middle)
    for (x, y, z), sound in zip(FOUR, heard, strict=True):
        own = np.stack([x * np.cos(yaw) + z * np.sin(yaw), y + 0 * yaw, z * np.cos(yaw) - x * np.sin(yaw)], 1)
        distance = np.linalg.norm(place - own, axis=1)
        exact = wave((time - distance / SPEED) * RATE) / distance
        assert 10 * np.log10(np.mean((sound - exact) ** 2) / np.mean(exact**2)) < -35


@pytest.mark.parametrize(("part", "place"), [(0.6, (2, -3, 1)), (0.3, (-1, 0.5, -4)), (1.0, (0, 0, 1.0))])
def test_late_intensity_points_to_where_sound_comes_from(part, place):
    """Part of the sound from one direction, the rest from all over: energies, and the flow of each octave and turn."""
    config, rng = AudioConfig(receiver=Ambisonics()), np.random.default_rng(0)
    unit = np.array(place) / np.linalg.norm(place)
    around = rng.normal(size=(4000, 3))
    around = np.concatenate([around, -around]) / np.tile(np.linalg.norm(around, axis=1, keepdims=True), (2, 1))
    for yaw in (0.0, 2.0):
        quat = camera_quat(jnp.float32(yaw), jnp.float32(0.3))
        own, other = (
            np.asarray(late_channel_gains(jnp.float32(x), quat, config))[..., 0] for x in (unit[None], around)
        )
        levels = part * own[0] + (1 - part) * other.mean(axis=0)
        energy = jnp.asarray(np.broadcast_to(levels[:, None], (config.num_bins, 7, 7)), jnp.float32)
        keys = [jax.random.key(k) for k in range(8)]
        run = jax.jit(lambda key, energy=energy, quat=quat: late_response(energy, key, config, quat))
        w, y, z, x = np.concatenate([np.asarray(run(key), float) for key in keys], axis=1)
        np.testing.assert_allclose(np.mean(np.square([w, y, z, x]), axis=1) / np.mean(w**2), levels[:4], atol=0.03)
        flow = np.asarray(quat_matrix(quat)) @ [-w @ y, w @ z, -w @ x] / (w @ w)
        np.testing.assert_allclose(flow, part * unit, atol=0.04)


@pytest.mark.parametrize("config", [ARRAY, FOA])
def test_receptions_have_as_many_channels(config):
    config = dataclasses.replace(config, motion=Motion(tail_seconds=0.2))
    scene = scene_of(shoebox(absorption=0.03))
    ends = SoundSource(jnp.float32([-1, -1, 1.2])), Listener(jnp.float32([1, 1, 1.6]), HEAD)
    heard = jax.jit(render_receiver_state, static_argnums=4)(scene, *ends, jax.random.key(0), config)
    assert heard.energy.shape == (config.num_bins, config.num_late_channels, 7)
    assert config.num_late_channels == (7 if isinstance(config.receiver, Ambisonics) else 4)
    assert jax.tree.map(jnp.shape, heard) == jax.tree.map(jnp.shape, silent_state(config))
    assert late_state(heard, config).shares.bin_weights().shape[:2] == (config.num_bins, 4)
    assert bool(is_truncated(heard, config))  # after 0.3 s of a room that rings for 2


@pytest.mark.parametrize(
    "wrong",
    [
        (),
        "left",
        ((0, 0),),
        ("abc",),
        ((0, 0, float("nan")),),
        ((0, 0, 1.5),),
        ((0, 0, 0),) * 33,
    ],
)
def test_bad_microphones_are_refused(wrong):
    with pytest.raises(ConfigError, match="positions"):
        MicrophoneArray(wrong)


def test_lists_of_microphones_are_hashable_and_surveys_want_ears():
    config = AudioConfig(receiver=MicrophoneArray([[0, 0, 0.1]]))
    assert hash(config) == hash(AudioConfig(receiver=MicrophoneArray(((0.0, 0.0, 0.1),))))
    scene, ends = scene_of(shoebox()), (SoundSource(jnp.zeros(3)), Listener(jnp.ones(3), HEAD))
    with pytest.raises(ConfigError, match="two ears"):
        survey_room(scene, *ends, jax.random.key(0), config)
