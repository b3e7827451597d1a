"""A house from above, without ceilings, with paths drawn on it."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, UInt8
from PIL import Image, ImageDraw

from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.raycast_render.scene.vec import Vec, select
from home_mjx.raycast_render.shading.shading import albedo, encode
from home_mjx.schema.compiled import ARCHITECTURE

CUT = 2.2  # [m] above the floor: above furniture and doors, below lintels' tops and ceilings
MARGIN = 0.4  # [m] around the walls
WALL = 0.02  # linear grey of cut walls
PATH, HERE, RADIO = (40, 90, 255), (20, 200, 90), (235, 40, 40)


class TopView:
    """A picture of one environment's house in its current state.

    Args:
        bank: The houses.
        scene: The environment as rays see it.
        pixels: Resolution of the longer side.
    """

    def __init__(self, bank: HouseBank, scene: Scene, pixels: int = 512) -> None:
        house = int(scene.house)
        self.low, side = _extent(bank, house)
        self.scale = pixels / side
        ticks = (np.arange(pixels) + 0.5) / self.scale
        x, y = np.meshgrid(self.low[0] + ticks, self.low[1] + ticks[::-1])
        top = float(bank.physics.floor[house]) + CUT
        origin = jnp.asarray(np.stack([x, y, np.full_like(x, top)], axis=-1), jnp.float32)
        self.image = np.asarray(_from_above(scene, origin))

    def with_path(
        self, path: Float[np.ndarray, "t 3"], source: Float[np.ndarray, " 3"], size: int
    ) -> UInt8[np.ndarray, "s s 3"]:
        """The picture with a path [m], its end, and the sound source."""
        canvas = Image.fromarray(self.image)
        draw = ImageDraw.Draw(canvas)
        points = [self._pixel(p) for p in path]
        if len(points) > 1:
            draw.line(points, fill=PATH, width=4)
        self._dot(draw, points[-1], 7, HERE)
        self._dot(draw, self._pixel(source), 9, RADIO)
        return np.asarray(canvas.resize((size, size), Image.Resampling.LANCZOS))

    def _pixel(self, point: Float[np.ndarray, " 3"]) -> tuple[float, float]:
        x, y = (np.asarray(point[:2]) - self.low) * self.scale
        return float(x), float(self.image.shape[0] - y)

    def _dot(self, draw: Any, at: tuple[float, float], radius: float, colour: tuple[int, int, int]) -> None:
        draw.ellipse((at[0] - radius, at[1] - radius, at[0] + radius, at[1] + radius), fill=colour)


def _extent(bank: HouseBank, house: int) -> tuple[np.ndarray, float]:
    """Lower corner and side of the square around a house's rooms [m]."""
    inside = np.argwhere(np.asarray(bank.navigation.room[house, 0]) >= 0)
    low, high = inside.min(0)[::-1] * bank.spec.cell, (inside.max(0)[::-1] + 1) * bank.spec.cell
    side = float((high - low).max()) + 2 * MARGIN
    return np.asarray(bank.navigation.origin[house]) + (low + high) / 2 - side / 2, side


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
