"""Monte Carlo of sound among the triangles of a house: an oracle of furnished rooms, written apart from the engine.

As `decay_oracle`, but particles meet triangles, found by Embree, two-sided, each with its own surface. It shares with
the engine only the compiled house's triangles and rows of materials; it places them, and opens doors, itself.
"""

from dataclasses import dataclass

import numba as nb
import numpy as np
from decay_oracle import QUIET, SPEED, _hear

from home_mjx.schema.compiled import CompiledHouse, RayKind

SKIN = 2e-4  # [m], from a surface to where a particle starts anew
AT_ONCE = 20_000  # particles
LEAST = 0.12  # [m]: smaller balls hear too little
PROBES = 4000  # directions in which one looks for what cuts a ball


@dataclass(frozen=True)
class Surfaces:
    """Triangles with their surfaces.

    Attributes:
        corners: (t, 3, 3) [m].
        row: (t,), of the tables.
        absorption: (rows, bands), energy fractions.
        scattering: (rows, bands), energy fractions.
        air: (bands,), the m of exp(−m r) for energy [1/m].
    """

    corners: np.ndarray
    row: np.ndarray
    absorption: np.ndarray
    scattering: np.ndarray
    air: np.ndarray

    def faces(self, band: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, float]:
        """Unit normals (t, 3), absorption and scattering (t,) of one octave, and its air."""
        normal = np.cross(self.corners[:, 1] - self.corners[:, 0], self.corners[:, 2] - self.corners[:, 0])
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        absorbed, scattered = (x[self.row, band].astype(float) for x in (self.absorption, self.scattering))
        return normal, absorbed, scattered, float(self.air[band])

    def rays(self):
        """A scene of Embree with these triangles."""
        from embreex.mesh_construction import TriangleMesh
        from embreex.rtcore_scene import EmbreeScene

        scene = EmbreeScene()
        TriangleMesh(scene, self.corners.astype(np.float32))
        return scene


def surfaces_of(house: CompiledHouse, air: np.ndarray) -> Surfaces:
    """What stops sound in a house, its movable things as they stand, the doors between rooms wide open.

    Args:
        house: Any.
        air: (bands,), see `Surfaces`.
    """
    instances, corners, rows = house.instances, [], []
    opened = {int(i): _opened(house, door) for door, i in enumerate(house.doors.instance)}
    for number, (key, pose) in enumerate(zip(instances.model, instances.pose, strict=True)):
        model = house.models[key]
        turn, way = opened.get(number, (np.eye(3), np.zeros(3)))
        placed = (model.triangle.astype(float) @ pose[:, :3].T + pose[:, 3]) @ turn.T + way
        row = instances.material[number] + model.slot
        stops = (house.materials.mask[row] & int(RayKind.SOUND)) > 0
        corners.append(placed[stops])
        rows.append(row[stops])
    corner = np.concatenate(corners)
    area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1)
    kept, table = area > 0, house.materials
    return Surfaces(
        corner[kept], np.concatenate(rows)[kept], table.absorption, table.scattering, np.asarray(air, float)
    )


def _opened(house: CompiledHouse, door: int) -> tuple[np.ndarray, np.ndarray]:
    """Rotation and translation of a leaf from where it stands to wide open."""
    doors = house.doors
    far, slide = float(doors.fully_open[door]), doors.slide[door]
    if slide.any():
        return np.eye(3), np.append(far * slide, 0.0)
    c, s = np.cos(far), np.sin(far)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    pivot = np.append(doors.pivot[door], 0.0)
    return turn, pivot - turn @ pivot


def free_radii(surfaces: Surfaces, receivers: np.ndarray, radius: float = 0.35) -> np.ndarray:
    """Of each receiver the largest ball, up to a radius [m], that nothing cuts; 0 where that is too small."""
    scene, rng = surfaces.rays(), np.random.default_rng(0)
    way = rng.normal(size=(PROBES, 3))
    way = np.float32(way / np.linalg.norm(way, axis=1, keepdims=True))
    found = []
    for point in np.atleast_2d(receivers):
        start = np.broadcast_to(np.asarray(point, np.float32), way.shape)
        near = scene.run(np.ascontiguousarray(start), way, np.full(PROBES, radius, np.float32), output=1)
        found.append(np.where(near["geomID"] >= 0, near["tfar"], radius).min())
    return np.where(np.array(found) < LEAST, 0.0, np.array(found))


def fly(
    surfaces: Surfaces,
    source: np.ndarray,
    receivers: np.ndarray,
    seconds: float,
    bin_seconds: float = 0.004,
    particles: int = 4000,
    radius: float | np.ndarray = 0.35,
    seed: int = 0,
) -> np.ndarray:
    """Energies (receivers, bands, bins) re the free field at 1 m.

    Args:
        surfaces: What particles meet.
        source: (3,) [m].
        receivers: (r, 3) [m]; nothing may cut the balls around them, see `free_radii`.
        seconds: For which they fly.
        bin_seconds: Time bin.
        particles: Per octave.
        radius: Of the balls [m], one or each its own.
        seed: Of the random numbers.
    """
    bands, bins, scene = surfaces.absorption.shape[1], round(seconds / bin_seconds), surfaces.rays()
    receivers = np.ascontiguousarray(receivers, float)
    ears = receivers, np.broadcast_to(np.asarray(radius, float), len(receivers)).copy(), bin_seconds * SPEED
    energy = np.zeros((bands, len(receivers), bins))
    for band in range(bands):
        rng = np.random.default_rng((seed, band))
        for first in range(0, particles, AT_ONCE):
            count = min(AT_ONCE, particles - first)
            _flight(scene, surfaces.faces(band), np.asarray(source, float), ears, energy[band], count, rng)
    energy = np.moveaxis(energy, 0, 1) / particles
    return energy + _direct(surfaces, scene, source, receivers, bins, bin_seconds)


def _direct(surfaces, scene, source, receivers, bins, bin_seconds) -> np.ndarray:
    """Of receivers that the source sees."""
    energy = np.zeros((len(receivers), len(surfaces.air), bins))
    for row, point in enumerate(receivers):
        way = point - source
        distance = float(np.linalg.norm(way))
        reach = np.array([distance], np.float32)
        met = scene.run(np.asarray([source], np.float32), np.asarray([way / distance], np.float32), reach, output=1)[
            "geomID"
        ][0]
        at = int(distance / SPEED / bin_seconds)
        if met < 0 and at < bins:
            energy[row, :, at] = np.exp(-surfaces.air * distance) / distance**2
    return energy


def _flight(scene, faces, source, ears, energy, count, rng) -> None:
    """Adds what particles of one octave give."""
    way = rng.normal(size=(count, 3))
    way /= np.linalg.norm(way, axis=1, keepdims=True)
    point, state = np.tile(source, (count, 1)), np.zeros((count, 2))
    state[:, 0] = 1.0  # energy left; the other column is the way flown [m]
    heard = False  # the direct sound is not
    while count:
        met = scene.run(np.float32(point[:count]), np.float32(way[:count]), output=1)
        hit = met["tfar"], met["primID"], met["geomID"]
        count = _bounce((point, way, state), hit, faces, ears, heard, energy, rng, count)
        heard = True


@nb.njit(cache=True)
def _bounce(rays, hit, faces, ears, heard, energy, rng, count):
    """One segment of each particle, heard, and the reflection at its end; those that fly on come first: how many."""
    (point, way, state), (length, triangle, met), (normal, absorption, scattering, air) = rays, hit, faces
    kept, flow, turned = 0, np.zeros((1, energy.shape[1], 3)), np.zeros(3)
    for i in range(count):
        if met[i] < 0:
            continue
        far, t = float(length[i]), triangle[i]
        left, flown = state[i]
        if heard:
            _heard(point[i], way[i], far, flown, left, air, ears, energy, flow)
        left *= np.exp(-air * far) * (1 - absorption[t])
        if left < QUIET or flown + far >= energy.shape[1] * ears[2]:
            continue
        side = -1.0 if way[i] @ normal[t] > 0 else 1.0
        _turn(way[i], normal[t], side, scattering[t], rng, turned)
        for a in range(3):
            point[kept, a] = point[i, a] + far * way[i, a] + SKIN * side * normal[t, a]
        way[kept] = turned
        state[kept, 0], state[kept, 1] = left, flown + far
        kept += 1
    return kept


@nb.njit(cache=True)
def _heard(point, way, far, flown, left, air, ears, energy, flow):
    """Adds what all ears hear of a segment, each in a ball of its own size."""
    places, radius, per_bin = ears
    for r in range(len(places)):
        one, scale = slice(r, r + 1), 3 / radius[r] ** 3  # 4 pi over the ball's volume
        _hear(energy[one], flow, places[one], point, way, far, flown, left, air, per_bin, radius[r], scale)


@nb.njit(cache=True)
def _turn(way, normal, side, scatter, rng, out):
    """The direction after a reflection: mirrored, or by Lambert's law."""
    if rng.random() >= scatter:
        out[:] = way - 2 * (way @ normal) * normal
        return
    while True:  # a point of the ball, put on the sphere, and the normal
        x, y, z = 2 * rng.random() - 1, 2 * rng.random() - 1, 2 * rng.random() - 1
        size = x * x + y * y + z * z
        if 1e-6 < size <= 1:
            break
    size = np.sqrt(size)
    out[0], out[1], out[2] = x / size, y / size, z / size
    out += side * normal
    out /= np.sqrt(out @ out) + 1e-12
