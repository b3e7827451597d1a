"""Free camera of the picture, which follows the camera of the 3D scene in the page that moved last."""

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
from jaxtyping import Float

from home_mjx.core.transforms import quat_multiply
from home_mjx.raycast_render.cameras.camera import Camera
from home_mjx.viewer.browser.broadcast import Broadcast

HALF_TURN = (0.0, 1.0, 0.0, 0.0)  # about x: from viser's camera frame (+z ahead, +y down) to MuJoCo's


class FreeCamera:
    """Free camera of all pages.

    Args:
        broadcast: Scene and picture.
        post: Function that runs a command on the simulation's thread.
    """

    def __init__(self, broadcast: Broadcast, post: Callable[[Callable[[], Any]], None]) -> None:
        self._broadcast, self._post = broadcast, post
        self._camera: Camera | None = None

    def follow(self, client: Any) -> None:
        """Follow the camera of a page's scene; on a viser thread, called once for each page."""
        client.camera.on_update(self._move)

    def _move(self, view: Any) -> None:
        """Store a page's camera; it is set on the simulation's thread, unless an earlier one still waits there."""
        is_waiting = self._camera is not None
        self._camera = convert_camera(view.position, view.wxyz, view.fov)
        if not is_waiting:
            self._post(self._set)

    def _set(self) -> None:
        """Set the last camera."""
        camera, self._camera = self._camera, None
        if camera is not None:
            self._broadcast.set_free_camera(camera)


def convert_camera(position: Float[np.ndarray, " 3"], wxyz: Float[np.ndarray, " 4"], fov: float) -> Camera:
    """Return viser's camera as one of ours.

    Args:
        position: [m].
        wxyz: Rotation of the camera's frame, with +z ahead and +y down.
        fov: Vertical field of view [rad].

    Example:
        >>> camera = convert_camera(np.zeros(3), np.array([1.0, 0, 0, 0]), 1.0)  # looks along +z
        >>> camera.quat.tolist()
        [0.0, 1.0, 0.0, 0.0]
    """
    quat = quat_multiply(jnp.asarray(wxyz, jnp.float32), jnp.array(HALF_TURN))
    return Camera(jnp.asarray(position, jnp.float32), quat, jnp.float32(fov))
