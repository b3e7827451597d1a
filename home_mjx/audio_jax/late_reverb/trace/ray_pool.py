"""Pool of rays that reached portal states, from which new flights start (host only)."""

from itertools import pairwise

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.trace.batches import FlightStart
from home_mjx.audio_jax.late_reverb.trace.trace_cells import PortalRays
from home_mjx.schema.compiled import BANDS


class RayPool:
    """Rays that reached portal states, from which new flights start."""

    def __init__(self) -> None:
        self.rays: list[tuple[np.ndarray, ...]] = []

    def add(self, ended: PortalRays, source: Int[np.ndarray, " f"]) -> None:
        """Add ended rays of flights (f, 2, n): those that left a room, and those that aged there.

        Args:
            ended: Host arrays of rays, octave after octave; rays without energy are skipped.
            source: Source of each flight.
        """
        ray, (_, kinds, count) = ended.ray, ended.entered_room.shape
        kept = np.flatnonzero(ray.energy > 0)
        values = (ray.origin, ray.direction, ray.travelled, ray.energy, ray.room, ended.entered_room)
        flat = (np.reshape(x, (-1, *np.shape(x)[3:]))[kept] for x in values)
        octave = kept % count // (count // len(BANDS))
        self.rays.append((*flat, octave, source[kept // (kinds * count)]))

    def draw_flights(
        self,
        rooms: Int[np.ndarray, "g 2"],
        number: Int[np.ndarray, "*s r r"],
        first: int,
        size: tuple[int, int],
        age: float,
        rng: np.random.Generator,
    ) -> list[list[FlightStart]]:
        """Draw flights from each of some portal states, by energy from rays of the same octave.

        Args:
            rooms: Rooms left and entered by these states.
            number: Index of the state per pair of rooms, shared by all sources or per source.
            first: Index of the first of these states.
            size: Number of flights per state, and of rays per octave in each flight.
            age: Path length at which the new rays end by age [m].
            rng: Random generator.

        Returns:
            Flights of each state; empty if no ray reached it. Octaves without rays draw from those of all octaves.
        """
        if not self.rays:
            return [[] for _ in rooms]
        origin, direction, travelled, energy, room, entered, octave, source = (
            np.concatenate(x) for x in zip(*self.rays, strict=True)
        )
        gate = number[source, room, entered] if number.ndim == 3 else number[room, entered]
        flights, count = size
        bands = len(BANDS)
        key = np.where(gate < first, -1, (gate - first) * bands + octave)
        key = np.minimum(key, len(rooms) * bands).astype(np.int16)  # radix sort of int16 takes one pass
        order = np.argsort(key, kind="stable")
        ends = np.searchsorted(key[order], np.arange(len(rooms) * bands + 1))
        out = []
        for index, here in enumerate(rooms[:, 1]):
            cuts = ends[index * bands : (index + 1) * bands + 1]
            mine = order[cuts[0] : cuts[-1]]
            if not mine.size:  # no ray reached this state
                out.append([])
                continue
            own = [order[a:b] if b > a else np.sort(mine) for a, b in pairwise(cuts)]
            drawn = np.stack([_draw_rows(rows, energy, count * flights, rng) for rows in own])
            every = np.moveaxis(drawn.reshape(bands, flights, count), 1, 0).reshape(flights, -1)
            out.append([FlightStart(origin[pick], direction[pick], travelled[pick], int(here), age) for pick in every])
        return out


def _draw_rows(
    rows: Int[np.ndarray, " n"], energy: Float[np.ndarray, " m"], count: int, rng: np.random.Generator
) -> Int[np.ndarray, " count"]:
    """Draw rows by energy with systematic sampling, in random order."""
    parts = np.cumsum(energy[rows].astype(float))
    place = (np.arange(count) + rng.random()) / count * parts[-1]
    return rng.permutation(rows[np.minimum(np.searchsorted(parts, place, side="right"), len(rows) - 1)])
