"""Seamless patterns of hard surfaces: floors, tiles, stone, walls. Numbers and lengths are for one square metre."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.textures import Color, Gray, Rgb, blend, canvas, grid, joint, noise, pixels, tones

Rng = np.random.Generator
Window = tuple[np.ndarray, ...]  # index of a part of an image: rows, columns


def scattered(rng: Rng, count: int, radius: float, numbers: int = 0) -> Iterator[tuple[Window, Gray, Gray, np.ndarray]]:
    """Generate random places and what is around them, with the image's edges joined.

    Args:
        rng: Source of randomness.
        count: Number of places per square metre.
        radius: Half of the edge of the part around each place [m].
        numbers: Number of random numbers for each place.

    Yields:
        Index of the part in the image, offsets of its pixels from the place to the right and down [m], and numbers
        in 0..1.
    """
    size, metres = canvas()
    reach = min(int(np.ceil(radius * size / metres)), (size - 1) // 2)
    steps = np.arange(-reach, reach + 1)
    for x, y, *more in rng.uniform(0, 1, (count * metres**2, 2 + numbers)):
        columns, rows = (int(at * size) + steps for at in (x, y))
        dx, dy = (((i + 0.5) / size - at) * metres for i, at in ((columns, x), (rows, y)))
        yield np.ix_(rows % size, columns % size), dx[None, :], dy[:, None], np.array(more)


def knotty(rng: Rng, dark: Color, light: Color, knots: int = 3, bands: int = 7) -> Rgb:
    """Draw wood with a strong level grain of `bands` periods that flows around knots."""
    _, v = pixels()
    flow = v + 0.03 * noise(rng, 50, 14)
    for part, dx, dy, _ in scattered(rng, knots, 0.4):
        flow[part] += 0.05 * np.sign(dy) * np.exp(-((dx / 0.12) ** 2) - (dy / 0.05) ** 2)
    return blend(dark, light, 0.5 + 0.28 * np.sin(2 * np.pi * bands * flow) + 0.12 * noise(rng, 25, 1))


def herringbone(rng: Rng, dark: Color, light: Color, count: int = 4) -> Rgb:
    """Draw parquet of blocks that meet at right angles, each 1 / (4 count) wide."""
    u, v = pixels()
    x, y = (u * 4 * count).astype(int), (v * 4 * count).astype(int)
    step = (x - y) % 8
    across = step < 4
    key = np.where(across, (y * 131 + (x - step) * 17), (x * 137 + (y - (7 - step)) * 29 + 7)) % 97
    tone = 0.5 + 0.2 * rng.standard_normal(97)[key] + 0.1 * noise(rng, 3, 3)
    fine = np.where(across, v * 4 * count % 1, u * 4 * count % 1)
    return blend(dark, light, tone) * np.where(np.minimum(fine, 1 - fine) < joint(0.07), 0.75, 1.0)[..., None]


def basket(rng: Rng, dark: Color, light: Color, count: int = 4, slats: int = 4) -> Rgb:
    """Draw count x count parquet squares whose slats run across those of their neighbours."""
    u, v = pixels()
    cell, edge = grid(count, count)
    row, column = np.divmod(cell, count * canvas().metres)
    odd = (row + column) % 2 == 1
    slat = (np.where(odd, u, v) * count * slats).astype(int)
    tone = 0.5 + 0.16 * rng.standard_normal(409)[(slat * 37 + cell * 11) % 409] + 0.1 * noise(rng, 4, 4)
    fine = (np.where(odd, u, v) * count * slats) % 1
    gap = (edge.min(-1) < joint(0.004)) | (np.minimum(fine, 1 - fine) < joint(0.05))
    return blend(dark, light, tone) * np.where(gap, 0.75, 1.0)[..., None]


def chevron(rng: Rng, dark: Color, light: Color, count: int = 4, rows: int = 10) -> Rgb:
    """Draw `rows` level zigzag bands, alternately dark and light, with `count` peaks."""
    u, v = pixels()
    zig = np.abs((u * count) % 1 - 0.5) * 2
    band = ((v * rows + zig * rows / count / 1.5) % rows).astype(int)
    tone = 0.25 + 0.5 * (band % 2) + 0.05 * noise(rng, 3, 3)
    return blend(dark, light, tone)


def subway(rng: Rng, dark: Color, light: Color, rows: int = 10, columns: int = 5, grout: float = 0.9) -> Rgb:
    """Draw oblong wall tiles in running bond; `grout` is the grey of the joints."""
    cell, edge = grid(rows, columns, shift=0.5)
    face = blend(dark, light, 0.6 + 0.14 * tones(rng, cell) + 0.03 * noise(rng, 5, 5))
    return np.where((edge.min(-1) < joint(0.005))[..., None], grout, face)


def mosaic(rng: Rng, palette: tuple[Color, ...], count: int = 20, grout: float = 0.88) -> Rgb:
    """Draw count x count square tiles in random colours; `grout` is the grey of the joints."""
    cell, edge = grid(count, count)
    face = np.asarray(palette)[rng.integers(0, len(palette), int(cell.max()) + 1)][cell]
    return np.where((edge.min(-1) < joint(0.005))[..., None], grout, face * (1 + 0.03 * noise(rng, 2, 2)[..., None]))


def hexagons(rng: Rng, dark: Color, light: Color, count: int = 6, line: float = 0.06) -> Rgb:
    """Draw a honeycomb of tiles, `count` side by side; `line` is the joint width over a tile."""
    u, v = pixels()
    x, y = u * count, v * count
    # The nearest two of all centres are among two of a row at full numbers and two of a row between.
    low, high = np.round(y), np.floor(y) + 0.5
    near = [(np.floor(x) + i, low) for i in (0, 1)] + [(np.floor(x + i - 0.5) + 0.5, high) for i in (0, 1)]
    distance = np.stack([np.hypot(x - a, (y - b) * 1.732) for a, b in near])
    first, second = np.partition(distance, 1, axis=0)[:2]
    around = 2 * count * canvas().metres
    keys = [(2 * a).astype(int) % around * around + (2 * b).astype(int) % around for a, b in near]
    face = blend(dark, light, 0.5 + 0.25 * tones(rng, np.choose(distance.argmin(axis=0), keys)))
    return np.where((second - first < joint(line))[..., None], 0.85, face)


def cement(rng: Rng, dark: Color, light: Color, accent: Color, count: int = 4) -> Rgb:
    """Draw patterned cement tiles: a star in a ring, the same in every tile."""
    u, v = pixels()
    x, y = (u * count) % 1 - 0.5, (v * count) % 1 - 0.5
    angle, radius = np.arctan2(y, x), np.hypot(x, y)
    image = blend(dark, light, 0.9 + 0.04 * noise(rng, 4, 4))
    image[radius < 0.26 + 0.1 * np.cos(4 * angle)] = dark
    image[radius < 0.13 + 0.05 * np.cos(4 * angle + np.pi)] = accent
    image[np.abs(np.hypot(np.abs(x) - 0.5, np.abs(y) - 0.5) - 0.2) < 0.035] = accent
    image[np.maximum(np.abs(x), np.abs(y)) > 0.492] = 0.8
    return image


def terrazzo(rng: Rng, ground: Color, chips: tuple[Color, ...], count: int = 260) -> Rgb:
    """Draw `count` stone chips in random colours in cement."""
    image = np.asarray(ground) + 0.012 * noise(rng, 1, 1)[..., None]
    for part, dx, dy, (size, turn, kind) in scattered(rng, count, 0.03, 3):
        a, b = dx * np.cos(6 * turn) + dy * np.sin(6 * turn), dy * np.cos(6 * turn) - dx * np.sin(6 * turn)
        chip = np.abs(a) + 1.6 * np.abs(b) < 0.008 + 0.018 * size**2
        image[part] = np.where(chip[..., None], chips[int(kind * len(chips))], image[part])
    return image


def marble(rng: Rng, dark: Color, light: Color, veins: float = 3.0) -> Rgb:
    """Draw polished stone with dark veins; about 2 x `veins` cross each row."""
    u, v = pixels()
    wave = np.sin(2 * np.pi * (np.round(veins) * u + 2 * v) + 1.6 * noise(rng, 18, 18) + 0.5 * noise(rng, 5, 5))
    return blend(dark, light, 1 - 0.8 * np.exp(-((wave / 0.12) ** 2)) - 0.15 * np.clip(noise(rng, 22, 22), 0, 1))


def flagstones(rng: Rng, dark: Color, light: Color, count: int = 14, mortar: Color = (0.45, 0.43, 0.40)) -> Rgb:
    """Draw `count` irregular slabs: Voronoi cells of random points."""
    size = canvas().size
    first, second, tone = np.full((size, size), 9.0), np.full((size, size), 9.0), np.zeros((size, size))
    for part, dx, dy, (shade,) in scattered(rng, count, 2.2 / np.sqrt(count), 1):
        distance, near = np.hypot(dx, dy), first[part]
        second[part] = np.minimum(second[part], np.maximum(distance, near))
        tone[part] = np.where(distance < near, 0.87 * shade - 0.43, tone[part])  # of the deviation of a quarter
        first[part] = np.minimum(distance, near)
    face = blend(dark, light, 0.5 + tone + 0.12 * noise(rng, 3, 3))
    return np.where((second - first < joint(0.018))[..., None], mortar, face)


def brushed(rng: Rng, dark: Color, light: Color, length: float = 60.0) -> Rgb:
    """Draw metal with fine level scratches of a `length` [pixels]."""
    return blend(dark, light, 0.5 + 0.16 * noise(rng, length, 1) + 0.08 * noise(rng, 40, 20))


def boards(rng: Rng, dark: Color, light: Color, count: int = 8, upright: bool = True) -> Rgb:
    """Draw panelling: `count` boards side by side, upright or level, with dark grooves."""
    u, v = pixels()
    along = u if upright else v
    board = (along * count).astype(int)
    fine = (along * count) % 1
    lengthwise = noise(rng, 2, 45) if upright else noise(rng, 45, 2)
    tone = 0.5 + 0.12 * tones(rng, board) + 0.12 * lengthwise
    return blend(dark, light, tone) * np.where(np.minimum(fine, 1 - fine) < joint(0.04), 0.6, 1.0)[..., None]


def shingles(rng: Rng, dark: Color, light: Color, rows: int = 6, columns: int = 8) -> Rgb:
    """Draw overlapping rounded roof tiles, each casting a shadow on the next."""
    u, v = pixels()
    cell, _ = grid(rows, columns, shift=0.5)
    fine = (v * rows) % 1
    x = (u * columns + 0.5 * ((v * rows).astype(int) % 2)) % 1 - 0.5
    tone = 0.5 + 0.18 * tones(rng, cell) + 0.35 * (fine - 0.5) - 0.8 * x**2
    return blend(dark, light, tone + 0.05 * noise(rng, 2, 2))
