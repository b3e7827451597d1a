"""The oracle itself, against image sources, against statistical acoustics in its limits, and against conservation."""

from dataclasses import replace

import acoustic_rooms as rooms
import numpy as np
import pytest
from decay_oracle import SPEED, Blocks, fly, sees
from numpy_measures import decay_time, edt, t30

DT = 0.004
MID = 3  # 1 kHz
SIZE = np.array([6.0, 5.0, 3.0])
VOLUME, SURFACE = 90.0, 126.0


def at_1_khz(blocks: Blocks) -> Blocks:
    one = slice(MID, MID + 1)
    return replace(
        blocks, absorption=blocks.absorption[:, one], scattering=blocks.scattering[:, one], air=blocks.air[one]
    )


def box(absorption: float, scattering: float, air: float = 0.0) -> Blocks:
    blocks = at_1_khz(rooms.box_room("box", tuple(SIZE), absorption, scattering).blocks)
    return replace(blocks, air=np.array([air]))


def image_sources(listener: np.ndarray, absorption: float, bins: int) -> np.ndarray:
    """Energy per bin of all image sources of the box, added without phase."""
    reach = bins * DT * SPEED
    offsets, orders = [], []
    for axis in range(3):
        shift = SIZE[axis] / 2 if axis < 2 else 0.0
        s, m = rooms.SOURCE[axis] + shift, listener[axis] + shift
        k = np.arange(-int(reach / SIZE[axis] / 2) - 1, int(reach / SIZE[axis] / 2) + 2)
        offsets.append(np.concatenate([2 * k * SIZE[axis] + s, 2 * k * SIZE[axis] - s]) - m)
        orders.append(np.concatenate([np.abs(2 * k), np.abs(2 * k - 1)]))
    distance = np.sqrt(sum(g**2 for g in np.meshgrid(*offsets, indexing="ij", sparse=True)))
    order = sum(np.meshgrid(*orders, indexing="ij", sparse=True)) + 0 * distance
    heard = distance < reach
    energy = (1 - absorption) ** order[heard] / distance[heard] ** 2
    return np.bincount((distance[heard] / SPEED / DT).astype(int), energy, bins)[:bins]


def mean_t30(energy: np.ndarray) -> float:
    """Of all receivers' single octave."""
    return float(np.mean([t30(e[0], DT) for e in energy]))


def test_a_mirroring_box_is_that_of_image_sources():
    """Level within 0.1 dB, decay time within 1.5 %, and each 40 ms of the decay."""
    found = fly(box(0.2, 0.0), rooms.SOURCE, rooms.LISTENERS, 1.0, particles=20_000).energy
    exact = np.stack([image_sources(p, 0.2, 250) for p in rooms.LISTENERS])[:, None]
    level = 10 * np.log10(found.sum(axis=(0, 2)) / exact.sum(axis=(0, 2)))
    assert abs(level[0]) < 0.1
    assert mean_t30(found) == pytest.approx(mean_t30(exact), rel=0.015)
    assert mean_t30(exact) == pytest.approx(0.65, abs=0.01)
    parts = [e.sum(axis=(0, 1)).reshape(-1, 10).sum(axis=1)[:10] for e in (found, exact)]
    np.testing.assert_allclose(10 * np.log10(parts[0] / parts[1]), 0, atol=0.5)


@pytest.mark.parametrize("absorption", [0.02, 0.2])
def test_a_scattering_box_is_that_of_statistical_acoustics(absorption):
    """Kuttruff's correction of Eyring; where little is absorbed the two and Sabine's formula are one."""
    seconds = 4.0 if absorption < 0.1 else 1.0
    count = 1500 if absorption < 0.1 else 15_000
    found = fly(box(absorption, 1.0), rooms.SOURCE, rooms.LISTENERS, seconds, particles=count)
    exponent = -np.log(1 - absorption)
    sabine = 24 * np.log(10) / SPEED * VOLUME / (SURFACE * absorption)
    eyring = sabine * absorption / exponent
    kuttruff = eyring / (1 - 0.364 / 2 * exponent)
    if absorption < 0.1:
        assert sabine == pytest.approx(kuttruff, rel=0.015)
    assert mean_t30(found.energy) == pytest.approx(kuttruff, rel=0.02)
    level = np.mean(found.energy.sum(axis=(1, 2)) - 1 / np.linalg.norm(rooms.LISTENERS - rooms.SOURCE, axis=1) ** 2)
    diffuse = 16 * np.pi * (1 - absorption) / (SURFACE * exponent)  # what is left after the first reflection
    assert 10 * np.log10(level / diffuse) == pytest.approx(0, abs=0.5)


def test_nothing_is_lost_between_hard_walls():
    found = fly(box(0.0, 0.5), rooms.SOURCE, rooms.LISTENERS, 0.5, particles=200)
    np.testing.assert_allclose(found.left, 1, rtol=1e-9)
    assert found.path / found.reflections == pytest.approx(4 * VOLUME / SURFACE, rel=0.03)
    air = fly(box(0.0, 0.5, air=0.02), rooms.SOURCE, rooms.LISTENERS, 0.5, particles=50)
    np.testing.assert_allclose(air.left[0], np.exp(-0.02 * SPEED * DT * np.arange(125)), rtol=1e-9)


def test_every_octave_has_its_own_scattering():
    """It rises from 0.05 to 0.24 above a soft floor: high octaves find the floor sooner."""
    room = rooms.rising()
    found = fly(room.blocks, room.source, room.listeners, 1.5, particles=2500)
    assert found.energy.shape == (6, 7, 375)
    times = found.energy.sum(axis=0)
    assert t30(times[0], DT) > 1.3 * t30(times[5], DT) > 1.3 * t30(times[6], DT)


def two_room_slopes() -> np.ndarray:
    """Decay times of the energy balance of the two rooms, the longer first: V dE/dt = -c/4 (A E + S (E - E'))."""
    lengths, absorption, door = np.array([6 - rooms.LEAF, 4 - rooms.LEAF]), np.array([0.35, 0.05]), np.prod(rooms.DOOR)
    volumes = lengths * 4 * 2.7
    surfaces = 2 * (lengths * 4 + lengths * 2.7 + 4 * 2.7) - door
    areas = -np.log(1 - absorption) * surfaces
    matrix = SPEED / 4 * (np.diag(areas + door) - door * np.eye(2)[::-1]) / volumes[:, None]
    return np.sort(6 * np.log(10) / np.linalg.eigvals(matrix))[::-1]


@pytest.fixture(scope="module")
def two_rooms():
    room = rooms.coupled()
    return fly(at_1_khz(room.blocks), room.source, room.listeners, 2.0, particles=60_000, radius=0.5).energy[:, 0]


def test_coupled_rooms_decay_with_two_slopes(two_rooms):
    """The late slope of both rooms is that of the energy balance within a tenth; the source's room falls fast first."""
    slow, fast = two_room_slopes()
    near, far = two_rooms[:3].mean(axis=0), two_rooms[3:].mean(axis=0)
    assert decay_time(near, DT, -25, -45) == pytest.approx(slow, rel=0.1)
    assert decay_time(far, DT, -10, -35) == pytest.approx(slow, rel=0.1)
    assert fast < 0.4
    assert edt(near, DT) < 0.35


def test_blocks_hide_what_is_behind_them():
    blocks = rooms.coupled().blocks
    assert sees(blocks, np.array([2.0, 0, 1]), np.array([8.0, 0, 1]))
    assert not sees(blocks, np.array([2.0, 1, 1]), np.array([8.0, 1, 1]))
    assert not sees(blocks, np.array([2.0, 0, 2.5]), np.array([8.0, 0, 2.5]))


@pytest.mark.slow
def test_uneven_rooms_decay_as_an_older_oracle_had_it():
    """A floor of absorption 0.6, elsewhere 0.03: with scattering 0.1, and per octave; that one listened elsewhere."""
    room = rooms.uneven()
    found = fly(at_1_khz(room.blocks), room.source, room.listeners, 2.5, particles=100_000)
    assert mean_t30(found.energy) == pytest.approx(1.20, rel=0.05)
    room = rooms.rising()
    still = replace(room.blocks, air=np.zeros(7))  # the older figures are without the air's part
    found = fly(still, room.source, room.listeners, 3.0, particles=60_000).energy
    times = [np.mean([t30(e[band], DT) for e in found]) for band in (0, MID, 5, 6)]
    np.testing.assert_allclose(times, [1.77, 1.26, 0.92, 0.74], rtol=0.06)
