"""Rays that start anew where others entered a room, and how what all of them give adds up; host side.

Sound that has come through a doorway has forgotten where it began, but for when and how much of it there is; so has
sound that has been reflected often in a room. Such moments are *gates*: one per pair of rooms between which sound goes,
for what began in the first or grew old there; one per two doors that sound comes through, for what comes through one
door meets another as nothing else does; and one per room for what has grown old in it. From each gate rays fly as they
went through it, whatever cell they came from, so that a few tell of all cells and rooms that are many doors away.

With D what cells hear of a source before any gate, G what goes from it through gates over time, H what cells hear of
a gate before the next one, and K what goes from gate to gate, all hear D + G U. U = H + K U is what they hear of a gate
through others too: a renewal equation, solved by its Fourier transform.
"""

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Complex, Float, Int

MINOR = 0.05  # share of what comes into a room below which a gate is none of its own
LONGER = 1.25  # times as long as what is transformed is the transform
DAMPING = 1e-6  # of time before it is transformed, over the transform: what wraps around is so small


class Gates(NamedTuple):
    """Where rays start anew."""

    rooms: Int[np.ndarray, "g 2"]  # left and entered; alike: what has grown old in a room, and first what is very old
    number: Int[np.ndarray, "r r"]  # of the gate through which sound goes from room to room; -1 none
    older: Int[np.ndarray, "r r"]  # the same of sound that has grown old already

    def kinds(self) -> tuple[slice, slice, slice]:
        """Gates of what is very old, what is old, and what comes from another room."""
        own = int((self.rooms[:, 0] == self.rooms[:, 1]).sum()) // 2
        return slice(0, own), slice(own, 2 * own), slice(2 * own, len(self.rooms))


def gates_of(went: Float[np.ndarray, "r r"]) -> Gates:
    """One gate per pair of rooms between which sound goes; what little comes another way counts to the main one.

    Args:
        went: Energy from room to room, on the diagonal what is left in it.
    """
    between = went * ~np.eye(len(went), dtype=bool)
    alive = np.flatnonzero(went.sum(axis=0) > 0)
    own = np.stack([alive, alive], axis=1)
    main = between > MINOR * between.sum(axis=0)
    rooms = np.concatenate([own, own, np.argwhere(main)])
    number = np.full(went.shape, -1)
    most = np.argmax(between, axis=0)
    number[tuple(rooms.T)] = np.arange(len(rooms))
    minor = np.argwhere(~main & (between > 0))
    number[tuple(minor.T)] = number[most[minor[:, 1]], minor[:, 1]]
    older = number.copy()
    older[alive, alive] = np.arange(len(alive))
    return Gates(rooms, number, older)


def gates_after(
    gates: Gates, went: Float[np.ndarray, "f r r"]
) -> tuple[Int[np.ndarray, "g 2"], Int[np.ndarray, "f r r"], Int[np.ndarray, "g r r"]]:
    """More gates, for what comes through a door after another; what little comes another way forgets the first one.

    Args:
        gates: That there are.
        went: Energy from room to room of what started at each gate between rooms.

    Returns:
        Rooms left and entered, by gate; the gate through which goes what started at each gate between rooms; and the
        same of what started at these new ones.
    """
    first = gates.kinds()[2].start
    between = went * ~np.eye(went.shape[1], dtype=bool)
    main = np.argwhere(between > MINOR * between.sum(axis=(1, 2), keepdims=True))
    number = np.repeat(gates.number[None], len(went), axis=0)
    number[tuple(main.T)] = len(gates.rooms) + np.arange(len(main))
    rooms = main[:, 1:]
    before = gates.number[tuple(rooms.T)] - first
    return rooms, number, np.where(before[:, None, None] >= 0, number[before], gates.number)


def through(
    went: Float[np.ndarray, "s bands r r k"], number: Int[np.ndarray, "*s r r"], count: int
) -> Float[np.ndarray, "s bands g k"]:
    """Energy that went from room to room, by gates, which are alike for all sources or given by source."""
    out = np.zeros((*went.shape[:2], count, went.shape[-1]), went.dtype)
    each = np.broadcast_to(number, (len(went), *number.shape[-2:]))
    for left, entered in np.argwhere((each >= 0).any(axis=0)):
        rows = np.flatnonzero(each[:, left, entered] >= 0)
        out[rows, :, each[rows, left, entered]] += went[rows, :, left, entered]
    return out


def flux(given: Float[np.ndarray, "s g"], passed: Float[np.ndarray, "g g"]) -> Float[np.ndarray, "s g"]:
    """All energy that ever goes through each gate: what sources give, and what comes from other gates."""
    return np.linalg.solve(np.eye(len(passed)) - passed.T, given.T).T


def beyond(
    passed: Float[np.ndarray, "g g k"], heard: Float[np.ndarray, "g c k"], some: slice
) -> Float[np.ndarray, "s c k"]:
    """What cells hear of some gates, through others too, over time.

    Args:
        passed: Energy from gate to gate.
        heard: Of each gate before the next one.
        some: Which gates.
    """
    bins = heard.shape[-1]
    one = np.eye(len(passed))
    rate = np.linalg.solve(one - np.swapaxes(_spectrum(passed), 1, 2), one[:, some])
    found = np.moveaxis(np.swapaxes(rate, 1, 2) @ _spectrum(heard), 0, -1)
    over_time = np.fft.irfft(np.ascontiguousarray(found), int(LONGER * bins))
    return over_time[..., :bins] / _damping(bins)


@lru_cache
def _damping(bins: int) -> Float[np.ndarray, " k"]:
    return DAMPING ** (np.arange(bins) / int(LONGER * bins))


def _spectrum(values: Float[np.ndarray, "a b k"]) -> Complex[np.ndarray, "f a b"]:
    """Of what is damped, so that it has ended when it begins anew."""
    bins = values.shape[-1]
    return np.ascontiguousarray(np.moveaxis(np.fft.rfft(values * _damping(bins), int(LONGER * bins)), -1, 0))
