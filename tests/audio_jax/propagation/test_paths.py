"""Direct path and first reflections against image sources of Pyroomacoustics and the tables of partitions."""

import jax
import jax.numpy as jnp
import numpy as np
import pyroomacoustics as pra
import pytest
from handmade import Furniture, shoebox, two_rooms
from scenes import HEAD, scene_of

from home_mjx.audio_jax.auralization.response import early_response
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import Air, EarlyPaths, Omni
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.image_source_paths import image_source_reflections
from home_mjx.audio_jax.propagation.paths import air_attenuation, first_order_reflections
from home_mjx.scene_compile.materials.acoustic import transmission_loss_table
from home_mjx.schema.compiled import BANDS

CONFIG = AudioConfig(receiver=Omni())
SIZE = np.array([6.0, 5.0, 3.0])
SOURCE, LISTENER = jnp.float32([-1.3, -0.7, 1.2]), jnp.float32([1.4, 1.1, 1.6])


@jax.jit
def run(scene, source, listener, exclude=-1, emitter=-1):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        ends = SoundSource(source, jnp.int32(emitter)), Listener(listener, HEAD, jnp.int32(exclude))
        return early_paths(scene, *ends, CONFIG)


def lossless(paths) -> np.ndarray:
    """Gains without spreading and air."""
    distance = np.asarray(paths.distance, float)[:, None]
    return np.asarray(paths.gain, float) * distance * np.exp(air_attenuation(CONFIG) * distance / 2)


def sounding(paths) -> np.ndarray:
    """Indices of the paths that sound, nearest first."""
    loud = np.flatnonzero(np.any(np.asarray(paths.gain) > 0, axis=1))
    return loud[np.argsort(np.asarray(paths.distance)[loud])]


def pra_room(absorption: np.ndarray, source, listener) -> pra.ShoeBox:
    names = ("west", "east", "south", "north", "floor", "ceiling")
    walls = {
        name: pra.Material({"coeffs": list(row), "center_freqs": list(BANDS)})
        for name, row in zip(names, absorption, strict=True)
    }
    room = pra.ShoeBox(SIZE, fs=16000, materials=walls, max_order=1, air_absorption=False)
    corner = np.array([SIZE[0] / 2, SIZE[1] / 2, 0])
    room.add_source(np.asarray(source, float) + corner)
    room.add_microphone(np.asarray(listener, float) + corner)
    return room


def test_shoebox_equals_pyroomacoustics_image_sources(rng):
    """Distances, octave gains and directions of all seven paths, each wall with its own absorption."""
    absorption = rng.uniform(0.05, 0.9, (6, 7))
    scene = scene_of(shoebox(tuple(SIZE), absorption, scattering=0.0))
    paths = run(scene, SOURCE, LISTENER)
    room = pra_room(absorption, SOURCE, LISTENER)
    room.image_source_model()
    offset = room.sources[0].images.T - np.asarray(room.mic_array.R[:, 0])
    theirs = np.linalg.norm(offset, axis=1)
    order = np.argsort(theirs)
    ours = sounding(paths)
    assert len(ours) == len(order) == 7
    np.testing.assert_allclose(np.asarray(paths.distance)[ours], theirs[order], rtol=1e-5)
    np.testing.assert_allclose(np.asarray(paths.direction)[ours], (offset / theirs[:, None])[order], atol=1e-4)
    np.testing.assert_allclose(lossless(paths)[ours], room.sources[0].damping.T[order], rtol=1e-4)


def test_shoebox_response_equals_pyroomacoustics():
    """Complex spectrum 300 Hz to 6 kHz within 1 % of its peak; pyroomacoustics is 40 samples late by design."""
    dry = AudioConfig(receiver=Omni(), air=Air(humidity=0.0, temperature=20.0))
    absorption = np.full((6, 7), 0.3)
    scene = scene_of(shoebox(tuple(SIZE), absorption, scattering=0.0))
    paths = run(scene, SOURCE, LISTENER)
    paths = paths.replace(gain=jnp.asarray(lossless(paths) / np.asarray(paths.distance)[:, None], jnp.float32))
    ours = np.asarray(early_response(paths, jnp.float32([1, 0, 0, 0]), dry))[0]
    pra.constants.set("rir_hpf_enable", False)
    room = pra_room(absorption, SOURCE, LISTENER)
    room.set_sound_speed(dry.speed_of_sound)
    room.compute_rir()
    frequency = np.linspace(300, 6000, 400)

    def transform(x, lag):
        return x @ np.exp(-2j * np.pi * np.outer(np.arange(len(x)) - lag, frequency) / 16000)

    a, b = transform(ours, 0), transform(room.rir[0][0], pra.constants.get("frac_delay_length") // 2)
    assert np.max(np.abs(a - b)) < 0.01 * np.max(np.abs(b))


def test_scattered_energy_is_missing_from_reflections():
    for scattering in (0.0, 0.4):
        scene = scene_of(shoebox(absorption=0.2, scattering=scattering))
        paths = run(scene, SOURCE, LISTENER)
        gains = lossless(paths)[sounding(paths)]
        np.testing.assert_allclose(gains[0], 1, rtol=1e-5)
        np.testing.assert_allclose(gains[1:], np.sqrt(0.8 * (1 - scattering)), rtol=1e-4)


@pytest.mark.parametrize("distance", [0.2, 0.9, 2.7])
def test_direct_sound_falls_with_distance_and_air(distance):
    scene = scene_of(shoebox())
    paths = run(scene, SOURCE, SOURCE + jnp.float32([distance, 0, 0]))
    assert float(paths.distance[0]) == pytest.approx(distance, rel=1e-5)
    expected = np.exp(-air_attenuation(CONFIG) * distance / 2) / distance
    np.testing.assert_allclose(paths.gain[0], expected, rtol=1e-5)


@pytest.mark.parametrize("partition", ["stud_wall", "hollow_wood_door", "brick_4_inch"])
def test_a_wall_takes_its_table_value_once(partition):
    """The wall's two faces are one partition; it stops the reflections of the other room."""
    loss = transmission_loss_table()[partition]
    scene = scene_of(two_rooms(absorption=0.3, transmission=10 ** (-loss / 10)))
    paths = run(scene, jnp.float32([-2, 0.3, 1.2]), jnp.float32([2.2, -0.5, 1.6]))
    np.testing.assert_allclose(20 * np.log10(lossless(paths)[0]), -loss, atol=1e-3)
    assert list(sounding(paths)) == [0]


def test_furniture_muffles_once_and_not_its_own_sound():
    """A box of two faces counts once; as the emitter or the listener's own body it does not count."""
    box = Furniture(position=(0.0, 0.0), size=(0.6, 1.0, 1.8), category="wardrobe_cabinet")
    house = shoebox(furniture=[box])
    scene = scene_of(house)
    ends = jnp.float32([-1.5, 0.1, 1.2]), jnp.float32([1.5, 0, 1.3])
    expected = np.sqrt(house.materials.transmission[-1])
    assert np.all(expected < 0.5)
    np.testing.assert_allclose(lossless(run(scene, *ends))[0], expected, rtol=1e-4)
    for ids in ({"exclude": 0}, {"emitter": 0}):
        np.testing.assert_allclose(lossless(run(scene, *ends, **ids))[0], 1, rtol=1e-4)


def test_what_moves_muffles_where_it_is():
    """A movable box and an agent between the two, then moved aside."""
    box = Furniture(position=(0.0, 1.5), size=(0.6, 0.6, 1.8), mass=5.0)
    house = shoebox(furniture=[box])
    ends = jnp.float32([-1.5, 0, 1.2]), jnp.float32([1.5, 0, 1.2])
    free = lossless(run(scene_of(house), *ends))[0]
    np.testing.assert_allclose(free, 1, rtol=1e-4)
    scene = scene_of(house, agents=((0.0, 0.0, 0.8),))
    assert np.all(lossless(run(scene, *ends))[0] < 0.7)
    agent = scene.bank.spec.num_instances
    np.testing.assert_allclose(lossless(run(scene, *ends, exclude=agent))[0], 1, rtol=1e-4)


def test_furniture_before_a_wall_hides_its_reflection():
    """And reflects nothing itself unless it lies in the plane."""
    screen = Furniture(position=(0.0, 2.3), size=(6.0, 0.1, 3.0))
    plain, screened = (run(scene_of(shoebox(furniture=f)), SOURCE, LISTENER) for f in ([], [screen]))
    assert len(sounding(plain)) == 7
    left = np.asarray(screened.distance)[sounding(screened)]
    gone = set(np.round(np.asarray(plain.distance)[sounding(plain)], 3)) - set(np.round(left, 3))
    mirrored = np.asarray(SOURCE) * [1, -1, 1] + [0, 5.0, 0]
    assert gone == {np.round(np.float32(np.linalg.norm(mirrored - np.asarray(LISTENER))), 3)}


def test_paths_are_reciprocal():
    house = shoebox(absorption=np.linspace(0.1, 0.6, 42).reshape(6, 7), scattering=0.1)
    scene = scene_of(house)
    there, back = run(scene, SOURCE, LISTENER), run(scene, LISTENER, SOURCE)
    a, b = sounding(there), sounding(back)
    np.testing.assert_allclose(there.gain[a], back.gain[b], rtol=1e-4)


def test_more_surfaces_than_casts_are_silence():
    """Not a wrong level: what could not be followed to its end is taken as blocked."""
    config = AudioConfig(receiver=Omni(), early=EarlyPaths(max_crossings=2))
    scene = scene_of(two_rooms(transmission=0.5, absorption=0.6))
    paths = early_paths(scene, SoundSource(jnp.float32([-2, 0, 1])), Listener(jnp.float32([2, 0, 1]), HEAD), config)
    assert not np.any(paths.gain[0])


def test_vmap_and_scan_equal_single_environments(rng):
    scene = scene_of(shoebox(), two_rooms())
    sources = jnp.asarray(rng.uniform([-2, -2, 0.5], [2, 2, 2.5], (6, 3)), jnp.float32)
    hear = lambda s: early_paths(scene, SoundSource(s), Listener(LISTENER, HEAD), CONFIG)  # noqa: E731
    many, scanned = jax.jit(lambda s: (jax.vmap(hear)(s), jax.lax.map(hear, s)))(sources)
    for i in range(6):
        one = run(scene, sources[i], LISTENER)
        np.testing.assert_allclose(many.gain[i], one.gain, rtol=1e-5, atol=1e-6)
        np.testing.assert_allclose(scanned.gain[i], one.gain, rtol=1e-5, atol=1e-6)


@pytest.mark.parametrize("find", [first_order_reflections, image_source_reflections])
@pytest.mark.parametrize("offset", [-0.035, 0.0, 0.035])
def test_surfaces_beside_their_merged_mirror_plane_reflect(find, offset):
    """Walls within 6 cm share a plane, so rays hit most of them beside it."""
    scene = scene_of(shoebox(tuple(SIZE), 0.3, scattering=0.0))
    planes = scene.bank.acoustics
    moved = planes.replace(plane_center=planes.plane_center + offset * planes.plane_normal)
    scene = scene.replace(bank=scene.bank.replace(acoustics=moved))
    found = jax.jit(find, static_argnums=3)(scene, SoundSource(SOURCE), Listener(LISTENER, HEAD), CONFIG)
    assert len(sounding(found)) == 6
