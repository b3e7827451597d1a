"""Pool of rays that reached portal states, from which new flights start."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.trace.tracer import NO_ENDED_RAYS, EndedRays, FlightStart


class RayPool:
    """Rays that reached portal states, from which new flights start.

    Args:
        ended: Rays that ended, of each source.
    """

    def __init__(self, ended: Sequence[EndedRays]) -> None:
        self.rays = EndedRays(*(np.concatenate(x) for x in zip(NO_ENDED_RAYS, *ended, strict=True)))
        self.source = np.repeat(np.arange(len(ended)), [len(one.energy) for one in ended])

    def extend(self, other: "RayPool") -> None:
        """Append the rays of another pool, in place; all rays then have source 0."""
        self.rays = EndedRays(*(np.concatenate(x) for x in zip(self.rays, other.rays, strict=True)))
        self.source = np.zeros(len(self.rays.energy), int)

    def draw_flights(
        self,
        rooms: Int[np.ndarray, "g 2"],
        number: Int[np.ndarray, "*s r r"],
        first: int,
        count: int,
        age: float,
        rng: np.random.Generator,
    ) -> list[FlightStart]:
        """Draw a flight from each of some portal states.

        Rays are drawn by the sum of their shares of the energies of all octaves, with systematic sampling. Their
        energies are divided by that, so that each octave keeps its own distribution over the rays. An octave without
        energy takes the mean distribution of the others.

        Args:
            rooms: Rooms left and entered by these states.
            number: Index of the state per pair of rooms, shared by all sources or per source.
            first: Index of the first of these states.
            count: Number of rays per state.
            age: Path length at which the new rays end by age [m].
            rng: Random generator.

        Returns:
            A flight from each state, of no rays if no ray reached it.
        """
        left, entered = self.rays.rooms.T
        state = number[self.source, left, entered] if number.ndim == 3 else number[left, entered]
        order = np.argsort(state, kind="stable")
        ends = np.searchsorted(state[order], first + np.arange(len(rooms) + 1))
        flights = []
        for index, room in enumerate(rooms[:, 1]):
            rows = order[ends[index] : ends[index + 1]]
            pick, energy = _draw_rows(self.rays.energy[rows].astype(float), count, rng)
            place = self.rays.place[rows[pick]]
            flights.append(FlightStart(place[:, :3], place[:, 3:6], place[:, 6], energy, int(room), age))
        return flights


def _draw_rows(
    energy: Float[np.ndarray, "n bands"], count: int, rng: np.random.Generator
) -> tuple[Int[np.ndarray, " count"], Float[np.ndarray, "count bands"]]:
    """Draw `count` row indices by energy, with systematic sampling; return them and energies of mean 1 per octave.

    A row's weight is the mean of its shares of the octaves' energies. Without energy the result has no rows.
    """
    whole = energy.sum(axis=0)
    if not len(energy) or not whole.any():
        return np.zeros(0, int), np.zeros((0, energy.shape[1]), np.float32)
    share = energy / np.maximum(whole, 1e-300)
    weight = share.mean(axis=1)
    share[:, whole <= 0] = weight[:, None] / weight.sum()
    parts = np.cumsum(weight)
    place = (np.arange(count) + rng.random()) / count * parts[-1]
    pick = np.minimum(np.searchsorted(parts, place, side="right"), len(parts) - 1)
    out = share[pick] / weight[pick, None]
    return pick, (out / np.maximum(out.mean(axis=0), 1e-300)).astype(np.float32)
