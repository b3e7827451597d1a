"""Picture of the watched agent by the package's own renderer: colours by any shader, depth, normals or ids."""

import io
from dataclasses import dataclass
from typing import Any

import jax
import numpy as np
from jaxtyping import UInt8
from PIL import Image

from home_mjx.core.checks import check_known, check_number
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.tasks.base.config import AgentCamera
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.sensors.cameras import agent_ids, place_cameras
from home_mjx.viewer.pictures.pictures import colour_depth, colour_ids

FOVY = 75.0  # [degrees] vertical field of view
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

    Raises:
        UnknownNameError: The kind is unknown.
        ConfigError: The size is out of range.
    """

    kind: str = "colours"
    shader: str = "fast"
    size: int = 512

    def __post_init__(self) -> None:
        check_known("picture", [self.kind], PICTURES)
        check_number("size", self.size, MIN_SIZE, MAX_SIZE, integer=True)


class LiveCamera:
    """Camera at an agent's eyes, independent of its observations.

    Args:
        env: The environment.
        agent: Number of the agent.
    """

    def __init__(self, env: Env[HouseholdEnv], agent: int = 0) -> None:
        self.env, self.agent = env, agent
        self._see = jax.jit(self._seen, static_argnums=2)

    def capture(self, state: State, options: PictureOptions) -> UInt8[np.ndarray, "h w 3"]:
        """Render the picture of a state of one environment; each new choice of options compiles once."""
        image = np.asarray(self._see(self.env.params, state, options))
        if options.kind == "depth":
            return colour_depth(image[..., 0], self.env.config.max_depth)
        if options.kind == "normals":
            return np.round(127.5 * (image + 1)).astype(np.uint8)
        return image if options.kind == "colours" else colour_ids(image)

    def _seen(self, params: EnvParams, state: State, options: PictureOptions) -> Any:
        """Return the image of the first kind in `options`, not coloured; to be jitted."""
        core, kind = self.env.core, PICTURES[options.kind]
        snapshot, lens = core.snapshot(params, state), Lens(options.size, options.size)
        view = AgentCamera("viewer", ("rgb",), lens, fovy=FOVY, shader=options.shader)
        cameras = place_cameras(core.config, view, snapshot.pose, snapshot.camera_offsets)
        camera = jax.tree.map(lambda x: x[self.agent], cameras)
        own = agent_ids(snapshot.bank, core.config.num_agents)[self.agent]
        limit = core.config.max_depth
        images: dict[str, Any] = render(
            snapshot.scene, camera, lens, kinds=(kind,), shader=options.shader, exclude=own, depth_max=limit
        )
        return images[kind]


def encode_jpeg(image: UInt8[np.ndarray, "h w 3"]) -> bytes:
    """Return an image as JPEG."""
    data = io.BytesIO()
    Image.fromarray(image).save(data, "JPEG", quality=JPEG_QUALITY)
    return data.getvalue()
