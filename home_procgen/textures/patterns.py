"""Seamless patterns of hard surfaces: floors, tiles, stone, walls. One image covers one square metre."""

import numpy as np

from home_procgen.primitives.textures import TEXTURE_SIZE, Color, Gray, Rgb, blend, grid, noise

Rng = np.random.Generator


def pixels() -> tuple[Gray, Gray]:
    """Return the coordinates (row, column) of pixel centres, u to the right and v down, in 0..1."""
    line = (np.arange(TEXTURE_SIZE) + 0.5) / TEXTURE_SIZE
    v, u = np.meshgrid(line, line, indexing="ij")
    return u, v


def knotty(rng: Rng, dark: Color, light: Color, knots: int = 3, bands: int = 7) -> Rgb:
    """Draw wood with a strong level grain of `bands` periods that flows around knots."""
    u, v = pixels()
    flow = v + 0.03 * noise(rng, 50, 14)
    for x, y in rng.uniform(0, 1, (knots, 2)):
        dx, dy = (u - x + 0.5) % 1 - 0.5, (v - y + 0.5) % 1 - 0.5
        flow = flow + 0.05 * np.sign(dy) * np.exp(-((dx / 0.12) ** 2) - (dy / 0.05) ** 2)
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
    return blend(dark, light, tone) * np.where(np.minimum(fine, 1 - fine) < 0.07, 0.75, 1.0)[..., None]


def basket(rng: Rng, dark: Color, light: Color, count: int = 4, slats: int = 4) -> Rgb:
    """Draw count x count parquet squares whose slats run across those of their neighbours."""
    u, v = pixels()
    cell, edge = grid(count, count)
    odd = (cell // count + cell % count) % 2 == 1
    slat = (np.where(odd, u, v) * count * slats).astype(int)
    tone = 0.5 + 0.16 * rng.standard_normal(409)[(slat * 37 + cell * 11) % 409] + 0.1 * noise(rng, 4, 4)
    fine = (np.where(odd, u, v) * count * slats) % 1
    joint = (edge.min(-1) < 0.004) | (np.minimum(fine, 1 - fine) < 0.05)
    return blend(dark, light, tone) * np.where(joint, 0.75, 1.0)[..., None]


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
    face = blend(dark, light, 0.6 + 0.14 * rng.standard_normal(rows * columns)[cell] + 0.03 * noise(rng, 5, 5))
    return np.where((edge.min(-1) < 0.005)[..., None], grout, face)


def mosaic(rng: Rng, palette: tuple[Color, ...], count: int = 20, grout: float = 0.88) -> Rgb:
    """Draw count x count square tiles in random colours; `grout` is the grey of the joints."""
    cell, edge = grid(count, count)
    face = np.asarray(palette)[rng.integers(0, len(palette), count * count)][cell]
    return np.where((edge.min(-1) < 0.005)[..., None], grout, face * (1 + 0.03 * noise(rng, 2, 2)[..., None]))


def hexagons(rng: Rng, dark: Color, light: Color, count: int = 6, line: float = 0.06) -> Rgb:
    """Draw a honeycomb of tiles, `count` side by side; `line` is the joint width over a tile."""
    u, v = pixels()
    x, y = u * count, v * count
    near = []
    for row in range(-1, 2 * count + 2):
        centres = np.arange(-1, count + 2) + 0.5 * (row % 2)
        keys = (2 * centres).astype(int) % (2 * count) * 64 + row % (2 * count)
        near += [(np.hypot(x - c, (y - row / 2) * 1.732), key) for c, key in zip(centres, keys.tolist(), strict=True)]
    distance = np.stack([d for d, _ in near])
    order = np.argsort(distance, 0)[:2]
    first, second = np.take_along_axis(distance, order, 0)
    key = np.array([k for _, k in near])[order[0]]
    face = blend(dark, light, 0.5 + 0.25 * rng.standard_normal(8192)[key])
    return np.where((second - first < line)[..., None], 0.85, face)


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
    u, v = pixels()
    image = np.asarray(ground) + 0.012 * noise(rng, 1, 1)[..., None]
    for x, y, size, turn, kind in rng.uniform(0, 1, (count, 5)):
        dx, dy = (u - x + 0.5) % 1 - 0.5, (v - y + 0.5) % 1 - 0.5
        a, b = dx * np.cos(6 * turn) + dy * np.sin(6 * turn), dy * np.cos(6 * turn) - dx * np.sin(6 * turn)
        image[np.abs(a) + 1.6 * np.abs(b) < 0.008 + 0.018 * size**2] = chips[int(kind * len(chips))]
    return image


def marble(rng: Rng, dark: Color, light: Color, veins: float = 3.0) -> Rgb:
    """Draw polished stone with dark veins; about 2 x `veins` cross each row."""
    u, v = pixels()
    wave = np.sin(2 * np.pi * (np.round(veins) * u + 2 * v) + 1.6 * noise(rng, 18, 18) + 0.5 * noise(rng, 5, 5))
    return blend(dark, light, 1 - 0.8 * np.exp(-((wave / 0.12) ** 2)) - 0.15 * np.clip(noise(rng, 22, 22), 0, 1))


def flagstones(rng: Rng, dark: Color, light: Color, count: int = 14, joint: Color = (0.45, 0.43, 0.40)) -> Rgb:
    """Draw `count` irregular slabs: Voronoi cells of random points."""
    u, v = pixels()
    points = rng.uniform(0, 1, (count, 2))
    dx = np.abs((u[..., None] - points[:, 0] + 0.5) % 1 - 0.5)
    dy = np.abs((v[..., None] - points[:, 1] + 0.5) % 1 - 0.5)
    distance = np.hypot(dx, dy)
    order = np.argsort(distance, -1)[..., :2]
    first, second = np.moveaxis(np.take_along_axis(distance, order, -1), -1, 0)
    tone = 0.5 + 0.25 * rng.standard_normal(count)[order[..., 0]] + 0.12 * noise(rng, 3, 3)
    return np.where((second - first < 0.018)[..., None], joint, blend(dark, light, tone))


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
    tone = 0.5 + 0.12 * rng.standard_normal(count)[board] + 0.12 * lengthwise
    return blend(dark, light, tone) * np.where(np.minimum(fine, 1 - fine) < 0.04, 0.6, 1.0)[..., None]


def shingles(rng: Rng, dark: Color, light: Color, rows: int = 6, columns: int = 8) -> Rgb:
    """Draw overlapping rounded roof tiles, each casting a shadow on the next."""
    u, v = pixels()
    cell, _ = grid(rows, columns, shift=0.5)
    fine = (v * rows) % 1
    x = (u * columns + 0.5 * ((v * rows).astype(int) % 2)) % 1 - 0.5
    tone = 0.5 + 0.18 * rng.standard_normal(rows * columns)[cell] + 0.35 * (fine - 0.5) - 0.8 * x**2
    return blend(dark, light, tone + 0.05 * noise(rng, 2, 2))
