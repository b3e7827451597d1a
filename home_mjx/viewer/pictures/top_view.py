"""Orthographic view of a house from above, without ceilings, with paths and markers."""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.lighting.texture import albedo, encode_srgb
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, select
from home_mjx.schema.compiled import ARCHITECTURE

CUT_HEIGHT = 2.2  # [m] cut height above the floor: above furniture and doors, below lintels' tops and ceilings
VIEW_MARGIN = 0.4  # [m] around the walls
FLOOR_MARGIN = 0.01  # [m], by which a point on a floor is raised to count as above it
CUT_WALL_GREY = 0.02  # linear grey of cut walls
Colour = tuple[int, int, int]
PATH_COLOUR, AGENT_COLOUR, SOURCE_COLOUR = (40, 90, 255), (20, 200, 90), (235, 40, 40)


class Marker(NamedTuple):
    """Dot on an image."""

    pos: Float[np.ndarray, " *p"]  # [m]
    colour: Colour
    radius: float = 8.0  # [px] at a resolution of 512


class TopView:
    """Image of one environment's house in its current state.

    Args:
        bank: The houses.
        scene: Scene of the environment, for ray casting.
        pixels: Rows and columns of the square image, as long as the house's longer side with margins.
        level: Index of a level with rooms, from the bottom. All levels are framed on the rooms of the lowest one.
    """

    def __init__(self, bank: HouseBank, scene: Scene, pixels: int = 512, level: int = 0) -> None:
        house = int(scene.house)
        self.low, self.size, side = frame_house(bank, house)
        self.scale = pixels / side
        ticks = (np.arange(pixels) + 0.5) / self.scale
        x, y = np.meshgrid(self.low[0] + ticks, self.low[1] + ticks[::-1])
        top = float(bank.navigation.floor[house, level]) + CUT_HEIGHT
        origin = jnp.asarray(np.stack([x, y, np.full_like(x, top)], axis=-1), jnp.float32)
        self.image = np.asarray(_render_from_above(scene, origin))

    def draw_path(
        self, path: Float[np.ndarray, "t 3"], source: Float[np.ndarray, " 3"], size: int
    ) -> UInt8[np.ndarray, "s s 3"]:
        """Return the image scaled to `size` [px], with a path [m], its end (green), and the sound source (red).

        The path has at least one point. All is drawn, whatever its storey.
        """
        image = self.draw_markers([Marker(path[-1], AGENT_COLOUR, 7), Marker(source, SOURCE_COLOUR, 9)], path)
        return np.asarray(Image.fromarray(image).resize((size, size), Image.Resampling.LANCZOS))

    def draw_markers(
        self, marks: Sequence[Marker], path: Float[np.ndarray, "t 3"] | None = None
    ) -> UInt8[np.ndarray, "s s 3"]:
        """Return a copy of the image with a line along the path [m], unless it is one point, and dots over it.

        Later dots cover earlier ones.
        """
        canvas = Image.fromarray(self.image)
        draw, unit = ImageDraw.Draw(canvas), len(self.image) / 512
        if path is not None and len(path) > 1:
            draw.line([self.to_pixel(p) for p in path], fill=PATH_COLOUR, width=round(4 * unit))
        for mark in marks:
            (x, y), radius = self.to_pixel(mark.pos), mark.radius * unit
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=mark.colour)
        return np.asarray(canvas)

    def crop(self, image: UInt8[np.ndarray, "s s 3"]) -> UInt8[np.ndarray, "h w 3"]:
        """Crop an image of this view's size to the extent of the rooms and `VIEW_MARGIN`."""
        width, height = (int(length * self.scale) for length in self.size)
        x, y = (len(image) - width) // 2, (len(image) - height) // 2
        return image[y : y + height, x : x + width]

    def to_pixel(self, point: Float[np.ndarray, " *p"]) -> tuple[float, float]:
        """Return column and row, with fractions, of a point in the world [m]; outside the image for points outside."""
        x, y = (np.asarray(point[:2]) - self.low) * self.scale
        return float(x), float(self.image.shape[0] - y)


def find_level(bank: HouseBank, house: int, pos: Float[np.ndarray, " 3"]) -> int:
    """Return the index of the highest storey whose floor is below a point [m]; the lowest for points below all floors.

    A point exactly on a floor counts to the storey beneath; raise points on floors by `FLOOR_MARGIN` first.
    """
    return max(int((pos[2] > np.asarray(bank.navigation.floor[house])).sum()) - 1, 0)


def frame_house(bank: HouseBank, house: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Return lower corner (x, y) of a square around the lowest storey's rooms, their extent (x, y), and its side [m].

    The extent includes `VIEW_MARGIN` on each side.
    """
    inside = np.argwhere(np.asarray(bank.navigation.room[house, 0]) >= 0)
    low, high = inside.min(0)[::-1] * bank.spec.cell, (inside.max(0)[::-1] + 1) * bank.spec.cell
    size = high - low + 2 * VIEW_MARGIN
    side = float(size.max())
    return np.asarray(bank.navigation.origin[house]) + (low + high) / 2 - side / 2, size, side


@jax.jit
def _render_from_above(scene: Scene, origin: Float[Array, "h w 3"]) -> UInt8[Array, "h w 3"]:
    """Render albedo straight down from each point of `origin` [m], lower surfaces darker, cut walls dark; sRGB."""
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), origin.shape)
    hit = cast(scene, origin, down)
    # Lower surfaces are darker, which separates furniture from the floor.
    light = 1 - 0.5 * jnp.clip(hit.t / CUT_HEIGHT, 0, 1)
    color = albedo(scene, hit) * light
    return (
        select(is_in_wall(scene, origin), Vec(CUT_WALL_GREY, CUT_WALL_GREY, CUT_WALL_GREY), color)
        .map(encode_srgb)
        .pack()
    )


def is_in_wall(
    scene: Scene, origin: Float[Array, "h w 3"], reach: Float[Array, "h w"] | float = float("inf")
) -> Bool[Array, "h w"]:
    """Return the mask of points `origin` (world) [m] inside walls, where a downward view would start behind a face.

    Walls are closed solids: from inside one, a ray hits the back of a face, in x or in y. Rays are at most `reach` [m]
    long; a point of a negative reach is in no wall.
    """
    inside = jnp.zeros(origin.shape[:-1], bool)
    for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        hit = cast(scene, origin, jnp.broadcast_to(jnp.array(axis, jnp.float32), origin.shape), t_max=reach)
        inside = inside | ((hit.instance == ARCHITECTURE) & ~hit.front)
    return inside
