"""Seamless patterns of fabrics and wallpapers. Numbers and lengths are for one square metre."""

import numpy as np

from home_procgen.primitives.textures import Color, Gray, Rgb, blend, canvas, noise, pixels
from home_procgen.textures.patterns import Rng, scattered


def _thread(rng: Rng) -> Gray:
    rows, columns = np.indices((canvas().size,) * 2) // 2
    return 0.06 * ((rows + columns) % 2) + 0.03 * noise(rng, 1, 6)


def plaid(rng: Rng, ground: Color, stripe: Color, line: Color, count: int = 4) -> Rgb:
    """Draw a tartan: `count` broad bands and thin lines per side, in both directions."""
    u, v = pixels()
    image = np.tile(np.asarray(ground, float), (*u.shape, 1))
    for t in (u, v):
        share = ((t * count) % 1)[..., None]
        image = np.where(share < 0.42, 0.5 * image + 0.5 * np.asarray(stripe), image)
        image = np.where(np.abs(share - 0.7) < 0.05, 0.45 * image + 0.55 * np.asarray(line), image)
    return image * (0.94 + _thread(rng)[..., None])


def gingham(rng: Rng, dark: Color, light: Color, count: int = 10) -> Rgb:
    """Draw checks of `count` crossing bands per side."""
    u, v = pixels()
    share = 0.5 * ((u * count) % 1 < 0.5) + 0.5 * ((v * count) % 1 < 0.5)
    return blend(dark, light, 1 - share + _thread(rng))


def houndstooth(rng: Rng, dark: Color, light: Color, count: int = 16) -> Rgb:
    """Draw `count` broken checks with teeth per side."""
    u, v = pixels()
    x, y = (u * count) % 1, (v * count) % 1
    teeth = ((x + y) * 4 % 1 < 0.5) & ((x < 0.5) != (y < 0.5))
    return blend(dark, light, np.where((x < 0.5) & (y < 0.5) | teeth, 0.05, 0.95) + _thread(rng) - 0.03)


def dots(rng: Rng, ground: Color, dot: Color, count: int = 12, size: float = 0.26) -> Rgb:
    """Draw staggered rows of `count` dots; `size` is their radius over their spacing."""
    u, v = pixels()
    row = (v * count).astype(int)
    x, y = (u * count + 0.5 * (row % 2)) % 1 - 0.5, (v * count) % 1 - 0.5
    image = blend(ground, dot, np.clip((size - np.hypot(x, y)) * 12, 0, 1))
    return image * (0.96 + _thread(rng)[..., None])


def bands(rng: Rng, colors: tuple[Color, ...], count: int = 3, upright: bool = True) -> Rgb:
    """Draw `count` repeats of stripes of all colours, the later ones wider, upright or level."""
    u, v = pixels()
    t = ((u if upright else v) * count) % 1
    edges = np.cumsum(np.linspace(1.0, 2.2, len(colors)))
    index = np.searchsorted(edges / edges[-1], t)
    return np.asarray(colors)[np.clip(index, 0, len(colors) - 1)] * (0.95 + _thread(rng)[..., None])


def knit(rng: Rng, dark: Color, light: Color, count: int = 20) -> Rgb:
    """Draw `count` rows of `count` V-shaped stitches."""
    u, v = pixels()
    x = np.abs((u * count) % 1 - 0.5)
    wave = np.sin(2 * np.pi * (v * count + 1.4 * x))
    return blend(dark, light, 0.55 + 0.35 * wave * (0.4 + x) - 0.5 * (x < 0.06) + 0.05 * noise(rng))


def cord(rng: Rng, dark: Color, light: Color, count: int = 32) -> Rgb:
    """Draw `count` upright ribs, as of corduroy."""
    u, _ = pixels()
    return blend(dark, light, 0.5 + 0.35 * np.sin(2 * np.pi * count * u) + 0.08 * noise(rng, 1, 8))


def terry(rng: Rng, dark: Color, light: Color, border: bool = False) -> Rgb:
    """Draw small loops, as of towels, with or without a woven border."""
    _, v = pixels()
    tone = 0.6 + 0.2 * noise(rng, 1.2, 1.2)
    if border:
        tone = np.where(np.abs(v % 1 - 0.85) < 0.05, 0.1 + 0.1 * (np.abs(v % 1 - 0.85) < 0.02), tone)
    return blend(dark, light, tone)


def melange(rng: Rng, dark: Color, light: Color) -> Rgb:
    """Draw soft flecks of mixed yarns."""
    return blend(dark, light, 0.5 + 0.16 * noise(rng, 2.5, 1) + 0.16 * noise(rng, 1, 2.5) + 0.05 * noise(rng, 20, 20))


def petals(rng: Rng, ground: Color, bloom: Color, green: Color, count: int = 16, size: float = 0.05) -> Rgb:
    """Draw `count` scattered flowers with leaves; `size` is about their radius [m]."""
    image = np.asarray(ground) * (0.98 + 0.01 * noise(rng, 2, 2)[..., None])
    for part, dx, dy, (turn, scale, tips) in scattered(rng, count, 2.3 * size, 3):
        radius, angle = np.hypot(dx, dy), np.arctan2(dy, dx) + 6.28 * turn
        r = size * (0.7 + 0.6 * scale)
        found = image[part]
        found[radius < 1.7 * r * np.abs(np.cos(1.5 * angle + 1)) ** 6] = green
        found[radius < r * (0.6 + 0.4 * np.abs(np.cos((2 + int(tips * 2)) * angle)))] = bloom
        found[radius < 0.28 * r] = np.clip(np.asarray(bloom) * 0.5 + (0.45, 0.38, 0.1), 0, 1)
        image[part] = found
    return image


def vines(rng: Rng, ground: Color, green: Color, count: int = 4) -> Rgb:
    """Draw `count` upright winding stems with pairs of leaves."""
    u, v = pixels()
    image = np.asarray(ground) * (0.98 + 0.01 * noise(rng, 2, 2)[..., None])
    for column in range(count):
        stem = (column + 0.5) / count + 0.03 * np.sin(2 * np.pi * (2 * v + column / count))
        off = (u - stem + 0.5) % 1 - 0.5
        image[np.abs(off) < 0.005] = np.asarray(green) * 0.8
        y = (v * 10 + 0.5 * column) % 1 - 0.5
        leaf = (y - np.abs(off) * 7 + 0.2) ** 2 * 6 + ((np.abs(off) - 0.032) / 0.03) ** 2
        image[leaf < 1] = green
    return image


def damask(rng: Rng, dark: Color, light: Color, count: int = 3) -> Rgb:
    """Draw large symmetric ornaments, `count` per side and as many between them."""
    u, v = pixels()
    total = np.zeros(u.shape)
    for shift in (0.0, 0.5):
        x, y = (u * count + shift) % 1 - 0.5, (v * count + shift) % 1 - 0.5
        radius, angle = np.hypot(x, y * 0.8), np.arctan2(y, np.abs(x))
        total += radius < 0.27 + 0.11 * np.cos(5 * angle) - 0.05 * np.cos(9 * angle)
        total -= (radius < 0.17 + 0.07 * np.cos(5 * angle)) & (radius > 0.1)
    return blend(dark, light, np.clip(total, 0, 1) * 0.85 + 0.03 * noise(rng))


def diamonds(rng: Rng, dark: Color, light: Color, line: Color, count: int = 6) -> Rgb:
    """Draw argyle lozenges, `count` pairs per side, under thin crossing lines."""
    u, v = pixels()
    a, b = (u * count + v * count / 1.5 * 1.5) % 2, (u * count - v * count) % 2
    image = blend(dark, light, np.where((a < 1) == (b < 1), 0.1, 0.9) + _thread(rng))
    crossing = np.minimum(np.abs((a + 0.5) % 1 - 0.5), np.abs((b + 0.5) % 1 - 0.5)) < 0.04
    return np.where(crossing[..., None], line, image)


def fans(rng: Rng, dark: Color, light: Color, count: int = 6) -> Rgb:
    """Draw overlapping scallops of rings, `count` side by side, in art deco style."""
    u, v = pixels()
    image = np.zeros(u.shape)
    for row in range(-1, 2 * count * canvas().metres + 2):
        band = np.abs(v[:, 0] * count - row / 2) < 0.5  # the rows of pixels that it may reach
        x, y = (u[band] * count + 0.5 * (row % 2)) % 1 - 0.5, v[band] * count - row / 2
        radius = np.hypot(x, y) * 2
        inside = (radius < 1) & (y < 0.02)
        image[band] = np.where(inside, (radius * 5 % 1 < 0.6) * (1 - 0.4 * (radius > 0.93)), image[band])
    return blend(dark, light, image * 0.9 + 0.03 * noise(rng))


def triangles(rng: Rng, palette: tuple[Color, ...], count: int = 6) -> Rgb:
    """Draw two triangles in each of count x count cells, in random colours."""
    u, v = pixels()
    x, y = u * count, v * count
    key = (x.astype(int) * 2 + ((x % 1) + (y % 1) > 1)) * 64 + y.astype(int)
    return np.asarray(palette)[rng.integers(0, len(palette), 4096)][key] * (0.98 + 0.02 * noise(rng)[..., None])


def leaves(rng: Rng, ground: Color, greens: tuple[Color, ...], count: int = 40, size: float = 0.12) -> Rgb:
    """Draw `count` large overlapping leaves, as of a jungle; `size` is about half their length [m]."""
    image = np.tile(np.asarray(ground, float), (canvas().size,) * 2 + (1,))
    for part, dx, dy, (turn, scale, kind) in scattered(rng, count, 1.4 * size, 3):
        a, b = dx * np.cos(6.28 * turn) + dy * np.sin(6.28 * turn), dy * np.cos(6.28 * turn) - dx * np.sin(6.28 * turn)
        r = size * (0.6 + 0.8 * scale)
        inside = (np.abs(a) < r) & (np.abs(b) < 0.35 * r * np.cos(np.clip(a / r, -1, 1) * np.pi / 2) ** 0.8)
        color = np.asarray(greens[int(kind * len(greens))])
        veins = inside & ((np.abs(b) < 0.004) | (((np.abs(b) * 1.2 + a) / r * 6) % 1 < 0.12))
        image[part] = np.where(veins[..., None], color * 1.25, np.where(inside[..., None], color, image[part]))
    return np.clip(image, 0, 1)


def cane(rng: Rng, dark: Color, light: Color, count: int = 32) -> Rgb:
    """Draw woven rattan, `count` strips per side, with dark holes."""
    u, v = pixels()
    x, y = (u * count) % 1 - 0.5, (v * count) % 1 - 0.5
    row, column = (v * count).astype(int), (u * count).astype(int)
    over = np.where((row + column) % 2 == 0, np.cos(np.pi * x), np.cos(np.pi * y))
    return blend(dark, light, 0.1 + 0.8 * over + 0.08 * noise(rng, 2, 2))


def fur(rng: Rng, dark: Color, light: Color) -> Rgb:
    """Draw a long soft pile."""
    return blend(dark, light, 0.5 + 0.22 * noise(rng, 1.2, 7) + 0.15 * noise(rng, 6, 12))
