"""From a compiled house to its late field."""

from dataclasses import dataclass, replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, Int

from home_mjx.audio_jax.baked.spans import BINS, at_knots
from home_mjx.audio_jax.baking.cells import Cells, divide
from home_mjx.audio_jax.baking.fit import Tally
from home_mjx.audio_jax.baking.flight import Flown, Grid, fly
from home_mjx.audio_jax.baking.flow import flow_of
from home_mjx.audio_jax.baking.late_field import LateField, small
from home_mjx.audio_jax.baking.places import clear_points, in_view, places, start_points, ways
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, CompiledHouse

SHORT = 0.02  # share of rays that may have ended before the traced time does
NARROW = 0.3  # [m]: portals that agents cannot cross count as so wide
AT_ONCE = {"gpu": 16}  # sources whose rays fly together; elsewhere one


@dataclass(frozen=True)
class BakeOptions:
    """How late sound is baked.

    Attributes:
        size: Wanted edge of a cell [m].
        rays: Per cell and octave.
        bounces: Of each ray; what is later goes on as it fell.
        seed: Of all random numbers.

    Raises:
        ConfigError: A number cannot be used.
    """

    size: float = 1.0
    rays: int = 300
    bounces: int = 100
    seed: int = 0

    def __post_init__(self) -> None:
        check_number("size", self.size, 0.25)
        for name in ("rays", "bounces"):
            check_number(name, getattr(self, name), 10, whole=True)
        check_number("seed", self.seed, 0, whole=True)


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
        (480_512, (73, 73, 4, 7))
    """
    options = options or BakeOptions()
    scene, cells = open_scene(bank or HouseBank.from_compiled([house]), index), divide(house, options.size)
    rng = np.random.default_rng(options.seed)
    cells = replace(cells, center=clear_points(scene, cells, rng))
    distance = ways(cells.center, in_view(scene, cells.center, cells.center))
    config = AudioConfig(num_bounces=options.bounces, response_seconds=BINS * AudioConfig.bin_seconds)
    tally = Tally(cells.room, distance, len(BANDS), BINS, config.bin_seconds * config.speed_of_sound)
    starts, free = start_points(scene, cells, options.rays, rng)
    total = _fly_all(scene, _grid(cells, free, len(house.rooms.type)), starts, cells.room, config, tally, options.seed)
    level, shape = tally.finish()
    heard = {
        "distance": distance,
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


def _grid(cells: Cells, free: Float[np.ndarray, " n"], rooms: int) -> Grid:
    """On the device, padded so that houses of similar size share a program."""
    count, (_, rows, columns) = len(cells.room), cells.lookup.shape
    beyond = -count % 16
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
        rooms=-(-rooms // 8) * 8,
        step=float(cells.step),
    )


@partial(jax.jit, static_argnames=("config", "bins"))
def _fly(
    scene: Scene,
    grid: Grid,
    start: Float[Array, "s r 3"],
    room: Int[Array, " s"],
    key: Array,
    config: AudioConfig,
    bins: int,
) -> Flown:
    """Several sources at once."""
    return jax.vmap(lambda p, r, k: fly(scene, grid, p, r, k, config, bins))(start, room, key)


def _fly_all(
    scene: Scene,
    grid: Grid,
    starts: Float[np.ndarray, "n r 3"],
    room: Int[np.ndarray, " n"],
    config: AudioConfig,
    tally: Tally,
    seed: int,
) -> dict[str, np.ndarray]:
    """Fills the tally; mean directions from cell to cell, and sums over all rays."""
    count, at_once = len(starts), AT_ONCE.get(jax.default_backend(), 1)
    keys = jax.random.split(jax.random.key(seed), count)
    comes_from = np.zeros((count, count, 3), np.int8)
    total: dict[str, np.ndarray] = {}
    for first in range(0, count, at_once):
        rows = np.minimum(np.arange(first, first + at_once), count - 1)
        points = jnp.asarray(starts[rows], jnp.float32)
        found = jax.device_get(
            _fly(scene, grid, points, jnp.asarray(room[rows], jnp.int32), keys[rows], config, tally.bins)
        )
        for row, source in enumerate(rows[: count - first]):
            heard = found.energy[row, :, :count].astype(float)
            tally.add(int(source), heard, float(np.quantile(found.distance[row], SHORT)))
            whole = np.maximum(heard.sum(axis=(0, 2)), 1e-30)[:, None]
            comes_from[source] = np.round(np.clip(-127 * found.way[row, :count] / whole, -127, 127))
            for name in ("lived", "lost", "moved", "through"):
                total[name] = total.get(name, 0.0) + getattr(found, name)[row].astype(float)
    return total | {"comes_from": comes_from}


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
