"""Flights of rays in a house: where and when they end, and that all octaves of a ray are right."""

from itertools import pairwise
from typing import no_type_check

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from acoustic_rooms import RISING, coupled
from handmade import shoebox
from numba import njit

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake import stages
from home_mjx.audio_jax.late_reverb.trace import flight
from home_mjx.audio_jax.late_reverb.trace.cells import divide_rooms
from home_mjx.audio_jax.late_reverb.trace.house_rays import HouseRays
from home_mjx.audio_jax.late_reverb.trace.ray_pool import RayPool
from home_mjx.audio_jax.late_reverb.trace.tracer import FlightStart, FlightTracer, make_grid
from home_mjx.audio_jax.propagation.paths import air_attenuation
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.schema.compiled import BANDS, CompiledHouse, RayKind

CONFIG = AudioConfig()
METRES = CONFIG.bin_seconds * CONFIG.speed_of_sound  # of a time bin
UNEVEN = np.array([[0.03]] * 4 + [[0.6], [0.03]])  # absorption of walls, floor and ceiling
POOL = np.arange(len(BANDS))


def tracer_of(house: CompiledHouse, max_bounces: int = 250) -> FlightTracer:
    cells, rooms = divide_rooms(house, 1.5), len(house.rooms.type)
    rays = HouseRays.from_bank(HouseBank.from_compiled([house]), 0)
    grid = make_grid(cells, np.ones((rooms, rooms), bool))
    return FlightTracer(rays, grid, air_attenuation(CONFIG), METRES, cells.volume, max_bounces)


def source(place: object, count: int, age: float, octaves: np.ndarray = POOL) -> FlightStart:
    """Rays of some octaves from a place in the first room, in random directions."""
    way = np.random.default_rng(0).normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    energy = np.tile(np.isin(POOL, octaves).astype(float), (count, 1))
    return FlightStart(np.tile(np.asarray(place, float), (count, 1)), way, np.zeros(count), energy, 0, age)


def test_rays_grow_old_by_the_way_that_they_flew():
    """In a small room, reflected every 1.3 m, too: ends by reflections cut those short that last.

    In the real SUNCG house rooms lost a third of their energy there.
    """
    tracer, age = tracer_of(shoebox((2.0, 1.6, 2.4), absorption=0.02), 60), stages.CELL_MIXING_LENGTH
    sums, _ = tracer.trace([source((0, 0, 1.2), 400, age)], stages.YOUNG_BINS, 0, from_source=True)
    went = sums.portal.sum(axis=(0, 1, 2, 4))
    early = went[: int(age / METRES)].sum() / went.sum()
    assert went.sum() > 0
    assert early == pytest.approx(0, abs=0.15)
    assert np.flatnonzero(went)[-1] < 2 * age / METRES


def test_what_is_not_absorbed_goes_on():
    """From a room through a doorway: in each octave absorbed energy and that into portal states add up to all."""
    house = coupled()
    sums, _ = tracer_of(house.house).trace([source(house.source, 20_000, 40.0)], 64, 0, from_source=True)
    went = sums.portal[0].sum(axis=2)[..., POOL]
    np.testing.assert_allclose(sums.absorbed[0].sum(axis=0)[POOL] + went.sum(axis=(0, 1)), 1, atol=0.01)
    assert np.all((went[0, 1] > 0.01) & (went[0, 1] < 0.1))


def test_every_octave_is_as_if_it_flew_alone():
    """A soft floor, scattering from 0.05 to 0.24: the decay of each octave of common rays within 5 %."""
    tracer = tracer_of(shoebox((6.0, 5.0, 3.0), UNEVEN, np.array([RISING])))
    starts = [source((1, -1, 1.2), 12_000, np.inf, octaves) for octaves in (POOL, POOL[:1], POOL[3:4], POOL[6:])]
    sums, _ = tracer.trace(starts, 160, 0, from_source=True)
    decay = sums.energy.sum(axis=1)
    for row, octave in enumerate((0, 3, 6), 1):
        together, alone = ([decay[i, a:b, octave].sum() for a, b in pairwise((2, 20, 60, 160))] for i in (0, row))
        np.testing.assert_allclose(together, alone, rtol=(0.02, 0.05, 0.12)[len(together) - 1])
    assert not decay[1, :, 1:7].any()


@njit
@no_type_check
def stratified(copy, copies, number):
    """What only compiled code calls."""
    return flight.stratify(copy, copies, number)


@pytest.mark.parametrize("copies", [1, 2, 3, 64])
def test_choices_of_copies_stay_below_one(copies):
    """At 1, a ray is mirrored by a surface that scatters everything, and its energy is 0 / 0."""
    least, largest = np.float32(0), np.nextafter(np.float32(1), np.float32(0))
    found = [float(stratified(copy, copies, number)) for copy in range(copies) for number in (least, largest)]
    assert found[::2] == pytest.approx(np.arange(copies) / copies)
    assert max(found) < 1
    assert found == sorted(found)


def test_sound_is_as_late_behind_states_as_without_them():
    """Half a bin less at each makes decays of houses 4 % short: rays restart with what is left of a bin."""
    tracer, rng = tracer_of(shoebox((5.0, 4.0, 3.0), absorption=0.3)), np.random.default_rng(0)
    starts = [source((1, -1, 1.2), 20_000, age) for age in (12.0, np.inf)]
    sums, ended = tracer.trace(starts, 100, 0, from_source=True, keeps_ended=True)
    pool, state = RayPool(ended[:1]), np.zeros((1, 2), int)
    again, _ = tracer.trace(pool.draw_flights(state, np.zeros((1, 1), int), 0, 20_000, np.inf, rng), 100, 1)
    first, whole, later = (x.sum(axis=0)[:, 3] for x in (*sums.energy, again.energy[0]))
    chained = first + np.convolve(sums.portal[0, 0, 0, :, 3], later)[:100]
    time = np.arange(100)
    assert chained.sum() == pytest.approx(whole.sum(), rel=0.01)
    assert chained @ time / chained.sum() == pytest.approx(whole @ time / whole.sum(), abs=0.1)


def test_the_number_of_threads_changes_nothing(monkeypatch):
    house = coupled()
    tracer, starts = tracer_of(house.house), [source(house.source + 0.1 * i, 50 + i, 40.0) for i in range(6)]
    found = []
    for cores in (1, 4):
        monkeypatch.setattr("home_mjx.core.workers.usable_cores", lambda cores=cores: cores)
        found.append(tracer.trace(starts, 64, 7, from_source=True, keeps_ended=True))
    for a, b in zip(*map(jax.tree.leaves, found), strict=True):
        np.testing.assert_array_equal(a, b)


def test_rays_meet_the_house_of_an_open_scene(generated_bank):
    """Movable objects as they stand and doors wide open, as `make_open_scene` has them."""
    rays, scene = HouseRays.from_bank(generated_bank, 0), make_open_scene(generated_bank, 0)
    moving = np.asarray(scene.moving.instance) >= 0
    ours = rays.arrays[14:]
    np.testing.assert_array_equal(ours[0], np.asarray(scene.moving.instance)[moving])
    np.testing.assert_allclose(ours[2], np.asarray(scene.moving.inverse)[moving], atol=1e-4)
    np.testing.assert_allclose(ours[3], np.asarray(scene.moving.box)[moving], atol=1e-4)
    rng = np.random.default_rng(0)
    middle = np.asarray(scene.moving.box)[moving].mean(axis=1)
    start, end = middle[rng.integers(len(middle), size=(2, 4000))] + rng.normal(0, 0.5, (2, 4000, 3))
    run = jax.jit(lambda a, b: occluded(scene, a, b - a, t_max=1.0, mask=int(RayKind.SOUND)))
    hidden = np.asarray(run(jnp.float32(start), jnp.float32(end)))
    assert 0.1 < hidden.mean() < 0.95
    assert np.mean(rays.occluded(start, end) != hidden) < 1e-3
