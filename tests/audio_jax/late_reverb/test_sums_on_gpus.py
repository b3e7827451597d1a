"""Sums of energies between cells on GPUs, as C++ for the CPU: they agree with those in Numba and NumPy."""

import numpy as np
import pytest
from emulated_gpu import EmulatedStream, emulate_kernels

from home_mjx.audio_jax.late_reverb.bake import gpu_sums as sums
from home_mjx.audio_jax.late_reverb.bake import pair_sums
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import Transfer
from home_mjx.audio_jax.late_reverb.bake.renewal import solve_renewal

ROOM = np.array([0, 0, 1, 1, 1])
BINS, STATES = 45, 6


@pytest.fixture(scope="module")
def stream(tmp_path_factory):
    return EmulatedStream(emulate_kernels(tmp_path_factory.mktemp("sums")))


def on_device(stream, energy):
    """Energies (lanes, states, cells, bins) as `gather_states` leaves them."""
    padded = np.pad(np.moveaxis(energy, 2, 3), [(0, 0)] * 3 + [(0, sums.CELLS - energy.shape[2])])
    return stream.upload(np.ascontiguousarray(padded, np.float32))


def test_transfers_are_those_of_numba(stream):
    """Also within a bin, for states without any transfer, and for directions, which are means over octaves."""
    rng = np.random.default_rng(0)
    source, target = np.array([0, 0, 1, 3, 4, 4]), np.array([1, 2, 0, 3, 2, 5])
    energy = rng.random((6, 7, BINS)).astype(np.float32) * np.geomspace(0.05, 1e-3, BINS, dtype=np.float32)
    energy[1, :, :3] = energy[2, :, 20:] = 0
    received = rng.normal(1, 0.5, (10, STATES, len(ROOM), BINS)).astype(np.float32)
    found = stream.download(sums.solve_transfers(stream, on_device(stream, received), Transfer(source, target, energy)))
    for lane in range(10):
        one = energy[:, lane] if lane < 7 else energy.mean(axis=1)
        exact = solve_renewal(source, target, one, received[lane], slice(0, STATES))
        np.testing.assert_allclose(np.moveaxis(found[lane, :, :, : len(ROOM)], 1, 2), exact, rtol=2e-5, atol=1e-5)


def test_pairs_are_those_of_numba(stream):
    """From energies after three of the states, negative ones as 0, times a ratio per room."""
    rng, first = np.random.default_rng(1), slice(2, 5)
    own = rng.random((5, 5, 20, 10)).astype(np.float32)
    energy = rng.normal(1, 1, (10, STATES, 5, BINS)).astype(np.float32)
    emitted = (rng.random((7, 5, 3, 12)) * (rng.random((7, 5, 3, 12)) < 0.5)).astype(np.float32)
    ratio, arrival = rng.uniform(0.5, 2, (3, 2, BINS)), rng.integers(0, 9, (5, 5))
    found, given = on_device(stream, energy), stream.upload(own)
    for lane, lanes, bins, factor in ((0, 7, BINS, ratio), (7, 3, 30, None)):
        part = energy[lane : lane + lanes, first, :, :bins]
        expected = np.maximum(part, 0) * factor[:, ROOM].astype(np.float32) if lane == 0 else part
        after = sums.energy_after(stream, found, first, ROOM, (lane, lanes, bins), factor)
        ours = sums.sum_pairs(stream, given, lane, emitted[:lanes], after, arrival, ROOM)
        theirs = pair_sums.sum_pairs(own[..., lane : lane + lanes], emitted[:lanes], expected, arrival, ROOM)
        for a, b in zip(ours, theirs, strict=True):
            np.testing.assert_allclose(a, b, rtol=1e-5, atol=1e-5 * np.abs(b).max())


def test_rooms_sum_their_cells_over_intervals(stream):
    energy = np.random.default_rng(2).normal(1, 1, (2, STATES, 5, sums.RECORDED_BINS, 10)).astype(np.float32)
    strides = np.array(energy.strides)[[0, 4, 1, 3, 2]] // 4
    given = stream.upload(energy)
    found = sums.sum_rooms(stream, given.address, (2, STATES), ROOM, tuple(map(int, strides)))
    parts = np.add.reduceat(np.maximum(energy, 0).astype(float), sums.INTERVAL_EDGES[:-1], axis=3)
    exact = np.einsum("mgneb,nr->mbgre", parts[..., :7], np.eye(2)[ROOM])
    np.testing.assert_allclose(found, exact, rtol=1e-6)
