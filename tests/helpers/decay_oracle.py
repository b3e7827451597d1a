"""Monte Carlo of sound among blocks: an oracle of decays, written apart from the engine.

Particles fly from the source, lose energy to air and walls, and are reflected, mirrored or by Lambert's law, with each
octave's own scattering. What a receiver hears is the energy density in a ball: every segment inside it counts by its
length, whatever brought it there, so nothing depends on how reflections are sorted; only the direct sound, whose mean
over the ball is not that at its middle, is put in by formula. Energies are re the free field of the source at 1 m.
"""

import math
from dataclasses import dataclass

import numba as nb
import numpy as np

SPEED = 343.2139  # [m/s], at 20 °C
QUIET = 1e-9  # share of its energy at which a particle ends


@dataclass(frozen=True)
class Blocks:
    """Solid boxes along the axes, each with its own surface.

    Attributes:
        low: (n, 3) [m].
        high: (n, 3) [m].
        absorption: (n, bands), energy fractions.
        scattering: (n, bands), energy fractions.
        air: (bands,), the m of exp(−m r) for energy [1/m].
    """

    low: np.ndarray
    high: np.ndarray
    absorption: np.ndarray
    scattering: np.ndarray
    air: np.ndarray


@dataclass(frozen=True)
class Heard:
    """What a run gave.

    Attributes:
        energy: (receivers, bands, k), per time bin, re the free field at 1 m.
        way: (receivers, bands, k, 3), the same times the directions in which it flies, without the direct sound.
        reflections: (bands,), mean number of reflections per particle.
        path: (bands,), mean distance that a particle flew [m].
        left: (bands, k), energy of all particles at the start of each bin, 1 at time 0.
    """

    energy: np.ndarray
    way: np.ndarray
    reflections: np.ndarray
    path: np.ndarray
    left: np.ndarray


def fly(
    blocks: Blocks,
    source: np.ndarray,
    receivers: np.ndarray,
    seconds: float,
    bin_seconds: float = 0.004,
    particles: int = 4000,
    radius: float = 0.35,
    seed: int = 0,
    direct: bool = True,
    axis: np.ndarray | None = None,
    weight: float = 0.0,
    exponent: float = 1.0,
) -> Heard:
    """Runs the particles of all octaves.

    Args:
        blocks: What they meet.
        source: (3,) [m].
        receivers: (r, 3) [m]; balls around them must be free of blocks.
        seconds: For which they fly.
        bin_seconds: Time bin.
        particles: Per octave.
        radius: Of the balls [m].
        seed: Of the random numbers.
        direct: Whether the direct sound is added, to receivers that the source sees.
        axis: (3,), unit vector along which a directional source points.
        weight: w of its pressure |1 - w + w cos θ|ⁿ.
        exponent: n.
    """
    pattern = np.array([1.0, 0, 0] if axis is None else axis, float), float(weight), float(exponent)
    count, bins = blocks.absorption.shape[1], round(seconds / bin_seconds)
    source, receivers = np.asarray(source, float), np.ascontiguousarray(receivers, float)
    box = (np.ascontiguousarray(blocks.low, float), np.ascontiguousarray(blocks.high, float))
    energy, left = np.zeros((len(receivers), count, bins)), np.zeros((count, bins))
    way = np.zeros((*energy.shape, 3))
    tally = np.zeros((count, 2))
    for band in range(count):
        walls = blocks.absorption[:, band].astype(float), blocks.scattering[:, band].astype(float)
        numbers = (
            float(blocks.air[band]),
            bin_seconds * SPEED,
            bins,
            particles,
            radius,
            np.random.default_rng((seed, band)),
            *pattern,
        )
        found = _fly(*box, *walls, source, receivers, *numbers)
        energy[:, band], way[:, band], left[band], tally[band] = found
    if direct:
        energy += _direct(blocks, source, receivers, bins, bin_seconds, *pattern)
    return Heard(energy, way, tally[:, 0] / particles, tally[:, 1] / particles, left)


def sees(blocks: Blocks, start: np.ndarray, end: np.ndarray) -> bool:
    """Whether no block lies between two points."""
    way = np.asarray(end, float) - start
    length = float(np.linalg.norm(way))
    met, _, _ = _meet(
        np.asarray(blocks.low, float), np.asarray(blocks.high, float), np.asarray(start, float), way / length
    )
    return met >= length


def _direct(
    blocks: Blocks,
    source: np.ndarray,
    receivers: np.ndarray,
    bins: int,
    bin_seconds: float,
    axis: np.ndarray,
    weight: float,
    exponent: float,
) -> np.ndarray:
    energy = np.zeros((len(receivers), len(blocks.air), bins))
    for row, point in enumerate(receivers):
        distance = float(np.linalg.norm(point - source))
        at = int(distance / SPEED / bin_seconds)
        if at < bins and sees(blocks, source, point):
            toward = abs(1 - weight + weight * float((point - source) @ axis) / distance) ** (2 * exponent)
            energy[row, :, at] = toward * np.exp(-blocks.air * distance) / distance**2
    return energy


@nb.njit(cache=True)
def _meet(low, high, point, way):
    """Distance to the nearest block, its number, and the axis of the face."""
    nearest, block, face = 1e30, -1, 0
    for i in range(low.shape[0]):
        enter, leave, axis = -1e30, 1e30, 0
        for a in range(3):
            if abs(way[a]) < 1e-12:
                if point[a] <= low[i, a] or point[a] >= high[i, a]:
                    enter = 1e30
                continue
            near, far = (low[i, a] - point[a]) / way[a], (high[i, a] - point[a]) / way[a]
            if near > far:
                near, far = far, near
            if near > enter:
                enter, axis = near, a
            leave = min(leave, far)
        if enter < leave and 1e-9 < enter < nearest:
            nearest, block, face = enter, i, axis
    return nearest, block, face


@nb.njit(cache=True)
def _hear(energy, flow, receivers, point, way, length, begin, left, air, per_bin, radius, scale):
    """Adds the parts of one segment that lie within each ball, split at the edges of bins."""
    for r in range(receivers.shape[0]):
        middle, square = 0.0, 0.0
        for a in range(3):
            offset = receivers[r, a] - point[a]
            middle += offset * way[a]
            square += offset * offset
        half = radius * radius - (square - middle * middle)
        if half <= 0:
            continue
        half = math.sqrt(half)
        start, stop = max(middle - half, 0.0), min(middle + half, length)
        while start < stop:
            k = int((begin + start) / per_bin + 1e-9)
            end = min((k + 1) * per_bin - begin, stop)
            if end <= start:
                break
            if k < energy.shape[1]:
                heard = scale * left * (end - start) * math.exp(-air * 0.5 * (start + end))
                energy[r, k] += heard
                for a in range(3):
                    flow[r, k, a] += heard * way[a]
            start = end


@nb.njit(cache=True)
def _turn(way, face, scatter, rng):
    """The direction after a reflection: mirrored, or by Lambert's law."""
    side = -1.0 if way[face] > 0 else 1.0
    if rng.random() >= scatter:
        way[face] = -way[face]
        return
    height = math.sqrt(rng.random())  # the cosine of Lambert's law
    angle = 2 * math.pi * rng.random()
    flat = math.sqrt(max(0.0, 1 - height * height))
    way[(face + 1) % 3], way[(face + 2) % 3] = flat * math.cos(angle), flat * math.sin(angle)
    way[face] = side * height


@nb.njit(cache=True)
def _fly(
    low, high, absorption, scattering, source, receivers, air, per_bin, bins, particles, radius, rng, axis, weight, n
):
    """One octave."""
    energy, remaining, tally = np.zeros((receivers.shape[0], bins)), np.zeros(bins), np.zeros(2)
    flow = np.zeros((receivers.shape[0], bins, 3))
    scale = 4 * math.pi / (4 / 3 * math.pi * radius**3) / particles
    point, way = np.zeros(3), np.zeros(3)
    for i in range(particles):
        z = 2 * (i + rng.random()) / particles - 1
        angle, ring = 2 * math.pi * rng.random(), math.sqrt(max(0.0, 1 - z * z))
        way[0], way[1], way[2] = ring * math.cos(angle), ring * math.sin(angle), z
        for a in range(3):
            point[a] = source[a]
        cosine = way[0] * axis[0] + way[1] * axis[1] + way[2] * axis[2]
        left, flown, bounces = abs(1 - weight + weight * cosine) ** (2 * n), 0.0, 0
        while flown < bins * per_bin and left > QUIET:
            length, block, face = _meet(low, high, point, way)
            if block < 0:
                break
            if bounces > 0:
                _hear(energy, flow, receivers, point, way, length, flown, left, air, per_bin, radius, scale)
            for k in range(math.ceil(flown / per_bin), min(math.ceil((flown + length) / per_bin), bins)):
                remaining[k] += left * math.exp(-air * (k * per_bin - flown)) / particles
            for a in range(3):
                point[a] += length * way[a]
            point[face] = low[block, face] if way[face] > 0 else high[block, face]
            flown += length
            left *= math.exp(-air * length) * (1 - absorption[block])
            _turn(way, face, scattering[block], rng)
            bounces += 1
        tally[0] += bounces
        tally[1] += flown
    return energy, flow, remaining, tally
