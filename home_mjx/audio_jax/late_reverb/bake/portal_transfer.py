"""Portal states, at which rays are restarted (NumPy, host only).

Sound that has passed a doorway no longer depends on its start, except for its time and energy. The same holds for sound
that has been reflected often in a room. Rays end at such *portal states*, and new rays start there:

- one state per ordered pair of rooms with exchange, for paths that began or aged in the first room;
- one state per two consecutive doors, because sound from one door reaches another with its own distribution;
- two states per room, for paths that are old and very old in it.

New rays continue those that reached a state, regardless of their start cell. So a few rays serve all cells, and rooms
many doors away.

D is the energy that cells receive from a source before any portal state, and G its emission into portal states over
time. Cells receive D + G U in total, where U is the energy from a state including transfer through others; see
`renewal`.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

MIN_STATE_SHARE = 0.05  # share of the energy into a room below which a path has no portal state of its own
MIN_GOING_SHARE = 1e-9  # share of all energy that is left in transfer between portal states when its sum ends
MAX_PASSES = 10_000  # maximum states that energy passes in that sum


class PortalStates(NamedTuple):
    """Portal states, at which rays restart."""

    rooms: Int[np.ndarray, "g 2"]  # left and entered; equal for aged paths, first the very old, then the old ones
    number: Int[np.ndarray, "r r"]  # index of the state for sound from room to room; -1 none
    aged_number: Int[np.ndarray, "r r"]  # the same for sound that is old already

    def ranges(self) -> tuple[slice, slice, slice]:
        """Return the index ranges of states of very old paths, of old paths, and of paths from another room."""
        own = int((self.rooms[:, 0] == self.rooms[:, 1]).sum()) // 2
        return slice(0, own), slice(own, 2 * own), slice(2 * own, len(self.rooms))


class Transfer(NamedTuple):
    """Energy from portal state to portal state over time, per unit in the first; a list of pairs with exchange."""

    source: Int[np.ndarray, " p"]  # in ascending order
    target: Int[np.ndarray, " p"]
    energy: Float[np.ndarray, "p bands k"]


def build_portal_states(portal_energy: Float[np.ndarray, "r r"]) -> PortalStates:
    """Build two states per room with energy, and one per ordered pair of rooms with exchange.

    Rooms have energy if it enters them or ages in them. Pairs with at most `MIN_STATE_SHARE` of the energy that enters
    a room have no own state: they share that of the pair with most energy into the same room, the first of equals.

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

    Minor are paths with at most `MIN_STATE_SHARE` of the energy that left their first state.

    Args:
        gates: States of rooms and of single doors.
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
    return rooms, number, np.where(before[:, None, None] >= 0, number[np.maximum(before, 0)], gates.number)


def sum_transfer(
    portal_energy: Float[np.ndarray, "s bands r r k"], number: Int[np.ndarray, "*s r r"], count: int
) -> Float[np.ndarray, "s bands g k"]:
    """Sum energy from room to room by state; `number`: states of room pairs, -1 omitted, shared or per source s.

    `count` is the number of states g.
    """
    out = np.zeros((*portal_energy.shape[:2], count, portal_energy.shape[-1]), portal_energy.dtype)
    each = np.broadcast_to(number, (len(portal_energy), *number.shape[-2:]))
    for left, entered in np.argwhere((each >= 0).any(axis=0)):
        rows = np.flatnonzero(each[:, left, entered] >= 0)
        out[rows, :, each[rows, left, entered]] += portal_energy[rows, :, left, entered]
    return out


def list_transfers(
    parts: Sequence[tuple[Int[np.ndarray, " _"], Float[np.ndarray, "_ bands r r _"]]],
    number: Int[np.ndarray, "g r r"],
    bins: int,
) -> Transfer:
    """List the transfers between portal states, of nonzero energy only, by source, then by target.

    A transfer sums the energies of all pairs of rooms with the same next state.

    Args:
        parts: At least one. Indices of some states, ascending through all parts, and their energy from room to room per
            octave and bin. States in no part have no transfers.
        number: Index of the next state per pair of rooms, for each state; -1: the energy is left out.
        bins: Number of bins of the result, at least that of each part, which is padded with zeros.
    """
    sources, targets, energies = [], [], []
    for rows, portal_energy in parts:
        dense = sum_transfer(portal_energy, number[rows], len(number))
        source, target = np.nonzero(dense.any(axis=(1, 3)))
        energies.append(np.zeros((len(source), dense.shape[1], bins), np.float32))
        energies[-1][..., : dense.shape[3]] = dense[source, :, target]
        sources.append(rows[source])
        targets.append(target)
    return Transfer(*(np.concatenate(x) for x in (sources, targets, energies)))


def total_flux(emitted: Float[np.ndarray, "bands g"], transfer: Transfer) -> Float[np.ndarray, "bands g"]:
    """Compute the total energy through each portal state: emitted, and from other states in any number of passes.

    Passes end when less than `MIN_GOING_SHARE` of the energy is left in them, at most after `MAX_PASSES`.
    """
    share = transfer.energy.sum(axis=2, dtype=float).T
    total, going, count = emitted.copy(), emitted, emitted.shape[1]
    for _ in range(MAX_PASSES):
        going = np.stack(
            [np.bincount(transfer.target, e[transfer.source] * s, count) for e, s in zip(going, share, strict=True)]
        )
        total += going
        if going.sum() <= MIN_GOING_SHARE * total.sum():
            break
    return total
