"""Images of floor plans: top-down maps, and values over rooms such as reverberation times."""

import math

import numpy as np
from jaxtyping import Bool, Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.tasks.metrics.top_down import CellOccupancy, TopDownMap
from home_mjx.viewer.pictures.pictures import BACKGROUND, add_caption, colour_depth

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

    `size` is the approximate length of the longer side [px]; cells have a whole number of pixels, at least 1. The image
    is cropped to the rooms with `MAP_MARGIN`. The storey must have a room.

    Example:
        >>> write_png("map.png", draw_map(found))  # doctest: +SKIP
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
        """Return the pixel of a cell's centre."""
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
    """Return the whole map with one pixel per cell, the first row in the south."""
    image = np.array([COLOURS[ground] for ground in CellOccupancy], float)[np.asarray(found.occupancy)]
    goal = np.asarray(found.goal)
    image[goal] = 0.35 * image[goal] + 0.65 * np.array(GOAL_COLOUR)
    image[~np.asarray(found.seen)] *= UNSEEN_BRIGHTNESS
    image[np.asarray(found.visited)] = PATH_COLOUR
    return image.astype(np.uint8)


def _arrow(at: tuple[float, float], yaw: float, radius: float) -> list[tuple[float, float]]:
    """Return the four corners of a notched arrow head around `at` [px]; its tip is 1.6 `radius` away.

    Image y is down, and `yaw` [rad] counter-clockwise from image x.
    """
    turns = (0.0, 2.5, math.pi, -2.5)
    sizes = (1.6, 1.2, 0.5, 1.2)
    return [
        (at[0] + size * radius * math.cos(yaw + turn), at[1] - size * radius * math.sin(yaw + turn))
        for turn, size in zip(turns, sizes, strict=True)
    ]


WALL_COLOUR = (120, 120, 125)
SOURCE_COLOUR = (255, 255, 255)
SOUND_MAP_MARGIN = 2  # margin around the rooms [cells]


def draw_sound_map(
    values: Float[np.ndarray, "rows columns"],
    room: Bool[np.ndarray, "rows columns"],
    source: Float[np.ndarray, "2"],
    caption: str,
    size: int = 512,
) -> UInt8[np.ndarray, "_ _ 3"]:
    """Draw values over a floor plan, low ones dark and high ones bright, north (+y) up, with a ring around the source.

    Args:
        values: Values of the cells, row 0 in the south; NaN or infinite where unknown, drawn grey in rooms.
        room: True for cells in a room. Known values of other cells are drawn as well.
        source: Row and column of the source [cells] from the south-west corner of the first cell. So the centre of
            that cell is (0.5, 0.5), and its corner (0, 0).
        caption: Name of the quantity; its range, 0 to 0 if no value is known, is appended.
        size: Approximate length of the longer side [px] without the caption's 18 rows, which are above. Cells have a
            whole number of pixels, at least 1, and there is a margin of `SOUND_MAP_MARGIN` cells.

    Example:
        >>> values, room = np.array([[1.0, 2.0], [3.0, np.nan]]), np.ones((2, 2), bool)
        >>> draw_sound_map(values, room, np.array([0.5, 1.5]), "T30 [s]", 64).shape
        (78, 60, 3)
    """
    known = np.isfinite(values)
    low, high = (float(f(values[known])) for f in (np.min, np.max)) if known.any() else (0.0, 0.0)
    rows, columns = values.shape
    image = np.full((rows + 2 * SOUND_MAP_MARGIN, columns + 2 * SOUND_MAP_MARGIN, 3), BACKGROUND, np.uint8)
    inner = image[SOUND_MAP_MARGIN:-SOUND_MAP_MARGIN, SOUND_MAP_MARGIN:-SOUND_MAP_MARGIN]
    inner[room] = WALL_COLOUR
    span = max(high - low, 1e-6)
    inner[known] = colour_depth((high - values[known])[None], span)[0]
    pixels = max(size // max(image.shape[:2]), 1)
    picture = Image.fromarray(np.repeat(np.repeat(image[::-1], pixels, axis=0), pixels, axis=1))
    y, x = (image.shape[0] - source[0] - SOUND_MAP_MARGIN) * pixels, (source[1] + SOUND_MAP_MARGIN) * pixels
    radius = max(pixels, 4)
    ImageDraw.Draw(picture).ellipse((x - radius, y - radius, x + radius, y + radius), outline=SOURCE_COLOUR, width=2)
    return add_caption(np.asarray(picture), f"{caption}: {low:.3g} (dark) to {high:.3g} (bright)")
