"""Flights of rays through a house in Numba: all bounces of a source's rays, with the energy recorded in all cells.

Each ray carries the energies of all octaves. It is scattered or mirrored with one probability: the mean of its octaves'
scattering coefficients, weighted by their energies. Each energy is multiplied by the ratio of its own probability to
that one, so every octave is unbiased (importance sampling). After each reflection rays are resampled by the sum of
their shares of all octaves, which bounds the energies of each.

All memory is accessed through bare pointers, since Numba's reference counting of arrays costs several times the work
itself. The octaves of a ray fill the first lanes of a vector.
"""
# ruff: noqa: ANN001, ANN201, ANN202  (Numba infers the types)

from typing import Any, NamedTuple, no_type_check

import numpy as np
from numba import types

from home_mjx.audio_jax.late_reverb.trace.cells import CELL_FLOOR_GAP
from home_mjx.audio_jax.late_reverb.trace.house_rays import cast_rays
from home_mjx.core.native.inner import compile_inner
from home_mjx.core.native.memory import address_of, stack_of
from home_mjx.core.native.simd import LANES, broadcast, load, maximum, minimum, store, sum_lanes
from home_mjx.schema.compiled import ARCHITECTURE, BANDS

RAY_OFFSET = np.float32(1e-4)  # [m], offset of ray ends from surfaces
SAMPLES_PER_BIN = np.int64(2)  # times per bin at which rays are recorded
INWARD_OFFSET = np.float32(0.1)  # [m], offset from a surface to a point in the room in front of it
BEHIND_OFFSETS = tuple(np.float32(x) for x in (0.08, 0.15, 0.25, 0.4))  # [m], from a surface to the room behind it
ENTRY_BISECTIONS = 5  # bisections of a segment to find where it enters another room
FLOOR_THICKNESS_RATIO = np.float32(2)  # maximum thickness of floors re walls
MAX_ACTIVE_SHARE = np.float32(0.1)  # maximum active energy when a flight ends, re the energy that has aged
MIN_ENERGY_SHARE = np.float32(1e-6)  # the same re the initial energy; the larger limit applies
EVENNESS = 0.7  # 0: rays in proportion to a room's energy; 1: equal numbers of rays in all rooms
MAX_RAY_LENGTH = np.float32(1e4)  # [m], maximum length of a segment
BELOW_CELL = np.float32(CELL_FLOOR_GAP) + INWARD_OFFSET  # [m], from the bottom of a cell to just below its floor
NUM_OCTAVES = len(BANDS)
FIRST_DIRECTION = NUM_OCTAVES  # lane of the first component of the intensity in recorded energies
PLACE = 7  # numbers of an ended ray: origin, direction, distance since the start of the bin of the portal state [m]
TINY, ZERO, HALF, ONE, TWO = (np.float32(x) for x in (1e-30, 0, 0.5, 1, 2))
TURN = np.float32(2 * np.pi)
BELOW_ONE = np.nextafter(ONE, ZERO)

Pointer = Any  # a C pointer, which Numba indexes like an array
octave_floats, vector = stack_of(types.float32, LANES), stack_of(types.float32, 3)
compiled = compile_inner()


class Surfaces(NamedTuple):
    """Pointers to arrays from which the surface at a hit is read."""

    triangle: Pointer  # (t, 3, 3) float32
    slot: Pointer  # (t,) int32
    inverse: Pointer  # (i, 3, 4) float32
    material: Pointer  # (i,) int32
    absorption: Pointer  # (r, lanes) float32
    scattering: Pointer  # (r, lanes) float32
    transmission: Pointer  # (r, lanes) float32
    rows: np.int64  # of materials


class Grid(NamedTuple):
    """Cells, see `tracer.CellGrid`."""

    lookup: Pointer  # (levels, rows, columns) int32
    low: Pointer  # (n,) float32
    high: Pointer  # (n,) float32
    room: Pointer  # (n,) int32
    joined: Pointer  # (r, r) uint8
    levels: np.int64
    rows: np.int64
    columns: np.int64
    rooms: np.int64
    x: np.float32
    y: np.float32
    step: np.float32


class FlightRules(NamedTuple):
    """Rules of one flight."""

    room: np.int64  # room in which the rays start
    from_source: np.bool_  # rays start at a source, not at a reflection
    ends: np.bool_  # rays end in other rooms; else they continue there
    age: np.float32  # path length at which rays end by age [m]
    bounces: np.int64  # maximum reflections; the energy left then counts as aged
    rays: np.int64
    bins: np.int64
    kept: np.int64  # maximum number of ended rays that are kept
    bin_length: np.float32  # distance that sound travels in one bin [m]


class FlightRays(NamedTuple):
    """Rays of a flight."""

    origin: Pointer  # (n, 3) float32
    direction: Pointer  # (n, 3) float32
    travelled: Pointer  # (n,) float32, since the source or the start of the bin of a portal state [m]
    energy: Pointer  # (n, lanes) float32
    recorded: Pointer  # (n,) uint8, 0 on segments that early paths render
    room: Pointer  # (n,) int32, current room, or the room that it left
    last: Pointer  # (n,) int32, room in front of the surface of the last reflection


class FlightSums(NamedTuple):
    """Sums over the rays of one source; see `tracer.SourceSums`."""

    energy: Pointer  # (c, k, lanes) float32, of octaves, then the three components of the intensity
    portal: Pointer  # (r, r, k, lanes) float32
    path_length: Pointer  # (r, lanes) float32
    absorbed: Pointer  # (r, lanes) float32
    exchanged: Pointer  # (r, r, lanes) float32
    transmitted: Pointer  # (r, r, lanes) float32


class EndedMemory(NamedTuple):
    """Memory for rays that left a room or aged, as reflected."""

    place: Pointer  # (m, PLACE) float32
    energy: Pointer  # (m, lanes) float32
    rooms: Pointer  # (m, 2) int32, left and entered; equal if aged


class Scratch(NamedTuple):
    """Memory of a flight."""

    normal: Pointer  # (n, 3) float32, of the surface that each ray meets, towards the ray
    row: Pointer  # (n,) int32, its material
    unmirrored: Pointer  # (n,) uint8, 1: the mirrored ray is not recorded, because early paths render it
    seen: Pointer  # (n,) int32, room in front of it
    record_phase: Pointer  # (n,) float32, time of the first record of each ray [intervals between records]
    weight: Pointer  # (n,) float64
    balance: Pointer  # (3, lanes) float32, energies that are active, have aged, and were first
    room_factor: Pointer  # (r, lanes) float32, see `_weigh_rooms`
    random: Pointer  # (1,) uint64


class Flight(NamedTuple):
    """Everything that the bounces of a flight share."""

    surfaces: Surfaces
    grid: Grid
    air: Any  # vector, energy attenuation [1/m]
    rules: FlightRules
    sums: FlightSums
    ended: EndedMemory
    scratch: Scratch


@compiled
@no_type_check
def fly(scene, flight, rays, other, memory, seed):
    """Trace rays until they end, add to the sums, and return how many entries of `ended` were written.

    A ray ends at the first reflection in another room, or by age. Only sound that a source emits directly into another
    room continues there. The portal state is reached at the point where the segment enters that room. Tracing stops
    after `rules.bounces` reflections, or once hardly any energy is active, see `_is_active`. The energy left counts as
    aged.

    Args:
        scene: See `house_rays.CastScene`.
        flight: Inputs, sums and memory.
        rays: Rays; overwritten.
        other: Memory for as many rays.
        memory: See `house_rays.RayMemory`.
        seed: Seed of random numbers.
    """
    rules, scratch = flight.rules, flight.scratch
    scratch.random[0] = seed
    for i in range(rules.rays):
        scratch.record_phase[i] = uniform(scratch.random)
    active = _sum_energy(flight, rays)
    store(scratch.balance, 0, active)
    store(scratch.balance, LANES, broadcast(ZERO))
    store(scratch.balance, 2 * LANES, active)
    filled = np.int64(0)
    for _ in range(rules.bounces):
        if not _is_active(scratch.balance):
            break
        filled = _bounce(scene, flight, rays, memory, filled)
        active = _sum_energy(flight, rays)
        store(scratch.balance, 0, active)
        if sum_lanes(active) > ZERO:
            _resample(flight, rays, other)
            rays, other = other, rays
    for i in range(rules.rays):
        energy = load(rays.energy, LANES * i)
        if sum_lanes(energy) > ZERO:
            room, when = np.int64(rays.room[i]), rays.travelled[i] / rules.bin_length
            _add_portal(flight, room, room, when, energy)
            since = (when - np.floor(when)) * rules.bin_length
            filled = _keep(flight, rays, i, rays.direction, 3 * i, energy, since, room, room, filled)
    return filled


@compiled
@no_type_check
def _sum_energy(flight, rays):
    """Return the energy of all rays, per octave."""
    total = broadcast(ZERO)
    for i in range(flight.rules.rays):
        total = total + load(rays.energy, LANES * i)
    return total


@compiled
@no_type_check
def _is_active(balance):
    """Return whether the active energy of any octave exceeds both limits, re aged energy and re that at the start."""
    for b in range(NUM_OCTAVES):
        least = max(MAX_ACTIVE_SHARE * balance[LANES + b], MIN_ENERGY_SHARE * balance[2 * LANES + b])
        if balance[b] > least:
            return True
    return False


@compiled
@no_type_check
def _bounce(scene, flight, rays, memory, filled):
    """Trace and record the next segment of all rays; return the number of ended rays kept so far (`filled`).

    Rays without energy are skipped.
    """
    count = flight.rules.rays
    for i in range(count):
        memory.reach[i] = MAX_RAY_LENGTH if sum_lanes(load(rays.energy, LANES * i)) > ZERO else -ONE
    cast_rays(scene, address_of(rays.origin), address_of(rays.direction), memory, count, False)
    for i in range(count):
        if memory.reach[i] > ZERO:
            filled = _meet(flight, rays, i, memory.instance[i], memory.triangle[i], memory.t[i], filled)
    return filled


@compiled
@no_type_check
def uniform(random):
    """Return the next random number in [0, 1): SplitMix64 (Steele et al. 2014)."""
    random[0] += np.uint64(0x9E3779B97F4A7C15)
    z = random[0]
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return np.float32((z ^ (z >> np.uint64(31))) >> np.uint64(40)) * np.float32(2**-24)


@compiled
@no_type_check
def stratify(part, parts, number):
    """Move a number in [0, 1) to interval `part` of `parts` equal intervals of [0, 1)."""
    # Sums near `parts` round up to it. A number of 1 would mirror rays at surfaces that scatter all, with energy 0 / 0.
    return min((np.float32(part) + number) / np.float32(parts), BELOW_ONE)


@compiled
@no_type_check
def attenuate(air, length):
    """Return exp(-air length): the eighth power of a polynomial, within 1e-4 up to 4 dB and 1 % up to 17 dB.

    Exponents are clipped to 8, that is 35 dB.
    """
    x = minimum(air * length, broadcast(np.float32(8))) * np.float32(0.125)
    y = ONE - x * (ONE - x * (HALF - x * (np.float32(1 / 6) - x * np.float32(1 / 24))))
    y = y * y
    y = y * y
    return y * y


@compiled
@no_type_check
def _add(pointer, row, value):
    """Add a vector to row `row` of an array with `LANES` columns."""
    store(pointer, LANES * row, load(pointer, LANES * row) + value)


@compiled
@no_type_check
def _meet(flight, rays, i, instance, triangle, length, filled):
    """Record the segment of ray `i` up to its hit, reduce its energy or end it; return the number of kept ended rays.

    On a miss, `instance` < 0, all its energy counts as absorbed. The room changes only to one that shares a portal with
    the current one, or that was in front of the last surface too. `_resample` changes the direction.
    """
    grid, rules, scratch, sums = flight.grid, flight.rules, flight.scratch, flight.sums
    before, energy = np.int64(rays.room[i]), load(rays.energy, LANES * i)
    if instance < 0:
        _add(sums.absorbed, before, energy)
        store(rays.energy, LANES * i, broadcast(ZERO))
        return filled
    row = np.int64(flight.surfaces.material[instance]) + np.int64(flight.surfaces.slot[triangle])
    row = min(max(row, np.int64(0)), flight.surfaces.rows - 1)
    nx, ny, nz = _find_normal(flight.surfaces, rays.direction, 3 * i, np.int64(instance), np.int64(triangle))
    x = rays.origin[3 * i] + length * rays.direction[3 * i]
    y = rays.origin[3 * i + 1] + length * rays.direction[3 * i + 1]
    z = rays.origin[3 * i + 2] + length * rays.direction[3 * i + 2]
    seen = room_at(grid, x + INWARD_OFFSET * nx, y + INWARD_OFFSET * ny, z + INWARD_OFFSET * nz)
    seen = seen if seen >= 0 else before
    # Objects reach into walls and beyond, so a room without a portal to the last one needs a second reflection.
    room = seen if grid.joined[before * grid.rooms + seen] or seen == rays.last[i] else before
    if rays.recorded[i]:
        _record(flight, rays, i, length)
    half = attenuate(flight.air, HALF * length)
    middle, left = energy * half, energy * half * half
    _add(sums.path_length, before, middle * (HALF * length))
    _add(sums.path_length, room, middle * (HALF * length))
    if room != before:
        _add(sums.exchanged, before * grid.rooms + room, middle)
    if instance == ARCHITECTURE:
        _add_transmission(flight, left, (x, y, z), (nx, ny, nz), room, row)
    left = left * (ONE - load(flight.surfaces.absorption, LANES * row))
    _add(sums.absorbed, room, energy - left)
    unheard = rules.from_source and rays.travelled[i] == ZERO
    goes, inside = rules.ends and room != before and not unheard, ZERO
    if goes:
        inside = _length_inside(grid, rays, i, length, room)
    travelled = rays.travelled[i] + length
    rays.origin[3 * i], rays.origin[3 * i + 1] = x + RAY_OFFSET * nx, y + RAY_OFFSET * ny
    rays.origin[3 * i + 2], rays.travelled[i] = z + RAY_OFFSET * nz, travelled
    scratch.normal[3 * i], scratch.normal[3 * i + 1], scratch.normal[3 * i + 2] = nx, ny, nz
    scratch.row[i], scratch.seen[i], scratch.unmirrored[i] = row, seen, unheard and instance == ARCHITECTURE
    if goes or (travelled >= rules.age and not unheard):
        filled = _end(
            flight, rays, i, left, (travelled - inside) / rules.bin_length, inside, before, room, goes, filled
        )
        left = broadcast(ZERO)
    rays.room[i] = room
    store(rays.energy, LANES * i, left)
    return filled


@compiled
@no_type_check
def _end(flight, rays, i, energy, when, inside, before, room, goes, filled):
    """End ray `i` at time `when` [bins], by entering `room` (`goes`) or by age; return the number of kept ended rays.

    `inside`: length of its last segment in the entered room [m], else 0. Its energy counts also if memory for ended
    rays is full.
    """
    scratch, left_room = flight.scratch, before if goes else room
    _add_portal(flight, left_room, room, when, energy)
    if not goes:
        _add(scratch.balance, 1, energy)
    if filled >= flight.rules.kept:
        return filled
    share = energy / maximum(load(scratch.balance, 0), broadcast(TINY))
    direction = vector()
    chance = uniform(scratch.random)
    factor, _ = _reflect(flight, rays, i, share, chance, direction, 0)
    since = inside + (when - np.floor(when)) * flight.rules.bin_length
    return _keep(flight, rays, i, direction, 0, energy * factor, since, left_room, room, filled)


@compiled
@no_type_check
def _add_portal(flight, room, entered, when, energy):
    """Add energy that passes from `room` to `entered` (equal: aged) at time `when` [bins] to the portal sums.

    The last bin also takes later energy.
    """
    index = min(np.int64(when), flight.rules.bins - 1)
    _add(flight.sums.portal, (room * flight.grid.rooms + entered) * flight.rules.bins + index, energy)


@compiled
@no_type_check
def _keep(flight, rays, i, direction, at, energy, since, room, entered, filled):
    """Append ended ray `i` at its current origin; return the number of kept rays, unchanged if memory is full.

    `at`: index of the first component in `direction`. `since`: distance from the start of the bin in which it
    reached the portal state [m]; restarts need it. `entered`: room after `room`, equal if it ended by age.
    """
    ended = flight.ended
    if filled >= flight.rules.kept:
        return filled
    for axis in range(3):
        ended.place[PLACE * filled + axis] = rays.origin[3 * i + axis]
        ended.place[PLACE * filled + 3 + axis] = direction[at + axis]
    ended.place[PLACE * filled + 6] = since
    store(ended.energy, LANES * filled, energy)
    ended.rooms[2 * filled], ended.rooms[2 * filled + 1] = room, entered
    return filled + 1


@compiled
@no_type_check
def _find_normal(surfaces, direction, at, instance, triangle):
    """Return the unit normal of a triangle in the world, towards the ray; `at`: index of the ray's first component."""
    t, k, m, j = surfaces.triangle, 9 * triangle, surfaces.inverse, 12 * instance
    ax, ay, az = t[k + 3] - t[k], t[k + 4] - t[k + 1], t[k + 5] - t[k + 2]
    bx, by, bz = t[k + 6] - t[k], t[k + 7] - t[k + 1], t[k + 8] - t[k + 2]
    u, v, w = ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx
    x = m[j] * u + m[j + 4] * v + m[j + 8] * w
    y = m[j + 1] * u + m[j + 5] * v + m[j + 9] * w
    z = m[j + 2] * u + m[j + 6] * v + m[j + 10] * w
    along = x * direction[at] + y * direction[at + 1] + z * direction[at + 2]
    scale = ONE / max(np.sqrt(x * x + y * y + z * z), TINY)
    scale = -scale if along > ZERO else scale
    return x * scale, y * scale, z * scale


@compiled
@no_type_check
def _record(flight, rays, i, length):
    """Add energy and intensity of a ray's segment to cells, at the points of `SAMPLES_PER_BIN` regular times per bin.

    Each time counts 1 / `SAMPLES_PER_BIN` of the energy, attenuated by air. Points outside all cells, such as those
    near the floor, and times after the last bin are omitted.
    """
    grid, bins, unit = flight.grid, flight.rules.bins, flight.rules.bin_length / np.float32(SAMPLES_PER_BIN)
    travelled, phase = rays.travelled[i], flight.scratch.record_phase[i]
    index = np.int64(np.ceil(travelled / unit - phase))
    along = (np.float32(index) + phase) * unit - travelled
    if along >= length:
        return
    x, y, z = rays.origin[3 * i], rays.origin[3 * i + 1], rays.origin[3 * i + 2]
    dx, dy, dz = rays.direction[3 * i], rays.direction[3 * i + 1], rays.direction[3 * i + 2]
    energy = load(rays.energy, LANES * i) * attenuate(flight.air, along) * (ONE / np.float32(SAMPLES_PER_BIN))
    step, row = attenuate(flight.air, unit), octave_floats()
    while along < length and index < bins * SAMPLES_PER_BIN:
        height = z + along * dz
        cell = cell_at(grid, x + along * dx, y + along * dy, height)
        if cell >= 0 and height >= grid.low[cell] and height < grid.high[cell]:
            total = sum_lanes(energy)
            store(row, 0, energy)
            row[FIRST_DIRECTION], row[FIRST_DIRECTION + 1], row[FIRST_DIRECTION + 2] = (
                total * dx,
                total * dy,
                total * dz,
            )
            _add(flight.sums.energy, cell * bins + index // SAMPLES_PER_BIN, load(row, 0))
        energy = energy * step
        along += unit
        index += 1


@compiled
@no_type_check
def _add_transmission(flight, energy, point, normal, room, row):
    """Add to the sums the energy that architecture would transmit from `room` to a room behind it; trace no ray.

    That is the first other room in depths of `BEHIND_OFFSETS`; without one nothing is added.
    """
    across = ONE if abs(normal[2]) < HALF else FLOOR_THICKNESS_RATIO
    for depth in BEHIND_OFFSETS:
        away = depth * across
        x, y, z = point[0] - away * normal[0], point[1] - away * normal[1], point[2] - away * normal[2]
        behind = room_at(flight.grid, x, y, z)
        if behind >= 0 and behind != room:
            passed = energy * load(flight.surfaces.transmission, LANES * row)
            _add(flight.sums.transmitted, room * flight.grid.rooms + behind, passed)
            return


@compiled
@no_type_check
def _reflect(flight, rays, i, share, chance, out, at):
    """Write a specular or Lambertian direction of ray `i`; return the factors of its energies, and if it is specular.

    Args:
        flight: The flight.
        rays: Rays at their surfaces.
        i: Index of the ray.
        share: Weights of the octaves in the probability of scattering.
        chance: Random number in [0, 1); the direction is scattered if it is below that probability.
        out: Direction that is written.
        at: Index of its first component.
    """
    scattering = load(flight.surfaces.scattering, LANES * np.int64(flight.scratch.row[i]))
    scatters = sum_lanes(share * scattering) / max(sum_lanes(share), TINY)
    normal, incident, k = flight.scratch.normal, rays.direction, 3 * i
    if chance >= scatters:
        along = incident[k] * normal[k] + incident[k + 1] * normal[k + 1] + incident[k + 2] * normal[k + 2]
        for axis in range(3):
            out[at + axis] = incident[k + axis] - TWO * along * normal[k + axis]
        return (ONE - scattering) / (ONE - scatters), True
    height, turn = ONE - TWO * uniform(flight.scratch.random), TURN * uniform(flight.scratch.random)
    radius = np.sqrt(max(ONE - height * height, ZERO))
    x, y, z = normal[k] + radius * np.cos(turn), normal[k + 1] + radius * np.sin(turn), normal[k + 2] + height
    scale = ONE / max(np.sqrt(x * x + y * y + z * z), np.float32(1e-6))
    out[at], out[at + 1], out[at + 2] = x * scale, y * scale, z * scale
    return scattering / scatters, False


@compiled
@no_type_check
def _resample(flight, rays, other):
    """Resample the rays into `other`, as many, and reflect them.

    Rays split in rooms with little energy and end where many others carry energy. A room with the share E of the energy
    of an octave gets a share of the rays in proportion to E^(1 - `EVENNESS`). Systematic sampling keeps the expected
    energy of every ray (Kitagawa 1996). The choices of a ray's copies between scattering and not are stratified.
    """
    count, weight, factor = flight.rules.rays, flight.scratch.weight, flight.scratch.room_factor
    _weigh_rooms(flight, rays)
    whole = 0.0
    for i in range(count):
        weight[i] = sum_lanes(load(rays.energy, LANES * i) * load(factor, LANES * np.int64(rays.room[i])))
        whole += weight[i]
    spacing = whole / count
    place = spacing * uniform(flight.scratch.random)
    reached, i, new = weight[0], np.int64(0), np.int64(0)
    while new < count:
        while reached <= place and i < count - 1:
            i += 1
            reached += weight[i]
        copies = np.int64(1)
        while new + copies < count and (place + copies * spacing < reached or i == count - 1):
            copies += 1
        energy = load(rays.energy, LANES * i)
        share = energy * load(factor, LANES * np.int64(rays.room[i]))
        energy = energy * np.float32(spacing / weight[i] if weight[i] > 0 else 0.0)
        for copy in range(copies):
            chance = stratify(copy, copies, uniform(flight.scratch.random))
            _continue(flight, rays, i, other, new, energy, share, chance)
            new += 1
        place += copies * spacing


@compiled
@no_type_check
def _continue(flight, rays, i, other, new, energy, share, chance):
    """Write ray `i`, reflected, as ray `new` of `other`; `energy`: that before reflection, others as in `_reflect`."""
    scratch = flight.scratch
    factor, mirrored = _reflect(flight, rays, i, share, chance, other.direction, 3 * new)
    store(other.energy, LANES * new, energy * factor)
    for axis in range(3):
        other.origin[3 * new + axis] = rays.origin[3 * i + axis]
    other.travelled[new], other.room[new], other.last[new] = rays.travelled[i], rays.room[i], scratch.seen[i]
    other.recorded[new] = not (mirrored and scratch.unmirrored[i])


@compiled
@no_type_check
def _weigh_rooms(flight, rays):
    """Write to `room_factor`, per room and octave, the factor on a ray's energy that yields its weight in resampling.

    For rooms with energies E it is E^-`EVENNESS` / sum of E^(1 - `EVENNESS`); 0 without energy.
    """
    factor, rooms = flight.scratch.room_factor, flight.grid.rooms
    for room in range(rooms):
        store(factor, LANES * room, broadcast(ZERO))
    for i in range(flight.rules.rays):
        _add(factor, np.int64(rays.room[i]), load(rays.energy, LANES * i))
    for b in range(NUM_OCTAVES):
        whole = 0.0
        for room in range(rooms):
            whole += factor[LANES * room + b] ** (1 - EVENNESS)
        for room in range(rooms):
            here = factor[LANES * room + b]
            factor[LANES * room + b] = here**-EVENNESS / whole if here > ZERO else 0.0


@compiled
@no_type_check
def _length_inside(grid, rays, i, length, room):
    """Return the length of a segment inside the room where it ends [m], within 1 / 32 of `length`, by bisection."""
    low, high, k = ZERO, length, 3 * i
    for _ in range(ENTRY_BISECTIONS):
        middle = (low + high) * HALF
        x = rays.origin[k] + middle * rays.direction[k]
        y = rays.origin[k + 1] + middle * rays.direction[k + 1]
        z = rays.origin[k + 2] + middle * rays.direction[k + 2]
        if room_at(grid, x, y, z) == room:
            high = middle
        else:
            low = middle
    return length - high


@compiled
@no_type_check
def room_at(grid, x, y, z):
    """Return the index of the room over whose floor a point is; -1 if none."""
    cell = cell_at(grid, x, y, z)
    return np.int64(grid.room[cell]) if cell >= 0 else np.int64(-1)


@compiled
@no_type_check
def cell_at(grid, x, y, z):
    """Return the index of the cell over whose floor a point is, on the highest storey below it; -1 if none.

    A storey is below points from `INWARD_OFFSET` under its floor on; there is no upper limit.
    """
    column, row = np.int64(np.floor((x - grid.x) / grid.step)), np.int64(np.floor((y - grid.y) / grid.step))
    if row < 0 or row >= grid.rows or column < 0 or column >= grid.columns:
        return np.int64(-1)
    for level in range(grid.levels - 1, -1, -1):
        cell = np.int64(grid.lookup[(level * grid.rows + row) * grid.columns + column])
        if cell >= 0 and z >= grid.low[cell] - BELOW_CELL:
            return cell
    return np.int64(-1)
