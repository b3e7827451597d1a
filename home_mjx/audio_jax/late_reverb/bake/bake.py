"""Baking of the late field of a compiled house."""

from dataclasses import dataclass, replace

import jax.numpy as jnp
import numpy as np
from jaxtyping import Bool

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake.baker import Baker
from home_mjx.audio_jax.late_reverb.bake.fit import Tally
from home_mjx.audio_jax.late_reverb.bake.flow import flow_of
from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, small
from home_mjx.audio_jax.late_reverb.bake.places import clear_points, in_view, places, start_points, ways
from home_mjx.audio_jax.late_reverb.lookup.spans import BINS, at_knots
from home_mjx.audio_jax.late_reverb.trace.cells import divide
from home_mjx.audio_jax.late_reverb.trace.grid import grid_of
from home_mjx.audio_jax.late_reverb.trace.stage import Flights
from home_mjx.bank.bank import HouseBank
from home_mjx.core.checks import check_number
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.schema.compiled import BANDS, CompiledHouse

PLACES = 0  # seed of the points in cells; the same in every bake of a house
NARROW = 0.3  # [m], minimum width of portals; it replaces the width 0 of those that agents cannot cross
MOST_RAYS = (1600, 800, 400)  # rays per cell and octave; few values, because each compiles its own program
RAYS_IN_ALL = 50_000  # maximum rays from all cells, per octave


@dataclass(frozen=True)
class BakeOptions:
    """Options of baking late reverberation.

    Attributes:
        size: Target edge length of a cell [m].
        rays: Rays per cell and octave. None: 1,600; 800 in houses of more than 31 cells, 400 of more than 62 cells.
            Baking then takes about as long for all houses. Small ones, where few cells sample a room's decay, are
            accurate too.
        bounces: Maximum reflections of the rays that determine the final decay of rooms.
        seed: Seed of all random numbers of rays.

    Raises:
        ConfigError: An option is out of range.
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
        """Return the rays per cell and octave for a house of `cells` cells.

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
    scene, cells = open_scene(bank or HouseBank.from_compiled([house]), index), divide(house, options.size)
    rays = options.rays_for(len(cells.room))
    rng = np.random.default_rng(PLACES)
    cells = replace(cells, center=clear_points(scene, cells, rng))
    seen = in_view(scene, cells.center, cells.center)
    distance = ways(cells.center, seen)
    config = AudioConfig(num_bounces=options.bounces, response_seconds=BINS * AudioConfig.bin_seconds)
    tally = Tally(cells.room, distance, len(BANDS), BINS, config.bin_seconds * config.speed_of_sound)
    starts, free = start_points(scene, cells, rays, rng)
    around = places(house, scene, cells, options.size)
    flights = Flights(scene, grid_of(cells, free, _joined(house)), config, BINS, rays * len(BANDS), options.bounces)
    total = Baker(flights, tally, options.seed).run(starts, cells.room)
    level, shape = tally.finish(seen)
    heard = {
        "arrival": np.minimum(tally.arrival, 255).astype(np.uint8),
        "level": level,
        "comes_from": total["comes_from"],
        "room": cells.room.astype(np.int32),
        "shape": at_knots(shape),
    }
    return small(heard | around() | _rooms(house, total))


def open_scene(bank: HouseBank, index: int) -> Scene:
    """Make the scene of a house of a bank, without agents and with all doors wide open."""
    house, physics = jnp.int32(index), bank.physics
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    return make_scene(
        bank, house, physics.body_pos[house], physics.body_quat[house], *nobody, door_angle=physics.door_wide[house]
    )


def _joined(house: CompiledHouse) -> Bool[np.ndarray, "r r"]:
    """Return a mask of room pairs that share a portal; all pairs if no portal is known."""
    count, pair = len(house.rooms.type), house.navigation.portals.room
    pair = pair[(pair >= 0).all(axis=1)]
    joined = np.full((count, count), not len(pair))
    joined[tuple(pair.T)] = joined[tuple(pair.T[::-1])] = True
    return joined


def _rooms(house: CompiledHouse, total: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Compute the energy balance of the house's rooms, and the fields of its portals."""
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
