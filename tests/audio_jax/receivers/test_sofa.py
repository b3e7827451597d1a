"""Heads from SOFA files: of the exact rigid sphere, heard from directions that are not in the file; broken files."""

import dataclasses

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import shoebox
from scenes import HEAD, scene_of
from scipy.signal import fftconvolve
from scipy.spatial.transform import Rotation

from home_mjx import HouseBank, HouseholdEnv
from home_mjx.audio_jax import AudioConfig, Listener, Paths, SoundSource, impulse_response, read_head
from home_mjx.audio_jax.auralization.envelope import energy_envelope
from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.options import Binaural, Motion, Omni, Traced
from home_mjx.audio_jax.moving_sources.frames import render_frame
from home_mjx.audio_jax.moving_sources.receiver_state import silent_state
from home_mjx.audio_jax.receivers.channels import channel_gains
from home_mjx.audio_jax.receivers.direction_grid import grid_directions
from home_mjx.audio_jax.receivers.hrtf_interpolation import interpolate_directions
from home_mjx.audio_jax.receivers.measured_hrtf import make_measured_head
from home_mjx.audio_jax.receivers.sofa import read_measurements
from home_mjx.audio_jax.receivers.spherical_head import ear_table, sphere_spectrum
from home_mjx.errors import ConfigError, DatasetError, MissingFileError
from home_mjx.schema.timing import Timing
from home_mjx.tasks import make_config

sofar = pytest.importorskip("sofar", reason="the extra `sofa` is not installed")
netCDF4 = pytest.importorskip("netCDF4", reason="sofar brings it")

FINE = AudioConfig(timing=Timing(sample_rate=48000), response_seconds=0.1)
COARSE = AudioConfig(response_seconds=0.1)
RATE, TAPS, ONSET = 44100, 384, 2e-3  # of the file; when sound reaches the middle of the head [s]
RADIUS, SPEED = FINE.receiver_radius, FINE.speed_of_sound
AHEAD = jnp.float32([1, 0, 0, 0])
OCTAVES = (500, 1000, 2000, 4000, 8000)


def sphere(direction: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """(m, 2, f) of the closed form, left ear first; directions in the frame of the head."""
    cosine = np.clip(np.stack([-direction[:, 0], direction[:, 0]], axis=1), -1, 1)
    return sphere_spectrum(frequency, np.arccos(cosine).ravel(), RADIUS, SPEED).reshape(len(direction), 2, -1)


def responses(direction: np.ndarray) -> np.ndarray:
    """(m, 2, n), made at many more samples than are kept, so that nothing of the end comes round to the start."""
    frequency = np.fft.rfftfreq(8 * TAPS, 1 / RATE)
    late = np.exp(-2j * np.pi * frequency * ONSET)
    return np.fft.irfft(sphere(direction, frequency) * late, 8 * TAPS)[..., :TAPS]


def scattered(count: int) -> np.ndarray:
    """Directions on a spiral over the sphere."""
    height = 1 - (2 * np.arange(count) + 1) / count
    turn, ring = np.arange(count) * np.pi * (3 - 5**0.5), np.sqrt(1 - height**2)
    return np.stack([ring * np.cos(turn), height, ring * np.sin(turn)], axis=1)


IN_FILE = scattered(1500)
ELSEWHERE = scattered(41) @ Rotation.from_euler("xyz", [0.3, 0.5, 0.2]).as_matrix()


def polar(direction: np.ndarray, distance: float = 1.5) -> np.ndarray:
    """Azimuth to the left, elevation [degrees] and distance, as files have it."""
    x, y, z = -direction[:, 2], -direction[:, 0], direction[:, 1]
    angles = np.degrees(np.arctan2(y, x)) % 360, np.degrees(np.arcsin(z))
    return np.stack([*angles, np.full(len(x), distance)], axis=1)


def sphere_file(direction: np.ndarray):
    sofa = sofar.Sofa("SimpleFreeFieldHRIR")
    sofa.Data_IR, sofa.Data_SamplingRate = responses(direction), float(RATE)
    sofa.Data_Delay, sofa.SourcePosition = np.zeros((1, 2)), polar(direction)
    return sofa


@pytest.fixture(scope="module")
def path(tmp_path_factory):
    path = tmp_path_factory.mktemp("sofa") / "sphere.sofa"
    sofar.write_sofa(str(path), sphere_file(IN_FILE))
    return path


@pytest.fixture(scope="module", params=["minimum", "measured"])
def head(path, request):
    return read_head(path, FINE, request.param)


def heard(head, direction, config=FINE, quat=AHEAD) -> np.ndarray:
    """(m, 2, l) of single paths from 5 m."""
    one = lambda toward: Paths(jnp.full(1, 5.0), jnp.full((1, 7), 0.2), toward[None])  # noqa: E731
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        run = jax.jit(jax.vmap(lambda toward: early_response(one(toward), quat, config, head)))
        return np.asarray(run(jnp.float32(direction)), float)


def transform(response: np.ndarray, frequency: np.ndarray, rate: int) -> np.ndarray:
    return response @ np.exp(-2j * np.pi * np.outer(np.arange(response.shape[-1]) / rate, frequency))


def lead(spectra: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """[s], by which the left ear is earlier: where both are most alike within an octave."""
    lags = np.arange(-1e-3, 1e-3, 2e-6)
    cross = spectra[:, 0] * np.conj(spectra[:, 1])
    return lags[np.argmax(np.real(cross @ np.exp(-2j * np.pi * np.outer(frequency, lags))), axis=1)]


def test_differences_of_level_and_time_are_those_of_the_exact_sphere(head):
    """In directions that are not in the file, each octave: levels and their differences 1 dB, of time 15 µs."""
    assert np.max(ELSEWHERE @ IN_FILE.T) < np.cos(np.radians(0.2))
    response = heard(head, ELSEWHERE) / 0.2
    for octave in OCTAVES:
        frequency = np.linspace(octave / 2**0.5, octave * 2**0.5, 60)
        ours, exact = transform(response, frequency, 48000), sphere(ELSEWHERE, frequency)
        level = [10 * np.log10(np.mean(np.abs(x) ** 2, axis=2)) for x in (ours, exact)]
        np.testing.assert_allclose(*level, atol=1)
        np.testing.assert_allclose(*(np.diff(x, axis=1) for x in level), atol=1)
        np.testing.assert_allclose(*(lead(x, frequency) for x in (ours, exact)), atol=15e-6)


def test_sound_comes_when_it_should(head):
    """Each ear against the exact sphere and the way of 5 m, 1 kHz: 20 µs."""
    frequency = np.linspace(700.0, 1400.0, 60)
    exact = sphere(ELSEWHERE, frequency) * np.exp(-2j * np.pi * frequency * 5 / SPEED)
    ours = transform(heard(head, ELSEWHERE), frequency, 48000)
    late = [lead(np.stack([ours[:, ear], exact[:, ear]], axis=1), frequency) for ear in (0, 1)]
    np.testing.assert_allclose(late, 0, atol=20e-6)


@pytest.fixture(scope="module")
def coarse(path):
    return read_head(path, COARSE)


def test_energies_are_those_of_the_sphere(coarse):
    """Per octave, of late sound: 1 dB re the closed form's own table."""
    toward = jnp.float32(ELSEWHERE)
    ours, exact = (np.asarray(channel_gains(toward, AHEAD, COARSE, head)) for head in (coarse, None))
    np.testing.assert_allclose(10 * np.log10(ours[..., :6] / exact[..., :6]), 0, atol=1)


def test_a_turned_head_takes_its_ears_along(coarse):
    turn = Rotation.from_euler("xyz", [0.4, -0.9, 0.3])
    quat = jnp.float32(np.roll(turn.as_quat(), 1))
    ours = heard(coarse, turn.apply(ELSEWHERE), COARSE, quat)
    np.testing.assert_allclose(ours, heard(coarse, ELSEWHERE, COARSE), atol=2e-5)


def test_frames_of_a_still_source_are_one_convolution(coarse, rng):
    config = dataclasses.replace(COARSE, motion=Motion(tail_seconds=0.0))
    vectors = np.array([[1.1, 0.4, -1.5], [-3, 2, 2.5], [0.2, 11, 4]])
    distance = np.linalg.norm(vectors, axis=1)
    parts = distance, rng.uniform(0.1, 1, (3, 7)), vectors / distance[:, None]
    paths = Paths(*(jnp.asarray(x, jnp.float32) for x in parts))
    still = silent_state(config).replace(paths=paths, quat=AHEAD)
    response = np.asarray(jax.jit(lambda p, h: early_response(p, AHEAD, config, h))(paths, coarse), float)
    noise, frame = rng.normal(size=4 * config.frame), config.frame
    part = noise[2 * frame + 1 - config.memory_length : 3 * frame + config.num_lookahead]
    sound = jax.jit(lambda s, h: render_frame(s, still, still, config, h))(jnp.asarray(part, jnp.float32), coarse)
    for one, channel in zip(np.asarray(sound), response, strict=True):
        whole = fftconvolve(noise, channel)[2 * frame : 3 * frame]
        np.testing.assert_allclose(one, whole, atol=1e-4 * np.max(np.abs(whole)))


def test_a_listener_has_its_head_in_a_room(coarse):
    """Responses and energies; their levels are those of the built-in sphere, since this head is one: 0.5 dB."""
    config = AudioConfig(response_seconds=0.2, late=Traced(num_rays=16, num_bounces=4))
    scene, source = scene_of(shoebox()), SoundSource(jnp.float32([-1, -1, 1.2]))

    @jax.jit
    def hear(head):
        ends = source, Listener(jnp.float32([1, 1, 1.6]), HEAD, head=head)
        key = jax.random.key(0)
        return impulse_response(scene, *ends, key, config), energy_envelope(scene, *ends, key, config)

    (ours, envelope), (plain, expected) = hear(coarse), hear(None)
    np.testing.assert_allclose(*(10 * np.log10(np.sum(x**2, axis=1)) for x in (ours, plain)), atol=0.5)
    np.testing.assert_allclose(*(10 * np.log10(np.sum(x.energy, axis=0)) for x in (envelope, expected)), atol=0.5)
    np.testing.assert_allclose(envelope.left_ear_lead, expected.left_ear_lead, atol=30e-6)


def test_agents_hear_with_the_head_of_their_parameters(coarse):
    """It is an argument of what is jitted: another one runs the same program."""
    audio = AudioConfig(response_seconds=0.1, late=Traced(num_rays=4, num_bounces=1))
    config = make_config(audio=audio, sensors=("audio",), impl="kinematic", actions="discrete")
    core = HouseholdEnv(config)
    env, traced = core.bind(HouseBank.from_compiled([shoebox()])), []

    @jax.jit
    def reset(params):
        traced.append(1)
        return core.reset(params, jax.random.key(0)).obs["audio"]

    swapped = jax.tree.map(lambda x: x[:, :, ::-1], coarse)
    one, other = (np.asarray(reset(env.params.replace(head=head))) for head in (coarse, swapped))
    assert len(traced) == 1
    assert np.abs(one).max() > 0
    assert not np.allclose(one, other)


def test_between_nodes_of_the_grid():
    """A table of the directions themselves: right at its nodes, poles and where azimuths begin anew among them."""
    nodes = grid_directions()
    table = jnp.asarray(nodes, jnp.float32)
    np.testing.assert_allclose(interpolate_directions(table, table), nodes, atol=2e-3)
    np.testing.assert_allclose(interpolate_directions(table, jnp.float32(ELSEWHERE)), ELSEWHERE, atol=2e-3)


FEW = scattered(60)


def few_file(**changes):
    sofa = sphere_file(FEW)
    for name, value in changes.items():
        setattr(sofa, name, value)
    return sofa


def written(sofa, tmp_path, name="few.sofa"):
    sofar.write_sofa(str(tmp_path / name), sofa)
    return tmp_path / name


def cartesian(direction, distance=1.5):
    return distance * np.stack([-direction[:, 2], -direction[:, 0], direction[:, 1]], axis=1)


def turned(sofa):
    """The same measurements of a head that looks to the left of the room, away from its origin."""
    sofa.ListenerView, sofa.ListenerPosition = np.array([[0.0, 1.0, 0.0]]), np.array([[1.0, 2.0, 0.5]])
    x, y, z = cartesian(FEW).T
    sofa.SourcePosition = np.stack([1 - y, 2 + x, 0.5 + z], axis=1)
    sofa.SourcePosition_Type, sofa.SourcePosition_Units = "cartesian", "metre"


def other_order(sofa):
    sofa.Data_IR, sofa.ReceiverPosition = sofa.Data_IR[:, ::-1], -sofa.ReceiverPosition


def two_distances(sofa):
    sofa.Data_IR = np.concatenate([sofa.Data_IR, 2 * sofa.Data_IR])
    sofa.SourcePosition = np.concatenate([sofa.SourcePosition, sofa.SourcePosition * [1, 1, 0.5]])


@pytest.mark.parametrize("change", [turned, other_order, two_distances])
def test_the_same_measurements_written_otherwise(change, tmp_path):
    sofa = few_file()
    change(sofa)
    found = read_measurements(written(sofa, tmp_path))
    np.testing.assert_allclose(found.direction, FEW, atol=1e-6)
    np.testing.assert_allclose(found.response, responses(FEW), atol=1e-9)


def test_delays_of_a_file_count(tmp_path):
    """Responses that are cut off at their start, by as much as the file says, make the same head."""
    cut = np.tile([[20, 30]], (60, 1))
    whole = responses(FEW)
    short = np.stack(
        [np.stack([np.roll(row, -n) for row, n in zip(*x, strict=True)]) for x in zip(whole, cut, strict=True)]
    )
    path = written(few_file(Data_IR=short, Data_Delay=cut.astype(float)), tmp_path)
    one, other = (read_head(p, COARSE) for p in (path, written(few_file(), tmp_path, "whole.sofa")))
    np.testing.assert_allclose(one.delay, other.delay, atol=1e-6)
    np.testing.assert_allclose(one.real, other.real, atol=0.02)  # what limits the band began before the cut


def test_levels_can_be_those_of_a_sphere(tmp_path):
    """A file that was scaled, and one that was not; its mean energy at 500 Hz."""
    one, other = (
        read_head(written(few_file(Data_IR=gain * responses(FEW)), tmp_path), COARSE, level="sphere")
        for gain in (1.0, 3.7)
    )
    np.testing.assert_allclose(one.real, other.real, atol=1e-5)
    np.testing.assert_allclose(one.energy, other.energy, rtol=1e-5)
    area = np.cos(np.radians(np.arange(-90, 91, 5)))
    table = ear_table(1024, 16000, RADIUS, SPEED).energy[:, 2]
    expected = np.average(table, weights=np.sin(np.linspace(0, np.pi, 181)))
    assert np.average(np.asarray(one.energy)[..., 2].mean(axis=(1, 2)), weights=area) == pytest.approx(
        expected, rel=1e-4
    )


def test_where_nothing_was_measured_it_is_filled_in_and_told(caplog):
    """As in sets that end at 40 degrees below."""
    above = IN_FILE[::5][IN_FILE[::5, 1] > np.sin(np.radians(-40))]
    head = make_measured_head(above, responses(above), RATE, COARSE)
    assert "are filled in" in caplog.text
    assert all(np.isfinite(x).all() for x in jax.tree.leaves(head))


def broken(path, name):
    """Files that are none."""
    content = path.read_bytes()
    bad = {
        "cut": content[: len(content) // 2],
        "text": b"hello",
        "empty": b"",
        "flipped": content[:3000] + b"x" * 400 + content[3400:],
    }
    target = path.parent / f"{name}.sofa"
    target.write_bytes(bad[name])
    return target


@pytest.mark.parametrize("name", ["cut", "text", "empty", "flipped"])
def test_files_that_are_none_are_refused(path, name):
    with pytest.raises(DatasetError, match=rf"cannot be read as SOFA.*{name}\.sofa"):
        read_head(broken(path, name), COARSE)


def test_missing_files_and_other_names(path, tmp_path):
    with pytest.raises(MissingFileError, match=r"none\.sofa"):
        read_head(tmp_path / "none.sofa", COARSE)
    other = path.with_suffix(".nc")
    other.write_bytes(path.read_bytes())
    with pytest.raises(DatasetError, match=r"ends in \.sofa"):
        read_head(other, COARSE)
    with pytest.raises(ConfigError, match="phase"):
        read_head(path, COARSE, phase="linear")


LATE = np.zeros((60, 2, TAPS))
LATE[:30, :, 10], LATE[30:, :, 250] = 1, 1


@pytest.mark.parametrize(
    ("name", "values", "message"),
    [
        ("Data.IR", np.nan, r"not finite.*Data\.IR"),
        ("Data.IR", 0.0, r"response 0 of the left ear is silent.*Data\.IR"),
        ("Data.IR", LATE, r"ms from the head centre.*Data\.IR"),
        ("Data.SamplingRate", -1.0, r"positive rate.*Data\.SamplingRate"),
        ("Data.SamplingRate", 8000.0, "8000 Hz do not cover the frequencies of sound of 16000 Hz"),
        ("SourcePosition", polar(FEW, 0.0), "at the head centre.*SourcePosition"),
        ("SourcePosition", polar(FEW) * [1, 0, 1], "do not surround it"),
        ("SourcePosition", np.inf, "not finite.*SourcePosition"),
        ("SourcePosition:Type", "cubic", "'cubic'.*SourcePosition:Type"),
        ("ListenerUp", np.array([[1.0, 0, 0]]), "up vector is zero or parallel.*ListenerUp"),
        ("ReceiverPosition", 0.0, "neither ear.*ReceiverPosition"),
    ],
)
def test_files_that_make_no_head_are_refused_with_the_place(name, values, message, tmp_path):
    path, (name, _, attribute) = written(few_file(), tmp_path), name.partition(":")
    with netCDF4.Dataset(path, "r+") as file:
        if attribute:
            file[name].setncattr(attribute, values)
        else:
            file[name][:] = values
    with pytest.raises(DatasetError, match=message) as error:
        read_head(path, COARSE)
    assert str(path) in str(error.value)


def test_other_conventions_are_refused(tmp_path):
    with pytest.raises(DatasetError, match="expected the convention SimpleFreeFieldHRIR, got 'GeneralFIR'"):
        read_head(written(sofar.Sofa("GeneralFIR"), tmp_path), COARSE)


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"receiver": Omni()}, r"receiver=Omni\(\)"),
        ({"receiver": Binaural(pinna=True)}, "outer ears"),
        ({"timing": Timing(sample_rate=48000)}, "Hz"),
    ],
)
def test_heads_are_heard_with_the_options_they_were_read_for(coarse, options, message):
    with pytest.raises(ConfigError, match=message):
        channel_gains(jnp.float32(ELSEWHERE), AHEAD, AudioConfig(**options), coarse)
