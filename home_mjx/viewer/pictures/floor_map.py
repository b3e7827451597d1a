"""Image of a top-down map."""

import math

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw

from home_mjx.tasks.metrics.top_down import CellOccupancy, TopDownMap

COLOURS = {
    CellOccupancy.OUTSIDE: (24, 26, 30),
    CellOccupancy.BLOCKED: (120, 120, 125),
    CellOccupancy.FREE: (240, 240, 240),
}
GOAL_COLOUR, PATH_COLOUR, START_COLOUR = (255, 205, 40), (40, 120, 255), (225, 80, 70)
AGENT_COLOURS = ((20, 200, 90), (255, 150, 40), (190, 110, 255), (60, 200, 230))
UNSEEN_BRIGHTNESS = 0.55  # brightness factor of unseen cells
MAP_MARGIN = 2  # margin around the rooms [cells]


def draw_map(found: TopDownMap, size: int = 512) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw the rooms of a storey from above, north (+y) up; unseen cells are darker, agents are arrows.

    Args:
        found: The map of one environment.
        size: Approximate length of the longer side [px]; cells have a whole number of pixels.

    Example:
        >>> write_png("map.png", map_picture(found))  # doctest: +SKIP
    """
    ground = np.asarray(found.occupancy)
    inside = np.argwhere(ground != CellOccupancy.OUTSIDE)
    low = np.maximum(inside.min(axis=0) - MAP_MARGIN, 0)
    high = np.minimum(inside.max(axis=0) + MAP_MARGIN + 1, ground.shape)
    image = _paint_cells(found)[low[0] : high[0], low[1] : high[1]]
    pixels = max(size // max(image.shape[:2]), 1)
    picture = Image.fromarray(np.repeat(np.repeat(image[::-1], pixels, axis=0), pixels, axis=1))
    draw = ImageDraw.Draw(picture)

    def middle(cell: np.ndarray) -> tuple[float, float]:
        row, column = cell + 0.5
        return (column - low[1]) * pixels, (high[0] - row) * pixels

    radius = max(2 * pixels, 4)
    if found.start[0] >= 0:
        x, y = middle(np.asarray(found.start))
        draw.ellipse((x - radius / 2, y - radius / 2, x + radius / 2, y + radius / 2), fill=START_COLOUR)
    for number, (cell, yaw) in enumerate(zip(np.asarray(found.agents), np.asarray(found.yaw), strict=True)):
        if cell[0] >= 0:
            draw.polygon(_arrow(middle(cell), float(yaw), radius), fill=AGENT_COLOURS[number % len(AGENT_COLOURS)])
    return np.asarray(picture)


def _paint_cells(found: TopDownMap) -> UInt8[np.ndarray, "rows columns 3"]:
    """Return the map with one pixel per cell."""
    image = np.array([COLOURS[ground] for ground in CellOccupancy], float)[np.asarray(found.occupancy)]
    goal = np.asarray(found.goal)
    image[goal] = 0.35 * image[goal] + 0.65 * np.array(GOAL_COLOUR)
    image[~np.asarray(found.seen)] *= UNSEEN_BRIGHTNESS
    image[np.asarray(found.visited)] = PATH_COLOUR
    return image.astype(np.uint8)


def _arrow(at: tuple[float, float], yaw: float, radius: float) -> list[tuple[float, float]]:
    """Return the corners of an arrow head that points along a yaw."""
    turns = (0.0, 2.5, math.pi, -2.5)
    sizes = (1.6, 1.2, 0.5, 1.2)
    return [
        (at[0] + size * radius * math.cos(yaw + turn), at[1] - size * radius * math.sin(yaw + turn))
        for turn, size in zip(turns, sizes, strict=True)
    ]
