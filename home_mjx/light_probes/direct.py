"""Direct light of lamps, suns and open sky at surfaces that rays of probes hit."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from home_mjx.bank.records.lights import NUM_GROUPS, OTHER_LAMPS, OWN_LAMPS, SUNS, ZENITH
from home_mjx.light_probes.emitters import (
    MIN_SURFACE_DISTANCE,
    Lamps,
    Windows,
    open_sky,
    sample_lamp_on_face,
    sky_groups,
    sun_directions,
)
from home_mjx.light_probes.ray_scene import RayScene
from home_mjx.light_probes.surfaces import SurfacePoints

BIAS = 1e-3  # [m], offset of shadow rays above a surface


class DirectLight(NamedTuple):
    """Direct light at points of surfaces."""

    light: Float[np.ndarray, "n groups 3"]  # irradiance
    received: Float[np.ndarray, "r k"]  # luminous sums over points of each room, by lamp
    spill: Float[np.ndarray, "r s"]  # sums over rays of probes of room r of light by lamps of room s - 1


def light_surfaces(
    scene: RayScene,
    lamps: Lamps,
    windows: Windows,
    points: SurfacePoints,
    own: Int[np.ndarray, " n"],
    rooms: int,
    stream: tuple[int, ...],
) -> DirectLight:
    """Compute the direct light at points seen from probes.

    Args:
        scene: The house.
        lamps: Its lamps, each of which is tested at every point.
        windows: Its windows, each of which is tested at points of its room.
        points: Points of surfaces.
        own: Room of the probe that sees each.
        rooms: Number of rooms.
        stream: Seeds of points on lamps; each lamp adds its row.
    """
    light = np.zeros((len(own), NUM_GROUPS, 3), np.float32)
    received, spill = np.zeros((rooms, len(lamps.number))), np.zeros((rooms, rooms + 1))
    start = points.pos + points.normal * BIAS
    inside = np.where(points.seen & (points.room >= 0), points.room, -1)
    for k, number in enumerate(lamps.number):
        random = np.random.default_rng((*stream, int(number))).random((len(own), 2), np.float32) * 2 - 1
        way, share, reach = sample_lamp_on_face(lamps, k, start, points.normal, random)
        share = share * points.seen
        share = share * scene.is_clear(start, way, np.where(share > 0, reach, -1))
        group = np.where(own == lamps.room[k], OWN_LAMPS, OTHER_LAMPS)
        light[np.arange(len(own)), group] += share[:, None] * lamps.intensity[k]
        received[:, k] = np.bincount(inside + 1, share, rooms + 1)[1:] * lamps.intensity[k].mean()
        spill[:, lamps.room[k] + 1] += np.bincount(own, share, rooms) * lamps.intensity[k].mean()
    for s, aim in enumerate(sun_directions()):
        cosine = np.maximum(np.einsum("ij,j->i", points.normal, aim), 0) * points.seen
        clear = scene.is_clear(start, aim[None], np.where(cosine > 0, np.inf, -1))
        light[:, SUNS + s] = (cosine * clear)[:, None]
    light[:, ZENITH : ZENITH + 2] = np.where((points.room < 0)[:, None, None], open_sky(points.normal[:, 2]), 0)
    for w in range(len(windows.number)):
        rows = np.flatnonzero(points.seen & (points.room == windows.room[w]))
        light[rows, ZENITH : ZENITH + 2] += sky_through(scene, windows, w, start[rows], points.normal[rows], stream)
    return DirectLight(light, received, spill)


def sky_through(
    scene: RayScene,
    windows: Windows,
    w: int,
    start: Float[np.ndarray, "n 3"],
    normal: Float[np.ndarray, "n 3"],
    stream: tuple[int, ...],
) -> Float[np.ndarray, "n 2 3"]:
    """Return the irradiance by the sky groups through window `w`, from a random point on it for each row."""
    random = np.random.default_rng((*stream, int(windows.number[w]))).random((len(start), 2)) * 2 - 1
    way = windows.pos[w] + random[:, :1] * windows.axis_u[w] + random[:, 1:] * windows.axis_v[w] - start
    distance = np.maximum(np.linalg.norm(way, axis=1), MIN_SURFACE_DISTANCE)
    way = way / distance[:, None]
    cosine = np.maximum(np.einsum("ij,ij->i", way, normal), 0) * np.maximum(
        -np.einsum("ij,j->i", way, windows.inward[w]), 0
    )
    share = windows.area[w] * cosine / distance**2
    clear = scene.is_clear(start, way, np.where(share > 0, np.inf, -1))
    return np.minimum(share * clear, np.pi)[:, None, None] * sky_groups(way)
