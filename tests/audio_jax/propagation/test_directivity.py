"""Sources that sound louder ahead: patterns in closed form, paths by geometry, late sound against the oracle."""

import functools
from types import SimpleNamespace

import acoustic_rooms as rooms
import jax
import jax.numpy as jnp
import numpy as np
import pytest
from decay_oracle import fly
from handmade import Furniture, Slab, _architecture_rows, _room_planes, _rooms, _shell, build_house, shoebox
from scenes import HEAD, open_air, scene_of
from scipy.integrate import quad

from home_mjx.audio_jax import AudioConfig, Listener, Paths, SoundSource, early_paths, impulse_response
from home_mjx.audio_jax.auralization.envelope import energy_envelope
from home_mjx.audio_jax.base.directivity import (
    TALKER_FRONT_TO_BACK,
    directivity_gains,
    first_order_directivity,
    mean_energy,
    tabulated_directivity,
    talker_directivity,
)
from home_mjx.audio_jax.base.options import EarlyPaths, Omni, Traced
from home_mjx.audio_jax.propagation.diffraction import diffracted_paths
from home_mjx.audio_jax.propagation.image_source_paths import image_source_reflections
from home_mjx.audio_jax.propagation.paths import direct_path, first_order_reflections
from home_mjx.core.transforms import camera_quat
from home_mjx.errors import ConfigError

OMNI = AudioConfig(receiver=Omni())
CARDIOID = first_order_directivity(0.5)
hear = jax.jit(impulse_response, static_argnums=4)
found_paths = jax.jit(early_paths, static_argnums=3)
ALONG_X = HEAD  # points along +x, as that head looks
PATTERNS = [(0.0, 1.0), (0.5, 1.0), (0.3, 2.5), (0.75, 1.0), (1.0, 1.0), (1.0, 3.0), (0.5, 0.0)]


def closed_mean(weight: float, exponent: float) -> float:
    """Mean of |1 - w + w x|²ⁿ over x from -1 to 1."""
    if weight == 0:
        return 1.0
    back, power = 1 - 2 * weight, 2 * exponent + 1
    return (1 - np.sign(back) * abs(back) ** power) / (2 * weight * power)


@pytest.mark.parametrize(("weight", "exponent"), PATTERNS)
def test_mean_energy_of_first_order_patterns(weight, exponent):
    found = np.asarray(mean_energy(first_order_directivity(weight, exponent)))
    np.testing.assert_allclose(found, closed_mean(weight, exponent), rtol=1e-3)
    numeric = quad(lambda x: abs(1 - weight + weight * x) ** (2 * exponent), -1, 1)[0] / 2
    assert closed_mean(weight, exponent) == pytest.approx(numeric, rel=1e-6)


def test_mean_energy_of_a_talker():
    k = np.array(TALKER_FRONT_TO_BACK) * np.log(10) / 10
    np.testing.assert_allclose(mean_energy(talker_directivity()), (1 - np.exp(-k)) / k, rtol=1e-3)


def test_a_coarse_table_has_the_mean_of_what_runs_straight_between_its_energies():
    table = np.repeat(np.array([1.0, 0.8, 0.3, 0.1, 0.2])[:, None], 7, axis=1)
    energy = lambda t: np.interp(t, np.linspace(0, np.pi, 5), table[:, 0] ** 2)  # noqa: E731
    numeric = quad(lambda t: energy(t) * np.sin(t) / 2, 0, np.pi, points=np.linspace(0, np.pi, 5))[0]
    np.testing.assert_allclose(mean_energy(tabulated_directivity(table)), numeric, rtol=1e-5)
    angle = np.linspace(0, np.pi, 50)
    found = np.asarray(directivity_gains(tabulated_directivity(table), jnp.float32(np.cos(angle))))[:, 2]
    np.testing.assert_allclose(found**2, energy(angle), atol=1e-4)


def test_patterns_at_any_angle():
    angle = np.radians([0, 12.3, 45, 77.7, 100.1, 150, 180])
    found = np.asarray(
        directivity_gains(
            first_order_directivity([0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.5], 2.0), jnp.float32(np.cos(angle))
        )
    )
    weight = np.array([0.1, 0.2, 0.3, 0.4, 0.45, 0.5, 0.5])
    np.testing.assert_allclose(found, (1 - weight + weight * np.cos(angle)[:, None]) ** 2, atol=2e-4)


@pytest.mark.parametrize("bad", [np.ones((5, 3)), np.ones((1, 7)), -np.ones((5, 7)), np.full((5, 7), np.nan)])
def test_bad_tables_are_refused(bad):
    with pytest.raises(ConfigError, match=r"directivity"):
        tabulated_directivity(bad)


def test_bad_weights_and_sources_that_point_nowhere_are_refused():
    for wrong in ({"weight": 1.5}, {"weight": [0.5] * 3}, {"exponent": -1.0}, {"exponent": float("nan")}):
        with pytest.raises(ConfigError):
            first_order_directivity(**wrong)
    scene, head = scene_of(shoebox()), Listener(jnp.float32([1, 1, 1.6]), HEAD)
    for quat, message in ((None, "needs an orientation"), (2 * HEAD, "a source's quaternion")):
        with pytest.raises(ConfigError, match=message):
            early_paths(scene, SoundSource(jnp.zeros(3), quat=quat, directivity=CARDIOID), head, OMNI)
    untold = lambda *ends: Paths(jnp.ones(1), jnp.ones((1, 7)), jnp.float32([[1, 0, 0]]))  # noqa: E731
    with pytest.raises(ConfigError, match="departure"):
        early_paths(scene, SoundSource(jnp.zeros(3), quat=HEAD, directivity=CARDIOID), head, OMNI, [untold])


@pytest.mark.parametrize("degrees", [0, 30, 60, 90, 120, 150])
def test_level_of_direct_sound_at_angles(degrees):
    """Waveforms in the open, re the same source without directivity: within 0.05 dB of the pattern at 1 kHz."""
    scene, angle = open_air(), np.radians(degrees)
    away = jnp.float32([3 * np.cos(angle), 3 * np.sin(angle), 0])
    place = jnp.float32([-0.3, -1.0, 9.0])
    wave = np.exp(-2j * np.pi * 1000 * np.arange(OMNI.response_length) / OMNI.sample_rate)
    ours, even = (
        abs(np.asarray(hear(scene, source, Listener(place + away, HEAD), jax.random.key(0), OMNI), float)[0] @ wave)
        for source in (
            SoundSource(place, quat=ALONG_X, directivity=first_order_directivity(0.4, 2.0)),
            SoundSource(place),
        )
    )
    assert 20 * np.log10(ours / even) == pytest.approx(40 * np.log10(0.6 + 0.4 * np.cos(angle)), abs=0.05)


def test_reflections_are_as_loud_as_the_source_toward_their_walls():
    """Of the six of a box: the listener mirrored in each wall, seen from the source."""
    scene = scene_of(shoebox((6.0, 5.0, 3.0), absorption=0.2, scattering=0.0))
    source, listener = np.array([-1.0, 0.7, 1.2]), np.array([1.5, -1.0, 1.7])
    quat = camera_quat(jnp.float32(0.8), jnp.float32(0.3))
    axis = np.array([np.cos(0.8) * np.cos(0.3), np.sin(0.8) * np.cos(0.3), np.sin(0.3)])
    ends = jnp.asarray(source, jnp.float32), Listener(jnp.asarray(listener, jnp.float32), HEAD)
    even = found_paths(scene, SoundSource(ends[0]), ends[1], OMNI)
    ours = found_paths(scene, SoundSource(ends[0], quat=quat, directivity=CARDIOID), ends[1], OMNI)
    ratio = np.asarray(ours.gain[:, 3] / jnp.maximum(even.gain[:, 3], 1e-9))
    mirrored = [listener.copy()]
    for k, low, high in ((0, -3, 3), (1, -2.5, 2.5), (2, 0, 3)):
        for wall in (low, high):
            image = listener.copy()
            image[k] = 2 * wall - image[k]
            mirrored.append(image)
    way = np.array(mirrored) - source
    length = np.linalg.norm(way, axis=1)
    expected = dict(zip(length.round(3), 0.5 + 0.5 * way @ axis / length, strict=True))
    heard = np.asarray(even.gain[:, 3]) > 0
    assert heard.sum() == 7
    for distance, share in zip(np.asarray(even.distance)[heard], ratio[heard], strict=True):
        nearest = min(expected, key=lambda x: abs(x - distance))
        assert share == pytest.approx(expected[nearest], abs=1e-3)


@functools.cache
def screened():
    """A hall with a screen from one wall to its middle, and a wardrobe."""
    low, high = (-6.0, -6.0), (6.0, 6.0)
    slabs = [*_shell(low, high, 9.0, 0), Slab((-0.01, -6.0, 0.0), (0.01, 0.0, 9.0), "wall", 6, 0)]
    table = _architecture_rows(slabs, 0.3, 0.1, 0.0)
    box = Furniture(position=(2.0, 2.0), size=(0.6, 1.0, 1.8), category="wardrobe_cabinet")
    planes = _room_planes(low, high, 9.0, 0)
    return scene_of(build_house("screened", slabs, table, _rooms([(low, high)], 9.0), planes, [box]))


@pytest.mark.parametrize(
    ("find", "options"),
    [
        (direct_path, {}),
        (first_order_reflections, {"num_reflections": 6}),
        (image_source_reflections, {"reflection_order": 3, "num_reflections": 40}),
        (diffracted_paths, {"num_edges": 8}),
    ],
)
def test_directions_in_which_paths_leave_are_those_in_which_they_come_the_other_way(find, options):
    scene, config = screened(), AudioConfig(early=EarlyPaths(**options), receiver=Omni())
    here, there = jnp.float32([-1.5, -0.8, 1.2]), jnp.float32([1.3, -0.6 if find is diffracted_paths else 1.6, 1.5])
    run = jax.jit(find, static_argnums=3)
    go, back = (run(scene, SoundSource(a), Listener(b, HEAD), config) for a, b in ((here, there), (there, here)))
    found = [
        np.concatenate([p.distance[:, None], x], axis=1)[np.asarray(jnp.max(p.gain, axis=1) > 0)]
        for p, x in ((go, go.departure), (back, back.direction))
    ]
    assert len(found[0]) == len(found[1]) > 0
    for path in found[0]:
        assert np.min(np.max(np.abs(found[1] - path), axis=1)) < 2e-3
    np.testing.assert_allclose(np.linalg.norm(found[0][:, 1:], axis=1), 1, atol=1e-5)


@functools.partial(jax.jit, static_argnums=3)
def octave_levels(scene, source, listener, config):
    """(bins, bands), paths and rays."""
    return energy_envelope(scene, source, Listener(listener, HEAD), jax.random.key(0), config).energy[:, 0]


def test_late_level_is_that_of_the_power():
    """In a diffuse room every pattern's late energy, 0.1 s after its start, is its mean over the sphere: 0.2 dB."""
    scene = scene_of(shoebox(absorption=0.1, scattering=1.0))
    config = AudioConfig(receiver=Omni(), late=Traced(num_rays=1500, num_bounces=40))
    place, ears = jnp.float32([-1, -1, 1.2]), jnp.float32([1, 1, 1.6])
    even = octave_levels(scene, SoundSource(place), ears, config)[25:].sum(axis=0)
    for pattern in (CARDIOID, talker_directivity()):
        ours = octave_levels(scene, SoundSource(place, quat=ALONG_X, directivity=pattern), ears, config)[25:].sum(
            axis=0
        )
        np.testing.assert_allclose(10 * np.log10(ours / even / np.asarray(mean_energy(pattern))), 0, atol=0.2)


@pytest.mark.parametrize("yaw", [0.0, 2.2])
def test_levels_against_the_oracle(yaw):
    """A narrow source in a room, mean over listeners of 1 kHz: 0.3 dB, of the first 50 ms 0.5 dB."""
    room = rooms.box_room("bare", (6.0, 5.0, 3.0), 0.2, 0.3)
    axis = np.array([np.cos(yaw), np.sin(yaw), 0])
    one = SimpleNamespace(**vars(room.blocks))
    for name in ("absorption", "scattering"):
        setattr(one, name, getattr(room.blocks, name)[:, 3:4])
    one.air = room.blocks.air[3:4]
    truth = fly(one, room.source, room.listeners, 0.5, particles=40_000, axis=axis, weight=0.5, exponent=2.0)
    source = SoundSource(
        jnp.asarray(room.source, jnp.float32),
        quat=camera_quat(jnp.float32(yaw), jnp.float32(0)),
        directivity=first_order_directivity(0.5, 2.0),
    )
    config, scene = AudioConfig(receiver=Omni(), late=Traced(num_rays=1500, num_bounces=40)), scene_of(room.house)
    ours = [np.asarray(octave_levels(scene, source, jnp.float32(p), config))[:, 3] for p in room.listeners]
    both = np.mean(ours, axis=0), truth.energy[:, 0].mean(axis=0)
    for part, within in ((slice(None), 0.3), (slice(0, 13), 0.5), (slice(13, None), 0.3)):
        assert 10 * np.log10(both[0][part].sum() / both[1][part].sum()) == pytest.approx(0, abs=within)


def test_an_even_pattern_changes_nothing():
    scene, ears = scene_of(shoebox()), Listener(jnp.float32([1, 1, 1.6]), HEAD)
    place, key = jnp.float32([-1, -1, 1.2]), jax.random.key(0)
    even = SoundSource(place, quat=ALONG_X, directivity=first_order_directivity(0.0))
    np.testing.assert_allclose(
        hear(scene, even, ears, key, OMNI), hear(scene, SoundSource(place), ears, key, OMNI), atol=1e-6
    )


def test_a_source_that_is_stretched_is_silent_inside_jit():
    scene, ears = scene_of(shoebox()), Listener(jnp.float32([1, 1, 1.6]), HEAD)
    place, key = jnp.float32([-1, -1, 1.2]), jax.random.key(0)
    assert not np.asarray(hear(scene, SoundSource(place, quat=2 * HEAD, directivity=CARDIOID), ears, key, OMNI)).any()
