"""Roof tiles, foliage, and whole fronts of houses with their windows."""

import numpy as np

from home_procgen.primitives.textures import Color, Rgb, blend, noise, pixels
from home_procgen.textures.patterns import Rng, shingles

PANE_COLOR, FRAME_COLOR = (0.26, 0.32, 0.38), (0.93, 0.93, 0.91)


def front(rng: Rng, wall: Color, storeys: int = 2, columns: int = 3, door: bool = False) -> Rgb:
    """Draw a front with `columns` windows per storey, some with curtains, and if `door` a door below the middle."""
    u, v = pixels()
    tone = 1.0 + 0.025 * noise(rng, 2, 2) + 0.02 * noise(rng, 14, 30)
    image = np.asarray(wall)[None, None] * tone[..., None]
    image[v > 0.94] *= 0.75
    for row in range(storeys):
        for column in range(columns):
            is_door = door and row == storeys - 1 and column == columns // 2
            middle, wide = (column + 0.5) / columns, (0.19 if is_door else 0.26) / columns
            top, low = (row + (0.3 if is_door else 0.24)) / storeys, (row + (1.0 if is_door else 0.7)) / storeys
            _window(image, (np.abs(u - middle) / wide, (v - top) / (low - top)), is_door, rng)
    return image


def _window(image: Rgb, place: tuple[np.ndarray, np.ndarray], is_door: bool, rng: Rng) -> None:
    """Draw a window in place; `place` holds -1..1 across and 0..1 down from its top per pixel."""
    across, down = place
    inside = (across < 1) & (down > 0) & (down < 1)
    rim = (across > 0.86) | (down < 0.07) | ((down > 0.93) & (not is_door)) | (across < 0.06)
    if is_door:
        image[inside] = rng.choice([(0.3, 0.16, 0.1), (0.18, 0.28, 0.26), (0.2, 0.22, 0.3)])
    else:
        shade = 0.8 + 0.5 * rng.random()
        image[inside] = np.asarray(PANE_COLOR) * shade * (1.25 - 0.5 * down[inside])[:, None]
        drawn = inside & (across > rng.uniform(0.45, 1.4))
        image[drawn] = 0.72
    image[inside & rim & ((across > 0.86) | (not is_door))] = FRAME_COLOR


def foliage(rng: Rng, dark: Color, light: Color, size: float = 4.0) -> Rgb:
    """Draw distant leaves in light and shade, in clumps of a few times `size` [pixels]."""
    clumps, leaves = noise(rng, 3 * size, 3 * size), noise(rng, size, size)
    return blend(dark, light, 0.5 + 0.2 * clumps + 0.28 * leaves + 0.1 * noise(rng, 1.5, 1.5))


RECIPE_ROWS = {
    "foliage": (
        (foliage, "#2c4a20 #7ca04c"),
        (foliage, "#1e3a26 #527a4c", {"size": 2.0}),
        (foliage, "#4a5a20 #a4b05c", {"size": 5.0}),
    ),
    "roof": (
        (shingles, "#7a3a28 #b4694c"),
        (shingles, "#4a4c50 #74777c", {"rows": 5, "columns": 5}),
        (shingles, "#5a4436 #86705c"),
        (shingles, "#8a4a34 #c88664", {"rows": 4, "columns": 6}),
    ),
    "front": (
        (front, "#e8e4da", {"storeys": 1, "columns": 3}),
        (front, "#e8e4da", {"storeys": 1, "columns": 3, "door": True}),
        (front, "#e8e4da", {"storeys": 2, "columns": 3}),
        (front, "#e8e4da", {"storeys": 2, "columns": 4}),
        (front, "#e4e0d8", {"storeys": 5, "columns": 5}),
        (front, "#dcdcda", {"storeys": 5, "columns": 7}),
    ),
}
