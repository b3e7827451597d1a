"""Seamless texture images, named after the SUNCG families (wood_1, tile_2, ...), and the canvas they are drawn on.

Lengths and counts of a recipe are for one metre, whatever the canvas; pictures and rugs are fitted to theirs instead.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from functools import cache, partial
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int, UInt8
from scipy import fft


class Canvas(NamedTuple):
    """What an image covers."""

    size: int = 128  # edge [px]
    metres: int = 1  # edge [m]

    @property
    def dtype(self) -> type[np.floating]:
        """Type of values: single precision for large images, which take half the time."""
        return np.float64 if self.size <= 128 else np.float32

    @property
    def scale(self) -> float:
        """Pixels per metre over those of the smallest canvas, 128: the unit of lengths in pixels."""
        return self.size / self.metres / 128


Gray = Float[np.ndarray, "s s"]
Rgb = Float[np.ndarray, "s s 3"]
Image = UInt8[np.ndarray, "s s 3"]
Color = tuple[float, float, float]
MAX_THREAD = 2.0  # [px], lengths up to this are of threads and grains: as fine as the canvas allows
_SMALLEST = Canvas()
_CANVAS: ContextVar[Canvas] = ContextVar("canvas", default=_SMALLEST)


def canvas() -> Canvas:
    """Return the canvas on which recipes draw."""
    return _CANVAS.get()


@contextmanager
def draw_on(new: Canvas) -> Iterator[None]:
    """Let recipes draw on a canvas inside the context."""
    token = _CANVAS.set(new)
    try:
        yield
    finally:
        _CANVAS.reset(token)


def pixels() -> tuple[Gray, Gray]:
    """Return the coordinates of pixel centres in metres, u to the right and v down, from 0 to the canvas's edge."""
    size, metres = canvas()
    line = ((np.arange(size) + 0.5) / size * metres).astype(canvas().dtype)
    v, u = np.meshgrid(line, line, indexing="ij")
    return u, v


def tones(rng: np.random.Generator, cell: Int[np.ndarray, "s s"]) -> Gray:
    """Return a random value per cell, normally distributed."""
    return rng.standard_normal(int(cell.max()) + 1).astype(canvas().dtype)[cell]


def joint(width: float) -> float:
    """Return the width of a joint of `width` on the smallest canvas: it is as narrow as the pixels allow [m]."""
    return width / canvas().scale


def noise(rng: np.random.Generator, width: float = 1.0, height: float = 1.0) -> Gray:
    """Return periodic Gaussian noise with zero mean and unit variance.

    Args:
        rng: Source of randomness.
        width: Correlation length along a row, in pixels of the smallest canvas.
        height: Correlation length along a column, in pixels of the smallest canvas.
    """
    size, scale, dtype = canvas().size, canvas().scale, canvas().dtype
    wide, high = (length if length <= MAX_THREAD else length * scale for length in (width, height))
    columns = np.exp(-((np.pi * fft.rfftfreq(size) * wide) ** 2))
    rows = np.exp(-((np.pi * fft.fftfreq(size) * high) ** 2))
    blur = (rows[:, None] * columns).astype(dtype)
    spectrum = np.asarray(fft.rfft2(rng.standard_normal((size, size), dtype))) * blur
    field = np.asarray(fft.irfft2(spectrum, (size, size)))
    field -= field.mean()
    return field / field.std()


def blend(dark: Color, light: Color, weight: Gray) -> Rgb:
    """Mix two colours by a weight from 0 (dark) to 1 (light), clipped."""
    share = np.clip(weight, 0.0, 1.0)[..., None]
    first, second = (np.asarray(color, canvas().dtype) for color in (dark, light))
    return first + (second - first) * share


def grid(rows: int, columns: float, shift: float = 0.0) -> tuple[np.ndarray, Float[np.ndarray, "s s 2"]]:
    """Return the cell index of each pixel, and its distances to the cell's edges (vertical, horizontal) in metres.

    Args:
        rows: Cells per metre, downwards.
        columns: Cells per metre, sideways.
        shift: Sideways offset of every second row, in cells.
    """
    line, total = pixels()[0][0], round(columns * canvas().metres)
    across, down = np.stack([line * columns, line * columns + shift]) % total, line * rows
    row = down.astype(int)
    beside, above = (np.minimum(at % 1, 1 - at % 1) / per for at, per in ((across, columns), (down, rows)))
    edge = np.stack(np.broadcast_arrays(beside[row % 2], above[:, None]), -1)
    return row[:, None] * total + across.astype(int)[row % 2], edge


def wood(rng: np.random.Generator, dark: Color, light: Color) -> Rgb:
    """Draw wood with straight grain along the rows."""
    bands = 0.5 + 0.22 * noise(rng, 60, 3) + 0.10 * noise(rng, 20, 1)
    return blend(dark, light, bands)


def planks(rng: np.random.Generator, dark: Color, light: Color, rows: int = 8, columns: int = 2) -> Rgb:
    """Draw `rows` rows per metre of staggered boards, `columns` to each canvas, of slightly different tones."""
    cell, edge = grid(rows, columns / canvas().metres, shift=0.5)
    tone = 0.5 + 0.13 * tones(rng, cell) + 0.12 * noise(rng, 50, 2)
    return blend(dark, light, tone) * np.where(edge.min(-1) < joint(0.004), 0.72, 1.0)[..., None]


def tiles(rng: np.random.Generator, dark: Color, light: Color, count: int = 4, checker: bool = False) -> Rgb:
    """Draw count x count square tiles with pale grout, of similar tones or as a checkerboard."""
    cell, edge = grid(count, count)
    row, column = np.divmod(cell, count * canvas().metres)
    tone = (row + column) % 2 if checker else 0.6 + 0.15 * tones(rng, cell)
    face = blend(dark, light, tone + 0.03 * noise(rng, 6, 6))
    return np.where((edge.min(-1) < joint(0.006))[..., None], (0.78, 0.77, 0.74), face)


def bricks(rng: np.random.Generator, dark: Color, light: Color) -> Rgb:
    """Draw bricks in running bond with mortar."""
    cell, edge = grid(14, 4, shift=0.5)
    tone = 0.5 + 0.2 * tones(rng, cell) + 0.12 * noise(rng, 2, 2)
    return np.where((edge.min(-1) < 0.006)[..., None], (0.74, 0.72, 0.68), blend(dark, light, tone))


def stripes(rng: np.random.Generator, dark: Color, light: Color, count: int = 8) -> Rgb:
    """Draw `count` pairs of upright dark and light wallpaper stripes with soft edges."""
    u, _ = pixels()
    wave = 0.5 + 0.5 * np.tanh(6 * np.sin(2 * np.pi * count * u))
    return blend(dark, light, wave + 0.04 * noise(rng))


def rosettes(rng: np.random.Generator, dark: Color, light: Color, count: int = 6) -> Rgb:
    """Draw wallpaper with soft light and dark dots in turn, 2 x `count` of each per side."""
    size, metres = canvas()
    v, u = np.meshgrid(*(np.arange(size) / size * metres,) * 2, indexing="ij")
    wave = np.cos(2 * np.pi * count * (u + v)) * np.cos(2 * np.pi * count * (u - v))
    return blend(dark, light, 0.5 + 0.35 * wave + 0.04 * noise(rng))


def grain(rng: np.random.Generator, dark: Color, light: Color, size: float = 1.0, contrast: float = 0.2) -> Rgb:
    """Draw isotropic speckle with grains of `size` [pixels]: carpet, leather, stone or stucco."""
    return blend(dark, light, 0.5 + contrast * noise(rng, size, size) + 0.5 * contrast * noise(rng, 5 * size, 5 * size))


def weave(rng: np.random.Generator, dark: Color, light: Color) -> Rgb:
    """Draw woven threads, each two pixels wide."""
    rows, columns = np.indices((canvas().size,) * 2) // 2
    return blend(dark, light, 0.4 + 0.25 * ((rows + columns) % 2) + 0.08 * noise(rng, 6, 1) + 0.08 * noise(rng, 1, 6))


def landscape(rng: np.random.Generator, dark: Color, light: Color) -> Rgb:
    """Draw a picture: light sky, sun and three rows of dark hills."""
    u, v = pixels()
    image = blend(light, (0.98, 0.95, 0.88), v * 1.4)
    sun = np.hypot(u - rng.uniform(0.2, 0.8), v - rng.uniform(0.15, 0.3)) < rng.uniform(0.06, 0.1)
    image[sun] = (0.98, 0.82, 0.45)
    for hill in range(3):
        waves = sum(rng.normal(0, 0.06) * np.sin(2 * np.pi * (k * u + rng.uniform())) for k in (1, 2, 3))
        image[v > 0.45 + 0.17 * hill + waves] = np.asarray(dark) * (1.3 - 0.35 * hill)
    return image


def blocks(rng: np.random.Generator, dark: Color, light: Color) -> Rgb:
    """Draw a picture: coloured rectangles between black bars."""
    palette = np.array([dark, light, (0.95, 0.93, 0.87), (0.93, 0.90, 0.82), (0.85, 0.68, 0.25)])
    across, down = (np.sort(rng.uniform(0.15, 0.85, 2)) for _ in range(2))
    pixel = pixels()[0][0]
    cell = np.searchsorted(down, pixel)[:, None] * 3 + np.searchsorted(across, pixel)[None, :]
    image = palette[rng.integers(0, len(palette), 9)][cell]
    image[np.abs(pixel[:, None] - down).min(-1) < 0.012] = 0.08
    image[:, np.abs(pixel[:, None] - across).min(-1) < 0.012] = 0.08
    return image


BASE_RECIPES: dict[str, Callable[[np.random.Generator], Rgb]] = {
    "wood_1": partial(wood, dark=(0.45, 0.29, 0.16), light=(0.72, 0.52, 0.32)),
    "wood_2": partial(wood, dark=(0.24, 0.14, 0.08), light=(0.42, 0.26, 0.16)),
    "wood_3": partial(wood, dark=(0.70, 0.56, 0.38), light=(0.90, 0.78, 0.58)),
    "wood_4": partial(wood, dark=(0.78, 0.76, 0.72), light=(0.93, 0.92, 0.89)),
    "wood_5": partial(wood, dark=(0.40, 0.18, 0.10), light=(0.62, 0.32, 0.20)),
    "wood_6": partial(wood, dark=(0.42, 0.39, 0.36), light=(0.62, 0.58, 0.54)),
    "prkt_1": partial(planks, dark=(0.50, 0.33, 0.18), light=(0.74, 0.54, 0.33)),
    "prkt_2": partial(planks, dark=(0.33, 0.20, 0.12), light=(0.52, 0.35, 0.22), rows=12, columns=3),
    "prkt_3": partial(planks, dark=(0.66, 0.52, 0.36), light=(0.86, 0.73, 0.54), rows=10),
    "laminate_1": partial(planks, dark=(0.62, 0.55, 0.46), light=(0.80, 0.73, 0.63), rows=5, columns=1),
    "laminate_2": partial(planks, dark=(0.42, 0.40, 0.38), light=(0.60, 0.57, 0.54), rows=5, columns=1),
    "tile_1": partial(tiles, dark=(0.80, 0.82, 0.83), light=(0.95, 0.96, 0.96)),
    "tile_2": partial(tiles, dark=(0.35, 0.48, 0.55), light=(0.55, 0.68, 0.74), count=8),
    "tile_3": partial(tiles, dark=(0.20, 0.20, 0.22), light=(0.92, 0.91, 0.88), checker=True),
    "tile_4": partial(tiles, dark=(0.62, 0.48, 0.36), light=(0.78, 0.64, 0.50), count=3),
    "tile_5": partial(tiles, dark=(0.45, 0.56, 0.46), light=(0.66, 0.76, 0.66), count=6),
    "wallp_0": partial(grain, dark=(0.97, 0.97, 0.97), light=(1.0, 1.0, 1.0)),
    "wallp_1": partial(stripes, dark=(0.86, 0.82, 0.74), light=(0.95, 0.93, 0.88)),
    "wallp_2": partial(rosettes, dark=(0.74, 0.80, 0.80), light=(0.90, 0.93, 0.92)),
    "wallp_3": partial(stripes, dark=(0.68, 0.76, 0.86), light=(0.88, 0.92, 0.96), count=12),
    "wallp_4": partial(rosettes, dark=(0.84, 0.74, 0.68), light=(0.95, 0.89, 0.85), count=4),
    "stucco_1": partial(grain, dark=(0.90, 0.89, 0.86), light=(0.98, 0.97, 0.95), size=2),
    "carpet_1": partial(grain, dark=(0.46, 0.40, 0.34), light=(0.66, 0.60, 0.53)),
    "carpet_2": partial(grain, dark=(0.26, 0.30, 0.40), light=(0.42, 0.48, 0.60)),
    "carpet_3": partial(grain, dark=(0.44, 0.18, 0.18), light=(0.64, 0.32, 0.30)),
    "bricks_1": partial(bricks, dark=(0.48, 0.22, 0.16), light=(0.72, 0.42, 0.32)),
    "bricks_2": partial(bricks, dark=(0.60, 0.55, 0.48), light=(0.82, 0.77, 0.70)),
    "textile_1": partial(weave, dark=(0.42, 0.44, 0.47), light=(0.62, 0.64, 0.67)),
    "textile_2": partial(weave, dark=(0.20, 0.30, 0.42), light=(0.36, 0.48, 0.62)),
    "textile_3": partial(weave, dark=(0.46, 0.20, 0.18), light=(0.66, 0.36, 0.32)),
    "textile_4": partial(weave, dark=(0.62, 0.55, 0.42), light=(0.82, 0.76, 0.62)),
    "textile_5": partial(weave, dark=(0.28, 0.40, 0.30), light=(0.46, 0.58, 0.46)),
    "linen_1": partial(weave, dark=(0.82, 0.80, 0.76), light=(0.97, 0.96, 0.93)),
    "leather_1": partial(grain, dark=(0.24, 0.14, 0.09), light=(0.42, 0.27, 0.18), size=1.5, contrast=0.15),
    "leather_2": partial(grain, dark=(0.10, 0.10, 0.11), light=(0.24, 0.24, 0.25), size=1.5, contrast=0.15),
    "stone_1": partial(grain, dark=(0.30, 0.30, 0.32), light=(0.62, 0.61, 0.60), size=1.2),
    "stone_2": partial(grain, dark=(0.80, 0.77, 0.72), light=(0.94, 0.92, 0.88), size=3),
    "picture_1": partial(landscape, dark=(0.22, 0.42, 0.28), light=(0.48, 0.68, 0.90)),
    "picture_2": partial(landscape, dark=(0.42, 0.26, 0.40), light=(0.92, 0.62, 0.48)),
    "picture_3": partial(blocks, dark=(0.72, 0.12, 0.12), light=(0.14, 0.28, 0.62)),
    "picture_4": partial(blocks, dark=(0.12, 0.42, 0.42), light=(0.86, 0.46, 0.24)),
}


@cache
def base_texture(name: str) -> Image:
    """Return the image of a texture of `BASE_RECIPES`, row 0 at the top, sRGB.

    Example:
        >>> base_texture("wood_1").shape
        (128, 128, 3)
    """
    rng = np.random.default_rng(list(BASE_RECIPES).index(name))
    return np.round(np.clip(BASE_RECIPES[name](rng), 0.0, 1.0) * 255.0).astype(np.uint8)
