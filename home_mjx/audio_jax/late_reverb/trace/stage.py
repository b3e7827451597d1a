"""Flights from several sources, as many together as suits the device, and what those of each gave on average."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial, reduce
from typing import Any, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int, UInt32

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.trace.flight import FLIGHTS, Gave, Gone, fly
from home_mjx.audio_jax.late_reverb.trace.grid import Grid
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS

RAYS_AT_ONCE = {"gpu": 1 << 18}  # that fly together, about as many as there are threads; elsewhere those of one flight
MOST_AT_ONCE = 96  # flights, each of which has 3 to 9 MB of what is heard
SOURCES = 16  # a multiple of so many have their means taken together: few programs do for all
KEYS = 256
PER_METRE = 1.0  # most reflections: flights end by age, for rays that are reflected seldom are those that last


class Start(NamedTuple):
    """Rays of one flight, octave after octave, equally many of each."""

    origin: Float[np.ndarray, "n 3"]
    direction: Float[np.ndarray, "n 3"]
    travelled: Float[np.ndarray, " n"]  # since the bin began in which it went through a gate [m]
    room: int
    age: float  # at which they are old [m]


class Heard(NamedTuple):
    """What some sources gave, on average over the flights of each; gates are sources too."""

    count: int  # of sources
    parts: tuple[tuple[Int[np.ndarray, " s"], Gave], ...]  # sources and, with others behind them, what they gave

    def whole(self, read: Callable[[Gave], Array | np.ndarray]) -> Float[np.ndarray, "count ..."]:
        """One of the arrays of what was given, or a part of it, of all sources: 0 of one from which nothing flew."""
        found = [(rows, np.asarray(read(gave))) for rows, gave in self.parts]
        out = np.zeros((self.count, *found[0][1].shape[1:]), np.float32)
        for rows, some in found:
            out[rows] = some[: len(rows)]
        return out

    def on_device(self, read: Callable[[Gave], Array]) -> Array:
        """The same as `whole` where each source has flown, on the device."""
        return jnp.concatenate([read(gave)[: len(rows)] for rows, gave in self.parts])


def together(count: int, some: Sequence[tuple[Int[np.ndarray, " _"], Heard]]) -> Heard:
    """So many sources: those of several, each with its new number."""
    return Heard(count, tuple((number[rows], gave) for number, heard in some for rows, gave in heard.parts))


@dataclass(frozen=True)
class Flights:
    """Of one house.

    Attributes:
        scene: The house.
        grid: Its cells.
        config: `bin_seconds` and the air.
        bins: Number of time bins.
        rays: Of each flight, of all octaves.
        bounces: How often rays are reflected at most.
    """

    scene: Scene
    grid: Grid
    config: AudioConfig
    bins: int
    rays: int
    bounces: int

    @property
    def at_once(self) -> int:
        """How many fly together."""
        return int(np.clip(RAYS_AT_ONCE.get(jax.default_backend(), 0) // self.rays, 1, MOST_AT_ONCE))

    def fly(
        self,
        starts: Sequence[Sequence[Start]],
        fresh: bool,
        seed: int,
        ends: bool = True,
        heard: int | None = None,
        keep: Callable[[Gone, Int[np.ndarray, " f"]], None] | None = None,
    ) -> Heard:
        """Flights of some sources; what they gave stays on the device, on its way to the host if it is needed there.

        Args:
            starts: The flights of each source.
            fresh: They come from sources, not from reflections.
            seed: Of all flights.
            ends: Rays end in other rooms; else they fly on there.
            heard: Bins that are kept; None: all.
            keep: Gets the rays that went through gates, those of flights (f, 2, n) that left a room and that grew old
                there, on the host, and the source of each flight.
        """
        source = np.repeat(np.arange(len(starts)), [len(some) for some in starts])
        every, keys = [one for some in starts for one in some], _keys(seed, len(source))
        how = np.bool_(fresh), np.bool_(ends)
        parts, ended = [(source[:0], _nothing(self.grid, heard or self.bins))], []
        for rows in self._blocks(source):
            gave = ()
            for some in _chunks(np.flatnonzero(np.isin(source, rows)), self.at_once):
                here = some[np.minimum(np.arange(self.at_once), len(some) - 1)]  # as many each time: one program
                rays = _stacked([every[flight] for flight in here])
                bounces = np.minimum(PER_METRE * rays[-1], self.bounces).astype(np.int32)
                found, gone = _fly(self.scene, self.grid, *rays, bounces, *how, keys[here], self.config, self.bins)
                ended.append((gone, source[some]))
                if keep:
                    _fetch(gone)
                gave = (_added(gave, found, *_shares(rows, source, some, self.at_once)),)
                jax.block_until_ready(ended[-2:-1])  # one may wait while another flies: each has its memory
            gave = tuple(_first_bins(one, heard) if heard else one for one in gave)
            # What cells hear of each other is most of it, and is needed on the device.
            _fetch(*(one._replace(energy=(), way=()) if fresh else one for one in gave))
            parts.append((rows, *gave))
        if keep:
            for gone, of in ended:
                keep(jax.tree.map(lambda x, of=of: x[: len(of)], jax.device_get(gone)), of)
        return Heard(len(starts), tuple(parts))

    def _blocks(self, source: Int[np.ndarray, " f"]) -> list[Int[np.ndarray, " s"]]:
        """Sources of so many flights as fly together, but at least one."""
        rows, flights = np.unique(source, return_counts=True)
        return _chunks(rows, max(self.at_once // max(flights.tolist(), default=1), 1))


def _fetch(*arrays: Any) -> None:
    """Begins to, the last ones first: none waits for what is heard, which is most and needed last."""
    for array in reversed(jax.tree.leaves(arrays)):
        array.copy_to_host_async()


@partial(jax.jit, static_argnums=1)
def _first_bins(gave: Gave, bins: int) -> Gave:
    return gave._replace(energy=gave.energy[..., :bins], way=gave.way[:, :, :bins], went=gave.went[..., :bins])


def _chunks(values: Int[np.ndarray, " n"], size: int) -> list[Int[np.ndarray, " _"]]:
    return [values[first : first + size] for first in range(0, len(values), size)]


def _keys(seed: int, count: int) -> np.ndarray:
    """Data of so many keys; more are made, so that hardly any number of them is compiled for."""
    return np.asarray(jax.random.key_data(jax.random.split(jax.random.key(seed), KEYS * (count // KEYS + 1))))


def _stacked(flights: Sequence[Start]) -> tuple[np.ndarray, ...]:
    *rays, room, age = (np.stack(x) for x in zip(*flights, strict=True))
    return *(x.astype(np.float32) for x in rays), room.astype(np.int32), age.astype(np.float32)


def _shares(
    rows: Int[np.ndarray, " s"], source: Int[np.ndarray, " f"], some: Int[np.ndarray, " n"], at_once: int
) -> tuple[Int[np.ndarray, "p m"], Float[np.ndarray, "p m"]]:
    """Of each of some sources, padded, the places of its flights among those that flew together, and their weights."""
    of, step = source[some], min(SOURCES, at_once)
    place, nth = np.searchsorted(rows, of), np.arange(len(of)) - np.searchsorted(of, of)
    shape = len(rows) + -len(rows) % step, nth.max() + 1
    flight, weight = np.zeros(shape, np.int32), np.zeros(shape, np.float32)
    flight[place, nth], weight[place, nth] = np.arange(len(of)), 1 / np.bincount(source)[of]
    return flight, weight


@partial(jax.jit, static_argnames=("config", "bins"))
def _fly(
    scene: Scene,
    grid: Grid,
    origin: Float[Array, "f n 3"],
    direction: Float[Array, "f n 3"],
    travelled: Float[Array, "f n"],
    room: Int[Array, " f"],
    age: Float[Array, " f"],
    bounces: Int[Array, " f"],
    fresh: Bool[Array, ""],
    ends: Bool[Array, ""],
    keys: UInt32[Array, "f 2"],
    config: AudioConfig,
    bins: int,
) -> tuple[Gave, Gone]:
    """What several flights gave at once, and the rays of each (f, 2, n) that ended in another room or old."""
    found = jax.vmap(
        lambda p, d, t, r, a, b, k: fly(scene, grid, p, d, t, r, fresh, ends, b, a, k, config, bins), axis_name=FLIGHTS
    )(origin, direction, travelled, room, age, bounces, jax.random.wrap_key_data(keys))
    return found.gave, jax.tree.map(lambda a, b: jnp.stack([a, b], axis=1), found.gone, found.aged)


@jax.jit
def _added(before: tuple[Gave, ...], gave: Gave, flight: Int[Array, "s m"], weight: Float[Array, "s m"]) -> Gave:
    """Adds to what sources gave their flights' shares, one after the other: the same sum every time."""

    def add(new: Array, *total: Array) -> Array:
        share = weight.T.reshape(*weight.T.shape, *(new.ndim - 1) * [1])
        return reduce(jnp.add, (*total, *(share[nth] * new[row] for nth, row in enumerate(flight.T))))

    return jax.tree.map(add, gave, *before)


def _nothing(grid: Grid, bins: int) -> Gave:
    """What no source gave."""
    bands, cells, rooms = len(BANDS), grid.volume.shape[0], grid.rooms
    pair = bands, rooms, rooms
    shapes = (bands, cells, bins), (cells, bins, 3), (*pair, bins), pair[:2], pair[:2], pair, pair
    return Gave(*(jax.device_put(np.zeros((0, *shape), np.float32)) for shape in shapes))
