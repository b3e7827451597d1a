"""Image of a top-down map."""

import math

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from home_mjx.tasks.metrics.top_down import Ground, TopDownMap

COLOURS = {Ground.OUTSIDE: (24, 26, 30), Ground.BLOCKED: (120, 120, 125), Ground.FREE: (240, 240, 240)}
GOAL, PATH, START = (255, 205, 40), (40, 120, 255), (225, 80, 70)
AGENTS = ((20, 200, 90), (255, 150, 40), (190, 110, 255), (60, 200, 230))
FOG = 0.55  # brightness factor of unseen cells
MARGIN = 2  # margin around the rooms [cells]


def map_picture(found: TopDownMap, size: int = 512) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the rooms of a storey from above, north (+y) up; unseen cells are darker, agents are arrows.

    Args:
        found: The map of one environment.
        size: Approximate length of the longer side [px]; cells have a whole number of pixels.

    Example:
        >>> write_png("map.png", map_picture(found))  # doctest: +SKIP
    """
    ground = np.asarray(found.ground)
    inside = np.argwhere(ground != Ground.OUTSIDE)
    low = np.maximum(inside.min(axis=0) - MARGIN, 0)
    high = np.minimum(inside.max(axis=0) + MARGIN + 1, ground.shape)
    image = _painted(found)[low[0] : high[0], low[1] : high[1]]
    pixels = max(size // max(image.shape[:2]), 1)
    picture = Image.fromarray(np.repeat(np.repeat(image[::-1], pixels, axis=0), pixels, axis=1))
    draw = ImageDraw.Draw(picture)

    def middle(cell: np.ndarray) -> tuple[float, float]:
        row, column = cell + 0.5
        return (column - low[1]) * pixels, (high[0] - row) * pixels

    radius = max(2 * pixels, 4)
    if found.start[0] >= 0:
        x, y = middle(np.asarray(found.start))
        draw.ellipse((x - radius / 2, y - radius / 2, x + radius / 2, y + radius / 2), fill=START)
    for number, (cell, yaw) in enumerate(zip(np.asarray(found.agents), np.asarray(found.yaw), strict=True)):
        if cell[0] >= 0:
            draw.polygon(_arrow(middle(cell), float(yaw), radius), fill=AGENTS[number % len(AGENTS)])
    return np.asarray(picture)


def _painted(found: TopDownMap) -> UInt8[np.ndarray, "rows columns 3"]:
    """Return the map with one pixel per cell."""
    image = np.array([COLOURS[ground] for ground in Ground], float)[np.asarray(found.ground)]
    goal = np.asarray(found.goal)
    image[goal] = 0.35 * image[goal] + 0.65 * np.array(GOAL)
    image[~np.asarray(found.seen)] *= FOG
    image[np.asarray(found.visited)] = PATH
    return image.astype(np.uint8)


def _arrow(at: tuple[float, float], yaw: float, radius: float) -> list[tuple[float, float]]:
    """Return the corners of an arrow head that points along a yaw."""
    turns = (0.0, 2.5, math.pi, -2.5)
    sizes = (1.6, 1.2, 0.5, 1.2)
    return [
        (at[0] + size * radius * math.cos(yaw + turn), at[1] - size * radius * math.sin(yaw + turn))
        for turn, size in zip(turns, sizes, strict=True)
    ]
