"""Sources of light of one house in the world: lamps, and the directional groups of sky and sun."""

import hashlib
import math
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.records.lights import SUN_AZIMUTHS, SUN_ELEVATION
from home_mjx.core.color import decode_srgb
from home_mjx.core.images import read_texture
from home_mjx.core.paths import cache_folder
from home_mjx.errors import DatasetError
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse

MIN_SURFACE_DISTANCE, MIN_PROBE_DISTANCE = 0.1, 0.2  # [m], assumed at least between a lamp and a surface
BULB_RADIUS = 0.05  # [m], of a lamp that has no extent
MEAN_COLOR_EDGE = 16  # [px], to which a texture is reduced before the mean of its colours is taken
COLOR_UNIT = 2.0**-12  # to which mean colours are rounded
ZENITH_COLOR, GROUND_COLOR = np.array([0.45, 0.68, 1.0]), np.array([0.2, 0.21, 0.16])  # as of the shader `lit`


@dataclass(frozen=True)
class Lamps:
    """Lamps of a house; fields as of `schema.lighting.LightTable`, but in the world."""

    number: Int[np.ndarray, " k"]  # row in the table
    pos: Float[np.ndarray, "k 3"]
    axis_u: Float[np.ndarray, "k 3"]
    axis_v: Float[np.ndarray, "k 3"]
    direction: Float[np.ndarray, "k 3"]
    intensity: Float[np.ndarray, "k 3"]
    exponent: Float[np.ndarray, " k"]
    cutoff: Float[np.ndarray, " k"]
    room: Int[np.ndarray, " k"]
    carrier: Int[np.ndarray, " k"]


def place_lamps(house: CompiledHouse) -> Lamps:
    """Return the lamps of a house that emit, with their models as placed."""
    table = house.lights
    number = np.flatnonzero(~table.daylight & (table.intensity.max(axis=1, initial=0) > 0))
    carrier = table.instance[number]
    pose = house.instances.pose[np.maximum(carrier, 0)]

    def turn(vectors: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "k 3"]:
        """Return the lamps' rows of a column of vectors, rotated to the world."""
        return np.einsum("kij,kj->ki", pose[..., :3], vectors[number])

    aim = turn(table.direction)
    return Lamps(
        number.astype(np.int32),
        turn(table.pos) + pose[..., 3],
        turn(table.axis_u),
        turn(table.axis_v),
        aim / np.maximum(np.linalg.norm(aim, axis=1, keepdims=True), 1e-9),
        table.intensity[number],
        table.exponent[number],
        table.cutoff[number],
        table.room[number],
        carrier,
    )


@dataclass(frozen=True)
class Windows:
    """Rectangles of glass between rooms and outdoors, in the world; fields as of `schema.lighting.LightTable`."""

    number: Int[np.ndarray, " w"]
    pos: Float[np.ndarray, "w 3"]
    axis_u: Float[np.ndarray, "w 3"]
    axis_v: Float[np.ndarray, "w 3"]
    inward: Float[np.ndarray, "w 3"]
    area: Float[np.ndarray, " w"]
    room: Int[np.ndarray, " w"]


def place_windows(house: CompiledHouse) -> Windows:
    """Return the windows of a house."""
    table = house.lights
    number = np.flatnonzero(table.daylight)
    pose = house.instances.pose[np.maximum(table.instance[number], 0)]
    pos, u, v, aim = (
        np.einsum("wij,wj->wi", pose[..., :3], x[number])
        for x in (table.pos, table.axis_u, table.axis_v, table.direction)
    )
    aim = aim / np.maximum(np.linalg.norm(aim, axis=1, keepdims=True), 1e-9)
    area = 4 * np.linalg.norm(np.cross(u, v), axis=1)
    return Windows(number, pos + pose[..., 3], u, v, aim, area, table.room[number])


def lamp_models(lamps: Lamps) -> Int[np.ndarray, " m"]:
    """Return the instances that carry lamps; light passes through them, as `lit` has it for each lamp's own."""
    return np.unique(lamps.carrier[lamps.carrier != ARCHITECTURE])


def sample_lamp(
    lamps: Lamps, k: int, points: Float[np.ndarray, "n 3"], random: Float[np.ndarray, "n 2"], least: float
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Return vectors to a point on lamp `k` [m], shares of its intensity over the squared distance [1/m²], and reach.

    That is the fraction of the way that a shadow ray tests. `random` is uniform in [-1, 1]; distances count as at
    least `least` [m].
    """
    target = lamps.pos[k] + random[:, :1] * lamps.axis_u[k] + random[:, 1:] * lamps.axis_v[k]
    if not lamps.axis_v[k].any():
        target = target + BULB_RADIUS * _on_sphere(random)
    way = (target - points).astype(np.float32)
    square = np.einsum("ij,ij->i", way, way)
    distance = np.sqrt(np.maximum(square, 1e-8))
    cosine = -np.einsum("ij,j->i", way, lamps.direction[k].astype(np.float32)) / distance
    profile = np.where(cosine >= lamps.cutoff[k], np.maximum(cosine, 1e-6) ** np.float32(lamps.exponent[k]), 0)
    return way, profile / np.maximum(square, np.float32(least**2)), np.maximum(1 - 1.1 * BULB_RADIUS / distance, 0)


def sample_lamp_on_face(
    lamps: Lamps,
    k: int,
    points: Float[np.ndarray, "n 3"],
    normal: Float[np.ndarray, "n 3"],
    random: Float[np.ndarray, "n 2"],
) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, " n"], Float[np.ndarray, " n"]]:
    """Return `sample_lamp` for faces: shares are of the irradiance on the unit normals, 0 behind a face."""
    way, share, reach = sample_lamp(lamps, k, points, random, MIN_SURFACE_DISTANCE)
    share = share * np.maximum(np.einsum("ij,ij->i", way, normal), 0)
    return way, share / np.maximum(np.linalg.norm(way, axis=1), 1e-6), reach


def _on_sphere(random: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
    """Map points of [-1, 1]² to unit vectors of uniform distribution."""
    z, turn = random[:, 0], np.pi * random[:, 1]
    ring = np.sqrt(np.maximum(1 - z * z, 0))
    return np.stack([ring * np.cos(turn), ring * np.sin(turn), z], axis=1)


def sun_directions() -> Float[np.ndarray, "s 3"]:
    """Return unit vectors to the suns of the sun groups."""
    turn, rise = np.radians(SUN_AZIMUTHS), math.radians(SUN_ELEVATION)
    return np.stack(
        [np.cos(turn) * math.cos(rise), np.sin(turn) * math.cos(rise), np.full(len(turn), math.sin(rise))], 1
    )


def sky_groups(way: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 2 3"]:
    """Return the radiance of the two sky groups in unit directions: zenith with ground, and white horizon."""
    high = np.sqrt(np.clip(way[:, 2:], 0, 1))
    zenith = np.where(way[:, 2:] >= 0, high * ZENITH_COLOR, GROUND_COLOR)
    return np.stack([zenith, np.where(way[:, 2:] >= 0, 1 - high, 0) * np.ones(3)], axis=1)


def open_sky(up: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2 3"]:
    """Return the irradiance by the sky groups without obstacles, for normals whose z component is `up`.

    Exact for up = -1, 0 and 1, quadratic between them: integrals of the radiance times the cosine.
    """
    up = up[:, None]
    ground, zenith, total = np.pi * (1 - up) / 2, _through(up, 0.9585, 0.8 * np.pi), np.pi * (1 + up) / 2
    return np.stack([zenith * ZENITH_COLOR + ground * GROUND_COLOR, (total - zenith) * np.ones(3)], axis=1)


def _through(x: Float[np.ndarray, "n 1"], middle: float, end: float) -> Float[np.ndarray, "n 1"]:
    """Return the quadratic that is 0, `middle` and `end` at x = -1, 0 and 1."""
    return middle + x * end / 2 + x * x * (end / 2 - middle)


def mean_colors(house: CompiledHouse) -> Float[np.ndarray, "r 3"]:
    """Return the mean diffuse reflectance of each material row, at most 1: its colour times its texture's mean."""
    table = house.materials
    white = np.full(3, 1 / COLOR_UNIT)
    texture = np.array([_summarize(*_stamp(path))[:3] if path else white for path in table.texture]) * COLOR_UNIT
    return np.minimum(decode_srgb(table.albedo[:, :3]) * texture.reshape(-1, 3), 1).astype(np.float32)


def check_sources(house: CompiledHouse) -> None:
    """Raise `DatasetError` for the first material, lamp or window whose light is not a number or negative."""
    table, rows = house.lights, house.materials.albedo[:, :3]
    wrong = [
        ("material", "reflectance", rows, ~(rows >= 0) | np.isinf(rows)),
        ("light", "intensity [W/sr]", table.intensity, ~(table.intensity >= 0) | np.isinf(table.intensity)),
        ("light", "position [m]", table.pos, ~np.isfinite(table.pos)),
    ]
    for what, quantity, values, bad in wrong:
        if bad.any():
            row = int(np.argmax(bad.any(axis=1)))
            message = f"the {quantity} of {what} {row} is {values[row].tolist()}, from which no light can be baked"
            hint = "Correct it in the dataset, or render with `fast` or with `lit` without a bake."
            raise DatasetError(message, element=f"house {house.id}, {what} {row}", hint=hint)


def texture_digest(house: CompiledHouse) -> bytes:
    """Return a digest of all textures of a house by material row, so that machines find each other's records.

    Machines draw textures that differ in last digits. Those in the cache folder count by their path in it, which
    contains the version or the source of what draws them; others by their mean colours and coarse cut-outs.
    """
    return hashlib.sha256(b"".join(_identify(path) for path in house.materials.texture)).digest()


def _identify(path: str) -> bytes:
    """Return what the texture file at a path contributes to `texture_digest`; empty for no path."""
    if not path:
        return b""
    kept = Path(path).absolute()
    if kept.is_relative_to(cache_folder().absolute()):
        return kept.relative_to(cache_folder().absolute()).as_posix().encode()
    return _summarize(*_stamp(path)).tobytes()


def _stamp(path: str) -> tuple[str, int, int]:
    """Return a file's path, size and time of change, by which readings of it are kept."""
    stat = Path(path).stat()
    return path, stat.st_size, stat.st_mtime_ns


@lru_cache(maxsize=4096)
def _summarize(path: str, _size: int, _time: int) -> Int[np.ndarray, " n"]:
    """Return the mean linear colour of an image, weighted by opacity, in units of `COLOR_UNIT`, then its coverage.

    That is the mean opacity of each cell of a coarse grid in eighths.
    """
    pixels = read_texture(Path(path), MEAN_COLOR_EDGE).reshape(-1, 4) / 255
    weight = np.maximum(pixels[:, 3:], 1e-6)
    mean = (decode_srgb(pixels[:, :3]) * weight).sum(axis=0) / weight.sum()
    return np.concatenate([np.round(mean / COLOR_UNIT), np.round(8 * pixels[:, 3])]).astype(np.int32)
