"""Image panels: colours for depth and ids, captions, and contact sheets."""

import colorsys
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int, UInt8
from PIL import Image, ImageDraw, ImageFont

BACKGROUND = (24, 26, 30)
TEXT_COLOUR = (235, 235, 235)


def colour_depth(depth: Float[np.ndarray, "h w"], max_depth: float) -> UInt8[np.ndarray, "h w 3"]:
    """Map depth, in the unit of `max_depth`, to colours: 0 or less is bright yellow, `max_depth` or more dark blue."""
    near = 1 - np.clip(depth / max_depth, 0, 1)
    ramp = np.array([[10, 12, 40], [60, 40, 120], [180, 60, 110], [245, 140, 60], [252, 250, 190]], float)
    place = near * (len(ramp) - 1)
    low = np.minimum(place.astype(int), len(ramp) - 2)
    mix = (place - low)[..., None]
    return (ramp[low] * (1 - mix) + ramp[low + 1] * mix).astype(np.uint8)


def colour_ids(ids: Int[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w 3"]:
    """Map ids to fixed colours; consecutive ids differ in hue, negative ones are black."""
    values = np.unique(ids)
    table = np.array([_id_colour(int(v)) for v in values], np.uint8)
    return table[np.searchsorted(values, ids)]


def _id_colour(value: int) -> tuple[int, int, int]:
    """Return the colour of one id."""
    if value < 0:
        return (0, 0, 0)
    red, green, blue = colorsys.hsv_to_rgb((value * 0.618034) % 1, 0.55 + 0.4 * ((value * 7) % 3) / 2, 0.95)
    return int(red * 255), int(green * 255), int(blue * 255)


def enlarge(image: UInt8[np.ndarray, "h w 3"], size: int) -> UInt8[np.ndarray, "s s2 3"]:
    """Scale an image to `size` rows, up or down, by nearest neighbours; the width follows, rounded down."""
    height, width = image.shape[:2]
    return np.asarray(Image.fromarray(image).resize((size * width // height, size), Image.Resampling.NEAREST))


def add_caption(image: UInt8[np.ndarray, "h w 3"], text: str) -> UInt8[np.ndarray, "h2 w 3"]:
    """Return a copy with 18 more rows above, which have one line of text; text beyond the width is cut off."""
    height, width = image.shape[:2]
    canvas = Image.new("RGB", (width, height + 18), BACKGROUND)
    canvas.paste(Image.fromarray(image), (0, 18))
    ImageDraw.Draw(canvas).text((4, 3), text, fill=TEXT_COLOUR, font=ImageFont.load_default(size=12))
    return np.asarray(canvas)


def compose_sheet(rows: Sequence[Sequence[UInt8[np.ndarray, "_ _ 3"]]], gap: int = 6) -> UInt8[np.ndarray, "_ _ 3"]:
    """Compose panels in rows, from the top left, on a dark background with `gap` [px] around them; sides are even.

    Panels of a row are aligned at the top and not scaled. There must be a row, and a panel in each.
    """
    heights = [max(panel.shape[0] for panel in row) for row in rows]
    widths = [sum(panel.shape[1] + gap for panel in row) for row in rows]
    # H.264 needs even sides.
    size = (max(widths) + gap, sum(heights) + gap * (len(rows) + 1))
    canvas = Image.new("RGB", (size[0] + size[0] % 2, size[1] + size[1] % 2), BACKGROUND)
    y = gap
    for row, height in zip(rows, heights, strict=True):
        x = gap
        for panel in row:
            canvas.paste(Image.fromarray(panel), (x, y))
            x += panel.shape[1] + gap
        y += height + gap
    return np.asarray(canvas)


def draw_waveform(
    samples: Float[np.ndarray, "2 n"], width: int, height: int, peak: float
) -> UInt8[np.ndarray, "h w 3"]:
    """Draw oscillograms of the left ear (above) and the right; ±`peak` fills half of the height each; n >= `width`."""
    canvas = Image.new("RGB", (width, height), BACKGROUND)
    draw = ImageDraw.Draw(canvas)
    for ear, colour in enumerate([(120, 200, 255), (255, 170, 110)]):
        middle = height * (1 + 2 * ear) // 4
        columns = np.array_split(samples[ear] / max(peak, 1e-9) * height / 4, width)
        for x, column in enumerate(columns):
            draw.line((x, middle - column.max(), x, middle - column.min()), fill=colour)
    return np.asarray(canvas)
