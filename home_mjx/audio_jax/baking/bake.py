"""From a compiled house to its late field."""

from dataclasses import replace
from functools import partial

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float
from scipy.sparse.csgraph import dijkstra

from home_mjx.audio_jax.baking.cells import Cells, divide
from home_mjx.audio_jax.baking.fit import SILENT, Tally, neighbours
from home_mjx.audio_jax.baking.flight import Grid, fly
from home_mjx.audio_jax.baking.late_field import NEAR, LateField
from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import occluded
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, CompiledHouse, Ray

REACH = 1.7  # [sizes of a cell], within which a cell matters
PLACE = 0.2  # [m], between the places at which weights are kept
EARS = 1.4  # [m], above the floor, from which places see cells
CANDIDATES = 8  # points of a cell that are tried for one that is clear
SHORT = 0.02  # share of rays that may have ended before the traced time does


def bake_house(
    house: CompiledHouse, size: float = 1.0, rays: int = 500, config: AudioConfig | None = None, seed: int = 0
) -> LateField:
    """Traces rays from every cell of a house and keeps what the others hear.

    Args:
        house: With its objects and doors as they were compiled.
        size: Of a cell [m].
        rays: Per cell and octave.
        config: `num_bounces`, `bin_seconds`, `response_seconds` and the air; None: 100 bounces and 2 s.
        seed: Of all random numbers.

    Example:
        >>> field = bake_house(house)  # doctest: +SKIP
        >>> late_energy(field, radio, ears, 0.004 * 343.2).shape  # doctest: +SKIP
        (500, 7)
    """
    config = config or AudioConfig(num_bounces=100, response_seconds=2.0)
    scene, cells, rng = _scene(house), divide(house, size), np.random.default_rng(seed)
    cells = replace(cells, center=_clear(scene, cells, rng))
    seen = _in_view(scene, cells.center, cells.center)
    distance = _ways(cells.center, seen)
    metres, bins = config.bin_seconds * config.speed_of_sound, config.num_bins
    tally = Tally(cells.room, distance, len(BANDS), bins, metres)
    starts, free = _starts(scene, cells, rays, rng)
    sizes = cells.origin, cells.low, cells.high, cells.volume * free
    grid = Grid(jnp.asarray(cells.lookup, jnp.int32), *(jnp.asarray(x, jnp.float32) for x in sizes))
    run = jax.jit(partial(fly, step=cells.step, config=config, bins=bins))
    keys = jax.random.split(jax.random.key(seed), len(starts))
    for source, (start, key) in enumerate(zip(starts, keys, strict=True)):
        heard, flown = run(scene, grid, start=jnp.asarray(start, jnp.float32), key=key)
        tally.add(source, np.asarray(heard, float), float(np.quantile(flown, SHORT)))
    level, shape = tally.finish()
    return _field(house, scene, cells, distance, level, shape, size)


def _clear(scene: Scene, cells: Cells, rng: np.random.Generator) -> Float[np.ndarray, "n 3"]:
    """A point of each cell that stands in nothing: of some, the one that sees most others of its room."""
    tried = np.stack([_points(cells, cell, CANDIDATES, rng) for cell in range(len(cells.room))])
    tried[:, 0] = cells.center
    flat = tried.reshape(-1, 3)
    room = np.repeat(cells.room, CANDIDATES)
    score = (_in_view(scene, flat, flat) & (room[:, None] == room[None])).sum(axis=1)
    return tried[np.arange(len(tried)), np.argmax(score.reshape(tried.shape[:2]), axis=1)]


def _starts(
    scene: Scene, cells: Cells, count: int, rng: np.random.Generator
) -> tuple[Float[np.ndarray, "n r 3"], Float[np.ndarray, " n"]]:
    """Random points in the free part of each cell, and how large that part is: what the middle of the cell sees."""
    points, free = [], []
    tried = np.stack([_points(cells, cell, 2 * count, rng) for cell in range(len(cells.room))])
    for seen, some in zip(_own_view(scene, cells.center, tried), tried, strict=True):
        good = some[seen] if seen.any() else some
        points.append(good[np.arange(count) % len(good)])
        free.append(max(seen.mean(), 0.1))
    return np.stack(points), np.array(free)


def _own_view(
    scene: Scene, center: Float[np.ndarray, "n 3"], points: Float[np.ndarray, "n r 3"]
) -> Bool[np.ndarray, "n r"]:
    """Which points of each cell its middle sees."""

    @jax.jit
    def hidden(start: Array, end: Array) -> Array:
        return occluded(scene, start[:, None], end - start[:, None], t_max=1.0, mask=int(Ray.SOUND))

    return ~np.asarray(hidden(jnp.asarray(center, jnp.float32), jnp.asarray(points, jnp.float32)))


def _points(cells: Cells, cell: int, count: int, rng: np.random.Generator) -> Float[np.ndarray, "r 3"]:
    """Random points of a cell."""
    _, row, column = np.nonzero(cells.lookup == cell)
    pick = rng.integers(len(row), size=count)
    plan = cells.origin + (np.stack([column[pick], row[pick]], 1) + rng.random((count, 2))) * cells.step
    return np.concatenate([plan, cells.low[cell] + rng.random((count, 1)) * (cells.high - cells.low)[cell]], axis=1)


def _scene(house: CompiledHouse) -> Scene:
    bank = HouseBank.from_compiled([house])
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(bank, jnp.zeros((), jnp.int32), bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)


def _in_view(scene: Scene, start: Float[np.ndarray, "p 3"], end: Float[np.ndarray, "n 3"]) -> Bool[np.ndarray, "p n"]:
    """Which points see which."""

    @jax.jit
    def hidden(start: Array, end: Array) -> Array:
        way = end[None] - start[:, None]
        return occluded(scene, start[:, None], way, t_max=1.0, mask=int(Ray.SOUND))

    return ~np.asarray(hidden(jnp.asarray(start, jnp.float32), jnp.asarray(end, jnp.float32)))


def _ways(center: Float[np.ndarray, "n 3"], seen: Bool[np.ndarray, "n n"]) -> Float[np.ndarray, "n n"]:
    """Shortest ways from cell to cell, from one to another in view; where there is none, the straight line."""
    straight = np.linalg.norm(center[:, None] - center[None], axis=2)
    ways = dijkstra(np.where(seen | seen.T, straight, 0), directed=False)
    return np.where(np.isfinite(ways), ways, straight)


def _field(
    house: CompiledHouse,
    scene: Scene,
    cells: Cells,
    distance: Float[np.ndarray, "n n"],
    level: Float[np.ndarray, "n n s b"],
    shape: Float[np.ndarray, "r r b k"],
    size: float,
) -> LateField:
    stride = max(round(PLACE / cells.step), 1)
    levels, rows, columns = cells.lookup.shape
    down, across = np.arange(stride // 2, rows, stride), np.arange(stride // 2, columns, stride)
    x, y = cells.origin[0] + (across + 0.5) * cells.step, cells.origin[1] + (down + 0.5) * cells.step
    floor = house.navigation.floor[:levels]
    place = np.stack(np.broadcast_arrays(x[None, None], y[None, :, None], floor[:, None, None] + EARS), -1)
    flat = place.reshape(-1, 3)
    near, weight = neighbours(cells.center, flat, _in_view(scene, flat, cells.center), REACH * size, NEAR)
    half = partial(jnp.asarray, dtype=jnp.float16)
    return LateField(
        distance=half(distance),
        level=half(level),
        shape=half(np.log(np.maximum(shape, SILENT))),
        room=jnp.asarray(cells.room, jnp.int32),
        near=jnp.asarray(near.reshape(*place.shape[:3], -1), jnp.uint8),
        weight=half(weight.reshape(*place.shape[:3], -1)),
        floor=jnp.asarray(floor, jnp.float32),
        origin=jnp.asarray([x[0], y[0]], jnp.float32) - stride * cells.step / 2,
        step=jnp.float32(stride * cells.step),
    )
