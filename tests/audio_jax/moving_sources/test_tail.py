"""What rings on after a response, read from streamed sound."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from numpy_measures import t30
from scipy.signal import fftconvolve

from home_mjx.audio_jax import AudioConfig, Paths, render_frame
from home_mjx.audio_jax.base.options import Motion, Omni
from home_mjx.audio_jax.moving_sources.receiver_state import is_truncated, pack_receiver_state
from home_mjx.schema.compiled import BANDS

OMNI = AudioConfig(receiver=Omni(), motion=Motion(tail_seconds=2.5))
RATE, FRAME = OMNI.sample_rate, OMNI.frame
AHEAD = jnp.float32([1, 0, 0, 0])


def decaying(seconds, config=OMNI, key=0):
    """A room without paths, whose octaves fall by 60 dB in so many seconds."""
    time = (np.arange(config.num_bins) + 0.5) * config.bin_seconds
    energy = np.repeat(1e-3 * np.exp(-13.8155 * time / seconds)[:, None], 2 * len(BANDS), axis=1)
    none = Paths(jnp.zeros(1), jnp.zeros((1, 7)), jnp.float32([[1, 0, 0]]))
    bins = jnp.asarray(energy.reshape(-1, 2, len(BANDS)), jnp.float32)
    return pack_receiver_state(none, bins, AHEAD, jax.random.key(key), config)


def click(frames, config=OMNI):
    """What is heard of a single sample's pulse at the start of the first frame, in so many frames."""
    rooms = [decaying(s, config) for s in click.rooms]
    run = jax.jit(jax.vmap(lambda s, r: render_frame(s, r, r, config), (None, 0)))
    rooms = jax.tree.map(lambda *x: jnp.stack(x), *rooms)
    width = config.memory_length - 1 + FRAME + config.num_lookahead
    heard = []
    for i in range(frames):
        at = config.memory_length - 1 - i * FRAME
        heard.append(run(jnp.zeros(width).at[at].set(1.0 if at >= 0 else 0.0), rooms))
    return np.concatenate([np.asarray(h, float) for h in heard], axis=2)


click.rooms = (0.5, 1.0, 1.5, 2.0)


@pytest.fixture(scope="module")
def heard():
    return click(33)


@pytest.mark.parametrize(("room", "seconds"), list(enumerate(click.rooms)))
def test_t30_read_from_the_waveform(heard, room, seconds):
    """In octaves of which there is enough to read, and of all; a response of 0.5 s used to end at -15 dB."""
    assert t30(heard[room, 0] ** 2, 1 / RATE) == pytest.approx(seconds, rel=0.05)


def test_levels_go_on_where_the_response_ends(heard):
    """Energy of each 0.1 s, before and after 0.5 s, as the exponential has it within 1 dB."""
    energy = np.sum(heard[:, 0, : 15 * FRAME].reshape(4, 15, FRAME) ** 2, axis=2)
    time = (np.arange(15) + 0.5) * 0.1
    exact = -60 * time[None] / np.array(click.rooms)[:, None]
    level = 10 * np.log10(energy) - exact
    assert np.max(np.abs(level[1:] - level[1:, :4].mean(axis=1, keepdims=True))) < 1


def test_a_still_room_is_one_convolution(heard, rng):
    """Noise through the room equals its convolution with what a click leaves, tail included."""
    noise = rng.normal(size=60 * FRAME)
    room = decaying(2.0)
    run = jax.jit(lambda s: render_frame(s, room, room, OMNI))
    for frame in (40, 41):
        begin = frame * FRAME
        part = noise[begin + 1 - OMNI.memory_length : begin + FRAME + OMNI.num_lookahead]
        ours = np.asarray(run(jnp.asarray(part, jnp.float32)), float)[0]
        whole = fftconvolve(noise[: begin + FRAME], heard[3, 0])[begin : begin + FRAME]
        assert np.max(np.abs(ours - whole)) < 1e-5 * np.max(np.abs(whole))


@pytest.mark.parametrize(
    ("tail", "seconds", "cut"), [(0.0, 0.9, False), (0.0, 1.2, True), (1.5, 3.5, False), (1.5, 4.8, True)]
)
def test_receptions_that_end_too_early_are_told(tail, seconds, cut):
    """60 dB in one second fall by 30 dB in half a second, in four by 30 dB in two."""
    config = AudioConfig(receiver=Omni(), motion=Motion(tail_seconds=tail))
    assert bool(is_truncated(decaying(seconds, config), config)) == cut
