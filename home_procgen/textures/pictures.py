"""Pictures for frames: landscapes, still lifes, abstracts, portraits, maps, posters."""

import numpy as np

from home_procgen.primitives.textures import Color, Rgb, blend, canvas, noise, pixels
from home_procgen.textures.patterns import Rng


def _canvas(color: Color) -> Rgb:
    return np.tile(np.asarray(color, float), (*[canvas().size] * 2, 1))


def _random_color(rng: Rng, low: float = 0.1, high: float = 0.95) -> np.ndarray:
    return rng.uniform(low, high, 3)


def _sky(rng: Rng, top: Color, low: Color) -> Rgb:
    _, v = pixels()
    clouds = np.clip(noise(rng, 22, 6), 0, 2)[..., None] * 0.13
    return np.clip(blend(top, low, v * 1.5) + clouds * np.clip(1 - 2 * v, 0, 1)[..., None], 0, 1)


def hills(rng: Rng, top: Color, low: Color, ground: Color, rows: int = 5) -> Rgb:
    """Draw `rows` ranges of hills, paler with distance, under a sky."""
    u, v = pixels()
    image = _sky(rng, top, low)
    for i in range(rows):
        line = 0.42 + 0.12 * i
        for k in (1, 2, 4):
            line = line + rng.normal(0, 0.05 / k) * np.sin(2 * np.pi * (k * u + rng.uniform()))
        share = (i + 1) / rows
        image[v > line] = np.asarray(low) * (1 - share) + np.asarray(ground) * share
    return image


def sea(rng: Rng, top: Color, low: Color, water: Color, boat: bool = True) -> Rgb:
    """Draw the sea under the sun, with a sailing boat if `boat`."""
    u, v = pixels()
    image = _sky(rng, top, low)
    x = rng.uniform(0.3, 0.7)
    image[np.hypot(u - x, v - 0.42) < 0.09] = (1.0, 0.9, 0.6)
    glitter = 0.25 * np.clip(noise(rng, 6, 1), 0, 2) * np.exp(-(((u - x) / 0.12) ** 2))
    image = np.where((v > 0.5)[..., None], blend(water, (1.0, 0.95, 0.8), glitter + 0.1 * noise(rng, 14, 1)), image)
    if boat:
        s = rng.uniform(0.15, 0.8)
        image[(v > 0.36) & (v < 0.54) & (u > s) & (u < s + (v - 0.36) * 0.6)] = 0.97
        image[(np.abs(v - 0.555) < 0.012) & (np.abs(u - s - 0.03) < 0.09 - (v - 0.54))] = (0.35, 0.2, 0.12)
    return image


def mountains(rng: Rng, top: Color, low: Color, rock: Color) -> Rgb:
    """Draw snowy peaks above a forest."""
    u, v = pixels()
    image = _sky(rng, top, low)
    for x, height, wide in ((0.25, 0.34, 0.9), (0.7, 0.24, 1.1), (0.5, 0.42, 0.8)):
        ridge = height + np.abs(u - x) * wide + 0.02 * noise(rng, 3, 30)
        snow = v < ridge + 0.1 + 0.04 * noise(rng, 3, 3)
        side = np.where((u > x)[..., None], np.asarray(rock) * 0.75, rock)
        face = np.where(snow[..., None], np.where((u > x)[..., None], 0.82, 0.97), side)
        image = np.where((v > ridge)[..., None], face, image)
    teeth = 0.8 + 0.1 * np.abs((u * 13) % 1 - 0.5) + 0.03 * noise(rng, 9, 40)
    image[v > teeth] = (0.12, 0.25, 0.18)
    return image


def forest(rng: Rng, mist: Color, trunk: Color, count: int = 16) -> Rgb:
    """Draw `count` tree trunks in mist."""
    u, v = pixels()
    image = blend(mist, (1.0, 1.0, 0.97), 0.7 - 0.4 * v)
    for i in range(count):
        x, wide, share = rng.uniform(0, 1), 0.008 + 0.022 * (i / count) ** 2, 0.25 + 0.75 * i / count
        color = np.asarray(mist) * (1 - share) + np.asarray(trunk) * share
        image[np.abs(u - x - 0.015 * np.sin(3 * v + i)) < wide] = color
        image[v > 0.98 - 0.12 * i / count + 0.02 * noise(rng, 12, 30)] = color
    return image


def city(rng: Rng, top: Color, low: Color, tower: Color, lit: Color) -> Rgb:
    """Draw a skyline with lit windows."""
    u, v = pixels()
    image = _sky(rng, top, low)
    for row in range(3):
        share = (row + 1) / 3
        color = np.asarray(low) * (1 - share) + np.asarray(tower) * share
        for x in np.arange(0, 1, 0.085):
            wide, height = rng.uniform(0.05, 0.1), rng.uniform(0.2, 0.55) - 0.12 * row
            inside = (u > x) & (u < x + wide) & (v > 0.95 - height - 0.1 * (2 - row))
            windows = inside & ((u * 64) % 2 < 1) & ((v * 50) % 2 < 1) & (rng.random((canvas().size,) * 2) < 0.75)
            image[inside] = color
            image[windows] = np.asarray(lit) * share + color * (1 - share)
    return image


def bouquet(rng: Rng, wall: Color, jug: Color, blooms: int = 22) -> Rgb:
    """Draw `blooms` flowers in a jug on a table."""
    u, v = pixels()
    image = blend(wall, (1.0, 1.0, 1.0), 0.12 * noise(rng, 14, 14))
    image[v > 0.84] = np.asarray(wall) * 0.55
    image[(np.abs(u - 0.5) < 0.11 + 0.05 * np.sin(9 * v)) & (v > 0.6) & (v < 0.9)] = jug
    for x, y in rng.normal((0.5, 0.36), (0.16, 0.12), (30, 2)):
        image[np.abs((u - 0.5) * (0.62 - y) - (x - 0.5) * (0.62 - v)) < 0.0018 * (v < 0.62) * (v > y)] = (0.2, 0.4, 0.2)
    for x, y, size in np.c_[rng.normal((0.5, 0.34), (0.17, 0.12), (blooms, 2)), rng.uniform(0.035, 0.075, blooms)]:
        radius, angle = np.hypot(u - x, v - y), np.arctan2(v - y, u - x)
        color = _random_color(rng, 0.45, 1.0) * (1.0, 0.7, 0.8)
        image[radius < size * (0.75 + 0.25 * np.cos(6 * angle))] = color
        image[radius < 0.3 * size] = color * 0.5 + (0.4, 0.3, 0.0)
    return np.clip(image, 0, 1)


def fruit(rng: Rng, wall: Color, cloth: Color) -> Rgb:
    """Draw a still life: fruit and a bottle."""
    u, v = pixels()
    image = blend(wall, (0.0, 0.0, 0.0), 0.25 * u + 0.05 * noise(rng, 9, 9))
    image[v > 0.66] = cloth
    neck = np.where(v < 0.42, 0.03, 0.075)
    image[(np.abs(u - 0.75) < neck) & (v > 0.2) & (v < 0.8)] = (0.14, 0.3, 0.2)
    image[(np.abs(u - 0.71) < 0.008) & (v > 0.46) & (v < 0.74)] = (0.5, 0.65, 0.5)
    for x, y, size, kind in ((0.2, 0.74, 0.1, 0), (0.36, 0.76, 0.11, 1), (0.52, 0.78, 0.09, 2), (0.3, 0.62, 0.09, 3)):
        color = np.array([(0.8, 0.2, 0.15), (0.93, 0.6, 0.15), (0.55, 0.65, 0.2), (0.9, 0.8, 0.25)])[kind]
        light = np.clip(1.15 - 1.6 * np.hypot(u - x + 0.04, v - y + 0.04) / size * 0.5, 0.45, 1.15)[..., None]
        image = np.where((np.hypot(u - x, v - y) < size)[..., None], color * light, image)
    return np.clip(image, 0, 1)


def portrait(rng: Rng, wall: Color, skin: Color, hair: Color, coat: Color, long_hair: bool = False) -> Rgb:
    """Draw a head and shoulders."""
    u, v = pixels()
    x, y = u - 0.5, v - 0.42
    image = blend(wall, (0.0, 0.0, 0.0), 0.12 * noise(rng, 18, 18) + 0.4 * np.hypot(x, v - 0.5))
    if long_hair:
        image[(np.abs(x) < 0.2) & (v > 0.36) & (v < 0.78)] = hair
    image[(np.hypot(x / 0.36, (v - 1.02) / 0.32) < 1)] = coat
    image[(np.abs(x) < 0.07) & (v > 0.5) & (v < 0.76)] = np.asarray(skin) * 0.85
    image[np.hypot(x / 0.19, (y + 0.06) / 0.23) < 1] = hair
    image[np.hypot(x / 0.145, (y + 0.0) / 0.19) < 1] = skin
    image[(np.hypot(x / 0.16, (y + 0.16) / 0.09) < 1)] = hair
    for side in (-1, 1):
        image[np.hypot((x - 0.055 * side) / 0.022, (y + 0.02) / 0.012) < 1] = (0.12, 0.1, 0.1)
        image[(np.abs(x - 0.055 * side) < 0.032) & (np.abs(y + 0.055) < 0.007)] = np.asarray(hair) * 0.7
    image[(np.abs(x - 0.006) < 0.009) & (np.abs(y - 0.03) < 0.035)] = np.asarray(skin) * 0.85
    image[np.hypot(x / 0.045, (y - 0.105) / 0.013) < 1] = (0.68, 0.26, 0.25)
    return np.clip(image, 0, 1)


def atlas(rng: Rng, water: Color, land: Color) -> Rgb:
    """Draw a map: continents in a net of lines."""
    u, v = pixels()
    height = noise(rng, 14, 14) + 0.35 * noise(rng, 4, 4)
    image = np.where((height > 0.35)[..., None], np.asarray(land) * (1 + 0.15 * (height[..., None] > 0.9)), water)
    image[np.abs(height - 0.35) < 0.07] = np.asarray(land) * 0.55
    net = np.minimum((u * 8) % 1, (v * 6) % 1) < 0.06
    image[net] *= 0.85
    edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    image[edge < 0.03] = (0.93, 0.9, 0.8)
    return image


def grid_art(rng: Rng, palette: tuple[Color, ...], lines: int = 5) -> Rgb:
    """Draw fields, half of the first colour, between `lines` black bars each way."""
    u, v = pixels()
    xs, ys = (np.sort(rng.uniform(0.08, 0.92, lines)) for _ in range(2))
    color = rng.choice(len(palette), (lines + 1) ** 2, p=_mostly_first(len(palette)))
    image = np.asarray(palette)[color][np.searchsorted(xs, u) * (lines + 1) + np.searchsorted(ys, v)]
    image[np.minimum(np.abs(u[..., None] - xs).min(-1), np.abs(v[..., None] - ys).min(-1)) < 0.012] = 0.06
    return image


def _mostly_first(count: int) -> np.ndarray:
    share = np.full(count, 0.5 / (count - 1))
    share[0] = 0.5
    return share


def circles(rng: Rng, ground: Color, palette: tuple[Color, ...], count: int = 14) -> Rgb:
    """Draw `count` discs and rings of many sizes on a ground."""
    u, v = pixels()
    image = _canvas(ground)
    for x, y, size, kind in rng.uniform(0, 1, (count, 4)):
        radius, r = np.hypot(u - x, v - y), 0.04 + 0.16 * size
        color = np.asarray(palette[int(kind * len(palette))])
        image[(radius < r) & ((radius > 0.7 * r) | (kind * 10 % 1 < 0.5))] = color
    return image


def fields(rng: Rng, upper: Color, lower: Color, ground: Color) -> Rgb:
    """Draw two soft blocks of colour on a ground."""
    u, v = pixels()
    image = blend(ground, (0.0, 0.0, 0.0), 0.04 + 0.04 * noise(rng, 9, 9))
    for low, high, color in ((0.08, 0.52, upper), (0.58, 0.92, lower)):
        edge = np.minimum(np.minimum(u - 0.1, 0.9 - u), np.minimum(v - low, high - v)) + 0.012 * noise(rng, 3, 3)
        share = np.clip(edge * 25, 0, 0.92)[..., None]
        image = image * (1 - share) + np.asarray(color) * share * (1 + 0.05 * noise(rng, 12, 5)[..., None])
    return np.clip(image, 0, 1)


def strokes(rng: Rng, ground: Color, palette: tuple[Color, ...], count: int = 26) -> Rgb:
    """Draw `count` broad crossing brush strokes on a ground."""
    u, v = pixels()
    image = _canvas(ground)
    for x, y, turn, long, kind in rng.uniform(0, 1, (count, 5)):
        c, s = np.cos(3.14 * turn), np.sin(3.14 * turn)
        a, b = (u - x) * c + (v - y) * s, (v - y) * c - (u - x) * s + 0.03 * np.sin(6 * (u - x))
        inside = (np.abs(a) < 0.1 + 0.3 * long) & (np.abs(b) < 0.035 + 0.01 * noise(rng, 8, 2))
        image[inside] = np.asarray(palette[int(kind * len(palette))]) * (0.85 + 0.3 * rng.random())
    return np.clip(image, 0, 1)


def sprig(rng: Rng, paper: Color, green: Color, pairs: int = 7) -> Rgb:
    """Draw a botanical print: one stem with pairs of leaves."""
    u, v = pixels()
    image = blend(paper, (0.8, 0.75, 0.65), 0.05 * noise(rng, 9, 9))
    stem = 0.5 + 0.05 * np.sin(3 * v)
    image[(np.abs(u - stem) < 0.008) & (v > 0.12) & (v < 0.92)] = np.asarray(green) * 0.6
    for i in range(pairs):
        y, size = 0.22 + 0.09 * i, 0.1 + 0.017 * i
        for side in (-1, 1):
            dx, dy = (u - 0.5) * side, v - y
            a, b = dx * 0.83 - dy * 0.55, dx * 0.55 + dy * 0.83
            inside = (a > 0) & (a < 2 * size) & (np.abs(b) < 0.3 * size * np.sin(np.pi * np.clip(a / size / 2, 0, 1)))
            image[inside] = np.asarray(green) * (1.0 if side > 0 else 0.85)
            image[inside & (np.abs(b) < 0.005)] = np.asarray(green) * 0.6
    return image


def poster(rng: Rng, ground: Color, shape: Color, ink: Color, sides: int = 0) -> Rgb:
    """Draw a poster: a regular polygon of `sides`, or a disc for 0, over lines of print."""
    u, v = pixels()
    image = _canvas(ground)
    x, y = u - 0.5, v - 0.4
    angle = np.arctan2(y, x)
    turn = (angle + np.pi / 2) % (2 * np.pi / max(sides, 1)) - np.pi / max(sides, 1)
    reach = 0.3 * np.cos(np.pi / sides) / np.cos(turn) if sides else 0.3
    image[np.hypot(x, y) < reach] = shape
    image[(np.hypot(x, y) < reach) & ((v * 30) % 1 < 0.25) & (v > 0.42)] = ground
    for i, wide in enumerate(rng.uniform(0.3, 0.42, 3)):
        inside = (np.abs(u - 0.5) < wide) & (np.abs(v - 0.79 - 0.06 * i) < 0.02 - 0.004 * i)
        image[inside & ((u * 40 + 7 * i) % 3 < 2.2)] = ink
    return image


def photo(rng: Rng, tint: Color) -> Rgb:
    """Draw an old photograph with a pale margin: a house and a tree."""
    u, v = pixels()
    tone = 0.75 - 0.3 * v + 0.04 * noise(rng, 20, 20)
    tone = np.where(v > 0.68, 0.35 + 0.05 * noise(rng, 3, 2), tone)
    x = rng.uniform(0.3, 0.45)
    tone[(np.abs(u - x) < 0.16) & (v > 0.48) & (v < 0.72)] = 0.85
    tone[(v < 0.48) & (v > 0.34 + 0.8 * np.abs(u - x))] = 0.3
    tone[(np.abs(np.abs(u - x) - 0.08) < 0.03) & (np.abs(v - 0.57) < 0.035)] = 0.25
    tone[(np.abs(u - 0.76) < 0.018) & (v > 0.45) & (v < 0.74)] = 0.2
    tone[np.hypot(u - 0.76, v - 0.36) < 0.15 + 0.02 * noise(rng, 3, 3)] = 0.28
    edge = np.minimum(np.minimum(u, 1 - u), np.minimum(v, 1 - v))
    return np.where((edge < 0.07)[..., None], (0.95, 0.93, 0.88), tone[..., None] * np.asarray(tint))


def animal(rng: Rng, ground: Color, coat: Color, ears: float = 0.1) -> Rgb:
    """Draw a child's picture: the face of an animal; `ears` lengthens its ears."""
    u, v = pixels()
    x, y = u - 0.5, v - 0.55
    image = _canvas(ground)
    image[((u * 9).astype(int) + (v * 9).astype(int)) % 2 == 0] = np.asarray(ground) * 0.95
    for side in (-1, 1):
        image[np.hypot((x - 0.2 * side) / 0.08, (y + 0.24) / (0.06 + ears)) < 1] = coat
        image[np.hypot((x - 0.2 * side) / 0.045, (y + 0.24) / (0.03 + ears)) < 1] = (0.95, 0.7, 0.7)
    image[np.hypot(x / 0.3, y / 0.27) < 1] = coat
    image[np.hypot(x / 0.14, (y - 0.1) / 0.1) < 1] = np.asarray(coat) * 0.4 + 0.58
    for side in (-1, 1):
        image[np.hypot(x - 0.11 * side, y + 0.05) < 0.035] = 0.05
        image[np.hypot(x - 0.1 * side, y + 0.06) < 0.011] = 1.0
    image[np.hypot(x / 0.05, (y - 0.06) / 0.03) < 1] = 0.1
    return image
