"""Portal states, at which rays are restarted, and the renewal equation that adds up their energies (NumPy, host only).

Sound that has passed a doorway no longer depends on its start, except for its time and energy. The same holds for sound
that has been reflected often in a room. Rays end at such *portal states*, and new rays start there:

- one state per ordered pair of rooms with exchange, for paths that began or aged in the first room;
- one state per two consecutive doors, because sound from one door reaches another with its own distribution;
- two states per room, for paths that are old and very old in it.

New rays continue those that reached a state, regardless of their start cell. So a few rays serve all cells, and rooms
many doors away.

D is the energy that cells receive from a source before any portal state, and G its emission into portal states over
time. H is the energy that cells receive from a state before the next one, and K the transfer between states. Cells then
receive D + G U in total. U = H + K U is the energy from a state including transfer through others: a renewal equation,
solved by its Fourier transform.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Complex, Float, Int

MIN_STATE_SHARE = 0.05  # share of the energy into a room below which a path has no portal state of its own
FFT_LENGTH_RATIO = 1.25  # length of the Fourier transform re the signal
FFT_DAMPING = 1e-6  # exponential damping over the length of the transform; bounds circular wrap-around


class PortalStates(NamedTuple):
    """Portal states, at which rays restart."""

    rooms: Int[np.ndarray, "g 2"]  # left and entered; equal for aged paths, first the very old, then the old ones
    number: Int[np.ndarray, "r r"]  # index of the state for sound from room to room; -1 none
    aged_number: Int[np.ndarray, "r r"]  # the same for sound that is old already

    def ranges(self) -> tuple[slice, slice, slice]:
        """Return the index ranges of states of very old paths, of old paths, and of paths from another room."""
        own = int((self.rooms[:, 0] == self.rooms[:, 1]).sum()) // 2
        return slice(0, own), slice(own, 2 * own), slice(2 * own, len(self.rooms))


def build_portal_states(portal_energy: Float[np.ndarray, "r r"]) -> PortalStates:
    """Build two states per room with energy, and one per ordered pair of rooms with exchange.

    Pairs below `MIN_STATE_SHARE` have no own state. They share that of the pair with most energy into the same room.

    Args:
        portal_energy: Energy from room (row) to room (column); on the diagonal the energy that aged in the room.
    """
    between = portal_energy * ~np.eye(len(portal_energy), dtype=bool)
    alive = np.flatnonzero(portal_energy.sum(axis=0) > 0)
    own = np.stack([alive, alive], axis=1)
    main = between > MIN_STATE_SHARE * between.sum(axis=0)
    rooms = np.concatenate([own, own, np.argwhere(main)])
    number = np.full(portal_energy.shape, -1)
    most = np.argmax(between, axis=0)
    number[tuple(rooms.T)] = np.arange(len(rooms))
    minor = np.argwhere(~main & (between > 0))
    number[tuple(minor.T)] = number[most[minor[:, 1]], minor[:, 1]]
    older = number.copy()
    older[alive, alive] = np.arange(len(alive))
    return PortalStates(rooms, number, older)


def build_second_states(
    gates: PortalStates, portal_energy: Float[np.ndarray, "f r r"]
) -> tuple[Int[np.ndarray, "g 2"], Int[np.ndarray, "f r r"], Int[np.ndarray, "g r r"]]:
    """Build states for two consecutive doors; minor paths use the state of the last door alone.

    Args:
        gates: Existing states.
        portal_energy: Energy from room to room of rays that started at each state between rooms.

    Returns:
        Rooms left and entered by each new state; state index per pair of rooms, for rays from each state between rooms;
        the same for rays from each new state.
    """
    first = gates.ranges()[2].start
    between = portal_energy * ~np.eye(portal_energy.shape[1], dtype=bool)
    main = np.argwhere(between > MIN_STATE_SHARE * between.sum(axis=(1, 2), keepdims=True))
    number = np.repeat(gates.number[None], len(portal_energy), axis=0)
    number[tuple(main.T)] = len(gates.rooms) + np.arange(len(main))
    rooms = main[:, 1:]
    before = gates.number[tuple(rooms.T)] - first
    return rooms, number, np.where(before[:, None, None] >= 0, number[before], gates.number)


def sum_transfer(
    portal_energy: Float[np.ndarray, "s bands r r k"], number: Int[np.ndarray, "*s r r"], count: int
) -> Float[np.ndarray, "s bands g k"]:
    """Sum energy from room to room by portal state; `number` is shared by all sources or has one row per source."""
    out = np.zeros((*portal_energy.shape[:2], count, portal_energy.shape[-1]), portal_energy.dtype)
    each = np.broadcast_to(number, (len(portal_energy), *number.shape[-2:]))
    for left, entered in np.argwhere((each >= 0).any(axis=0)):
        rows = np.flatnonzero(each[:, left, entered] >= 0)
        out[rows, :, each[rows, left, entered]] += portal_energy[rows, :, left, entered]
    return out


def total_flux(emitted: Float[np.ndarray, "s g"], transfer: Float[np.ndarray, "g g"]) -> Float[np.ndarray, "s g"]:
    """Compute the total energy through each portal state, from sources and from other states."""
    return np.linalg.solve(np.eye(len(transfer)) - transfer.T, emitted.T).T


def solve_renewal(
    transfer: Float[np.ndarray, "g g k"], received: Float[np.ndarray, "g c k"], states: slice
) -> Float[np.ndarray, "s c k"]:
    """Compute the energy over time that cells receive from some states, including transfer through others.

    Args:
        transfer: Energy from state (axis 0) to state (axis 1), by time bin.
        received: Energy that cells receive from each state before the next one.
        states: Indices of the states.
    """
    bins = received.shape[-1]
    one = np.eye(len(transfer))
    rate = np.linalg.solve(one - np.swapaxes(_spectrum(transfer), 1, 2), one[:, states])
    found = np.moveaxis(np.swapaxes(rate, 1, 2) @ _spectrum(received), 0, -1)
    over_time = np.fft.irfft(np.ascontiguousarray(found), int(FFT_LENGTH_RATIO * bins))
    return over_time[..., :bins] / _damping(bins)


@lru_cache
def _damping(bins: int) -> Float[np.ndarray, " k"]:
    return FFT_DAMPING ** (np.arange(bins) / int(FFT_LENGTH_RATIO * bins))


def _spectrum(values: Float[np.ndarray, "a b k"]) -> Complex[np.ndarray, "f a b"]:
    """Transform damped signals, so that circular wrap-around is negligible."""
    bins = values.shape[-1]
    return np.ascontiguousarray(np.moveaxis(np.fft.rfft(values * _damping(bins), int(FFT_LENGTH_RATIO * bins)), -1, 0))
