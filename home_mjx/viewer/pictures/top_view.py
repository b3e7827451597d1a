"""A house from above, without ceilings, with paths drawn on it."""

from collections.abc import Sequence
from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, select
from home_mjx.raycast_render.shaders.shading import albedo, encode
from home_mjx.schema.compiled import ARCHITECTURE

CUT = 2.2  # [m] above the floor: above furniture and doors, below lintels' tops and ceilings
MARGIN = 0.4  # [m] around the walls
WALL = 0.02  # linear grey of cut walls
Colour = tuple[int, int, int]
PATH, HERE, RADIO = (40, 90, 255), (20, 200, 90), (235, 40, 40)


class Mark(NamedTuple):
    """A dot on a picture."""

    pos: Float[np.ndarray, " *p"]  # [m]
    colour: Colour
    radius: float = 8.0  # [px] of 512


class TopView:
    """A picture of one environment's house in its current state.

    Args:
        bank: The houses.
        scene: The environment as rays see it.
        pixels: Resolution of the longer side.
        level: Which level that has rooms, from below. All are framed alike, on the rooms of the lowest one.
    """

    def __init__(self, bank: HouseBank, scene: Scene, pixels: int = 512, level: int = 0) -> None:
        house = int(scene.house)
        self.low, self.size, side = _extent(bank, house)
        self.scale = pixels / side
        ticks = (np.arange(pixels) + 0.5) / self.scale
        x, y = np.meshgrid(self.low[0] + ticks, self.low[1] + ticks[::-1])
        top = float(bank.navigation.floor[house, level]) + CUT
        origin = jnp.asarray(np.stack([x, y, np.full_like(x, top)], axis=-1), jnp.float32)
        self.image = np.asarray(_from_above(scene, origin))

    def with_path(
        self, path: Float[np.ndarray, "t 3"], source: Float[np.ndarray, " 3"], size: int
    ) -> UInt8[np.ndarray, "s s 3"]:
        """The picture with a path [m], its end, and the sound source."""
        image = self.marked([Mark(path[-1], HERE, 7), Mark(source, RADIO, 9)], path)
        return np.asarray(Image.fromarray(image).resize((size, size), Image.Resampling.LANCZOS))

    def marked(self, marks: Sequence[Mark], path: Float[np.ndarray, "t 3"] | None = None) -> UInt8[np.ndarray, "s s 3"]:
        """The picture with dots, and a path [m] below them."""
        canvas = Image.fromarray(self.image)
        draw, unit = ImageDraw.Draw(canvas), len(self.image) / 512
        if path is not None and len(path) > 1:
            draw.line([self.pixel(p) for p in path], fill=PATH, width=round(4 * unit))
        for mark in marks:
            (x, y), radius = self.pixel(mark.pos), mark.radius * unit
            draw.ellipse((x - radius, y - radius, x + radius, y + radius), fill=mark.colour)
        return np.asarray(canvas)

    def cropped(self, image: UInt8[np.ndarray, "s s 3"]) -> UInt8[np.ndarray, "h w 3"]:
        """The part of a picture on which there are rooms."""
        width, height = (int(length * self.scale) for length in self.size)
        x, y = (len(image) - width) // 2, (len(image) - height) // 2
        return image[y : y + height, x : x + width]

    def pixel(self, point: Float[np.ndarray, " *p"]) -> tuple[float, float]:
        """Column and row of a point [m]."""
        x, y = (np.asarray(point[:2]) - self.low) * self.scale
        return float(x), float(self.image.shape[0] - y)


def _extent(bank: HouseBank, house: int) -> tuple[np.ndarray, np.ndarray, float]:
    """Lower corner of the square around a house's rooms, extent of the rooms with a margin, side of the square [m]."""
    inside = np.argwhere(np.asarray(bank.navigation.room[house, 0]) >= 0)
    low, high = inside.min(0)[::-1] * bank.spec.cell, (inside.max(0)[::-1] + 1) * bank.spec.cell
    size = high - low + 2 * MARGIN
    side = float(size.max())
    return np.asarray(bank.navigation.origin[house]) + (low + high) / 2 - side / 2, size, side


@jax.jit
def _from_above(scene: Scene, origin: Float[Array, "h w 3"]) -> UInt8[Array, "h w 3"]:
    down = jnp.broadcast_to(jnp.array([0.0, 0.0, -1.0], jnp.float32), origin.shape)
    hit = cast(scene, origin, down)
    # Lower surfaces are darker, so that furniture stands out from the floor.
    light = 1 - 0.5 * jnp.clip(hit.t / CUT, 0, 1)
    color = albedo(scene, hit) * light
    return select(in_wall(scene, origin), Vec(WALL, WALL, WALL), color).map(encode).packed()


def in_wall(scene: Scene, origin: Float[Array, "h w 3"]) -> Bool[Array, "h w"]:
    """Whether points lie inside of walls, which a view from there would look through.

    Walls are closed solids: from inside one, a ray meets the back of a face, in x or in y.

    Args:
        scene: The house.
        origin: Points in the world [m].
    """
    inside = jnp.zeros(origin.shape[:-1], bool)
    for axis in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
        hit = cast(scene, origin, jnp.broadcast_to(jnp.array(axis, jnp.float32), origin.shape))
        inside = inside | ((hit.instance == ARCHITECTURE) & ~hit.front)
    return inside
