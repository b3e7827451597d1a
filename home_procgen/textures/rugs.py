"""Designs of rugs; an image covers its whole rug once."""

import numpy as np

from home_procgen.primitives.textures import Color, Rgb, canvas, noise, pixels
from home_procgen.textures.patterns import Rng


def _pile(rng: Rng, image: Rgb) -> Rgb:
    return image * (0.97 + 0.04 * noise(rng, 1, 1)[..., None])


def _inward(u: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Return the distance from the edge of the image, 0..0.5."""
    return np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))


def persian(rng: Rng, field: Color, border: Color, accent: Color, light: Color) -> Rgb:
    """Draw a medallion, corner pieces, and borders of small motifs."""
    u, v = pixels()
    x, y, edge = u - 0.5, v - 0.5, _inward(u, v)
    angle, radius = np.arctan2(y, x), np.hypot(x, y)
    image = np.tile(np.asarray(field, float), (*[canvas().size] * 2, 1))
    image[np.sin(26 * np.pi * u) * np.sin(26 * np.pi * v) > 0.8] = light
    for size, color in ((0.27, border), (0.22, light), (0.2, accent), (0.13, field), (0.06, light)):
        image[radius < size * (1 + 0.12 * np.cos(8 * angle))] = color
    corner = np.hypot(0.5 - np.abs(x) - 0.14, 0.5 - np.abs(y) - 0.14)
    image[(corner < 0.2) & (np.sin(60 * corner) > -0.2)] = accent
    image[edge < 0.14] = border
    image[(edge < 0.14) & (np.sin(40 * np.pi * u) * np.sin(40 * np.pi * v) > 0.35)] = light
    for at in (0.14, 0.115, 0.03):
        image[np.abs(edge - at) < 0.007] = accent
    return _pile(rng, image)


def kilim(rng: Rng, colors: tuple[Color, ...], rows: int = 7) -> Rgb:
    """Draw `rows` rows of four stepped lozenges of rings in all colours."""
    u, v = pixels()
    row = (v * rows).astype(int)
    x = np.floor(np.abs((u * 4) % 1 - 0.5) * 16) / 16
    y = np.abs((v * rows) % 1 - 0.5)
    ring = ((x + y) * 5).astype(int)
    return _pile(rng, np.asarray(colors)[(ring + row) % len(colors)])


def framed(rng: Rng, field: Color, border: Color, lines: int = 2) -> Rgb:
    """Draw a plain field with a broad border and `lines` thin lines inside it."""
    u, v = pixels()
    edge = _inward(u, v)
    image = np.where((edge < 0.1)[..., None], border, field) * np.ones((*[canvas().size] * 2, 1))
    for i in range(lines):
        image[np.abs(edge - 0.14 - 0.04 * i) < 0.008] = border
    return _pile(rng, image)


def steps(rng: Rng, colors: tuple[Color, ...], across: int = 11) -> Rgb:
    """Draw `across` level stripes in random colours."""
    _, v = pixels()
    order = rng.integers(0, len(colors), across)
    return _pile(rng, np.asarray(colors)[order[(v * across).astype(int)]])


def berber(rng: Rng, ground: Color, line: Color) -> Rgb:
    """Draw a pale shaggy field with an irregular lattice."""
    u, v = pixels()
    a = (3 * u + 3 * v + 0.04 * noise(rng, 8, 8)) % 1
    b = (3 * u - 3 * v + 0.04 * noise(rng, 8, 8)) % 1
    near = np.minimum(np.abs(a - 0.5), np.abs(b - 0.5)) < 0.05
    return np.where(near[..., None], line, ground) * (0.95 + 0.06 * noise(rng, 1.4, 1.4)[..., None])


def abstract(rng: Rng, colors: tuple[Color, ...], blobs: int = 7) -> Rgb:
    """Draw `blobs` large overlapping shapes on a ground of the first colour."""
    u, v = pixels()
    image = np.tile(np.asarray(colors[0], float), (*[canvas().size] * 2, 1))
    for i, (x, y, size) in enumerate(rng.uniform(0, 1, (blobs, 3))):
        radius = np.hypot(u - x, v - y) + 0.05 * np.sin(3 * np.arctan2(v - y, u - x) + 9 * size)
        image[radius < 0.12 + 0.2 * size] = colors[1 + i % (len(colors) - 1)]
    return _pile(rng, image)


def rings(rng: Rng, colors: tuple[Color, ...], count: int = 9) -> Rgb:
    """Draw `count` rings of all colours in turn around the middle, for round rugs."""
    u, v = pixels()
    ring = (np.hypot(u - 0.5, v - 0.5) * 2 * count).astype(int)
    return _pile(rng, np.asarray(colors)[ring % len(colors)])


def town(rng: Rng) -> Rgb:
    """Draw a play rug: streets, houses and a pond on grass."""
    u, v = pixels()
    image = np.tile(np.array([0.42, 0.62, 0.36]), (*[canvas().size] * 2, 1))
    streets = np.minimum(np.abs((u * 3) % 1 - 0.5) / 3, np.abs((v * 2) % 1 - 0.5) / 2)
    for x, y, tone in rng.uniform(0.04, 0.94, (26, 3)):
        image[(np.abs(u - x) < 0.035) & (np.abs(v - y) < 0.035)] = (0.9, 0.45 + 0.4 * tone, 0.35)
    image[np.hypot(u - 0.36, (v - 0.5) * 0.8) < 0.09] = (0.4, 0.66, 0.85)
    image[streets < 0.045] = (0.45, 0.45, 0.47)
    image[(streets < 0.005) & (((u + v) * 30) % 1 < 0.5)] = 0.95
    return _pile(rng, image)
