"""Image of values over a floor plan."""

import numpy as np
from jaxtyping import Bool, Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.viewer.pictures.pictures import BACKGROUND, add_caption, colour_depth

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
        values: Values of the cells; NaN where unknown.
        room: True for cells in a room.
        source: Row and column of the source, fractions allowed.
        caption: Name of the quantity; its range is appended.
        size: Approximate length of the longer side [px]; cells have a whole number of pixels.

    Example:
        >>> values, room = np.array([[1.0, 2.0], [3.0, np.nan]]), np.ones((2, 2), bool)
        >>> sound_map(values, room, np.zeros(2), "T30 [s]", 64).shape
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
