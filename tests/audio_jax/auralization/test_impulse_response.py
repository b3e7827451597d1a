"""The whole response of two ears in a house."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox, two_rooms
from numpy_measures import octave_energies, t30
from scenes import HEAD, open_air, scene_of

from home_mjx.audio_jax.auralization.clips import clip_samples
from home_mjx.audio_jax.auralization.convolution import convolve_clip_frame
from home_mjx.audio_jax.auralization.envelope import energy_envelope
from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource, is_indoors
from home_mjx.audio_jax.base.options import Omni, Traced
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.scene.scene import make_scene

BINAURAL, OMNI = AudioConfig(), AudioConfig(receiver=Omni())
RATE, SPEED = BINAURAL.sample_rate, BINAURAL.speed_of_sound
KEY = jax.random.key(0)


def hear(scene, source, listener, quat=HEAD, key=KEY, config=BINAURAL, exclude=-1):
    """The response, under strict promotion."""
    source, listener = (jnp.asarray(p, jnp.float32) for p in (source, listener))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(_run(scene, source, listener, quat, key, jnp.int32(exclude), config), float)


def _response(scene, source, listener, quat, key, exclude, config):
    return impulse_response(scene, SoundSource(source), Listener(listener, quat, exclude), key, config)


_run = jax.jit(_response, static_argnums=6)


@pytest.mark.parametrize("distance", [1.0, 2.5, 7.3])
def test_in_the_open(distance):
    """Delay within 0.05 samples of r / c and level within 0.05 dB of 1 / r (air taken out) at 1 kHz."""
    listener = np.array([-2.2, 2.4, 9.0])
    source = listener + distance * np.array([0.6, -0.64, 0.48])
    response = hear(open_air(), source, listener, config=OMNI)[0]
    frequency = np.linspace(700, 1300, 61)
    transfer = response @ np.exp(-2j * np.pi * np.outer(np.arange(response.size) / RATE, frequency))
    transfer *= np.exp(2j * np.pi * frequency * distance / SPEED)
    lag = -np.polyfit(2 * np.pi * frequency, np.unwrap(np.angle(transfer)), 1)[0] * RATE
    assert abs(lag) < 0.05
    assert np.mean(20 * np.log10(np.abs(transfer) * distance)) == pytest.approx(0, abs=0.05)
    assert int(np.argmax(np.abs(response))) == pytest.approx(distance / SPEED * RATE, abs=1)


def test_heads_whose_quaternion_is_not_of_unit_length_are_refused_and_inside_jit_hear_nothing():
    source, ears = jnp.zeros(3), jnp.array([1.0, 2.0, 9.0])
    for quat in (1.05 * HEAD, 0 * HEAD, jnp.nan * HEAD):
        with pytest.raises(ConfigError, match="a listener's quaternion must have unit length, got"):
            impulse_response(open_air(), SoundSource(source), Listener(ears, quat), KEY, BINAURAL)
    for quat in (1.05 * HEAD, 0 * HEAD):
        assert not hear(open_air(), source, ears, quat).any()
    assert hear(open_air(), source, ears, 1.001 * HEAD).any()


def test_inside_jit_envelopes_of_heads_whose_quaternion_is_not_of_unit_length_are_silent():
    scene, config = scene_of(shoebox((5.0, 4.0, 3.0))), AudioConfig(late=Traced(num_rays=8, num_bounces=3))
    source, ears = SoundSource(jnp.array([-1.5, 1.0, 1.5])), jnp.array([1.0, -0.5, 1.5])
    run = jax.jit(lambda quat: energy_envelope(scene, source, Listener(ears, quat), KEY, config))
    heard, silent = run(HEAD), run(1.05 * HEAD)
    assert heard.energy.sum() > 1e-3
    assert not silent.energy.any()
    assert not silent.left_ear_lead.any()


@pytest.mark.parametrize(("y", "nearer"), [(3.0, 0), (-3.0, 1)])
def test_left_and_right(y, nearer):
    """An agent that looks along +x has +y at its left; the nearer ear hears earlier and louder, as on the sphere."""
    left_right = hear(open_air(), [1.0, y / 2, 9.0], [1.0, -y / 2, 9.0])
    near, far = left_right[nearer], left_right[1 - nearer]
    level = 10 * np.log10(octave_energies(near, RATE) / octave_energies(far, RATE))
    assert np.all(level[2:] > 1.5)
    assert np.argmax(np.abs(near)) < np.argmax(np.abs(far))
    transfer = [e @ np.exp(-2j * np.pi * 250 * np.arange(e.size) / RATE) for e in (near, far)]
    delay = np.angle(transfer[0] / transfer[1]) / (2 * np.pi * 250)
    assert delay == pytest.approx(781e-6, abs=8e-6)


def test_turning_the_head_by_half_a_turn_swaps_the_ears():
    """Mirror symmetry of the sphere, for sound from the side."""
    scene = open_air()
    turned = jnp.float32([0.5, 0.5, 0.5, 0.5])  # looks along -x
    ends = [1, 2, 9.0], [1, -1, 9.0]
    ahead = hear(scene, *ends)
    back = hear(scene, *ends, quat=turned)
    np.testing.assert_allclose(ahead, back[::-1], atol=1e-5)


def test_nothing_arrives_before_the_direct_sound():
    """Late noise starts no earlier than the direct sound reaches the head, also when no path is there."""
    for wall in (0.3, 0.0):
        response = hear(scene_of(two_rooms(transmission=wall)), [-3, 0, 1.2], [-1, 1, 1.6], config=OMNI)
        first = int(np.sqrt(4 + 1 + 0.16) / SPEED * RATE)
        assert np.sum(response[:, : first - 24] ** 2) < 1e-4 * np.sum(response**2)


@pytest.mark.parametrize(("scattering", "expected"), [(0.1, 0.565), (0.3, 0.534), (1.0, 0.539)])
def test_reverberation_of_the_rendered_response(scattering, expected):
    """T30 at 1 kHz within 15 %, default options, from the samples themselves."""
    scene = scene_of(shoebox(scattering=scattering))
    config = AudioConfig(response_seconds=1.0, receiver=Omni())
    response = hear(scene, [-1, -1, 1.2], [1, 1, 1.6], config=config)[0]
    spectrum = np.fft.rfft(response, 2 * response.size)
    frequency = np.fft.rfftfreq(2 * response.size, 1 / RATE)
    band = np.fft.irfft(spectrum * ((frequency > 707) & (frequency < 1414)))[: response.size]
    assert t30(band**2, 1 / RATE) == pytest.approx(expected, rel=0.15)


def test_a_wall_between_takes_its_table_value():
    """Level of the response's first 10 ms per octave, with the wall against without it."""
    loss = np.array([17, 31, 33, 40, 38, 36, 36])
    ends = [-3, 0.5, 1.2], [3, -0.5, 1.6]
    walled = hear(scene_of(two_rooms(transmission=10 ** (-loss / 10), absorption=0.5)), *ends, config=OMNI)
    free = hear(open_air(), [0, 0.5, 4], [0.4, -0.5, 10], config=OMNI)  # as far
    drop = 10 * np.log10(octave_energies(free[0], RATE) / octave_energies(walled[0], RATE))
    np.testing.assert_allclose(drop, loss, atol=0.9)


def test_the_same_key_gives_the_same_response_and_small_steps_small_changes():
    """2 cm of a way change little with the same key; the early part moves by its delay, the tail stays coherent."""
    scene = scene_of(shoebox())
    here = hear(scene, [-1, -1, 1.2], [1, 1, 1.6], config=OMNI)
    np.testing.assert_array_equal(here, hear(scene, [-1, -1, 1.2], [1, 1, 1.6], config=OMNI))
    near = hear(scene, [-1, -1, 1.2], [1.02, 1, 1.6], config=OMNI)
    other = hear(scene, [-1, -1, 1.2], [1, 1, 1.6], config=OMNI, key=jax.random.key(1))
    late = slice(RATE // 20, None)
    assert np.corrcoef(here[0, late], near[0, late])[0, 1] > 0.97
    assert abs(np.corrcoef(here[0, late], other[0, late])[0, 1]) < 0.2


@pytest.mark.parametrize(("point", "inside"), [((1, 1, 1), True), ((0, 0.3, 1), False), ((20, 1, 1), False)])
def test_sources_in_walls_and_outside_are_told(point, inside):
    """Rooms on both sides of a wall at x = 0, under strict promotion."""
    scene, place = scene_of(two_rooms()), jnp.float32(point)
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        rooms = [bool(jax.jit(is_indoors)(scene, side)) for side in (place, place * jnp.float32([-1, 1, 1]))]
    assert any(rooms) == inside  # the map of this house covers one of its rooms


def test_own_body_is_no_obstacle():
    """A listener inside its agent's capsule."""
    house = shoebox()
    scene = scene_of(house, agents=((1.0, 1.0, 0.8),))
    without = scene_of(house)
    own = hear(scene, [-1, -1, 1.2], [1, 1, 1.5], exclude=scene.bank.spec.num_instances)
    free = hear(without, [-1, -1, 1.2], [1, 1, 1.5])
    assert np.sum((own - free) ** 2) < 0.01 * np.sum(free**2), "the body only shades what other surfaces receive"
    inside = hear(scene, [-1, -1, 1.2], [1, 1, 1.5])
    assert np.sum(inside**2) < 0.5 * np.sum(own**2)


def test_source_in_the_head_stays_finite():
    response = hear(scene_of(shoebox()), [1, 1, 1.5], [1, 1, 1.5])
    assert np.all(np.isfinite(response))


def test_a_step_over_different_houses_in_one_batch():
    """Responses and frames of environments in two houses, vmapped, equal those of each alone."""
    houses = shoebox(furniture=[Furniture((0.5, 0.5), mass=4.0)]), two_rooms()
    bank = scene_of(*houses).bank
    clip = jnp.asarray(clip_samples("speech", BINAURAL))

    def step(house, source, listener, key, old):
        pos, quat = bank.physics.body_pos[house], bank.physics.body_quat[house]
        scene = make_scene(bank, house, pos, quat, jnp.zeros((0, 3)), jnp.zeros((0, 4)))
        new = impulse_response(scene, SoundSource(source), Listener(listener, HEAD), key, BINAURAL)
        return new, convolve_clip_frame(clip, jnp.int32(7000), old, new, BINAURAL)

    house = jnp.array([0, 1, 0, 1], jnp.int32)
    source = jnp.float32([[-1, -1, 1.2], [-2, -1, 1.2], [1.5, 1, 1], [2, 1, 1]])
    listener = jnp.float32([[1, 1, 1.6], [-1, 1, 1.6], [-1.5, 0, 1.5], [3, -1, 1.5]])
    keys, old = jax.random.split(KEY, 4), jnp.zeros((4, 2, BINAURAL.response_length))
    responses, frames = jax.jit(jax.vmap(step))(house, source, listener, keys, old)
    assert frames.shape == (4, 2, BINAURAL.frame)
    single = jax.jit(step)
    for i in range(4):
        response, frame = single(house[i], source[i], listener[i], keys[i], old[i])
        np.testing.assert_allclose(responses[i], response, atol=2e-3 * np.max(np.abs(response)))
        np.testing.assert_allclose(frames[i], frame, atol=2e-3 * np.max(np.abs(frame)))
