"""Picture of the watched agent by the package's own renderer: colours by any shader, depth, normals or ids."""

import dataclasses
import io
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jaxtyping import UInt8
from PIL import Image

from home_mjx.core.checks import check_known, check_number
from home_mjx.raycast_render.cameras.camera import Camera, Lens
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.viewer.episodes.viewpoints import FIRST, FREE, TOP, VIEWPOINTS, EpisodeCamera
from home_mjx.viewer.pictures.pictures import colour_depth, colour_ids

SHADERS = ("fast", "lit")
PICTURES = {"colours": "rgb", "depth": "depth", "normals": "normal", "object ids": "instance", "categories": "fine"}
MIN_SIZE, MAX_SIZE = 16, 1024  # [px]
JPEG_QUALITY = 85


@dataclass(frozen=True)
class PictureOptions:
    """Options of the picture.

    Attributes:
        kind: One of `PICTURES`.
        shader: Shader of colours, such as `fast` or `lit`.
        size: Width and height [px].
        viewpoint: One of `VIEWPOINTS`.

    Raises:
        UnknownNameError: The kind or the viewpoint is unknown.
        ConfigError: The size is out of range.
    """

    kind: str = "colours"
    shader: str = "fast"
    size: int = 512
    viewpoint: str = FIRST

    def __post_init__(self) -> None:
        check_known("picture", [self.kind], PICTURES)
        check_known("camera", [self.viewpoint], VIEWPOINTS)
        check_number("size", self.size, MIN_SIZE, MAX_SIZE, integer=True)


class LiveCamera:
    """Pictures of an agent's environment from any viewpoint.

    Args:
        env: The environment.
        agent: Number of the agent.

    Attributes:
        free: Camera of the viewpoint `free`; None: pictures of it are `top-down`.
    """

    def __init__(self, env: Env[HouseholdEnv], agent: int = 0) -> None:
        self.env, self._camera = env, EpisodeCamera(env, agent)
        self._see = jax.jit(self._seen, static_argnums=3)
        self.free: Camera | None = None

    def capture(self, state: State, options: PictureOptions) -> UInt8[np.ndarray, "h w 3"]:
        """Render the picture of a state of one environment; each new choice of options compiles once."""
        if options.viewpoint == FREE and self.free is None:
            options = dataclasses.replace(options, viewpoint=TOP)
        image = np.asarray(self._see(self.env.params, state, self._spot(state, options), options))
        if options.kind == "depth":
            return colour_depth(image[..., 0], self.env.config.max_depth)
        if options.kind == "normals":
            return np.round(127.5 * (image + 1)).astype(np.uint8)
        return image if options.kind == "colours" else colour_ids(image)

    def _spot(self, state: State, options: PictureOptions) -> Camera | None:
        """Return the camera that the viewpoint needs."""
        overview = self._camera.place_overview(int(state.world.house)) if options.viewpoint == TOP else None
        return self.free if options.viewpoint == FREE else overview

    def _seen(self, params: EnvParams, state: State, spot: Camera | None, options: PictureOptions) -> Any:
        """Return the image of a state, not coloured; to be jitted."""
        snapshot, lens = self.env.core.snapshot(params, state), Lens(options.size, options.size)
        return self._camera.see(snapshot, lens, PICTURES[options.kind], options.shader, options.viewpoint, spot)


def encode_jpeg(image: UInt8[np.ndarray, "h w 3"]) -> bytes:
    """Return an image as JPEG."""
    data = io.BytesIO()
    Image.fromarray(image).save(data, "JPEG", quality=JPEG_QUALITY)
    return data.getvalue()
