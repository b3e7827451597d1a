"""Rooms whose sound is known: the same one as a house of the engine and as blocks of the oracle."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from decay_oracle import Blocks
from handmade import THICKNESS, Slab, _architecture_rows, _join_planes, _room_planes, _rooms, build_house, shoebox

from home_mjx.audio_jax.base.config import AudioConfig
from home_mjx.audio_jax.propagation.paths import air_attenuation
from home_mjx.schema.compiled import CompiledHouse, Planes

DOOR = (0.9, 2.05)  # [m], width and height of the opening between two rooms
LEAF = 0.01  # [m], half the thickness of the wall between


@dataclass(frozen=True)
class KnownRoom:
    """A room, or two.

    Attributes:
        name: Of the case.
        house: For the engine.
        blocks: For the oracle.
        source: [m].
        listeners: (n, 3) [m].
        volume: [m³], of all rooms.
    """

    name: str
    house: CompiledHouse
    blocks: Blocks
    source: np.ndarray
    listeners: np.ndarray
    volume: float


LISTENERS = np.array([[1, 1, 1.6], [-2, 1.5, 1], [2, -1.5, 2], [0, 0, 1.5], [2.2, 1.7, 0.8], [-2.2, -1.6, 2.2]])
SOURCE = np.array([-1.0, -1.0, 1.2])
# Octaves 125 .. 8000 Hz, after Vorländer, Auralization, 2008
STAGE = [0.10, 0.07, 0.06, 0.06, 0.06, 0.06, 0.06]
GYPSUM = [0.15, 0.10, 0.06, 0.04, 0.04, 0.05, 0.05]
BOARD = [0.20, 0.15, 0.10, 0.08, 0.04, 0.02, 0.02]
CARPET = [0.08, 0.08, 0.30, 0.60, 0.75, 0.80, 0.80]
CURTAIN = [0.30, 0.45, 0.65, 0.56, 0.59, 0.71, 0.71]
RISING = [0.05, 0.06, 0.07, 0.09, 0.12, 0.17, 0.24]  # scattering of surfaces 1 cm deep


def box_room(name: str, size: Sequence[float], absorption: object, scattering: object) -> KnownRoom:
    """One closed room; absorption and scattering broadcast to six slabs and seven octaves, as in `shoebox`."""
    house = shoebox((size[0], size[1], size[2]), np.asarray(absorption, float), np.asarray(scattering, float))
    scale = np.asarray(size) / [6, 5, 3]
    slabs = _box((-size[0] / 2, -size[1] / 2, 0), (size[0] / 2, size[1] / 2, size[2]))
    blocks = _blocks(slabs, absorption, scattering)
    return KnownRoom(name, house, blocks, SOURCE * scale, LISTENERS * scale, float(np.prod(size)))


def even() -> KnownRoom:
    """Absorption 0.2 everywhere."""
    return box_room("even", (6.0, 5.0, 3.0), 0.2, 0.3)


def uneven() -> KnownRoom:
    """A floor of absorption 0.6, elsewhere 0.03; scattering 0.1."""
    return box_room("uneven", (6.0, 5.0, 3.0), np.array([[0.03]] * 4 + [[0.6], [0.03]]), 0.1)


def rising() -> KnownRoom:
    """The same with a scattering that rises with frequency."""
    return box_room("rising scattering", (6.0, 5.0, 3.0), np.array([[0.03]] * 4 + [[0.6], [0.03]]), np.array([RISING]))


def household(soft: bool) -> KnownRoom:
    """A stage floor, walls of plasterboard, a ceiling on battens; soft: with a carpet and a curtain along one wall."""
    rows = np.array([GYPSUM] * 4 + [STAGE, BOARD])
    if soft:
        rows[0], rows[4] = CURTAIN, CARPET
    return box_room("carpet and curtain" if soft else "bare room", (5.0, 4.0, 2.5), rows, 0.1)


def coupled() -> KnownRoom:
    """10 x 4 x 2.7 m, split at x = 6 m, absorption 0.35 and 0.05, with an open doorway between; scattering 0.3.

    The source and three listeners are in the first room, three in the other.
    """
    source = np.array([2.0, -0.6, 1.4])
    listeners = np.array([[1, 1, 1.6], [3, -1.2, 1.0], [4.5, 1.3, 1.9], [7, 1.2, 1.5], [8.2, -1.1, 1.0], [9.3, 1, 1.8]])
    return two_coupled("coupled", (10.0, 4.0, 2.7), 6.0, (0.35, 0.05), source, listeners)


def small_coupled() -> KnownRoom:
    """9 x 5 x 2.5 m, split at x = 3.5 m: the source is in the smaller room, absorption 0.3, in the other it is 0.06."""
    source = np.array([1.1, 0.9, 1.5])
    listeners = np.array(
        [[2.4, -1, 1.3], [0.7, -1.7, 1.8], [2.8, 1.9, 1.1], [5, 1.5, 1.6], [6.7, -1.4, 1], [8.2, 0, 1.9]]
    )
    return two_coupled("small coupled", (9.0, 5.0, 2.5), 3.5, (0.3, 0.06), source, listeners)


def two_coupled(
    name: str,
    size: tuple[float, float, float],
    split: float,
    absorption: tuple[float, float],
    source: np.ndarray,
    listeners: np.ndarray,
) -> KnownRoom:
    """Two rooms along x with an open doorway in the middle of the wall between; scattering 0.3.

    Args:
        name: Of the case.
        size: Of both together [m].
        split: Where the wall is [m].
        absorption: Of each room.
        source: [m].
        listeners: [m], first those of the first room.
    """
    length, height, half, scattering = size[0], size[2], size[1] / 2, 0.3
    corners = [((0.0, -half), (split - LEAF, half)), ((split + LEAF, -half), (length, half))]
    slabs, rows, planes = [], [], []
    for room, ((x0, y0), (x1, y1)) in enumerate(corners):
        shell = _box((x0, y0, 0.0), (x1, y1, height))
        inner = 1 - room  # +x of the first room, -x of the second: the wall with the door
        outer = [_clipped(s, split, room) for i, s in enumerate(shell) if i != inner]
        slabs += [*outer, *_around_door(shell[inner], (x0, x1)[inner], split, half, height)]
        rows += [absorption[room]] * (len(outer) + 3)
        planes.append((room, (x0, y0), (x1, y1)))
    rows = np.repeat(np.array(rows)[:, None], 7, axis=1)
    parts = [Slab(tuple(low), tuple(high), "wall", i, 0 if i < 8 else 1) for i, (low, high) in enumerate(slabs)]
    mirror = [_without_door(_room_planes(a, b, height, 0), 8 * r, r) for r, a, b in planes]
    table = _architecture_rows(parts, rows, scattering, 0.0)
    house = build_house(name, parts, table, _rooms(corners, height), _join_planes(mirror))
    blocks = _blocks(slabs, rows, scattering)
    return KnownRoom(name, house, blocks, source, listeners, float(np.prod(size)))


def _clipped(slab: tuple[np.ndarray, np.ndarray], split: float, room: int) -> tuple[np.ndarray, np.ndarray]:
    """A slab that ends where the other room's begins."""
    low, high = slab[0].copy(), slab[1].copy()
    (high if room == 0 else low)[0] = (min(high[0], split), max(low[0], split))[room]
    return low, high


def _without_door(planes: Planes, first: int, room: int) -> Planes:
    """Rows of a coupled room's slabs for its planes; its wall with the door mirrors nothing, having a hole."""
    kept = np.array([i for i in range(6) if i != 1 - room])
    fields = {n: getattr(planes, n)[kept] for n in ("center", "normal", "axis_u", "axis_v")}
    return Planes(**fields, material=first + np.arange(5))


def _box(low: Sequence[float], high: Sequence[float]) -> list[tuple[np.ndarray, np.ndarray]]:
    """Slabs around a room: -x, +x, -y, +y, floor, ceiling."""
    slabs = []
    for axis in range(3):
        for side in (0, 1):
            a, b = np.array(low, float) - THICKNESS, np.array(high, float) + THICKNESS
            if side:
                a[axis] = high[axis]
            else:
                b[axis] = low[axis]
            slabs.append((a, b))
    return slabs


def _around_door(slab: tuple, inner: float, split: float, half: float, height: float) -> list:
    """Three slabs from a room's side of the wall to its middle: left and right of the door, and above it."""
    x0, x1 = min(inner, split), max(inner, split)
    width, top = DOOR[0] / 2, DOOR[1]
    spans = [((-half, 0.0), (-width, height)), ((width, 0.0), (half, height)), ((-width, top), (width, height))]
    t = THICKNESS
    out = []
    for (y0, z0), (y1, z1) in spans:
        low = (x0, y0 - t * (y0 == -half), z0 - t * (z0 == 0))
        high = (x1, y1 + t * (y1 == half), z1 + t * (z1 == height))
        out.append((np.array(low), np.array(high)))
    return out


def _blocks(slabs: Sequence[tuple], absorption: object, scattering: object) -> Blocks:
    shape = (len(slabs), 7)
    low, high = np.array([s[0] for s in slabs]), np.array([s[1] for s in slabs])
    values = [np.broadcast_to(np.asarray(v, float), shape).copy() for v in (absorption, scattering)]
    return Blocks(low, high, *values, air_attenuation(AudioConfig()).astype(float))
