"""What is heard through gates: against chains of rooms whose energies are powers of a matrix."""

import numpy as np

from home_mjx.audio_jax.late_reverb.bake.portal_transfer import (
    Transfer,
    build_portal_states,
    build_second_states,
    sum_transfer,
    total_flux,
)
from home_mjx.audio_jax.late_reverb.bake.renewal import solve_renewal
from home_mjx.audio_jax.late_reverb.trace.ray_pool import RayPool
from home_mjx.audio_jax.late_reverb.trace.tracer import EndedRays
from home_mjx.schema.compiled import BANDS

BINS = 200
STEP = np.array([[0.90, 0.04, 0.00], [0.03, 0.91, 0.02], [0.00, 0.01, 0.95]])  # energy that goes from room to room


def kernels() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Of three rooms: own decay (3, k), and what goes from each to each at every step (3, 3, k)."""
    stay = np.diag(STEP)[:, None] ** np.arange(BINS)
    leave = np.zeros((3, 3, BINS))
    for a in range(3):
        for b in range(3):
            if a != b:
                leave[a, b, 1:] = stay[a, :-1] * STEP[a, b]
    return stay, leave


def by_gates() -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Own decays (3, 3, k); sources' (3, g, k), gates' to gates (g, g, k) and to rooms (g, 3, k)."""
    stay, leave = kernels()
    gates = build_portal_states(leave.sum(axis=-1))
    own = np.eye(3)[:, :, None] * stay[:, None]
    went = np.zeros((3, 1, 3, 3, BINS))
    went[range(3), 0, range(3)] = leave
    given = sum_transfer(went, gates.number, len(gates.rooms))[:, 0]
    entered = gates.rooms[:, 1]
    return own, given, given[entered], own[entered]


def solved(transfer: np.ndarray, received: np.ndarray, states: slice) -> np.ndarray:
    """Energy from gates, of transfer (g, g, k)."""
    source, target = np.nonzero(transfer.any(axis=2))
    return solve_renewal(source, target, transfer[source, target], received, states)


def after_gates(given: np.ndarray, passed: np.ndarray, heard: np.ndarray) -> np.ndarray:
    """What cells hear of what sources send through gates, bin by bin."""
    each, bins = solved(passed, heard, slice(len(passed))), given.shape[-1]
    out = np.zeros((len(given), heard.shape[1], bins))
    for lag in range(bins):
        out[..., lag:] += np.einsum("cg,gnk->cnk", given[..., lag], each[..., : bins - lag])
    return out


def test_rooms_hear_what_powers_of_a_matrix_say():
    own, given, passed, heard = by_gates()
    found = own + after_gates(given, passed, heard)
    exact = np.stack([np.linalg.matrix_power(STEP, k) for k in range(BINS)], axis=-1)
    np.testing.assert_allclose(found, exact, rtol=1e-3, atol=1e-9)


def test_some_gates_are_heard_as_among_all():
    _, _, passed, heard = by_gates()
    every = solved(passed, heard, slice(len(passed)))
    np.testing.assert_allclose(solved(passed, heard, slice(1, 3)), every[1:3], rtol=1e-9, atol=1e-12)


def test_energy_through_gates_is_the_sum_over_all_ways():
    _, given, passed, _ = by_gates()
    source, target = np.nonzero(passed.any(axis=2))
    found = total_flux(given.sum(axis=(0, 2))[None], Transfer(source, target, passed[source, target][:, None]))
    exact = np.linalg.solve(np.eye(len(passed)) - passed.sum(axis=2).T, given.sum(axis=(0, 2)))
    np.testing.assert_allclose(found[0], exact, rtol=1e-6)


def test_what_has_grown_old_starts_anew_in_its_room():
    """A decay cut at step 10 and continued from a gate is the same decay."""
    stay = 0.97 ** np.arange(BINS)
    young, aged = np.where(np.arange(BINS) < 10, stay, 0), np.zeros(BINS)
    aged[10] = stay[10]
    found = young + after_gates(aged[None, None], aged[None, None], young[None, None])[0, 0]
    np.testing.assert_allclose(found, stay, rtol=1e-3)


def test_little_that_comes_another_way_counts_to_the_main_gate():
    went = np.zeros((4, 4))
    went[0, 1], went[2, 1], went[3, 1], went[1, 0] = 1.0, 0.5, 0.01, 0.2
    gates = build_portal_states(went)
    assert [tuple(pair) for pair in gates.rooms[gates.ranges()[2]].tolist()] == [(0, 1), (1, 0), (2, 1)]
    assert gates.number[3, 1] == gates.number[0, 1]
    assert (gates.number[went == 0] < 0).sum() == 12 - 2  # rooms that sound gets to grow old
    assert gates.number[1, 1] != gates.aged_number[1, 1]


def test_what_comes_through_a_door_in_line_with_the_next_goes_through_it():
    """Four rooms in a row: of what begins in a room a tenth goes on through the door after the next, but three tenths
    of what has come through a door before.

    With one gate per pair of rooms it had forgotten that: a third of it was heard in the last room.
    """
    gates = build_portal_states(np.diag(np.full(3, 0.5), 1))
    given = np.zeros((4, 1, 4, 4, 8))
    given[range(3), 0, range(3), range(1, 4), 1] = 0.5
    entering = gates.rooms[gates.ranges()[2]]
    met = went_on(entering, 0.1)
    rooms, first, second = build_second_states(gates, met.sum(axis=(1, 4)))
    assert rooms.tolist() == [[1, 2], [2, 3]]
    total = len(gates.rooms) + len(rooms)
    given, passed, later = (
        sum_transfer(*x, total)[:, 0] for x in ((given, gates.number), (met, first), (went_on(rooms, 0.3), second))
    )
    old = np.zeros((len(gates.rooms) - len(entering), total, 8))
    heard = np.zeros((total, 4, 8))
    heard[np.arange(total), np.concatenate([gates.rooms, rooms])[:, 1], 0] = 1
    found = after_gates(given, np.concatenate([old, passed, later]), heard).sum(axis=2)
    np.testing.assert_allclose(found[0], [0, 0.5, 0.05, 0.015], atol=1e-6)


def went_on(rooms: np.ndarray, share: float) -> np.ndarray:
    """Energy (g, 1, 4, 4, 8) of gates between four rooms in a row that goes on into the next, one bin later."""
    went = np.zeros((len(rooms), 1, 4, 4, 8))
    for gate, (_, entered) in enumerate(rooms):
        if entered < 3:
            went[gate, 0, entered, entered + 1, 1] = share
    return went


def ended(energy: np.ndarray, left: int, entered: int) -> EndedRays:
    """Rays (n, octaves) that left a room; where they are tells which they are."""
    place = np.repeat(np.arange(len(energy), dtype=np.float32)[:, None], 7, axis=1)
    return EndedRays(place, energy.astype(np.float32), np.tile(np.int32([left, entered]), (len(energy), 1)))


def test_rays_carry_the_energy_of_each_octave_on():
    """Of four rays with other shares in each octave: what those drawn carry together is what the pool has."""
    rng = np.random.default_rng(0)
    energy = rng.random((4, len(BANDS))) * np.array([0.0, 1.0, 3.0, 6.0])[:, None]
    energy[:, 2] = 0  # reached by no ray: taken as the mean of the others
    pool = RayPool([ended(energy, 0, 1), ended(np.ones((5, len(BANDS))), 1, 1)])
    gates = build_portal_states(np.array([[0.0, 1.0], [0.0, 1.0]]))
    entering = gates.ranges()[2]
    (flight,) = pool.draw_flights(gates.rooms[entering], gates.number, entering.start, 7000, 40.0, rng)
    assert flight.room == 1
    number = flight.origin[:, 0].astype(int)
    carried = np.stack([np.bincount(number, flight.energy[:, b], 4) for b in range(len(BANDS))], axis=1) / 7000
    share = energy / np.maximum(energy.sum(axis=0), 1e-9)
    share[:, 2] = share.sum(axis=1) / share.sum()
    np.testing.assert_allclose(carried, share, atol=2e-3)
    assert flight.energy.max() < len(BANDS)


def test_a_state_without_rays_has_an_empty_flight():
    gates = build_portal_states(np.array([[0.0, 1.0], [0.0, 0.0]]))
    entering = gates.ranges()[2]
    (flight,) = RayPool([]).draw_flights(
        gates.rooms[entering], gates.number, entering.start, 10, 40.0, np.random.default_rng(0)
    )
    assert len(flight.origin) == len(flight.energy) == 0


def test_what_passes_within_a_bin_comes_through_all_gates_at_once():
    """Three gates in a row, each of which lets half through in the same bin, and one back to the first."""
    transfer, received = np.zeros((3, 3, 4)), np.zeros((3, 1, 4))
    transfer[0, 1, 0] = transfer[1, 2, 0] = 0.5
    transfer[2, 0, 1] = 0.25
    received[2, 0, 0] = 1.0
    found = solved(transfer, received, slice(0, 3))[:, 0]
    np.testing.assert_allclose(found[:, 0], [0.25, 0.5, 1.0])
    np.testing.assert_allclose(found[2], [1, 1 / 16, 1 / 256, 1 / 4096])
