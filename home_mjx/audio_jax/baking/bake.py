"""From a compiled house to its late field."""

from dataclasses import dataclass, replace
from functools import partial, reduce
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.baked.spans import BINS, SPANS, at_knots
from home_mjx.audio_jax.baking.cells import Cells, divide
from home_mjx.audio_jax.baking.fit import Tally
from home_mjx.audio_jax.baking.flight import Flown, Grid, fly
from home_mjx.audio_jax.baking.flow import flow_of
from home_mjx.audio_jax.baking.late_field import LateField, small
from home_mjx.audio_jax.baking.places import clear_points, in_view, places, start_points, ways
from home_mjx.audio_jax.baking.renewal import Pool, Start, add_up, flux, gates_after, gates_of, through
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, CompiledHouse

PLACES = 0  # seed of places in cells, the same in every bake of a house
EARLY = 128  # bins, after which sound comes from everywhere
YOUNG = 40.0  # [m], after which it hardly matters in which cell of a room sound began
OLD = 120.0  # [m], after which it does not matter when
PER_METRE = 1.0  # most reflections: flights end by age, for rays that are reflected seldom are those that last
FLIGHTS = (1, 3, 2, 1)  # of rays of each room that are very old, old, from each gate between rooms, and after another
NARROW = 0.3  # [m]: portals that agents cannot cross count as so wide
MOST_RAYS = (1600, 800, 400)  # few numbers: each is a program of its own
RAYS_IN_ALL = 50_000  # from all cells, per octave
PAIRS = ("moved", "through")
SUMS = ("lived", "lost", *PAIRS)  # of `Flown`, over all rays
AT_ONCE = {"gpu": 16}  # sources whose rays fly together; elsewhere one


@dataclass(frozen=True)
class BakeOptions:
    """How late sound is baked.

    Attributes:
        size: Wanted edge of a cell [m].
        rays: Per cell and octave; None: 1,600; in houses of more than 31 cells 800, of more than 62 cells 400. So
            baking takes about as long for all, and small ones, where few cells tell how a room decays, are exact, too.
        bounces: Of rays that tell how rooms decay in the end; what is later begins anew.
        seed: Of all random numbers of rays.

    Raises:
        ConfigError: A number cannot be used.
    """

    size: float = 1.0
    rays: int | None = None
    bounces: int = 250
    seed: int = 0

    def __post_init__(self) -> None:
        check_number("size", self.size, 0.25)
        for name in ("rays", "bounces"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name), 10, whole=True)
        check_number("seed", self.seed, 0, whole=True)

    def rays_for(self, cells: int) -> int:
        """Per cell and octave, in a house of so many cells.

        Example:
            >>> tuple(BakeOptions().rays_for(cells) for cells in (30, 60, 139))
            (1600, 800, 400)
        """
        if self.rays is not None:
            return self.rays
        return next((rays for rays in MOST_RAYS if rays * cells <= RAYS_IN_ALL), MOST_RAYS[-1])


def bake_house(
    house: CompiledHouse, options: BakeOptions | None = None, bank: HouseBank | None = None, index: int = 0
) -> LateField:
    """Traces rays from every cell of a house, all doors wide open, and keeps what the others hear.

    Args:
        house: With its objects as they were compiled.
        options: How.
        bank: That holds the house; None: one is made. Houses of one bank share a compiled program.
        index: Of the house in the bank.

    Raises:
        ConfigError: The house has no room.

    Example:
        >>> field = bake_house(house)  # doctest: +SKIP
        >>> field.nbytes, field.level.shape  # doctest: +SKIP
        (480_512, (73, 73, 5, 7))
    """
    options = options or BakeOptions()
    scene, cells = open_scene(bank or HouseBank.from_compiled([house]), index), divide(house, options.size)
    rays = options.rays_for(len(cells.room))
    rng = np.random.default_rng(PLACES)
    cells = replace(cells, center=clear_points(scene, cells, rng))
    seen = in_view(scene, cells.center, cells.center)
    distance = ways(cells.center, seen)
    config = AudioConfig(num_bounces=options.bounces, response_seconds=BINS * AudioConfig.bin_seconds)
    tally = Tally(cells.room, distance, len(BANDS), BINS, config.bin_seconds * config.speed_of_sound)
    starts, free = start_points(scene, cells, rays, rng)
    baker = _Baker(scene, _grid(cells, free, _joined(house)), config, tally, rays, options)
    total = baker.run(starts, cells.room)
    level, shape = tally.finish(seen)
    heard = {
        "arrival": np.minimum(tally.arrival, 255).astype(np.uint8),
        "level": level,
        "comes_from": total["comes_from"],
        "room": cells.room.astype(np.int32),
        "shape": at_knots(shape),
    }
    return small(heard | places(house, scene, cells, options.size) | _rooms(house, total))


def open_scene(bank: HouseBank, index: int) -> Scene:
    """A house of a bank without agents, all doors wide open."""
    house, physics = jnp.int32(index), bank.physics
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(
        bank, house, physics.body_pos[house], physics.body_quat[house], *nobody, door_angle=physics.door_wide[house]
    )


def _joined(house: CompiledHouse) -> Bool[np.ndarray, "r r"]:
    """Which rooms have a portal in common; all, if none is known."""
    count, pair = len(house.rooms.type), house.navigation.portals.room
    pair = pair[(pair >= 0).all(axis=1)]
    joined = np.full((count, count), not len(pair))
    joined[tuple(pair.T)] = joined[tuple(pair.T[::-1])] = True
    return joined


def _grid(cells: Cells, free: Float[np.ndarray, " n"], joined: Bool[np.ndarray, "r r"]) -> Grid:
    """On the device, padded so that houses of similar size share a program."""
    more = -len(joined) % 8
    count, (_, rows, columns) = len(cells.room), cells.lookup.shape
    beyond = -count % 32
    lookup = np.pad(cells.lookup, ((0, 0), (0, -rows % 32), (0, -columns % 32)), constant_values=-1)

    def padded(values: np.ndarray, fill: float, kind: type = np.float32) -> Array:
        return jnp.asarray(np.pad(values, (0, beyond), constant_values=fill).astype(kind))

    return Grid(
        lookup=jnp.asarray(lookup, jnp.int32),
        origin=jnp.asarray(cells.origin, jnp.float32),
        low=padded(cells.low, np.inf),
        high=padded(cells.high, -np.inf),
        volume=padded(cells.volume * free, 1.0),
        room=padded(cells.room, 0, np.int32),
        joined=jnp.asarray(np.pad(joined, ((0, more), (0, more)))),
        rooms=len(joined) + more,
        step=float(cells.step),
    )


@partial(jax.jit, static_argnames=("config", "bins"))
def _fly(
    scene: Scene,
    grid: Grid,
    origin: Float[Array, "s n 3"],
    direction: Float[Array, "s n 3"],
    travelled: Float[Array, "s n"],
    room: Int[Array, " s"],
    fresh: Bool[Array, ""],
    bounces: Int[Array, ""],
    age: Float[Array, ""],
    key: Array,
    config: AudioConfig,
    bins: int,
) -> Flown:
    """Several flights at once."""
    return jax.vmap(lambda p, d, t, r, k: fly(scene, grid, p, d, t, r, fresh, bounces, age, k, config, bins))(
        origin, direction, travelled, room, key
    )


class _Heard(NamedTuple):
    """What some sources gave; gates are sources too."""

    energy: Float[np.ndarray, "s bands c k"]
    way: Float[np.ndarray, "s c k 3"]
    went: Float[np.ndarray, "s bands r r k"]
    sums: dict[str, np.ndarray]  # each (s, bands, ...)


@dataclass
class _Baker:
    scene: Scene
    grid: Grid
    config: AudioConfig
    tally: Tally
    rays: int  # of each flight, per octave
    options: BakeOptions

    def __post_init__(self) -> None:
        self.rng = np.random.default_rng(self.options.seed)

    def run(self, points: Float[np.ndarray, "c r 3"], room: Int[np.ndarray, " c"]) -> dict[str, np.ndarray]:
        """Fills the tally; directions from cell to cell, and sums over all rays."""
        pool = Pool()
        cells = self.flights([[self._source(p, int(r))] for p, r in zip(points, room, strict=True)], True, YOUNG, pool)
        gates = gates_of(cells.went.sum(axis=(0, 1, 4)))
        oldest, old, entering = gates.kinds()
        sizes = [(flights, self.rays) for flights in FLIGHTS]
        met, aged = Pool(), Pool()
        starts = pool.starts(gates.rooms[entering], gates.number, entering.start, sizes[2], self.rng)
        between = self.flights(starts, False, YOUNG, met)
        pool.rays += met.rays
        starts = pool.starts(gates.rooms[old], gates.number, old.start, sizes[1], self.rng)
        middle = self.flights(starts, False, OLD, aged)
        starts = aged.starts(gates.rooms[oldest], gates.older, oldest.start, sizes[0], self.rng)
        last = self.flights(starts, False, np.inf)
        rooms, first, second = gates_after(gates, between.went.sum(axis=(1, 4)))
        starts = met.starts(rooms, first, len(gates.rooms), sizes[3], self.rng)
        after = self.flights(starts, False, YOUNG)
        count = len(gates.rooms) + len(rooms)
        given = through(cells.went, gates.number, count)
        every = (last, gates.older), (middle, gates.older), (between, first), (after, second)
        passed = np.concatenate([through(x.went, number, count) for x, number in every])
        return self._join(cells, reduce(_both, (x for x, _ in every)), given, passed)

    def _source(self, points: Float[np.ndarray, "r 3"], room: int) -> Start:
        count = len(points) * len(BANDS)
        way = self.rng.normal(size=(count, 3))
        way /= np.linalg.norm(way, axis=1, keepdims=True)
        return Start(np.tile(points, (len(BANDS), 1)), way, np.zeros(count), room)

    def flights(self, starts: list[list[Start]], fresh: bool, age: float, pool: Pool | None = None) -> _Heard:
        """Means over the flights of each source."""
        bounces = min(int(age * PER_METRE), self.options.bounces) if np.isfinite(age) else self.options.bounces
        source = np.repeat(np.arange(len(starts)), [len(some) for some in starts])
        every = [one for some in starts for one in some]
        at_once = AT_ONCE.get(jax.default_backend(), 1)
        keys = jax.random.split(jax.random.key(int(self.rng.integers(2**31))), max(len(every), 1))
        cells, rooms, bins = len(self.tally.room), self.grid.rooms, self.tally.bins
        share = 1 / np.maximum(np.bincount(source, minlength=len(starts)), 1)
        energy = np.zeros((len(starts), len(BANDS), cells, bins), np.float32)
        way = np.zeros((len(starts), cells, bins, 3), np.float32)
        went = np.zeros((len(starts), len(BANDS), rooms, rooms, bins), np.float32)
        sums = {n: np.zeros((len(starts), len(BANDS), *(1 + (n in PAIRS)) * [rooms])) for n in SUMS}
        for first in range(0, len(every), at_once):
            rows = np.minimum(np.arange(first, first + at_once), len(every) - 1)
            *rays, room = (np.stack(x) for x in zip(*(every[row] for row in rows), strict=True))
            rays = *(jnp.asarray(x, jnp.float32) for x in rays), jnp.asarray(room, jnp.int32)
            how = jnp.asarray(fresh), jnp.int32(bounces), jnp.float32(age)
            found = jax.device_get(_fly(self.scene, self.grid, *rays, *how, keys[rows], self.config, bins))
            for index, row in enumerate(rows[: len(every) - first]):
                one, of = jax.tree.map(lambda x, i=index: x[i], found), source[row]
                energy[of] += share[of] * one.energy[:, :cells]
                way[of] += share[of] * one.way[:cells]
                went[of] += share[of] * one.went
                for name in SUMS:
                    sums[name][of] += share[of] * getattr(one, name)
                if pool:
                    pool.add(one, int(of))
        return _Heard(energy, way, went, sums)

    def _join(
        self,
        cells: _Heard,
        gates: _Heard,
        given: Float[np.ndarray, "c bands g k"],
        passed: Float[np.ndarray, "g bands g k"],
    ) -> dict[str, np.ndarray]:
        """Adds up what is heard before and after gates."""
        count = len(cells.energy)
        for band in range(len(BANDS)):
            cells.energy[:, band] += add_up(given[:, band], passed[:, band], gates.energy[:, band])
        mean = given.mean(axis=1)[..., :EARLY], passed.mean(axis=1)[..., :EARLY]
        for axis in range(3):
            cells.way[:, :, :EARLY, axis] += add_up(*mean, gates.way[:, :, :EARLY, axis])
        comes_from = np.zeros((count, count, len(SPANS), 3), np.int8)
        flown = float(self.tally.bins * self.tally.metres)
        for source in range(count):
            self.tally.add(source, np.maximum(cells.energy[source], 0).astype(float), flown)
            whole = np.maximum(self.tally.pair[source].sum(axis=2), 1e-30)
            way = self.tally.spans(source, np.moveaxis(cells.way[source], 2, 0).astype(float))
            comes_from[source] = np.round(np.clip(-127 * np.moveaxis(way, 1, 2) / whole[..., None], -127, 127))
        total = np.stack(
            [flux(given[:, b].sum(axis=2), passed[:, b].sum(axis=2)).sum(axis=0) for b in range(len(BANDS))]
        )
        sums = {
            n: cells.sums[n].sum(axis=0) + np.einsum("bg,gb...->b...", total, gates.sums[n], optimize=True)
            for n in SUMS
        }
        return sums | {"comes_from": comes_from}


def _both(first: _Heard, second: _Heard) -> _Heard:
    """Those of two, one after the other."""
    energy, way, went = (np.concatenate(pair) for pair in zip(first[:3], second[:3], strict=True))
    return _Heard(energy, way, went, {n: np.concatenate([first.sums[n], second.sums[n]]) for n in SUMS})


def _rooms(house: CompiledHouse, total: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """The energy balance of the house's rooms, and its portals."""
    count, navigation = len(house.rooms.type), house.navigation
    portals = navigation.portals
    inner = (portals.room >= 0).all(axis=1)
    pair = np.sort(portals.room[inner], axis=1)
    leaf, width = portals.leaf[inner], np.maximum(portals.width[inner], NARROW)
    area = np.bincount(navigation.room[navigation.room >= 0], minlength=count) * navigation.cell**2
    volume = np.maximum(area * (house.rooms.ceiling - house.rooms.floor), 1.0)
    sums = {n: total[n][:, :count] for n in ("lived", "lost")}
    pairs = {n: total[n][:, :count, :count] for n in ("moved", "through")}
    flow = flow_of(volume, **sums, **pairs, joined=pair)
    same = (pair[:, None] == pair[None]).all(axis=2)
    leak = np.zeros((len(pair), len(BANDS)))
    known = leaf[:, 0] >= 0
    if known.any():
        rows = house.instances.material[house.doors.instance[leaf[known, 0]]]
        leak[known] = house.materials.transmission[rows]
    return {
        "volume": volume,
        **flow._asdict(),
        "portal_room": pair.astype(np.int32),
        "portal_share": width / np.maximum(same @ width, 1e-6),
        "portal_leaf": leaf.astype(np.int32),
        "portal_leak": leak,
    }
