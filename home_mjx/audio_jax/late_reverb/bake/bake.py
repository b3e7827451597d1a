"""Baking of the late field of a compiled house."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.late_reverb.bake.accumulate import fill_accumulator
from home_mjx.audio_jax.late_reverb.bake.cell_points import (
    build_lattice,
    choose_points,
    compute_visibility,
    sample_free_points,
    shortest_paths,
)
from home_mjx.audio_jax.late_reverb.bake.decay_fit import Accumulator
from home_mjx.audio_jax.late_reverb.bake.gpu_sums import fill_accumulator as sum_on_gpu
from home_mjx.audio_jax.late_reverb.bake.late_field import LateField, pack_field
from home_mjx.audio_jax.late_reverb.bake.options import BakeOptions, Device
from home_mjx.audio_jax.late_reverb.bake.room_exchange import estimate_exchange
from home_mjx.audio_jax.late_reverb.bake.stages import trace_stages
from home_mjx.audio_jax.late_reverb.cuda.device import DeviceHouse
from home_mjx.audio_jax.late_reverb.cuda.flights import DeviceTracer
from home_mjx.audio_jax.late_reverb.cuda.kernels import traces_on_gpu
from home_mjx.audio_jax.late_reverb.lookup.time_grid import NUM_BINS, fit_knots
from home_mjx.audio_jax.late_reverb.trace.cells import divide_rooms
from home_mjx.audio_jax.late_reverb.trace.house_rays import HouseRays, SightLines
from home_mjx.audio_jax.late_reverb.trace.tracer import FlightTracer, make_grid
from home_mjx.audio_jax.propagation.paths import air_attenuation
from home_mjx.bank.bank import HouseBank
from home_mjx.schema.compiled import BANDS, CompiledHouse

POINT_SEED = 0  # seed of the points in cells; the same in every bake of a house
MIN_PORTAL_WIDTH = 0.3  # [m], minimum width of portals; it replaces the width 0 of those that agents cannot cross


def bake_house(
    house: CompiledHouse,
    options: BakeOptions | None = None,
    bank: HouseBank | None = None,
    index: int = 0,
    device: Device = "auto",
) -> LateField:
    """Trace rays from every cell of a house with all doors wide open, and keep the energy between cells.

    Args:
        house: House with its objects as compiled.
        options: Options; None: defaults.
        bank: Bank that holds the house; None: a new one. Houses of one bank share a compiled program.
        index: Index of the house in the bank.
        device: Device that traces the rays, see `LateReverbBake`.

    Raises:
        BackendError: `device` is "gpu" and there is none that works, or a GPU fails.
        ConfigError: The house has no room. Without `bank`, errors of `HouseBank.from_compiled` come through as well.

    Example:
        >>> field = bake_house(house)  # doctest: +SKIP
        >>> field.nbytes, field.level.shape  # doctest: +SKIP
        (480_512, (73, 73, 5, 7))
    """
    options = options or BakeOptions()
    cells = divide_rooms(house, options.edge)
    bank = bank or HouseBank.from_compiled([house])
    house_rays = HouseRays.from_bank(bank, index)
    gpu_house = DeviceHouse.from_rays(house_rays, bank, index) if traces_on_gpu(device) else None
    sight: SightLines = gpu_house or house_rays
    count, sizes = options.ray_counts(len(cells.room), len(house.rooms.type))
    rng = np.random.default_rng(POINT_SEED)
    cells = replace(cells, center=choose_points(sight, cells, rng))
    seen = compute_visibility(sight, cells.center, cells.center)
    config = AudioConfig()
    bin_length = config.bin_seconds * config.speed_of_sound
    tally = Accumulator(cells.room, shortest_paths(cells.center, seen), len(BANDS), NUM_BINS, bin_length)
    points, free = sample_free_points(sight, cells, count, rng)
    grid, volume = make_grid(cells, _portal_adjacency(house)), cells.volume * free
    given = house_rays, grid, air_attenuation(config), bin_length, volume, options.max_bounces
    tracer = DeviceTracer(*given, gpu_house) if gpu_house else FlightTracer(*given)
    rays = trace_stages(tracer, points, cells.room, sizes, options.seed)
    total = sum_on_gpu(tally, rays, gpu_house.stream) if gpu_house else fill_accumulator(tally, rays)
    level, shape = tally.finish(seen)
    fields = {
        "arrival": np.minimum(tally.arrival, 255).astype(np.uint8),
        "level": level,
        "comes_from": total["comes_from"],
        "room": cells.room.astype(np.int32),
        "shape": fit_knots(shape),
    }
    return pack_field(fields | build_lattice(house, sight, cells, options.edge) | _room_fields(house, total))


def _portal_adjacency(house: CompiledHouse) -> Bool[np.ndarray, "r r"]:
    """Return a mask of room pairs that share a portal; all pairs if no portal between rooms is known."""
    count, pair = len(house.rooms.type), house.navigation.portals.room
    pair = pair[(pair >= 0).all(axis=1)]
    joined = np.full((count, count), not len(pair))
    joined[tuple(pair.T)] = joined[tuple(pair.T[::-1])] = True
    return joined


def _room_fields(house: CompiledHouse, total: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Return the `LateField` arrays of rooms (energy balance) and of portals by name."""
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
