"""Stages of ray tracing in a house: from points of its cells, then from the portal states that rays reached."""

from concurrent.futures import ThreadPoolExecutor

import numpy as np
from jaxtyping import Float, Int

from home_mjx.audio_jax.late_reverb.bake.accumulate import fill_accumulator, propagate_portals
from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.portal_correction import RECORDED_BINS
from home_mjx.audio_jax.late_reverb.bake.portal_transfer import build_portal_states, build_second_states, sum_transfer
from home_mjx.audio_jax.late_reverb.trace.batches import FlightStart, FlightTracer, StageResult, merge_results
from home_mjx.audio_jax.late_reverb.trace.ray_pool import RayPool
from home_mjx.schema.compiled import BANDS

CELL_MIXING_LENGTH = 40.0  # [m], path length after which the start cell within a room hardly affects the field
STATIONARY_LENGTH = 120.0  # [m], further path length after which the decay no longer depends on the time since emission
UNTERMINATED_FLIGHTS = 2  # flights per first portal state whose rays portals do not terminate
UNTERMINATED_LENGTH_RATIO = 1.25  # path length of these flights re the recorded one, because not all rays reach its end
FLIGHTS_PER_STATE = (1, 3, 2, 1)  # per portal state: very old, old, after one door, after two doors


class Baker:
    """Ray tracing stages of one house.

    Args:
        house: Ray tracer of the house.
        tally: Accumulator of the energy that cells receive.
        seed: Seed of all random numbers of rays.
    """

    def __init__(self, house: FlightTracer, tally: Accumulator, seed: int) -> None:
        self.tracer, self.tally = house, tally
        self.rng = np.random.default_rng(seed)

    def run(self, points: Float[np.ndarray, "c r 3"], room: Int[np.ndarray, " c"]) -> dict[str, np.ndarray]:
        """Run all stages and fill the tally; return `comes_from` and sums over all rays, see `fill_accumulator`.

        Args:
            points: Start points of rays in each cell [m].
            room: Room of each cell.
        """
        sent, met, aged = RayPool(), RayPool(), RayPool()
        cells = self._trace([[self._source_rays(p, int(r))] for p, r in zip(points, room, strict=True)], True, sent)
        gates = build_portal_states(
            cells.gather(lambda gave: np.asarray(gave.portal_energy).sum(axis=(1, 4))).sum(axis=0)
        )
        oldest, old, entering = gates.ranges()
        sizes = [(flights, points.shape[1]) for flights in FLIGHTS_PER_STATE]
        young = sent.draw_flights(
            gates.rooms[entering], gates.number, entering.start, sizes[2], CELL_MIXING_LENGTH, self.rng
        )
        between = self._trace(young, False, met)
        sent.rays += met.rays
        grown = sent.draw_flights(gates.rooms[old], gates.number, old.start, sizes[1], STATIONARY_LENGTH, self.rng)
        middle = self._trace(grown, False, aged)
        rooms, first, second = build_second_states(
            gates, between.gather(lambda gave: np.asarray(gave.portal_energy).sum(axis=(1, 4)))
        )
        starts = aged.draw_flights(gates.rooms[oldest], gates.aged_number, oldest.start, sizes[0], np.inf, self.rng)
        after = met.draw_flights(rooms, first, len(gates.rooms), sizes[3], CELL_MIXING_LENGTH, self.rng)
        last = self._trace([*starts, *after], False)
        count = len(gates.rooms) + len(rooms)
        number = np.arange(count)
        others = np.concatenate([number[oldest], number[entering.stop :]])
        heard = merge_results(count, [(number[old], middle), (number[entering], between), (others, last)])
        goes = np.concatenate([np.repeat(gates.aged_number[None], entering.start, axis=0), first, second])
        passed = sum_transfer(heard.gather(lambda gave: gave.portal_energy), goes, count)
        with ThreadPoolExecutor(1) as pool:  # overlaps host work with ray tracing on a GPU
            later = pool.submit(propagate_portals, heard, passed, slice(old.start, entering.stop), len(room))
            told = self._trace_unterminated([*grown, *young])
            given = cells.gather(lambda gave: sum_transfer(np.asarray(gave.portal_energy), gates.number, count))
            return fill_accumulator(self.tally, cells, heard, given, passed, told, later.result())

    def _source_rays(self, points: Float[np.ndarray, "r 3"], room: int) -> FlightStart:
        count = len(points) * len(BANDS)
        way = self.rng.normal(size=(count, 3))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return FlightStart(np.tile(points, (len(BANDS), 1)), way, np.zeros(count), room, CELL_MIXING_LENGTH)

    def _trace_unterminated(self, starts: list[list[FlightStart]]) -> StageResult:
        """Trace some flights of each portal state without termination at other portals."""
        far = UNTERMINATED_LENGTH_RATIO * RECORDED_BINS * self.tally.metres
        return self._trace(
            [[one._replace(age=far) for one in some[:UNTERMINATED_FLIGHTS]] for some in starts], False, ends=False
        )

    def _trace(
        self, starts: list[list[FlightStart]], fresh: bool, pool: RayPool | None = None, ends: bool = True
    ) -> StageResult:
        seed, heard = int(self.rng.integers(2**31)), None if ends else RECORDED_BINS
        return self.tracer.trace(starts, fresh, seed, ends, heard, pool.add if pool else None)
