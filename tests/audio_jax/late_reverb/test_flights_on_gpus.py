"""Flights on GPUs, as C++ for the CPU: they agree with those in Numba; NVRTC, if it is here, compiles the kernels."""

import os
from dataclasses import replace

import numpy as np
import pytest
from acoustic_rooms import coupled
from compiled_kernels import nvrtc_ptx
from emulated_gpu import EmulatedStream, emulate_kernels
from soup import needs_gpu

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake import bake
from home_mjx.audio_jax.late_reverb.bake.field_cache import LateReverbBake
from home_mjx.audio_jax.late_reverb.bake.options import BakeOptions
from home_mjx.audio_jax.late_reverb.cuda import device, flights
from home_mjx.audio_jax.late_reverb.cuda.device import DeviceHouse
from home_mjx.audio_jax.late_reverb.cuda.flights import DeviceTracer
from home_mjx.audio_jax.late_reverb.cuda.kernels import SOURCES
from home_mjx.audio_jax.late_reverb.trace.cells import divide_rooms
from home_mjx.audio_jax.late_reverb.trace.house_rays import HouseRays
from home_mjx.audio_jax.late_reverb.trace.tracer import FlightStart, FlightTracer, make_grid
from home_mjx.audio_jax.propagation.paths import air_attenuation
from home_mjx.bank.bank import HouseBank
from home_mjx.errors import BackendError
from home_mjx.houses.bakes import bake_entry
from home_mjx.schema.compiled import BANDS

CONFIG = AudioConfig()
METRES = CONFIG.bin_seconds * CONFIG.speed_of_sound
SUMS = ("path_length", "absorbed", "exchanged", "transmitted")


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    return emulate_kernels(tmp_path_factory.mktemp("flights"))


@pytest.fixture(scope="module")
def scene():
    """Two rooms with a doorway, and a bank of them."""
    rooms = coupled()
    return rooms, HouseBank.from_compiled([rooms.house])


def tracers(library, scene, max_bounces):
    """Tracers of the same house: in Numba, and by the kernels."""
    (rooms, bank), cells = scene, divide_rooms(scene[0].house, 1.5)
    rays = HouseRays.from_bank(bank, 0)
    count = len(rooms.house.rooms.type)
    given = rays, make_grid(cells, np.ones((count, count), bool)), air_attenuation(CONFIG), METRES, cells.volume
    on_device = DeviceHouse.from_rays(rays, bank, 0, lambda: EmulatedStream(library))
    return FlightTracer(*given, max_bounces), DeviceTracer(*given, max_bounces, on_device)


def on_host(tracer, sums):
    """Sums with all arrays on the host."""
    energy = sums.energy
    return sums if isinstance(energy, np.ndarray) else sums._replace(energy=tracer.device.stream.download(energy))


def source(place, count, age=40.0, seed=0):
    """Rays from a place in the first room, in random directions."""
    way = np.random.default_rng(seed).normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    return FlightStart(np.tile(place, (count, 1)), way, np.zeros(count), np.ones((count, len(BANDS))), 0, age)


def test_a_first_segment_is_that_of_numba(library, scene):
    """One bounce needs no random number but for the times of records: all other sums are equal."""
    starts = [source(scene[0].source, 300), source(scene[0].source, 0), source(scene[0].source, 77, seed=1)]
    (expected, _), (found, _) = (t.trace(starts, 64, 0, from_source=True) for t in tracers(library, scene, 1))
    assert expected.absorbed[0].any()
    assert not found.absorbed[1].any()
    for name in SUMS:
        ours, theirs = getattr(found, name), getattr(expected, name)[..., : len(BANDS)]
        np.testing.assert_allclose(ours, theirs, rtol=2e-4, atol=1e-5 * theirs.max() + 1e-9)


@pytest.mark.parametrize("rules", [{"from_source": True, "keeps_ended": True}, {"end_in_rooms": False}])
def test_whole_flights_agree_on_average(library, scene, rules):
    """Twelve flights of forty bounces, each with its own random numbers: means within five standard errors."""
    starts = [source(scene[0].source, 800, seed=i) for i in range(12)]
    numba, kernels = tracers(library, scene, 250)
    (expected, first), (found, ended) = (t.trace(starts, 64, 0, **rules) for t in (numba, kernels))
    found = on_host(kernels, found)
    for name in (*SUMS, "energy", "portal"):
        _check_means(_coarse(getattr(expected, name)), _coarse(getattr(found, name)))
    for of in (lambda x: x.energy.sum(axis=0), lambda x: x.energy[x.rooms[:, 0] != x.rooms[:, 1]].sum(axis=0)):
        if ended:
            _check_means(*(np.array([of(one) for one in each]) for each in (first, ended)))


def _coarse(sums):
    """Octaves per source, and room or pair of rooms or sixteen bins."""
    sums = sums[..., : len(BANDS)].astype(float)
    if sums.shape[-2] == 64:
        sums = sums.reshape(len(sums), -1, 4, 16, len(BANDS)).sum(axis=3)
    return (sums.sum(axis=1) if sums.ndim == 4 and sums.shape[1] > 4 else sums).reshape(len(sums), -1, len(BANDS))


def _check_means(expected, found):
    error = np.sqrt((expected.var(axis=0) + found.var(axis=0)) / len(found))
    scale = expected.mean(axis=0).max()
    np.testing.assert_array_less(np.abs(expected.mean(axis=0) - found.mean(axis=0)), 5 * error + 0.003 * scale + 1e-12)


def test_bits_come_twice(library, scene):
    starts = [source(scene[0].source, 200)]
    _, kernels = tracers(library, scene, 30)
    (one, ended), (two, again) = (kernels.trace(starts, 64, 5, keeps_ended=True) for _ in range(2))
    for a, b in ((on_host(kernels, one), on_host(kernels, two)), (ended[0], again[0])):
        assert all(np.array_equal(x, y) for x, y in zip(a, b, strict=True))


def test_flights_of_many_rays_have_smaller_units(library, scene, monkeypatch):
    """With a sixteenth of the energy per ray, all results are the same but for rounding."""
    starts = [source(scene[0].source, 200), source(scene[0].source, 90)]
    _, kernels = tracers(library, scene, 30)
    one, ended = kernels.trace(starts, 64, 5, keeps_ended=True)
    monkeypatch.setattr(flights, "FULL_RAYS", 16)
    other, again = kernels.trace(starts, 64, 5, keeps_ended=True)
    for a, b in (
        *zip(on_host(kernels, one), on_host(kernels, other), strict=True),
        *zip(ended[0], again[0], strict=True),
    ):
        np.testing.assert_allclose(b, a, rtol=2e-3, atol=2e-5 * np.abs(a).max())


def test_sight_lines_are_those_of_numba(library, scene):
    rays = HouseRays.from_bank(scene[1], 0)
    on_device = DeviceHouse.from_rays(rays, scene[1], 0, lambda: EmulatedStream(library))
    ends = np.random.default_rng(0).uniform(-4, 4, (2, 2000, 3)) + np.asarray(scene[0].source)
    expected = rays.occluded(*ends)
    assert 0 < expected.mean() < 1
    np.testing.assert_array_equal(on_device.occluded(*ends), expected)


@pytest.mark.slow
def test_a_whole_bake_differs_as_between_seeds(library, scene, monkeypatch):
    """Levels and decays by those of the CPU's seeds, and all that rays do not decide not at all."""
    monkeypatch.setattr(device, "open_gpu", lambda: EmulatedStream(library))
    monkeypatch.setattr(bake, "traces_on_gpu", lambda device: device == "gpu")
    options = BakeOptions(cell_size=1.5, rays=800)
    house = scene[0].house
    one, other = (bake.bake_house(house, replace(options, seed=seed), scene[1], 0, "cpu") for seed in (0, 1))
    found = bake.bake_house(house, options, scene[1], 0, "gpu")
    for name in ("level", "shape"):
        a, b, c = (np.maximum(getattr(x, name).astype(float), -14) for x in (one, other, found))
        assert np.abs(c - a).mean() < 1.3 * np.abs(b - a).mean()
        assert np.abs(c - (a + b) / 2).max() < 2.5 * np.abs(b - a).max()
    for name in ("arrival", "near", "weight", "room"):
        np.testing.assert_array_equal(getattr(found, name), getattr(one, name))


def test_a_gpu_that_is_not_there_is_refused(scene):
    if "cuda" in os.environ.get("JAX_PLATFORMS", ""):
        pytest.skip("there may be a GPU here")
    with pytest.raises(BackendError, match="no NVIDIA GPU"):
        LateReverbBake(device="gpu").bake_house(scene[1], 0, scene[0].house)
    assert bake_entry(LateReverbBake(), scene[0].house) == bake_entry(LateReverbBake(device="cpu"), scene[0].house)


@needs_gpu
def test_on_a_gpu_flights_and_sight_lines_are_those_of_emulation(library, scene):
    """Whole flights on average, and the same bits twice."""
    _, emulated = tracers(library, scene, 250)
    kernels = replace(emulated, device=DeviceHouse.from_rays(emulated.house, scene[1], 0))
    starts = [source(scene[0].source, 800, seed=i) for i in range(12)]
    one, again, expected = (on_host(t, t.trace(starts, 64, 0)[0]) for t in (kernels, kernels, emulated))
    for a, b, c in zip(one, again, expected, strict=True):
        np.testing.assert_array_equal(a, b)
        _check_means(_coarse(c), _coarse(a))
    ends = np.random.default_rng(0).uniform(-4, 4, (2, 2000, 3)) + np.asarray(scene[0].source)
    np.testing.assert_array_equal(kernels.device.occluded(*ends), emulated.device.occluded(*ends))


def test_nvrtc_compiles_the_kernels():
    assert ".entry trace_segments" in nvrtc_ptx(SOURCES, 90)
