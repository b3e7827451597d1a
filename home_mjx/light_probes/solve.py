"""The bake of one house: rays from all probes once, direct light at their hits, then passes of reflected light.

Every source of light is traced for itself and every lamp at every hit, so that the light of a group does not depend on
the others. Work is split by blocks of probes whose sums do not depend on the number of threads.
"""

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.records.lights import NUM_GROUPS, NUM_KEY_LAMPS, OTHER_LAMPS, OWN_LAMPS, ZENITH
from home_mjx.core.workers import map_threads
from home_mjx.geometry.rotations import quat_matrix
from home_mjx.light_probes.charts import place_charts
from home_mjx.light_probes.direct import light_surfaces
from home_mjx.light_probes.emitters import (
    MIN_PROBE_DISTANCE,
    Lamps,
    Windows,
    lamp_models,
    place_lamps,
    place_windows,
    sample_lamp,
    sky_groups,
)
from home_mjx.light_probes.field import ProbeField, SurfaceLight, other_shares
from home_mjx.light_probes.hit_cache import HitCache, LitPoints
from home_mjx.light_probes.kernels import compile_kernels
from home_mjx.light_probes.lattice import ProbeLattice, find_donors, find_inner, place_probes
from home_mjx.light_probes.options import ProbeOptions
from home_mjx.light_probes.ray_scene import RayScene
from home_mjx.light_probes.surfaces import SurfacePoints, SurfaceTables
from home_mjx.light_probes.texels import (
    TexelScene,
    add_direct,
    gather_texels,
    keep_visible,
    known_light,
    known_rows,
    shared_parts,
    surface_arguments,
)
from home_mjx.schema.compiled import CompiledHouse

BLOCK = 64  # probes per task
MAX_BACK_SHARE = 0.25  # share of rays that hit backs of surfaces, beyond which a probe is inside a solid
MAX_PASSES = 40
MAX_RATIO = 0.95  # of what successive passes add; the rest of this series is added to the last pass
FIRST_RAYS = 32  # per texel, of the light that the rays of the last gather find
COHERENT = 8  # directions per packet of rays


@dataclass(frozen=True)
class Gathered:
    """Light of a block of probes without reflections, and surfaces that its rays hit; see `kernels.reflect`."""

    base: Float[np.ndarray, "b 6 lanes"]
    sky: Float[np.ndarray, "b 6 lanes"]  # of rooms with windows, whose surfaces get it by samples of windows
    back: Float[np.ndarray, " b"]
    received: Float[np.ndarray, "r k"]
    spill: Float[np.ndarray, "r s"]
    rays: tuple[np.ndarray, ...]
    own: Int[np.ndarray, " n"]  # rooms of rays' probes
    hits: SurfacePoints
    instance: Int[np.ndarray, " n"]  # of hits
    points: LitPoints  # of the probes' own rooms and outdoors


class Probes(NamedTuple):
    """Probes with rays in blocks, what these gather, and the donors of the others."""

    blocks: list[np.ndarray]
    parts: list[Gathered]
    donors: tuple[np.ndarray, ...]


def solve_house(bank: HouseBank, index: int, house: CompiledHouse, options: ProbeOptions) -> ProbeField:
    """Bake the probes of house `index` of a bank."""
    lattice, lamps, windows = place_probes(house.rooms, options.spacing), place_lamps(house), place_windows(house)
    scene, tables = RayScene.from_bank(bank, index, lamp_models(lamps)), SurfaceTables.from_bank(bank, house)
    turns = _rotations(len(lattice.pos), options.seed)
    used = np.flatnonzero(lattice.inside)
    blocks = [used[i : i + BLOCK] for i in range(0, len(used), BLOCK)]
    parts = map_threads(
        lambda rows: _gather(scene, tables, lattice, lamps, windows, rows, turns[rows], options), blocks
    )
    valid = np.zeros(len(lattice.pos), bool)
    valid[used] = np.concatenate([part.back for part in parts] or [np.zeros(0)]) <= MAX_BACK_SHARE
    sky = np.zeros((len(lattice.pos), 6, NUM_GROUPS * 3), np.float32)
    for rows, part in zip(blocks, parts, strict=True):
        sky[rows] = part.sky
    valid &= ~(_is_hidden(scene, lattice) & sky.any(axis=(1, 2)))  # dark corners behind furniture stay dark
    probes = Probes(blocks, parts, find_donors(lattice, valid))
    rooms = len(house.rooms.type)
    spill = sum((part.spill for part in parts), np.zeros((rooms, rooms + 1)))
    shares = other_shares(spill)
    base = np.zeros_like(sky)
    for rows, part in zip(blocks, parts, strict=True):
        base[rows] = part.base
    reflected = _passes(base, probes, shares, options.change)
    keys = _key_lamps(sum((part.received for part in parts), np.zeros((rooms, len(lamps.number)))))
    direct = HitCache.from_points(LitPoints.join([part.points for part in parts]))
    charts, seen = keep_visible(scene, place_charts(house, lattice, options.texels))
    first = TexelScene(scene, tables, lattice, reflected, direct, None, lamps, windows, keys, shares, options)
    known = known_light(charts, gather_texels(first, charts, seen, FIRST_RAYS), seen)
    reflected = _reflect(base, probes, shares, reflected, known)
    last = replace(first, light=reflected, known=known)
    texels = add_direct(last, charts, seen, gather_texels(last, charts, seen, options.rays))
    light = reflected + _fill(_direct_at_probes(scene, lattice, lamps, keys, valid), probes.donors)
    light += _fill(sky, probes.donors)
    rows = np.append(lamps.number, -1)[keys].astype(np.int32)
    return ProbeField.pack(lattice, light, valid, rows, spill, SurfaceLight(charts, texels))


def _is_hidden(scene: RayScene, lattice: ProbeLattice) -> Bool[np.ndarray, " p"]:
    """Return whether outermost probes do not see the next one in the room, as behind curtains."""
    hidden = np.zeros(len(lattice.pos), bool)
    for axis in (0, 1):
        for side in (-1, 1):
            rows, inner = find_inner(lattice, axis, side)
            way = lattice.pos[inner] - lattice.pos[rows]
            hidden[rows] |= ~scene.is_clear(lattice.pos[rows], way, np.ones(len(rows)))
    return hidden


def _gather(
    scene: RayScene,
    tables: SurfaceTables,
    lattice: ProbeLattice,
    lamps: Lamps,
    windows: Windows,
    rows: Int[np.ndarray, " b"],
    turns: Float[np.ndarray, "b 3 3"],
    options: ProbeOptions,
) -> Gathered:
    """Trace the rays of the probes `rows`, and sum the light that their hits reflect of lamps, sun and open sky."""
    way = np.einsum("bij,rj->bri", turns, _directions(options.rays)).reshape(-1, 3)
    origin = np.repeat(lattice.pos[rows], options.rays, axis=0)
    hits = scene.nearest(origin, way)
    points = tables.points(lattice, origin, way, hits)
    own = np.repeat(lattice.room[rows], options.rays)
    stream = options.seed, int(rows[0])
    found = light_surfaces(scene, lamps, windows, points, own, len(lattice.first), stream)
    sent = found.light.reshape(-1, NUM_GROUPS, 3) * (points.albedo / np.pi)[:, None] * points.seen[:, None, None]
    cosine = face_cosines(way).reshape(len(rows), -1, 6)
    cosine *= np.pi / cosine.sum(axis=1, keepdims=True)
    base = np.einsum("brf,brl->bfl", cosine, sent.reshape(len(rows), options.rays, -1))
    sky = np.where(points.seen[:, None, None], 0, sky_groups(way)).reshape(len(rows), options.rays, -1)
    sky = np.einsum("brf,brl->bfl", cosine, sky)
    sky = np.pad(sky, ((0, 0), (0, 0), (3 * ZENITH, 3 * (NUM_GROUPS - ZENITH - 2))))
    lit = np.isin(lattice.room[rows], windows.room)[:, None, None]
    return Gathered(
        (base + np.where(lit, 0, sky)).astype(np.float32),
        np.where(lit, sky, 0).astype(np.float32),
        (points.seen & ~hits.front).reshape(len(rows), -1).mean(axis=1),
        found.received,
        found.spill,
        (*surface_arguments(lattice, points, None, hits.instance), way.astype(np.float32)),
        own,
        points,
        hits.instance,
        _own_points(points, hits.instance, own, found.light),
    )


def _own_points(points: SurfacePoints, instance: np.ndarray, own: np.ndarray, light: np.ndarray) -> LitPoints:
    """Return the points in the rooms of the probes that see them, and outdoors."""
    rows = np.flatnonzero(points.seen & ((points.room == own) | (points.room < 0)))
    return LitPoints(points.pos[rows], points.normal[rows], instance[rows], light[rows])


def _passes(
    base: Float[np.ndarray, "p 6 lanes"], probes: Probes, shares: Float[np.ndarray, "r r"], change: float
) -> Float[np.ndarray, "p 6 lanes"]:
    """Repeat reflections until the last pass changes each group by less than `change`; return the light of probes."""
    light = _fill(base.copy(), probes.donors)
    step, ratio = light.sum(axis=(0, 1)), np.ones(light.shape[2])
    for _ in range(MAX_PASSES if probes.blocks else 0):
        before, light = light, _reflect(base, probes, shares, light, None)
        last, step, total = step, (light - before).sum(axis=(0, 1)), light.sum(axis=(0, 1))
        ratio = np.clip(step / np.maximum(last, 1e-20), 0, MAX_RATIO)
        if (step <= change * total).all():
            return light + (light - before) * (ratio / (1 - ratio)).astype(np.float32)
    return light


def _reflect(
    base: Float[np.ndarray, "p 6 lanes"],
    probes: Probes,
    shares: Float[np.ndarray, "r r"],
    light: Float[np.ndarray, "p 6 lanes"],
    known: HitCache | None,
) -> Float[np.ndarray, "p 6 lanes"]:
    """Return `base` and the light that surfaces reflect to probes: of `light` around them, or what is `known` of it."""
    reflect = compile_kernels().reflect

    def one(task: tuple[np.ndarray, Gathered]) -> np.ndarray:
        """Reflect the light around the probes of one block."""
        rows, part = task
        out = np.empty((len(rows), *light.shape[1:]), np.float32)
        rays = part.rays
        if known is not None:
            rays = *rays[:4], known_rows(known, part.hits, part.instance), known.light, *rays[6:]
        reflect(light, *rays, shared_parts(shares, part.hits.room, part.own), out)
        return out

    new = base.copy()
    tasks = list(zip(probes.blocks, probes.parts, strict=True))
    for rows, out in zip(probes.blocks, map_threads(one, tasks), strict=True):
        new[rows] += out
    return _fill(new, probes.donors)


def _fill(light: Float[np.ndarray, "p 6 lanes"], donors: tuple[np.ndarray, ...]) -> Float[np.ndarray, "p 6 lanes"]:
    """Write the light of donors into the invalid probes of `light`, which is returned."""
    missing, donor, weight = donors
    light[missing] = np.einsum("qk,qkml->qml", weight, light[donor])
    return light


def _key_lamps(received: Float[np.ndarray, "r k"]) -> Int[np.ndarray, "r keys"]:
    """Return the lamps that give the surfaces of each room the most direct light, brightest first; -1 none."""
    order = np.argsort(-received, axis=1, kind="stable")[:, :NUM_KEY_LAMPS]
    order = np.where(np.take_along_axis(received, order, 1) > 0, order, -1)
    return np.pad(order, ((0, 0), (0, NUM_KEY_LAMPS - order.shape[1])), constant_values=-1)


def _direct_at_probes(
    scene: RayScene, lattice: ProbeLattice, lamps: Lamps, keys: np.ndarray, valid: Bool[np.ndarray, " p"]
) -> Float[np.ndarray, "p 6 lanes"]:
    """Return the direct light at probes of all lamps but the key lamps of their rooms."""
    light = np.zeros((len(lattice.pos), 6, NUM_GROUPS, 3), np.float32)
    for k in range(len(lamps.number)):
        rows = np.flatnonzero(valid & (keys[lattice.room] != k).all(axis=1))
        way, share, reach = sample_lamp(lamps, k, lattice.pos[rows], np.zeros((len(rows), 2)), MIN_PROBE_DISTANCE)
        share = share * scene.is_clear(lattice.pos[rows], way, np.where(share > 0, reach, -1))
        aim = way / np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-6)
        share = face_cosines(aim) * share[:, None]
        group = np.where(lattice.room[rows] == lamps.room[k], OWN_LAMPS, OTHER_LAMPS)
        light[rows, :, group] += share[..., None] * lamps.intensity[k]
    return light.reshape(len(light), 6, 3 * NUM_GROUPS)


def face_cosines(way: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 6"]:
    """Return the cosines of unit vectors to the faces +x, -x, +y, -y, +z and -z; 0 behind them."""
    return np.maximum(np.stack([way, -way], axis=2).reshape(-1, 6), 0)


def _rotations(count: int, seed: int) -> Float[np.ndarray, "n 3 3"]:
    """Return random rotations."""
    return quat_matrix(np.random.default_rng(seed).normal(size=(count, 4)))


def _directions(count: int) -> Float[np.ndarray, "r 3"]:
    """Return `count` evenly distributed unit vectors, close ones next to each other (Fibonacci lattice)."""
    number = np.arange(count) + 0.5
    z, turn = 1 - 2 * number / count, np.pi * (1 + 5**0.5) * number
    ring = np.sqrt(1 - z * z)
    return _group(np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1))


def _group(ways: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Reorder vectors by halving them along their widest axis down to `COHERENT` ones."""
    if len(ways) <= COHERENT:
        return ways
    ways = ways[np.argsort(ways[:, np.argmax(np.ptp(ways, axis=0))], kind="stable")]
    half = len(ways) // 2
    return np.concatenate([_group(ways[:half]), _group(ways[half:])])
