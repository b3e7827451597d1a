"""Sound of moving sources against x(t - r(t) / c) / r(t), evaluated directly."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from scipy.signal import fftconvolve

from home_mjx.audio_jax import AudioConfig, Paths
from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.options import Motion, Omni
from home_mjx.audio_jax.moving_sources.frames import render_frame, render_frames
from home_mjx.audio_jax.moving_sources.receiver_state import pad_paths, silent_state
from home_mjx.audio_jax.receivers.spherical_head import near_sphere_spectrum

OMNI = AudioConfig(response_seconds=0.1, receiver=Omni(), motion=Motion(tail_seconds=0.0))
EARS = AudioConfig(response_seconds=0.1, motion=Motion(tail_seconds=0.0))
RATE, SPEED, FRAME = OMNI.sample_rate, OMNI.speed_of_sound, OMNI.frame
AHEAD = jnp.float32([1, 0, 0, 0])
NEAR = np.linspace(1.19, 1.3, 6)  # [m]


def received(vectors, config=OMNI, quat=AHEAD, gain=None, name=None):
    """Nothing but paths from the given image sources, relative to the head."""
    vectors = np.atleast_2d(np.asarray(vectors, float))
    distance = np.linalg.norm(vectors, axis=1)
    gain = np.repeat(1 / distance[:, None], 7, axis=1) if gain is None else gain
    paths = Paths(*(jnp.asarray(x, jnp.float32) for x in (distance, gain, vectors / distance[:, None])), name)
    return silent_state(config).replace(paths=paths, quat=jnp.asarray(quat, jnp.float32))


def streamed(signal, places, config=OMNI, quats=None):
    """Frames between the given moments, joined; `signal` is a function of time in samples."""
    span = np.arange(1 - config.memory_length, FRAME + config.num_lookahead)
    heard = []
    for i in range(len(places) - 1):
        turn = (AHEAD, AHEAD) if quats is None else (quats[i], quats[i + 1])
        old, new = (received(places[i + j], config, turn[j]) for j in (0, 1))
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            heard.append(_run[config](jnp.asarray(signal(span + i * FRAME), jnp.float32), old, new))
    return np.concatenate([np.asarray(h, float) for h in heard], axis=1)


_run = {c: jax.jit(lambda s, a, b, c=c: render_frame(s, a, b, c)) for c in (OMNI, EARS)}


@pytest.mark.parametrize("speed", [1.0, 1.4])
@pytest.mark.parametrize("frequency", [500.0, 1000.0, 2000.0, 4000.0])
def test_tones_of_a_source_passed_by(frequency, speed):
    """Past it at 1 m: error below -30 dB, pitch within 0.05 %, level within 1 dB of 1 / r, and no steps."""
    count = 12
    moments = np.arange(count + 1) * FRAME / RATE
    along = speed * (moments - moments.mean())
    heard = streamed(lambda n: np.sin(2 * np.pi * frequency * n / RATE), np.stack([along, 1 + 0 * along, 0 * along], 1))
    time = np.arange(count * FRAME) / RATE
    distance = np.hypot(speed * (time - moments.mean()), 1.0)
    exact = np.sin(2 * np.pi * frequency * (time - distance / SPEED)) / distance
    error = np.mean((heard[0] - exact) ** 2) / np.mean(exact**2)
    assert 10 * np.log10(error) < -40
    tone = np.exp(-2j * np.pi * frequency * time) * heard[0]
    window = np.hanning(640)
    mean = np.convolve(tone, window / window.sum(), "valid")
    level = 20 * np.log10(2 * np.abs(mean) * distance[320 : 320 + mean.size])
    assert np.ptp(level) < 1
    pitch = frequency + np.gradient(np.unwrap(np.angle(mean))) * RATE / (2 * np.pi)
    rate = np.gradient(distance, 1 / RATE)[320 : 320 + mean.size]
    assert np.max(np.abs(pitch / (frequency * (1 - rate / SPEED)) - 1)) < 5e-4


@pytest.mark.parametrize("config", [OMNI, EARS])
def test_a_still_path_is_one_convolution(config, rng):
    """Of noise, with uneven octaves, within 2e-5; near and far paths."""
    gain = rng.uniform(0.1, 1, (3, 7))
    vectors = np.array([[1.1, 0.4, -1.5], [-3, 2, 2.5], [0.2, 11, 4]])
    noise = rng.normal(size=6 * FRAME)
    start = 2 * FRAME
    still = received(vectors, config, gain=gain)
    response = np.asarray(early_response(still.paths, AHEAD, config), float)
    heard = []
    for i in range(3):
        begin = start + i * FRAME
        part = noise[begin + 1 - config.memory_length : begin + FRAME + config.num_lookahead]
        heard.append(np.asarray(_run[config](jnp.asarray(part, jnp.float32), still, still), float))
    heard = np.concatenate(heard, axis=1)
    for ear in range(2):
        whole = fftconvolve(noise, response[ear])[start : start + heard.shape[1]]
        assert np.max(np.abs(heard[ear] - whole)) < 2e-5 * np.max(np.abs(whole))


@pytest.mark.parametrize("frequency", [500.0, 2000.0, 4000.0])
def test_ears_of_a_head_that_walks_and_turns(frequency):
    """Against the series of the rigid sphere at every moment: both ears, 1 m/s past a source, turning by 90°/s."""
    count = 8
    moments = np.arange(count + 1) * FRAME / RATE
    middle = moments.mean()
    half = [np.pi / 4 * (t - middle) for t in moments]  # half the yaw about the head's own +y, up
    quats = [[np.cos(a), 0, np.sin(a), 0] for a in half]
    places = np.stack([moments - middle, 0 * moments, -1.2 + 0 * moments], 1)
    heard = streamed(lambda n: np.sin(2 * np.pi * frequency * n / RATE), places, EARS, quats)
    time = np.arange(0, count * FRAME, 7) / RATE
    place = np.stack([time - middle, 0 * time, -1.2 + 0 * time], 1)
    distance = np.linalg.norm(place, axis=1)
    yaw = np.pi / 2 * (time - middle)
    for ear, side in enumerate((-1, 1)):
        axis = side * np.stack([np.cos(yaw), 0 * yaw, -np.sin(yaw)], 1)
        angle = np.arccos(np.sum(place * axis, axis=1) / distance)
        near = [near_sphere_spectrum(np.array([frequency]), angle, d, EARS.receiver_radius, SPEED) for d in NEAR]
        grid = np.stack(near)[:, :, 0]
        sphere = np.array([np.interp(d, NEAR, row) for d, row in zip(distance, grid.T, strict=True)])
        exact = np.imag(sphere * np.exp(2j * np.pi * frequency * (time - distance / SPEED))) / distance
        error = np.mean((heard[ear, ::7] - exact) ** 2) / np.mean(exact**2)
        assert 10 * np.log10(error) < -30


def test_paths_that_come_and_go_fade():
    """No step where a path is found, lost, or jumps; what keeps its name and place sounds on."""
    wall, far, other = [[0.0, 3.0, 1.0]], [[2.0, -5.0, 0.0]], [[-6.0, 1.0, 0.5]]
    sets = [wall, wall + far, wall + far, wall + other, wall]
    names = [[3], [3, 8], [3, 8], [3, 9], [3]]
    width, tone = EARS.num_paths, 2 * np.pi * 440 / RATE
    heard = []
    span = np.arange(1 - OMNI.memory_length, FRAME + OMNI.num_lookahead)
    found = [received(v, OMNI, name=jnp.array(n, jnp.int32)).paths for v, n in zip(sets, names, strict=True)]
    ends = [pad_paths(paths, width) for paths in found]

    def tones_at(frame):
        return jnp.asarray(np.sin(tone * (span + frame * FRAME)), jnp.float32)

    for i in range(4):
        old, new = (silent_state(OMNI).replace(paths=p) for p in ends[i : i + 2])
        heard.append(np.asarray(_run[OMNI](tones_at(i), old, new), float))
    heard = np.concatenate(heard, axis=1)[0]
    bend = np.abs(heard[2:] - 2 * np.cos(tone) * heard[1:-1] + heard[:-2])  # 0 for a tone of any steady level
    assert np.max(bend) < 1e-3
    time = np.arange(4 * FRAME)
    distance = np.array([np.linalg.norm(v[0]) for v in (wall, far, other)])
    tones = np.sin(tone * (time - distance[:, None] * RATE / SPEED)) / distance[:, None]
    ramp = np.arange(FRAME) / FRAME
    level = np.stack(
        [
            np.ones(4 * FRAME),
            np.concatenate([ramp, ramp * 0 + 1, 1 - ramp, 0 * ramp]),
            np.concatenate([0 * ramp, 0 * ramp, ramp, 1 - ramp]),
        ]
    )
    np.testing.assert_allclose(heard, np.sum(level * tones, axis=0), atol=0.01)


def test_environments_in_one_batch_hear_what_each_hears_alone(rng):
    """Two scenes, vmapped: one still, one moving."""
    old = [received([[1.0, 0.4, -1.5], [2, 2, 2.0]], EARS), received([[-3.0, 1, 0], [1, 7, 2.0]], EARS)]
    new = [old[0], received([[-3.1, 1, 0.05], [1, 7.1, 2.0]], EARS)]
    noise = jnp.asarray(rng.normal(size=EARS.memory_length - 1 + FRAME + EARS.num_lookahead), jnp.float32)
    both = [jax.tree.map(lambda *x: jnp.stack(x), *pair) for pair in (old, new)]
    batch = jax.jit(jax.vmap(lambda a, b: render_frame(noise, a, b, EARS)))(*both)
    for i in range(2):
        np.testing.assert_allclose(batch[i], _run[EARS](noise, old[i], new[i]), atol=1e-5)


def test_several_sources_are_heard_as_the_sum_of_each(rng):
    """Early and late sound, three sources, one of them moving."""
    old = [received([[1.0, 0.4, -1.5]], EARS), received([[-3.0, 1, 0]], EARS), received([[2.0, -4, 1]], EARS)]
    energy = jnp.asarray(1e-4 * rng.uniform(0, 1, old[0].energy.shape), jnp.float32)
    old = [heard.replace(energy=energy * n) for n, heard in enumerate(old)]
    new = [old[0], received([[-3.1, 1, 0.05]], EARS).replace(energy=energy), old[2]]
    noise = jnp.asarray(rng.normal(size=(3, EARS.memory_length - 1 + FRAME + EARS.num_lookahead)), jnp.float32)
    stacked = [jax.tree.map(lambda *x: jnp.stack(x), *part) for part in (old, new)]
    together = jax.jit(lambda s, a, b: render_frames(s, a, b, EARS))(noise, *stacked)
    alone = sum(_run[EARS](*each) for each in zip(noise, old, new, strict=True))
    np.testing.assert_allclose(together, alone, atol=2e-5 * float(jnp.max(jnp.abs(alone))))
