"""Grid of small pictures of several environments, one of which is watched."""

import math
from collections.abc import Sequence
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import UInt8

from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.browser.live_camera import encode_jpeg
from home_mjx.viewer.episodes.viewpoints import FIRST, FREE, TOP, EpisodeCamera

TILE_SIZE = 160  # [px]
MAX_TILES = 9
TILE_MARK = b"\x01"  # first byte of a message with a grid; pictures begin with JPEG's 0xff


class TileCamera:
    """Cameras of several environments, which one jitted call renders.

    Args:
        env: The environment.
        size: Width and height of a tile [px].
    """

    def __init__(self, env: Env[HouseholdEnv], size: int = TILE_SIZE) -> None:
        self.env, self._camera, self._lens = env, EpisodeCamera(env), Lens(size, size)
        self._see = jax.jit(self._seen, static_argnums=3)

    def capture(self, states: State, viewpoint: str = FIRST) -> UInt8[np.ndarray, "h w 3"]:
        """Return the grid of a batch of states, row by row; tiles beyond its length are black.

        The shader is `fast`. The free camera is of one house only, so that its grids are in the first person.
        """
        viewpoint = FIRST if viewpoint == FREE else viewpoint
        spots = None
        if viewpoint == TOP:
            overviews = [self._camera.place_overview(int(house)) for house in np.asarray(states.world.house)]
            spots = jax.tree.map(lambda *x: jnp.stack(x), *overviews)
        return join_tiles(np.asarray(self._see(self.env.params, states, spots, viewpoint)))

    def _seen(self, params: EnvParams, states: State, spots: Any, viewpoint: str) -> Any:
        """Return the images of all states; to be jitted."""

        def look(state: State, spot: Any) -> Any:
            """Render one environment."""
            snapshot = self.env.core.snapshot(params, state)
            return self._camera.see(snapshot, self._lens, "rgb", "fast", viewpoint, spot)

        return jax.vmap(look)(states, spots)


def join_tiles(images: UInt8[np.ndarray, "n h w 3"]) -> UInt8[np.ndarray, "r c 3"]:
    """Return images side by side in a grid of `count_columns` columns.

    Example:
        >>> join_tiles(np.ones((3, 2, 2, 3), np.uint8))[..., 0].tolist()
        [[1, 1, 1, 1], [1, 1, 1, 1], [1, 1, 0, 0], [1, 1, 0, 0]]
    """
    count, height, width, _ = images.shape
    columns = count_columns(count)
    rows = -(-count // columns)
    grid = np.zeros((rows * columns, height, width, 3), np.uint8)
    grid[:count] = images
    return grid.reshape(rows, columns, height, width, 3).swapaxes(1, 2).reshape(rows * height, columns * width, 3)


def count_columns(count: int) -> int:
    """Return the number of columns of a grid."""
    return math.ceil(math.sqrt(count))


def choose_tiles(watched: int, num_envs: int, num_tiles: int = MAX_TILES) -> np.ndarray:
    """Return the numbers of the environments in the grid: the page of `num_tiles` that has the watched one.

    Example:
        >>> choose_tiles(10, 64, 4).tolist(), choose_tiles(10, 11, 4).tolist()
        ([8, 9, 10, 11], [7, 8, 9, 10])
    """
    count = min(num_tiles, num_envs)
    first = min(watched // count * count, num_envs - count)
    return np.arange(first, first + count)


def stack_states(states: Sequence[State]) -> State:
    """Return states of single environments as a batch."""
    return _stack(tuple(states))


@jax.jit
def _stack(states: tuple[State, ...]) -> State:
    """Return the states with a leading axis."""
    return jax.tree.map(lambda *x: jnp.stack(x), *states)


def encode_tiles(grid: UInt8[np.ndarray, "r c 3"]) -> bytes:
    """Return a grid as a message to pages."""
    return TILE_MARK + encode_jpeg(grid)
