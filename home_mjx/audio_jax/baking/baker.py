"""Stages in which rays fly through a house: from points of its cells, then from gates that others went through."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.baking.fit import Tally
from home_mjx.audio_jax.baking.flights.pool import Pool
from home_mjx.audio_jax.baking.flights.stage import Flights, Heard, Start, together
from home_mjx.audio_jax.baking.forgotten import TOLD
from home_mjx.audio_jax.baking.join import join, later_of
from home_mjx.audio_jax.baking.renewal import gates_after, gates_of, through
from home_mjx.schema.compiled import BANDS

YOUNG = 40.0  # [m], after which it hardly matters in which cell of a room sound began
OLD = 120.0  # [m], after which it does not matter when
PER_METRE = 1.0  # most reflections: flights end by age, for rays that are reflected seldom are those that last
FREE = 2  # flights from each gate that no other one ends
LONGER = 1.25  # times as far as they are heard fly rays that no gate ends, for not all fly as far
FLIGHTS = (1, 3, 2, 1)  # of rays of each room that are very old, old, from each gate between rooms, and after another


class Baker:
    """Of one house.

    Args:
        house: In which rays fly.
        tally: Of what cells hear.
        bounces: Of rays that tell how rooms decay in the end.
        seed: Of all random numbers of rays.
    """

    def __init__(self, house: Flights, tally: Tally, bounces: int, seed: int) -> None:
        self.house, self.tally, self.bounces = house, tally, bounces
        self.rng = np.random.default_rng(seed)

    def run(self, points: Float[np.ndarray, "c r 3"], room: Int[np.ndarray, " c"]) -> dict[str, np.ndarray]:
        """Fills the tally; directions from cell to cell, and sums over all rays.

        Args:
            points: Where rays start in each cell [m].
            room: Of each cell.
        """
        sent, met, aged = Pool(), Pool(), Pool()
        cells = self._fly([[self._source(p, int(r))] for p, r in zip(points, room, strict=True)], True, YOUNG, sent)
        gates = gates_of(cells.whole(lambda gave: np.asarray(gave.went).sum(axis=(1, 4))).sum(axis=0))
        oldest, old, entering = gates.kinds()
        sizes = [(flights, points.shape[1]) for flights in FLIGHTS]
        young = sent.starts(gates.rooms[entering], gates.number, entering.start, sizes[2], self.rng)
        between = self._fly(young, False, YOUNG, met)
        sent.rays += met.rays
        grown = sent.starts(gates.rooms[old], gates.number, old.start, sizes[1], self.rng)
        middle = self._fly(grown, False, OLD, aged)
        starts = aged.starts(gates.rooms[oldest], gates.older, oldest.start, sizes[0], self.rng)
        last = self._fly(starts, False, np.inf)
        rooms, first, second = gates_after(gates, _went(between).sum(axis=(1, 4)))
        starts = met.starts(rooms, first, len(gates.rooms), sizes[3], self.rng)
        after = self._fly(starts, False, YOUNG)
        count, opened = len(gates.rooms) + len(rooms), slice(old.start, entering.stop)
        every = (last, gates.older), (middle, gates.older), (between, first), (after, second)
        passed = np.concatenate([through(_went(heard), number, count) for heard, number in every])
        heard = together([heard for heard, _ in every])
        with ThreadPoolExecutor(1) as pool:  # the host has nothing else to do while a GPU's rays fly
            later = pool.submit(later_of, heard, passed, opened, len(room))
            some = [flights[:FREE] for flights in (*grown, *young)]
            free = self._fly(some, False, LONGER * TOLD * self.tally.metres, ends=False)
            given = cells.whole(lambda gave: through(np.asarray(gave.went), gates.number, count))
            return join(self.tally, cells, heard, given, passed, free, later.result())

    def _source(self, points: Float[np.ndarray, "r 3"], room: int) -> Start:
        count = len(points) * len(BANDS)
        way = self.rng.normal(size=(count, 3))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return Start(np.tile(points, (len(BANDS), 1)), way, np.zeros(count), room)

    def _fly(
        self, starts: list[list[Start]], fresh: bool, age: float, pool: Pool | None = None, ends: bool = True
    ) -> Heard:
        bounces = min(int(age * PER_METRE), self.bounces) if np.isfinite(age) else self.bounces
        seed = int(self.rng.integers(2**31))
        heard = None if ends else TOLD
        return self.house.fly(starts, fresh, bounces, age, seed, ends, heard, pool.add if pool else None)


def _went(heard: Heard) -> Float[np.ndarray, "s bands r r k"]:
    return heard.whole(lambda gave: gave.went)
