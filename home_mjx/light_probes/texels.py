"""Light at texels of faces: direct light by samples of its sources, reflected light by a last gather."""

import math
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Bool, Float, Int

from home_mjx.bank.records.lights import (
    KEY_LAMPS,
    KEY_SUN,
    NUM_GROUPS,
    NUM_TEXEL_GROUPS,
    OTHER_LAMPS,
    OWN_LAMPS,
    SUN_ELEVATION,
    TEXEL_SUN_AZIMUTH,
    ZENITH,
)
from home_mjx.core.workers import map_threads
from home_mjx.light_probes.charts import Charts, drop_unused, fill_invalid, smooth
from home_mjx.light_probes.direct import BIAS, sky_through
from home_mjx.light_probes.emitters import Lamps, Windows, sample_lamp_on_face, sky_groups
from home_mjx.light_probes.hit_cache import HitCache, LitPoints
from home_mjx.light_probes.kernels import compile_kernels
from home_mjx.light_probes.lattice import ProbeLattice, locate
from home_mjx.light_probes.options import ProbeOptions
from home_mjx.light_probes.ray_scene import RayScene
from home_mjx.light_probes.surfaces import PROBE_OFFSET, SurfacePoints, SurfaceTables

GATHER_BLOCK, DIRECT_BLOCK = 256, 2048  # texels per task
TEST_RAYS = 16  # of each texel, by which those inside solids and behind things are found
MAX_BACK_SHARE = 0.25  # share of rays that hit backs of surfaces, beyond which a texel is inside a solid
COVER_DISTANCE, MAX_COVER_SHARE = 0.03, 0.8  # [m], within which this share of rays ends at a covered texel
SUN_RADIUS = 0.0087  # of the sun's disc, at distance 1
SAMPLES = 8  # points on each lamp, window and the sun
KNOWN_CELLS = 0.2, 0.5  # [m], edges of cells of the faces' reflected light
NOTHING = np.zeros((1, 3 * NUM_GROUPS), np.float32)


@dataclass(frozen=True)
class TexelScene:
    """Inputs of the light at texels.

    Attributes:
        rays: The house.
        tables: Its surfaces.
        lattice: Its probes.
        light: Light that surfaces send to them.
        direct: Direct light of surfaces.
        known: Reflected light of faces; None: that between the probes counts.
        lamps: Its lamps.
        windows: Its windows.
        keys: Indices of each room's key lamps in `lamps`; -1 none.
        shares: Parts of each room's light of other rooms' lamps by room.
        options: Options of the bake.
    """

    rays: RayScene
    tables: SurfaceTables
    lattice: ProbeLattice
    light: Float[np.ndarray, "p 6 lanes"]
    direct: HitCache
    known: HitCache | None
    lamps: Lamps
    windows: Windows
    keys: Int[np.ndarray, "r k"]
    shares: Float[np.ndarray, "r r"]
    options: ProbeOptions


def keep_visible(rays: RayScene, charts: Charts) -> tuple[Charts, Bool[np.ndarray, " x"]]:
    """Return the charts with a texel that is in no solid and not covered, and whether each of their texels is valid."""
    way = _ways(charts.normal, TEST_RAYS, 0)
    hits = rays.nearest(np.repeat(charts.pos + BIAS * charts.normal, TEST_RAYS, axis=0), way.reshape(-1, 3))
    seen, near = hits.instance >= 0, hits.t < COVER_DISTANCE
    back, cover = (x.reshape(-1, TEST_RAYS).mean(axis=1) for x in (seen & ~hits.front, seen & near))
    valid = charts.inside & (back <= MAX_BACK_SHARE) & (cover <= MAX_COVER_SHARE)
    used = np.bincount(charts.chart[valid], minlength=len(charts.first)) > 0
    rows, number = used[charts.chart], np.where(used, np.cumsum(used) - 1, -1)
    sizes = np.prod(charts.count[used], axis=1)
    texels = {name: getattr(charts, name)[rows] for name in ("pos", "normal", "room", "instance", "inside")}
    start, of_triangle = drop_unused(charts, np.where(charts.of_triangle >= 0, number[charts.of_triangle], -1))
    kept = replace(
        charts,
        start=start,
        of_triangle=of_triangle,
        frame=charts.frame[used],
        count=charts.count[used],
        first=np.cumsum(sizes) - sizes,
        chart=number[charts.chart[rows]],
        **texels,
    )
    return kept, valid[rows]


def gather_texels(
    scene: TexelScene, charts: Charts, valid: Bool[np.ndarray, " x"], rays: int
) -> Float[np.ndarray, "x groups 3"]:
    """Return the irradiance of valid texels by surfaces, and by the sky where rooms have no windows, from `rays` rays.

    It is smoothed within charts.
    """
    light = np.zeros((len(valid), NUM_GROUPS, 3), np.float32)
    blocks = _blocks(valid, GATHER_BLOCK)
    parts = map_threads(lambda rows: _gather(scene, charts, rows, rays), blocks)
    for rows, found in zip(blocks, parts, strict=True):
        light[rows] = found
    return smooth(charts, light, valid)


def add_direct(
    scene: TexelScene, charts: Charts, valid: Bool[np.ndarray, " x"], light: Float[np.ndarray, "x groups 3"]
) -> Float[np.ndarray, "x texel_groups 3"]:
    """Add the direct light of texels; invalid ones get the light of valid neighbours."""
    total = np.zeros((len(valid), NUM_TEXEL_GROUPS, 3), np.float32)
    total[:, :NUM_GROUPS] = light
    blocks = _blocks(valid, DIRECT_BLOCK)
    for rows, found in zip(blocks, map_threads(lambda rows: _direct(scene, charts, rows), blocks), strict=True):
        total[rows] += found
    fill_invalid(charts, total, valid)
    return total


def known_light(charts: Charts, light: Float[np.ndarray, "x groups 3"], valid: Bool[np.ndarray, " x"]) -> HitCache:
    """Return the light of valid texels by place."""
    rows = np.flatnonzero(valid)
    points = LitPoints(charts.pos[rows], charts.normal[rows], charts.instance[rows], light[rows])
    return HitCache.from_points(points, KNOWN_CELLS)


def known_rows(known: HitCache | None, points: SurfacePoints, instance: Int[np.ndarray, " n"]) -> np.ndarray:
    """Return the rows of `known` for points on or near charts; -1 elsewhere."""
    return np.full(len(instance), -1, np.int64) if known is None else known.rows(points, instance)


def _blocks(valid: Bool[np.ndarray, " x"], size: int) -> list[np.ndarray]:
    """Return the valid texels in blocks of `size`."""
    used = np.flatnonzero(valid)
    return [used[i : i + size] for i in range(0, len(used), size)]


def _direct(scene: TexelScene, charts: Charts, rows: Int[np.ndarray, " b"]) -> Float[np.ndarray, "b texel_groups 3"]:
    """Return the irradiance of the texels `rows` by lamps, windows and the sun."""
    normal, room = charts.normal[rows], charts.room[rows]
    stream, start = (scene.options.seed, int(rows[0])), charts.pos[rows] + BIAS * normal
    light = np.zeros((len(rows), NUM_TEXEL_GROUPS, 3), np.float32)
    _add_lamps(scene, light, start, normal, room, stream)
    for w in range(len(scene.windows.number)):
        own = np.flatnonzero(room == scene.windows.room[w])
        for sample in range(SAMPLES if len(own) else 0):
            share = sky_through(scene.rays, scene.windows, w, start[own], normal[own], (*stream, sample))
            light[own, ZENITH : ZENITH + 2] += share / SAMPLES
    light[:, KEY_SUN] = _sun(scene.rays, start, normal, stream)[:, None]
    return light


def _gather(
    scene: TexelScene, charts: Charts, rows: Int[np.ndarray, " b"], rays: int
) -> Float[np.ndarray, "b groups 3"]:
    """Return the irradiance of the texels `rows` by surfaces, and by the sky where rooms have no windows."""
    normal, room, lattice = charts.normal[rows], charts.room[rows], scene.lattice
    way = _ways(normal, rays, scene.options.seed, int(rows[0])).reshape(-1, 3)
    origin, own = np.repeat(charts.pos[rows] + BIAS * normal, rays, axis=0), np.repeat(room, rays)
    hits = scene.rays.nearest(origin, way)
    points = scene.tables.points(lattice, origin, way, hits)
    row = scene.direct.rows(points, hits.instance)
    row = np.where(row < 0, len(scene.direct.light) - 1, row)
    out = np.empty((len(rows), 3 * NUM_GROUPS), np.float32)
    compile_kernels().gather(
        scene.light,
        *surface_arguments(lattice, points, scene.known, hits.instance),
        shared_parts(scene.shares, points.room, own),
        row,
        scene.direct.light,
        out,
    )
    light = out.reshape(len(rows), NUM_GROUPS, 3)
    dark = np.flatnonzero(~np.isin(room, scene.windows.room))
    sky = np.where(points.seen[:, None, None], 0, sky_groups(way)).reshape(len(rows), rays, 2, 3).mean(axis=1)
    light[dark, ZENITH : ZENITH + 2] += math.pi * sky[dark]
    return light


def surface_arguments(
    lattice: ProbeLattice, points: SurfacePoints, known: HitCache | None, instance: Int[np.ndarray, " n"]
) -> tuple[np.ndarray, ...]:
    """Return the arguments of `kernels.reflect` and `kernels.gather` from `cell` to `albedo`."""
    cell, fraction = locate(lattice, points.pos + points.normal * PROBE_OFFSET, points.room)
    cell = np.where(points.seen, cell, -1).astype(np.int64)
    count = lattice.count[np.maximum(points.room, 0)]
    stride = np.stack([count[:, 1] * count[:, 2], count[:, 2]], axis=1).astype(np.int64)
    normal, albedo = (np.ascontiguousarray(x, np.float32) for x in (points.normal, points.albedo))
    light = NOTHING if known is None else known.light
    return cell, fraction, stride, normal, known_rows(known, points, instance), light, albedo


def shared_parts(
    shares: Float[np.ndarray, "r r"], room: Int[np.ndarray, " n"], own: Int[np.ndarray, " n"]
) -> Float[np.ndarray, " n"]:
    """Return the argument of `kernels.change_room` for light from rooms `room` to rooms `own`."""
    return np.where((room != own) & (room >= 0), shares[room, own], np.float32(-1))


def _add_lamps(
    scene: TexelScene,
    light: Float[np.ndarray, "b texel_groups 3"],
    start: np.ndarray,
    normal: np.ndarray,
    room: np.ndarray,
    stream: tuple[int, ...],
) -> None:
    """Add the direct light of lamps: of key lamps of each texel's room, of its other lamps, and of other rooms' lamps.

    Groups are those of the probes: a key lamp of another room is in that of key lamps.
    """
    lamps = scene.lamps
    for k, number in enumerate(lamps.number):
        random = np.random.default_rng((*stream, int(number))).random((SAMPLES, len(start), 2), np.float32) * 2 - 1
        total = np.zeros(len(start), np.float32)
        for sample in random:
            way, share, reach = sample_lamp_on_face(lamps, k, start, normal, sample)
            total += share * scene.rays.is_clear(start, way, np.where(share > 0, reach, -1)) / SAMPLES
        group = np.where(room == lamps.room[k], OWN_LAMPS, OTHER_LAMPS)
        group = np.where((scene.keys[room] == k).any(axis=1), KEY_LAMPS, group)
        light[np.arange(len(start)), group] += total[:, None] * lamps.intensity[k]


def _sun(rays: RayScene, start: np.ndarray, normal: np.ndarray, stream: tuple[int, ...]) -> Float[np.ndarray, " b"]:
    """Return the irradiance by the direct sun of texels per normal irradiance."""
    turn, rise = math.radians(TEXEL_SUN_AZIMUTH), math.radians(SUN_ELEVATION)
    aim = np.array([math.cos(turn) * math.cos(rise), math.sin(turn) * math.cos(rise), math.sin(rise)])
    level = np.array([-math.sin(turn), math.cos(turn), 0.0])
    spread = np.random.default_rng((*stream, 1)).uniform(-SUN_RADIUS, SUN_RADIUS, (SAMPLES, len(start), 2))
    cosine, total = np.maximum(np.einsum("ij,j->i", normal, aim), 0), np.zeros(len(start), np.float32)
    for sample in spread:
        way = aim + sample[:, :1] * level + sample[:, 1:] * np.cross(aim, level)
        total += cosine * rays.is_clear(start, way, np.where(cosine > 0, np.inf, -1)) / SAMPLES
    return total


def _ways(normal: Float[np.ndarray, "n 3"], count: int, *stream: int) -> Float[np.ndarray, "n count 3"]:
    """Return cosine-distributed directions around normals: Fibonacci's spiral, turned at random."""
    number = np.arange(count) + 0.5
    ring, turn = np.sqrt(number / count), np.pi * (1 + 5**0.5) * number
    spin = np.random.default_rng(stream).random((len(normal), 1)) * 2 * np.pi + turn
    level = np.cross(np.where(np.abs(normal[:, 2:]) < 0.99, [[0.0, 0.0, 1.0]], [[0.0, 1.0, 0.0]]), normal)
    level /= np.linalg.norm(level, axis=1, keepdims=True)
    along = ring * np.cos(spin), ring * np.sin(spin)
    up = np.sqrt(1 - ring**2)[None, :, None] * normal[:, None]
    way = along[0][..., None] * level[:, None] + along[1][..., None] * np.cross(normal, level)[:, None] + up
    return way.astype(np.float32)
