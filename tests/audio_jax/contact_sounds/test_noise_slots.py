"""Slots of noises against a loop over samples, and the sound bank against the model that it states."""

import itertools

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.contact_sounds.options import ContactSoundConfig
from home_mjx.audio_jax.contact_sounds.sound_bank import (
    FLOORS,
    IMPACT_MATERIALS,
    SUSTAINED,
    TRANSIENTS,
    sustained_bank,
    transient_bank,
)
from home_mjx.audio_jax.contact_sounds.sound_slots import (
    TransientSounds,
    add_transients,
    emitted_power,
    emitted_signals,
    empty_contact_sounds,
    num_stored_frames,
    update_sustained,
)
from home_mjx.errors import ConfigError

AUDIO = AudioConfig(response_seconds=0.2)
FRAME, RATE = AUDIO.frame, AUDIO.sample_rate


def blows(gain, start, row=0) -> TransientSounds:
    count = len(gain)
    return TransientSounds(
        pos=jnp.zeros((count, 3)) + jnp.arange(count, dtype=jnp.float32)[:, None],
        body=jnp.full(count, -1),
        row=jnp.full(count, row),
        gain=jnp.float32(gain),
        start=jnp.array(start, jnp.int32),
    )


def power(sound, low, high) -> float:
    spectrum = np.abs(np.fft.rfft(sound)) ** 2
    frequency = np.fft.rfftfreq(len(sound), 1 / RATE)
    return spectrum[(frequency >= low) & (frequency < high)].sum() / spectrum.sum()


def test_levels_of_the_bank_are_those_of_its_tables():
    """RMS of the first 0.1 s; soft floors lack the band of friction; metal rings on, plastic does not."""
    bank = dict(zip(TRANSIENTS, transient_bank(RATE), strict=True))
    first = {name: 20 * np.log10(np.sqrt(np.mean(x[: RATE // 10] ** 2)) / 0.1) for name, x in bank.items()}
    assert all(
        first[f"step_{name}_{i}"] == pytest.approx(f.level, abs=0.01) for name, f in FLOORS.items() for i in (0, 3)
    )
    assert all(first[f"hit_{name}"] == pytest.approx(stuff.level, abs=0.01) for name, stuff in IMPACT_MATERIALS.items())
    above = {name: power(bank[f"step_{name}_1"], 1000, 8000) for name in FLOORS}
    assert above["hard"] > 2 * above["wood"] > 4 * above["soft"]
    late = {
        name: np.sum(bank[f"hit_{name}"][RATE // 5 :] ** 2) / np.sum(bank[f"hit_{name}"] ** 2)
        for name in IMPACT_MATERIALS
    }
    assert late["metal"] > 0.1 > 1e-4 > late["plastic"]
    assert not np.array_equal(bank["step_wood_0"], bank["step_wood_1"])


def test_modes_decay_as_their_friction_says():
    """Wood's lowest mode, 350 Hz and tan φ 0.02, falls by 8.686 π f tan φ = 191 dB/s."""
    sound = transient_bank(RATE)[TRANSIENTS.index("hit_wood")].astype(float)
    level = [20 * np.log10(np.sqrt(np.mean(sound[round(t * RATE) :][: RATE // 50] ** 2))) for t in (0.1, 0.2)]
    assert level[0] - level[1] == pytest.approx(0.1 * 8.686 * np.pi * 350 * 0.02, abs=1.0)


def test_loops_have_no_seam():
    """The step from the last sample to the first is none that does not occur within."""
    for row in sustained_bank(RATE):
        inside = np.abs(np.diff(row))
        assert abs(row[0] - row[-1]) <= inside.max()


def test_frames_of_noises_join():
    """What left in a frame is what the next one takes for its past; one sample after the other, by a loop."""
    noises, time = empty_contact_sounds(ContactSoundConfig(num_transients=2, num_sustained=1), AUDIO, 1), 3 * FRAME
    strikes, lost = add_transients(
        noises.transients, blows([0.5, 0.0, 2.0], [time + 7, 0, time + 900], 4), AUDIO, jnp.int32(time)
    )
    assert not lost
    rub = jnp.zeros((1, 3)), jnp.array([5]), jnp.array([SUSTAINED.index("creak")])
    gains, windows = [0.3, 1.0, 0.0], []
    for i, gain in enumerate(gains):
        rubs, lost = update_sustained(noises.sustained, *rub, jnp.float32([gain]))
        assert not lost
        noises = noises.replace(transients=strikes, sustained=rubs)
        windows.append(np.asarray(emitted_signals(noises, jnp.int32(time + i * FRAME), AUDIO)))
    past = AUDIO.memory_length - 1
    for earlier, later in itertools.pairwise(windows):
        np.testing.assert_allclose(later[:, past - FRAME : past], earlier[:, past:], atol=1e-6)
    bank, creak = transient_bank(RATE), sustained_bank(RATE)[SUSTAINED.index("creak")]
    expected = np.zeros((2, FRAME))
    for n in range(FRAME):
        for k, (gain, start) in enumerate([(2.0, 900), (0.5, 7)]):
            expected[k, n] = gain * bank[4][n - start] if n >= start else 0
    np.testing.assert_allclose(windows[0][:2, past:], expected, atol=1e-6)
    for frame, (before, after) in enumerate(zip([0.0, *gains], gains, strict=False)):
        line = before + (after - before) * np.arange(1, FRAME + 1) / FRAME
        played = creak[(time + frame * FRAME + np.arange(FRAME)) % len(creak)]
        np.testing.assert_allclose(windows[frame][2, past:], line * played, atol=1e-6)


def test_the_oldest_slot_goes_first_and_losses_are_told():
    keep = empty_contact_sounds(ContactSoundConfig(num_transients=2), AUDIO, 1).transients
    first, lost = add_transients(keep, blows([1.0], [0]), AUDIO, jnp.int32(0))
    second, also = add_transients(first, blows([0.2], [FRAME]), AUDIO, jnp.int32(FRAME))
    assert not lost
    assert not also
    assert sorted(np.asarray(second.gain)) == pytest.approx([0.2, 1.0])
    late = jnp.int32(10 * FRAME)
    third, lost = add_transients(second, blows([3.0], [10 * FRAME]), AUDIO, late)
    assert sorted(np.asarray(third.gain)) == pytest.approx([0.2, 3.0])  # the first one has gone
    assert not lost
    assert bool(add_transients(third, blows([1.0, 2.0, 4.0], [late] * 3), AUDIO, late)[1])  # three into two
    assert bool(add_transients(second, blows([1.0], [2 * FRAME]), AUDIO, jnp.int32(2 * FRAME))[1])  # cut off
    nothing, lost = add_transients(second, blows([0.0, 0.0], [0, 0]), AUDIO, late)
    assert not lost
    jax.tree.map(np.testing.assert_array_equal, nothing, second)


def test_rubs_keep_their_slot_until_they_are_forgotten():
    rubs = empty_contact_sounds(ContactSoundConfig(num_sustained=1), AUDIO, 1).sustained
    who = jnp.zeros((3, 3)), jnp.array([7, 8, 9]), jnp.array([0, 1, 2])
    rubs, lost = update_sustained(rubs, *who, jnp.float32([0, 0.5, 0.2]))
    assert bool(lost)
    assert (int(rubs.emitter[0]), int(rubs.body[0])) == (1, 8)
    rubs, lost = update_sustained(rubs, *who, jnp.float32([0, 0.1, 0]))
    assert not lost
    for _ in range(num_stored_frames(AUDIO)):
        rubs, lost = update_sustained(rubs, *who, jnp.zeros(3))
        assert not lost
    rubs, lost = update_sustained(rubs, *who, jnp.float32([0.9, 0, 0]))
    assert not lost
    assert int(rubs.emitter[0]) == 0
    np.testing.assert_allclose(rubs.gain[0, :2], [0.9, 0.0])


def test_power_is_that_of_the_waveform():
    """Summed over octaves and over the past."""
    noises, time = empty_contact_sounds(ContactSoundConfig(), AUDIO, 1), jnp.int32(8 * FRAME)
    strikes, _ = add_transients(noises.transients, blows([0.5, 2.0], [7 * FRAME, 7 * FRAME + 640], 0), AUDIO, time)
    noises = noises.replace(transients=strikes)
    wave = np.asarray(emitted_signals(noises, time, AUDIO))
    bins = np.asarray(emitted_power(noises, time, AUDIO))
    for k in (0, 1):
        assert bins[k].sum() * AUDIO.bin_samples == pytest.approx(np.sum(wave[k] ** 2), rel=0.02)


@pytest.mark.parametrize("wrong", [{"num_transients": 0}, {"num_sustained": 0}, {"step_length": 0.0}])
def test_options_that_cannot_be_used(wrong):
    with pytest.raises(ConfigError, match=next(iter(wrong))):
        ContactSoundConfig(**wrong)
