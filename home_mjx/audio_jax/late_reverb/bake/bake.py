"""Baking of the late field of a compiled house."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake.cell_points import (
    choose_points,
    compute_visibility,
    launch_lattice,
    sample_free_points,
    shortest_paths,
)
from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, pack_field
from home_mjx.audio_jax.late_reverb.bake.room_exchange import estimate_exchange
from home_mjx.audio_jax.late_reverb.bake.stages import Baker
from home_mjx.audio_jax.late_reverb.lookup.time_grid import NUM_BINS, fit_knots
from home_mjx.audio_jax.late_reverb.trace.batches import FlightTracer
from home_mjx.audio_jax.late_reverb.trace.cell_grid import make_grid
from home_mjx.audio_jax.late_reverb.trace.cells import divide_rooms
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.raycast_render.scene.scene import make_open_scene
from home_mjx.schema.compiled import BANDS, CompiledHouse

POINT_SEED = 0  # seed of the points in cells; the same in every bake of a house
MIN_PORTAL_WIDTH = 0.3  # [m], minimum width of portals; it replaces the width 0 of those that agents cannot cross
RAYS_PER_CELL = (1600, 800, 400)  # rays per cell and octave; few values, because each compiles its own program
MAX_RAYS_PER_OCTAVE = 50_000  # maximum rays from all cells, per octave


@dataclass(frozen=True)
class BakeOptions:
    """Options of baking late reverberation.

    Attributes:
        cell_size: Target edge length of a cell [m].
        rays: Rays per cell and octave. None: 1,600; 800 in houses of more than 31 cells, 400 of more than 62 cells.
            Baking then takes about as long for all houses. Small ones, where few cells sample a room's decay, are
            accurate too.
        max_bounces: Maximum reflections of the rays that determine the final decay of rooms.
        seed: Seed of all random numbers of rays.

    Raises:
        ConfigError: An option is out of range.
    """

    cell_size: float = 1.0
    rays: int | None = None
    max_bounces: int = 250
    seed: int = 0

    def __post_init__(self) -> None:
        check_number("cell_size", self.cell_size, 0.25)
        for name in ("rays", "max_bounces"):
            if getattr(self, name) is not None:
                check_number(name, getattr(self, name), 10, integer=True)
        check_number("seed", self.seed, 0, integer=True)

    def num_rays(self, cells: int) -> int:
        """Return the rays per cell and octave for a house of `cells` cells.

        Example:
            >>> tuple(BakeOptions().num_rays(cells) for cells in (30, 60, 139))
            (1600, 800, 400)
        """
        if self.rays is not None:
            return self.rays
        return next((rays for rays in RAYS_PER_CELL if rays * cells <= MAX_RAYS_PER_OCTAVE), RAYS_PER_CELL[-1])


def bake_house(
    house: CompiledHouse, options: BakeOptions | None = None, bank: HouseBank | None = None, index: int = 0
) -> LateField:
    """Trace rays from every cell of a house with all doors wide open, and keep the energy between cells.

    Args:
        house: House with its objects as compiled.
        options: Options; None: defaults.
        bank: Bank that holds the house; None: a new one. Houses of one bank share a compiled program.
        index: Index of the house in the bank.

    Raises:
        ConfigError: The house has no room.

    Example:
        >>> field = bake_house(house)  # doctest: +SKIP
        >>> field.nbytes, field.level.shape  # doctest: +SKIP
        (480_512, (73, 73, 5, 7))
    """
    options = options or BakeOptions()
    scene, cells = (
        make_open_scene(bank or HouseBank.from_compiled([house]), index),
        divide_rooms(house, options.cell_size),
    )
    rays = options.num_rays(len(cells.room))
    rng = np.random.default_rng(POINT_SEED)
    cells = replace(cells, center=choose_points(scene, cells, rng))
    seen = compute_visibility(scene, cells.center, cells.center)
    distance = shortest_paths(cells.center, seen)
    config = AudioConfig(response_seconds=NUM_BINS * AudioConfig.bin_seconds)
    tally = Accumulator(cells.room, distance, len(BANDS), NUM_BINS, config.bin_seconds * config.speed_of_sound)
    starts, free = sample_free_points(scene, cells, rays, rng)
    around = launch_lattice(house, scene, cells, options.cell_size)
    flights = FlightTracer(
        scene,
        make_grid(cells, free, _portal_adjacency(house)),
        config,
        NUM_BINS,
        rays * len(BANDS),
        options.max_bounces,
    )
    total = Baker(flights, tally, options.seed).run(starts, cells.room)
    level, shape = tally.finish(seen)
    heard = {
        "arrival": np.minimum(tally.arrival, 255).astype(np.uint8),
        "level": level,
        "comes_from": total["comes_from"],
        "room": cells.room.astype(np.int32),
        "shape": fit_knots(shape),
    }
    return pack_field(heard | around() | _room_fields(house, total))


def _portal_adjacency(house: CompiledHouse) -> Bool[np.ndarray, "r r"]:
    """Return a mask of room pairs that share a portal; all pairs if no portal is known."""
    count, pair = len(house.rooms.type), house.navigation.portals.room
    pair = pair[(pair >= 0).all(axis=1)]
    joined = np.full((count, count), not len(pair))
    joined[tuple(pair.T)] = joined[tuple(pair.T[::-1])] = True
    return joined


def _room_fields(house: CompiledHouse, total: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Compute the energy balance of the house's rooms, and the fields of its portals."""
    count, navigation = len(house.rooms.type), house.navigation
    portals = navigation.portals
    inner = (portals.room >= 0).all(axis=1)
    pair = np.sort(portals.room[inner], axis=1)
    leaf, width = portals.leaf[inner], np.maximum(portals.width[inner], MIN_PORTAL_WIDTH)
    area = np.bincount(navigation.room[navigation.room >= 0], minlength=count) * navigation.cell**2
    volume = np.maximum(area * (house.rooms.ceiling - house.rooms.floor), 1.0)
    sums = {n: total[n][:, :count] for n in ("path_length", "absorbed")}
    pairs = {n: total[n][:, :count, :count] for n in ("exchanged", "transmitted")}
    flow = estimate_exchange(volume, **sums, **pairs, joined=pair)
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
