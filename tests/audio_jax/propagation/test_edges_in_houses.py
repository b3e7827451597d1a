"""Edges and reflections of higher order in houses, validated by rays."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, Slab, _architecture_rows, _room_planes, _rooms, _shell, build_house, shoebox, two_rooms
from scenes import HEAD, scene_of

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.base.endpoints import Listener, SoundSource
from home_mjx.audio_jax.base.options import EarlyPaths, Omni
from home_mjx.audio_jax.propagation.diffraction import diffracted_paths
from home_mjx.audio_jax.propagation.early import early_paths
from home_mjx.audio_jax.propagation.image_source_paths import image_source_reflections
from home_mjx.audio_jax.propagation.paths import air_attenuation, direct_path
from home_mjx.houses.house_set import HouseSet
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.materials.acoustic import transmission_loss_table

BENDING = AudioConfig(receiver=Omni(), early=EarlyPaths(num_edges=8))
MIRRORING = AudioConfig(receiver=Omni(), early=EarlyPaths(reflection_order=3, num_reflections=80))
AIR = air_attenuation(BENDING)


@jax.jit
def around(scene, source, listener, emitter=-1):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return diffracted_paths(scene, SoundSource(source, jnp.int32(emitter)), Listener(listener, HEAD), BENDING)


@jax.jit
def mirrored(scene, source, listener):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return image_source_reflections(scene, SoundSource(source), Listener(listener, HEAD), MIRRORING)


def level(paths) -> np.ndarray:
    """Energy per octave re the free field of the straight path [dB], air left out."""
    length = np.asarray(paths.distance, float)[:, None]
    energy = np.asarray(paths.gain, float) ** 2 * np.exp(AIR * length)
    with np.errstate(divide="ignore"):
        return 10 * np.log10(energy.sum(axis=0) * length[0] ** 2)


def screened():
    """A hall with a thin screen from one wall to its middle."""
    low, high = (-6.0, -6.0), (6.0, 6.0)
    slabs = [*_shell(low, high, 9.0, 0), Slab((-0.01, -6.0, 0.0), (0.01, 0.0, 9.0), "wall", 6, 0)]
    table = _architecture_rows(slabs, 0.9, 0.1, 0.0)
    return build_house("screened", slabs, table, _rooms([(low, high)], 9.0), _room_planes(low, high, 9.0, 0))


@pytest.fixture(scope="module")
def scenes():
    """Of one bank, so that all tests share compiled programs."""
    box = Furniture(position=(0.0, 0.0), size=(0.6, 1.0, 1.8), category="wardrobe_cabinet")
    cube = shoebox((10.0, 10.0, 10.0), absorption=0.2, scattering=0.0)
    loss = two_rooms(absorption=0.3, transmission=10 ** (-np.linspace(15, 45, 7) / 10))
    every = [screened(), shoebox(furniture=[box]), cube, loss]
    return {name: scene_of(*every, house=i) for i, name in enumerate(("screen", "wardrobe", "cube", "wall"))}


def on_circle(angle) -> jnp.ndarray:
    a = np.radians(angle)
    return jnp.float32([-1.5 * np.sin(a), -1.5 * np.cos(a), 4.5])


@pytest.mark.parametrize(("turn", "expected"), [(0.5, -5.2), (15, -9.2), (30, -12.5), (60, -17.2)])
def test_the_edge_of_a_wall(scenes, turn, expected):
    """1 kHz, from a wall of no transmission, source 60 degrees from it."""
    assert level(around(scenes["screen"], on_circle(60), on_circle(240 + turn)))[3] == pytest.approx(expected, abs=1)


def test_past_a_wall_the_straight_path_is_softer_and_bends_nowhere(scenes):
    free, grazing = (around(scenes["screen"], on_circle(60), on_circle(a)) for a in (160, 239))
    assert not np.any(np.asarray(free.gain)[1:])
    assert np.all(abs(level(free)) < 1.5)
    assert np.all(level(grazing) > -6.1)
    assert level(grazing)[3] < -4


def test_sound_bends_around_a_wardrobe_as_high_as_it_is(scenes):
    """Long waves pass it, short ones are softened; its own sound is not muffled by itself."""
    ends = jnp.float32([-1.5, 0.1, 1.2]), jnp.float32([1.5, 0, 1.3])
    paths = around(scenes["wardrobe"], *ends)
    heard = level(paths)
    assert np.all(np.diff(heard) < 0.1)
    assert -3 < heard[0] < 0.1
    assert -40 < heard[6] < -15
    assert not np.any(paths.gain[0])
    own = around(scenes["wardrobe"], *ends, 0)
    np.testing.assert_allclose(level(own), 0, atol=1e-3)


def test_a_wall_lets_through_what_its_table_says(scenes):
    """No edge leads from room to room: only the straight path is left, softer by the transmission loss."""
    paths = around(scenes["wall"], jnp.float32([-2, 0.3, 1.2]), jnp.float32([2.2, -0.5, 1.6]))
    np.testing.assert_allclose(level(paths), -np.linspace(15, 45, 7), atol=0.01)


@pytest.mark.parametrize(("order", "count"), [(1, 7), (2, 25), (3, 63)])
def test_paths_of_homes_cube(scenes, order, count):
    """HoME's own counts and lengths for its cube, source in the middle, with the direct path."""
    middle, away = np.array([0.0, 0.0, 5.0]), np.array([2.5, -2.5, 3.0])
    paths = mirrored(scenes["cube"], jnp.float32(middle), jnp.float32(middle + away))
    sounding = np.sort(np.asarray(paths.distance)[np.any(np.asarray(paths.gain) > 0, axis=1)])
    grid = np.stack(np.meshgrid(*[np.arange(-3, 4)] * 3), axis=-1).reshape(-1, 3)
    orders = abs(grid).sum(axis=1)
    expected = np.linalg.norm(10.0 * grid - away, axis=1)
    assert len(sounding) == 62
    within = np.sort(expected[(orders > 0) & (orders <= 3)])
    np.testing.assert_allclose(sounding, within, rtol=1e-5)
    assert 1 + np.sum(orders[orders > 0] <= order) == count


def test_a_reflection_in_a_wardrobes_front(scenes):
    """Its length is that of the image source behind the front; its gain that of wood."""
    source, listener = np.array([-1.6, 0.3, 1.0]), np.array([-1.9, -0.2, 1.2])
    paths = mirrored(scenes["wardrobe"], jnp.float32(source), jnp.float32(listener))
    length = np.linalg.norm(source * [-1, 1, 1] + [-0.6, 0, 0] - listener)
    gain = np.asarray(paths.gain)[np.abs(np.asarray(paths.distance) - length) < 1e-4]
    assert len(gain) == 1
    assert np.all(gain > 0)


def test_options_choose_producers(scenes):
    """Both together: one direct path, the edges, the reflections; by default what always was."""
    both = AudioConfig(receiver=Omni(), early=EarlyPaths(num_edges=8, reflection_order=2, num_reflections=24))
    ends = SoundSource(jnp.float32([-1.5, 0.1, 1.2])), Listener(jnp.float32([1.5, 0, 1.3]), HEAD)
    run = jax.jit(lambda find, config: find(scenes["wardrobe"], *ends, config), static_argnums=(0, 1))
    assert jax.eval_shape(run, early_paths, both).distance.shape == (1 + 8 + 24,)
    default = AudioConfig(receiver=Omni())
    np.testing.assert_array_equal(run(early_paths, default).gain[:1], run(direct_path, default).gain)


def test_a_closed_door_lets_through_what_its_table_says_and_an_open_one_everything(generated_bank):
    """Half a metre before and behind a leaf: nothing leads around it while it is shut."""
    doors, house = generated_bank.physics, 0
    hinged = np.asarray(doors.door_valid[house]) & ~np.any(np.asarray(doors.door_slide[house]), axis=1)
    row = int(np.flatnonzero(hinged)[0])
    shut, wide, pivot = (
        float(doors.door_closed[house, row]),
        float(doors.door_fully_open[house, row]),
        np.asarray(doors.door_pivot[house, row]),
    )
    turn = np.array([[np.cos(shut), -np.sin(shut)], [np.sin(shut), np.cos(shut)]])
    middle = np.append(turn @ (np.asarray(doors.door_pos[house, row, :2]) - pivot) + pivot, 1.3)
    quat, size = np.asarray(doors.door_quat[house, row]), np.asarray(doors.door_size[house, row])
    yaw = 2 * np.arctan2(quat[3], quat[0]) + shut + (np.pi / 2 if size[1] < size[0] else 0)
    away = 0.5 * np.array([np.cos(yaw), np.sin(yaw), 0])

    @jax.jit
    def hear(angle):
        angles = jnp.zeros(generated_bank.spec.num_doors).at[row].set(angle)
        bodies = doors.body_pos[house], doors.body_quat[house]
        nobody = jnp.zeros((0, 3)), jnp.zeros((0, 4))
        scene = make_scene(generated_bank, jnp.int32(house), *bodies, *nobody, door_angle=angles)
        return diffracted_paths(
            scene, SoundSource(jnp.float32(middle + away)), Listener(jnp.float32(middle - away), HEAD), BENDING
        )

    loss = transmission_loss_table()["hollow_wood_door"]
    np.testing.assert_allclose(level(hear(shut)), -loss, atol=0.5)
    assert np.all(abs(level(hear(wide))) < 4)


@pytest.mark.slow
def test_first_reflections_of_homes_house(suncg_root):
    """HoME's own lengths for the real house, in a wall, the ceiling and the floor.

    Its path of 3.516 m is mirrored in the front of the box around a curtain, where there is no cloth; with objects as
    meshes it has none either. `early="home"` has it.
    """
    house = HouseSet(suncg_root).load()[0]
    shift = np.array([*house.offset[:2], 0.0])
    source, listener = np.array([39, -38.6, 1.5]) + shift, np.array([41, -39.5, 1.6]) + shift
    paths = mirrored(scene_of(house), jnp.float32(source), jnp.float32(listener))
    heard = np.asarray(paths.distance)[np.any(np.asarray(paths.gain) > 0, axis=1)]
    for length in (2.729, 3.164, 3.716):
        assert np.abs(heard - length).min() < 2e-3
    assert np.abs(heard - 3.516).min() > 0.02
