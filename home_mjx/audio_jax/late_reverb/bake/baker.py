"""Stages of ray tracing in a house: from points of its cells, then from the portal states that rays reached."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.bake.fit import Tally
from home_mjx.audio_jax.late_reverb.bake.forgotten import TOLD
from home_mjx.audio_jax.late_reverb.bake.join import join, later_of
from home_mjx.audio_jax.late_reverb.bake.renewal import gates_after, gates_of, through
from home_mjx.audio_jax.late_reverb.trace.pool import Pool
from home_mjx.audio_jax.late_reverb.trace.stage import Flights, Heard, Start, together
from home_mjx.schema.compiled import BANDS

YOUNG = 40.0  # [m], path length after which the start cell within a room hardly affects the field
OLD = 120.0  # [m], further path length after which the decay no longer depends on the time since emission
FREE = 2  # flights per first portal state whose rays portals do not terminate
FARTHER = 1.25  # path length of these flights re the recorded one, because not all rays reach its end
FLIGHTS = (1, 3, 2, 1)  # per portal state: very old, old, after one door, after two doors


class Baker:
    """Ray tracing stages of one house.

    Args:
        house: Ray tracer of the house.
        tally: Accumulator of the energy that cells receive.
        seed: Seed of all random numbers of rays.
    """

    def __init__(self, house: Flights, tally: Tally, seed: int) -> None:
        self.house, self.tally = house, tally
        self.rng = np.random.default_rng(seed)

    def run(self, points: Float[np.ndarray, "c r 3"], room: Int[np.ndarray, " c"]) -> dict[str, np.ndarray]:
        """Fill the tally; return directions from cell to cell and sums over all rays.

        Args:
            points: Start points of rays in each cell [m].
            room: Room of each cell.
        """
        sent, met, aged = Pool(), Pool(), Pool()
        cells = self._fly([[self._source(p, int(r))] for p, r in zip(points, room, strict=True)], True, sent)
        gates = gates_of(cells.whole(lambda gave: np.asarray(gave.went).sum(axis=(1, 4))).sum(axis=0))
        oldest, old, entering = gates.kinds()
        sizes = [(flights, points.shape[1]) for flights in FLIGHTS]
        young = sent.starts(gates.rooms[entering], gates.number, entering.start, sizes[2], YOUNG, self.rng)
        between = self._fly(young, False, met)
        sent.rays += met.rays
        grown = sent.starts(gates.rooms[old], gates.number, old.start, sizes[1], OLD, self.rng)
        middle = self._fly(grown, False, aged)
        rooms, first, second = gates_after(gates, between.whole(lambda gave: np.asarray(gave.went).sum(axis=(1, 4))))
        starts = aged.starts(gates.rooms[oldest], gates.older, oldest.start, sizes[0], np.inf, self.rng)
        after = met.starts(rooms, first, len(gates.rooms), sizes[3], YOUNG, self.rng)
        last = self._fly([*starts, *after], False)
        count = len(gates.rooms) + len(rooms)
        number = np.arange(count)
        others = np.concatenate([number[oldest], number[entering.stop :]])
        heard = together(count, [(number[old], middle), (number[entering], between), (others, last)])
        goes = np.concatenate([np.repeat(gates.older[None], entering.start, axis=0), first, second])
        passed = through(heard.whole(lambda gave: gave.went), goes, count)
        with ThreadPoolExecutor(1) as pool:  # overlaps host work with ray tracing on a GPU
            later = pool.submit(later_of, heard, passed, slice(old.start, entering.stop), len(room))
            told = self._fly_freely([*grown, *young])
            given = cells.whole(lambda gave: through(np.asarray(gave.went), gates.number, count))
            return join(self.tally, cells, heard, given, passed, told, later.result())

    def _source(self, points: Float[np.ndarray, "r 3"], room: int) -> Start:
        count = len(points) * len(BANDS)
        way = self.rng.normal(size=(count, 3))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return Start(np.tile(points, (len(BANDS), 1)), way, np.zeros(count), room, YOUNG)

    def _fly_freely(self, starts: list[list[Start]]) -> Heard:
        """Trace some flights of each portal state without termination at other portals."""
        far = FARTHER * TOLD * self.tally.metres
        return self._fly([[one._replace(age=far) for one in some[:FREE]] for some in starts], False, ends=False)

    def _fly(self, starts: list[list[Start]], fresh: bool, pool: Pool | None = None, ends: bool = True) -> Heard:
        seed, heard = int(self.rng.integers(2**31)), None if ends else TOLD
        return self.house.fly(starts, fresh, seed, ends, heard, pool.add if pool else None)
