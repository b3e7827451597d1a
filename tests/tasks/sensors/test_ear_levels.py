"""Levels and delays at both ears beside the waveform that the same rays give."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox

from home_mjx import HouseBank, HouseholdEnv, physics
from home_mjx.audio_jax import CLIPS, AudioConfig, clip_samples
from home_mjx.audio_jax.auralization.envelope import clip_power, mean_band_power
from home_mjx.tasks import make_config
from home_mjx.tasks.language import tokenize

OCTAVES = 125 * 2.0 ** np.arange(7)
TONE, NOISE, SILENT = CLIPS.index("tone"), CLIPS.index("noise"), -1
OPTIONS = {
    "impl": "kinematic",
    "sensors": ("audio", "ear_levels"),
    "clips": ("tone", "noise"),
    "actions": "discrete",
    "late": "traced",
    "motion": False,
}


@pytest.fixture(scope="module")
def heard():
    """A function from the clip, schedule and yaw to what is heard in the third frame of 0.3 s."""
    core = HouseholdEnv(make_config(num_agents=2, speech=("say:yes",), **OPTIONS))
    env = core.bind(HouseBank.from_compiled([shoebox((9.0, 7.0, 3.0), absorption=0.5)]))
    begun = jax.jit(functools.partial(core.reset, observe=False))(env.params, jax.random.key(0))
    template = core.template(env.bank)
    perceive = jax.jit(functools.partial(core.observe, update=True))
    angle = physics.door_angle(template, begun.physics)

    def hear(clip, yaw=0.0, duration=jnp.inf, gain=1.0, spoken_token=SILENT):
        pos = jnp.array([[0.5, 0.2, 0.0], [-3.0, -2.5, 0.0]], jnp.float32)
        yaws = jnp.array([yaw, 0.0], jnp.float32)
        state = begun.replace(physics=physics.reset(template, env.bank, begun.world.house, pos, yaws, angle, None))
        sounds = state.world.sounds
        agent = env.bank.spec.num_instances + 1
        sounds = sounds.replace(
            pos=jnp.array([[2.0, 0.2, 1.5]], jnp.float32),
            clip=jnp.full_like(sounds.clip, clip),
            body=jnp.full_like(sounds.body, agent if clip == -2 else -1),
            gain=jnp.full_like(sounds.gain, gain),
            duration=jnp.full_like(sounds.duration, duration),
        )
        for step in range(3):
            words = jnp.array([-1, spoken_token if step == 2 else -1], jnp.int32)
            world = state.world.replace(sounds=sounds, step=jnp.int32(step), spoken_token=words)
            state = perceive(env.params, state.replace(world=world))
        audio, levels = np.asarray(state.obs["audio"][0], float), np.asarray(state.obs["ear_levels"][0]).reshape(2, 7)
        np.testing.assert_allclose(state.obs["ear_difference"][0], levels[0] - levels[1], atol=1e-4)
        return audio, levels, float(state.obs["ear_delay"][0, 0])

    return hear


def octave_levels(audio):
    """By the periodogram: power between the edges of each octave [dB]."""
    power = 2 * np.abs(np.fft.rfft(audio)) ** 2 / audio.shape[-1] ** 2
    frequency = np.fft.rfftfreq(audio.shape[-1], 1 / 16000)
    inside = (frequency[None] >= OCTAVES[:, None] / 2**0.5) & (frequency[None] < OCTAVES[:, None] * 2**0.5)
    return 10 * np.log10(np.maximum(power @ inside.T, 1e-12))


@pytest.mark.parametrize("yaw", [0.0, np.pi / 2, -np.pi / 2])
def test_levels_are_those_of_the_waveform(heard, yaw):
    audio, levels, _ = heard(NOISE, yaw)
    expected = octave_levels(audio)
    np.testing.assert_allclose(levels[:, 2:6], expected[:, 2:6], atol=4.0)  # 500 Hz to 4 kHz; below, a frame is short
    assert np.abs(levels[:, 2:6] - expected[:, 2:6]).mean() < 1.6


def test_a_tone_is_in_its_octave(heard):
    """One frequency interferes, at each place of an ear another way: power is compared in the mean over some."""
    found = [heard(TONE, yaw)[:2] for yaw in (0.0, np.pi / 2, np.pi, -np.pi / 2)]
    levels = np.concatenate([levels for _, levels in found])
    assert (levels.argmax(axis=1) == 3).all()
    assert (levels[:, [0, 1, 5, 6]] < levels[:, 3:4] - 40).all()
    audio = np.concatenate([octave_levels(audio) for audio, _ in found])
    means = [10 * np.log10((10 ** (x[:, 3] / 10)).mean()) for x in (levels, audio)]
    np.testing.assert_allclose(*means, atol=3.0)


def test_the_nearer_ear_is_louder_and_earlier(heard):
    """The source is to the east; who looks to the north has it at the right, to the south at the left."""
    (_, ahead, none), (_, right, late), (_, left, early) = (heard(NOISE, yaw) for yaw in (0.0, np.pi / 2, -np.pi / 2))
    assert abs(none) < 0.1
    assert 0.15 < early < 0.8
    np.testing.assert_allclose(late, -early, atol=0.1)
    assert left[0, 4] > left[1, 4] + 2
    assert right[1, 4] > right[0, 4] + 2
    assert abs(ahead[0, 4] - ahead[1, 4]) < 2


def test_gains_schedules_and_silence(heard):
    levels = heard(NOISE)[1]
    np.testing.assert_allclose(heard(NOISE, gain=0.1)[1], levels - 20, atol=0.01)
    _, silent, delay = heard(SILENT)
    assert (silent == -100).all()
    assert delay == 0
    audio, ended, _ = heard(NOISE, duration=0.5)  # only its reverberation is left in the third frame
    assert (ended[:, 2:6] < levels[:, 2:6] - 6).all()
    np.testing.assert_allclose(ended[:, 2:6].mean(), octave_levels(audio)[:, 2:6].mean(), atol=4.0)


def test_voices_are_levels_as_well(heard):
    audio, levels, _ = heard(-2, spoken_token=tokenize("yes")[0])
    total = 10 * np.log10((10 ** (levels / 10)).sum()), 10 * np.log10((audio**2).mean(axis=1).sum())
    np.testing.assert_allclose(*total, atol=4.0)
    assert (heard(-2)[1] == -100).all()


def test_power_of_a_frame_by_hand():
    """Of bins of power and an envelope drawn at random: the plain double sum."""
    random = np.random.default_rng(0)
    envelope, power = random.random((5, 2, 7)), random.random((5 - 1 + 3, 7))
    expected = np.zeros((2, 7))
    for bin_, ago in np.ndindex(3, 5):
        expected += envelope[ago] * power[4 + bin_ - ago] / 3
    found = mean_band_power(jnp.asarray(envelope, jnp.float32), jnp.asarray(power, jnp.float32))
    np.testing.assert_allclose(found, expected, rtol=1e-5)


@pytest.mark.parametrize("name", ["tone", "speech"])
def test_the_power_of_clips_is_that_of_their_samples(name):
    """Energies of octaves add up, also where they overlap."""
    power, samples = clip_power(name, AudioConfig()), clip_samples(name, AudioConfig())
    assert power.sum(axis=1).mean() == pytest.approx(np.mean(samples**2), rel=5e-3)


def test_a_tone_between_two_octaves_has_all_its_power_in_both(monkeypatch):
    """At 710 Hz; amplitude gains of one half would leave half of the power."""
    tone = np.sin(2 * np.pi * 710 * np.arange(32_000) / 16_000)
    monkeypatch.setattr("home_mjx.audio_jax.auralization.envelope.clip_samples", lambda name, config: tone)
    power = clip_power.__wrapped__("tone", AudioConfig())
    assert power.sum(axis=1).mean() == pytest.approx(0.5, rel=5e-3)
