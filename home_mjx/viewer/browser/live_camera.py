"""Picture of the watched agent by the package's own renderer: colours by any shader, depth, normals or ids."""

import dataclasses
import io
import threading
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
MAX_PICTURE_SECONDS = 0.045  # [s], of pictures while something moves, for 20 a second
SHRINKS = (1, 2, 4)  # of width and height
PACE_WEIGHT = 0.2  # weight of the last picture in the mean of times


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
        self._ready: set[PictureOptions] = set()
        self._thread: threading.Thread | None = None
        self._preparing: PictureOptions | None = None

    def capture(self, state: State, options: PictureOptions) -> UInt8[np.ndarray, "h w 3"]:
        """Render the picture of a state of one environment; each new choice of options compiles once."""
        if options == self._preparing and threading.current_thread() is not self._thread and self._thread is not None:
            self._thread.join()  # rather than to compile it twice
        if options.viewpoint == FREE and self.free is None:
            return self.capture(state, dataclasses.replace(options, viewpoint=TOP))
        image = np.asarray(self._see(self.env.params, state, self._spot(state, options), options))
        self._ready.add(options)
        if options.kind == "depth":
            return colour_depth(image[..., 0], self.env.config.max_depth)
        if options.kind == "normals":
            return np.round(127.5 * (image + 1)).astype(np.uint8)
        return image if options.kind == "colours" else colour_ids(image)

    def is_ready(self, options: PictureOptions) -> bool:
        """Return whether the program of these options is compiled."""
        return options in self._ready

    def prepare(self, state: State, options: PictureOptions) -> None:
        """Compile the program of some options in a thread; one at a time."""
        if self._thread is None or not self._thread.is_alive():
            self._preparing = options
            self._thread = threading.Thread(target=self.capture, args=(state, options), daemon=True)
            self._thread.start()

    def _spot(self, state: State, options: PictureOptions) -> Camera | None:
        """Return the camera that the viewpoint needs."""
        overview = self._camera.place_overview(int(state.world.house)) if options.viewpoint == TOP else None
        return self.free if options.viewpoint == FREE else overview

    def _seen(self, params: EnvParams, state: State, spot: Camera | None, options: PictureOptions) -> Any:
        """Return the image of a state, not coloured; to be jitted."""
        snapshot, lens = self.env.core.snapshot(params, state), Lens(options.size, options.size)
        return self._camera.see(snapshot, lens, PICTURES[options.kind], options.shader, options.viewpoint, spot)


class PicturePace:
    """Size of pictures while something moves, so that each takes at most `MAX_PICTURE_SECONDS`.

    It halves while pictures of the full size are too slow, at most twice. Times are proportional to pixels.

    Example:
        >>> pace = PicturePace()
        >>> pace.choose(512)
        512
        >>> pace.record(512, 0.1)
        >>> pace.choose(512)
        256
    """

    def __init__(self) -> None:
        self._seconds_per_pixel: float | None = None

    def record(self, size: int, seconds: float) -> None:
        """Add the time of a picture."""
        measured, last = seconds / size**2, self._seconds_per_pixel
        self._seconds_per_pixel = measured if last is None else last + PACE_WEIGHT * (measured - last)

    def choose(self, size: int) -> int:
        """Return the largest size that is fast enough; the smallest one if none is."""
        sizes = [size // shrink for shrink in SHRINKS if size // shrink >= MIN_SIZE]
        cost = self._seconds_per_pixel or 0.0
        return next((n for n in sizes if n**2 * cost <= MAX_PICTURE_SECONDS), sizes[-1])


def encode_jpeg(image: UInt8[np.ndarray, "h w 3"]) -> bytes:
    """Return an image as JPEG."""
    data = io.BytesIO()
    Image.fromarray(image).save(data, "JPEG", quality=JPEG_QUALITY)
    return data.getvalue()
