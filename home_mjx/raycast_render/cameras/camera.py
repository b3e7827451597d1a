"""Cameras in MuJoCo's convention: looking along -z, +y up. Poses are arrays, lenses are static."""

import math
from dataclasses import dataclass
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float

from home_mjx.core.checks import check_known, check_number
from home_mjx.core.pytree import Pytree
from home_mjx.core.transforms import UNIT_QUAT_TOLERANCE, is_unit_quat, quat_matrix
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.distortion import check_corners, check_distortion, distort, undistort
from home_mjx.schema.categories import CAMERA_MODELS

MODELS = (*CAMERA_MODELS, "fisheye")
MAX_PIXELS = 2**26  # maximum pixels of an image: more is a mistake, and kernels count rays in 32 bits
MAX_SAMPLES = 1 << 16  # maximum rays per pixel
PIXEL_CENTER = (0.5, 0.5)  # centre of a pixel, right and down [px]
# Right, up and forward of the faces of a cube map in the camera's frame: front, right, back, left, up, down.
CUBE_FACES = np.array(
    [
        [[1, 0, 0], [0, 1, 0], [0, 0, -1]],
        [[0, 0, 1], [0, 1, 0], [1, 0, 0]],
        [[-1, 0, 0], [0, 1, 0], [0, 0, 1]],
        [[0, 0, -1], [0, 1, 0], [-1, 0, 0]],
        [[1, 0, 0], [0, 0, 1], [0, 1, 0]],
        [[1, 0, 0], [0, 0, -1], [0, -1, 0]],
    ],
    np.float32,
)


class Camera(Pytree):
    """Pose and field of view of a camera in the world.

    Example:
        >>> upright = jnp.array([0.5**0.5, 0.5**0.5, 0.0, 0.0])  # level, looking along +y
        >>> camera = Camera(jnp.array([0.0, 0.0, 1.5]), upright, jnp.deg2rad(90.0))
    """

    pos: Float[Array, "3"]  # [m]
    quat: Float[Array, "4"]  # w, x, y, z, unit
    fovy: Float[Array, ""]  # [rad]; of an orthographic camera the height of the image [m], as in MuJoCo


@dataclass(frozen=True)
class Lens:
    """Projection model and resolution of a camera; constant in a compiled program.

    Models:

    * pinhole: `fovy` is the vertical field of view; pixels are square.
    * panorama: equirectangular, 360 degrees; the centre is ahead, the left and right edges are behind.
    * cube: six pinholes of 90 degrees; images get a leading axis: front, right, back, left, up, down.
    * orthographic: parallel rays through an image that is `fovy` metres high.
    * lidar: `width` azimuths over 360 degrees as in a panorama, `height` elevations evenly spaced over `elevation`,
      both ends included, the highest first.
    * fisheye: Kannala-Brandt. Distances from the image's centre are `distort` of the angle to the optical axis; `fovy`
      is the vertical field of view, up to 2 pi. Angles beyond pi, in corners of very wide images, count as pi.

    Attributes:
        width: Columns.
        height: Rows.
        model: One of `MODELS`.
        samples: Rays per pixel of colour images, distributed over the pixel; other images use its centre.
        elevation: Lowest and highest beam of a lidar [degrees].
        distortion: Coefficients k1 to k4 of a fisheye (as of OpenCV's module fisheye), or of the radial distortion of a
            pinhole, whose focal length remains that of `fovy`.
        vignette: Darkening of a pinhole's colour images towards their corners; 1: by the cosine to the fourth power.
        shutter: Time of exposure of colour images, as a fraction of the time since the earlier camera that `render`
            gets: motion blur, for which `samples` must be above 1. 0: none.
        readout: Time from the first row's exposure to the last one's, in the same unit: a rolling shutter. The sum of
            both is at most 1.

    Raises:
        ConfigError: The model is unknown, or a number is invalid.

    Example:
        >>> Lens(360, 16, "lidar", elevation=(-15, 15)).shape
        (16, 360)
    """

    width: int = 64
    height: int = 64
    model: str = "pinhole"
    samples: int = 1
    elevation: tuple[float, float] = (-15.0, 15.0)
    distortion: tuple[float, ...] = ()
    vignette: float = 0.0
    shutter: float = 0.0
    readout: float = 0.0

    def __post_init__(self) -> None:
        check_known("camera model", [self.model], MODELS)
        check_distortion(self.distortion, self.model)
        check_number("width of a camera", self.width, 1, integer=True)
        check_number("height of a camera", self.height, 1, integer=True)
        check_number("samples of a camera", self.samples, 1, MAX_SAMPLES, integer=True)
        if math.prod(self.shape) > MAX_PIXELS:
            raise ConfigError(f"an image may have at most {MAX_PIXELS} pixels, got {' x '.join(map(str, self.shape))}")
        if self.model == "cube" and self.width != self.height:
            raise ConfigError(f"the faces of a cube map must be square, got {self.width} x {self.height}")
        is_pair = isinstance(self.elevation, tuple) and len(self.elevation) == 2
        self._check_exposure()
        if not (is_pair and -90 <= self.elevation[0] <= self.elevation[1] <= 90):
            raise ConfigError(f"`elevation` must be (lowest, highest) in [-90, 90] degrees, got {self.elevation}")

    def _check_exposure(self) -> None:
        """Raise `ConfigError` for impossible values of vignette, shutter and readout."""
        check_number("vignette of a camera", self.vignette, 0, 10)
        check_number("shutter of a camera", self.shutter, 0, 1)
        check_number("readout of a camera", self.readout, 0, 1)
        if self.shutter + self.readout > 1 + 1e-9:
            raise ConfigError(f"`shutter` and `readout` are together at most 1, got {self.shutter} and {self.readout}")
        if self.vignette and self.model != "pinhole":
            raise ConfigError(f"only a pinhole may have `vignette`, got the model `{self.model}`")
        if self.shutter and self.samples == 1:
            hint = "Write Lens(samples=8, shutter=0.5)."
            raise ConfigError("motion blur needs several samples per pixel, got `samples` 1", hint=hint)

    @property
    def shape(self) -> tuple[int, ...]:
        """Leading shape of the images: (height, width), or (6, height, width) of a cube."""
        return (6, self.height, self.width) if self.model == "cube" else (self.height, self.width)


def is_valid_camera(camera: Camera, lens: Lens) -> Bool[Array, ""]:
    """Return whether the camera yields an image: finite numbers, a unit quaternion and a valid `fovy`."""
    finite = [jnp.all(jnp.isfinite(leaf)) for leaf in jax.tree.leaves(camera)]
    return jnp.all(jnp.stack([*finite, is_unit_quat(camera.quat), _is_valid_fovy(camera.fovy, lens)]))


def check_camera(camera: Camera, lens: Lens) -> None:
    """Raise `ConfigError` for an invalid camera outside of traces: no unit quaternion, or `fovy` out of range.

    Traced cameras, and numbers that are not finite, pass; the latter give images without hits.
    """
    leaves = jax.tree.leaves(camera)
    if any(isinstance(x, jax.core.Tracer) for x in leaves) or not all(np.isfinite(x).all() for x in leaves):  # pyright: ignore
        return  # poses that are not finite give images without hits
    # NumPy, since JAX operations on concrete arrays return tracers while another function is traced.
    norm, fovy = float(np.linalg.norm(camera.quat)), float(camera.fovy)
    if abs(norm**2 - 1) >= UNIT_QUAT_TOLERANCE:
        hint = "Divide it by its length; (1, 0, 0, 0) is the identity."
        raise ConfigError(f"a camera's quaternion must have unit length, got {norm:.4g}", hint=hint)
    if not _is_valid_fovy(fovy, lens):
        limit = "2 pi" if lens.model == "fisheye" else "pi"
        what = "height [m] above 0" if lens.model == "orthographic" else f"field of view [rad] between 0 and {limit}"
        hint = "Write jnp.deg2rad(degrees)." if fovy > np.pi else "Use a positive number."
        raise ConfigError(f"`fovy` of a camera must be a {what}, got {fovy:g}", hint=hint)
    check_lens(lens, fovy)


def check_lens(lens: Lens, fovy: float) -> None:
    """Raise `ConfigError` if distortion folds an image of vertical field of view `fovy` [rad]."""
    if lens.distortion:
        check_corners(lens.distortion, fovy, lens.width / lens.height, lens.model == "fisheye")


def _is_valid_fovy(fovy: Any, lens: Lens) -> Any:
    """Return whether `fovy` is an angle in (0, pi) or, of a fisheye, (0, 2 pi) [rad], or a height above 0 [m].

    Other lenses ignore it: all numbers but NaN are valid.
    """
    if lens.model in ("pinhole", "fisheye"):
        return (fovy > 0) & (fovy < (np.pi if lens.model == "pinhole" else 2 * np.pi))
    return fovy > 0 if lens.model == "orthographic" else fovy == fovy


def has_intrinsics(lens: Lens) -> bool:
    """Return whether the lens is a pinhole, a cube or a fisheye, which have an intrinsic matrix."""
    return lens.model in ("pinhole", "cube", "fisheye")


def camera_rays(
    camera: Camera, lens: Lens, at: Float[Array, "2"] | tuple[float, float] = PIXEL_CENTER
) -> tuple[Float[Array, "*image 3"], Float[Array, "*image 3"]]:
    """Return world origins and directions of one ray per pixel, row 0 at the top.

    Directions of pinholes and cubes are scaled so that t is the depth along the optical axis; all others are unit
    vectors.

    Args:
        camera: Pose and field of view.
        lens: Model and resolution.
        at: Point in each pixel, right and down from its top left corner [px].
    """
    column, row = (jnp.arange(n, dtype=jnp.float32) + at[i] for i, n in enumerate((lens.width, lens.height)))
    column, row = jnp.meshgrid(column, row)
    turn = quat_matrix(camera.quat)
    if lens.model == "orthographic":
        x, y = _plane_coordinates(column, row, lens, camera.fovy / 2)
        shift = _rotate(turn, jnp.stack([x, y, jnp.zeros_like(x)], axis=-1))
        return jnp.broadcast_to(camera.pos, shift.shape) + shift, jnp.broadcast_to(-turn[:, 2], shift.shape)
    direction = _rotate(turn, _local_directions(camera, lens, column, row))
    return jnp.broadcast_to(camera.pos, direction.shape), direction


def pixel_footprint(camera: Camera, lens: Lens) -> tuple[Float[Array, ""], Float[Array, ""]]:
    """Return the height of a pixel across its ray [m]: at the ray's origin, and its growth per unit of t.

    Angles of panoramas and lidars count as tangents; a lidar's pixel is its elevation range over its rows.
    """
    none = jnp.zeros_like(camera.fovy)
    if lens.model == "orthographic":
        return camera.fovy / lens.height, none
    if lens.model in ("pinhole", "cube"):
        return none, 2 * half_height(camera, lens) / lens.height
    if lens.model == "fisheye":
        return none, camera.fovy / lens.height
    span = 180.0 if lens.model == "panorama" else lens.elevation[1] - lens.elevation[0]
    return none, jnp.full_like(none, np.deg2rad(span) / lens.height)


def intrinsics(camera: Camera, lens: Lens) -> Float[Array, "3 3"]:
    """Return the intrinsic matrix [px]: pixel coordinates (right, down) from camera coordinates (right, down, ahead).

    The origin of pixel coordinates is the image's top left corner.

    Raises:
        ConfigError: The camera is not a pinhole, cube or fisheye.

    Example:
        >>> camera = Camera(jnp.zeros(3), jnp.array([1.0, 0, 0, 0]), jnp.float32(jnp.pi / 2))
        >>> intrinsics(camera, Lens(64, 64)).round(3).tolist()
        [[32.0, 0.0, 32.0], [0.0, 32.0, 32.0], [0.0, 0.0, 1.0]]
    """
    if not has_intrinsics(lens):
        raise ConfigError(f"a camera of model `{lens.model}` has no intrinsic matrix")
    focal = lens.height / 2 / half_height(camera, lens)
    zero, one = jnp.zeros_like(focal), jnp.ones_like(focal)
    middle = one * (lens.width / 2), one * (lens.height / 2)
    rows = [[focal, zero, middle[0]], [zero, focal, middle[1]], [zero, zero, one]]
    return jnp.stack([jnp.stack(row) for row in rows])


def world_from_camera(camera: Camera) -> Float[Array, "4 4"]:
    """Return the homogeneous world-from-camera matrix; camera axes are x right, y up, looking along -z."""
    top = jnp.concatenate([quat_matrix(camera.quat), camera.pos[:, None]], axis=1)
    return jnp.concatenate([top, jnp.array([[0.0, 0.0, 0.0, 1.0]], jnp.float32)])


def depth_points(camera: Camera, lens: Lens, depth: Float[Array, "*image 1"]) -> Float[Array, "*image 3"]:
    """Return the world points [m] of an unclipped depth image (t of the camera's rays); not finite on a miss.

    Example:
        >>> images = render(scene, camera, lens, kinds=("depth",), depth_max=None)  # doctest: +SKIP
        >>> points = depth_points(camera, lens, images["depth"])  # doctest: +SKIP
    """
    origin, direction = camera_rays(camera, lens)
    return origin + direction * depth


def _local_directions(
    camera: Camera, lens: Lens, column: Float[Array, "h w"], row: Float[Array, "h w"]
) -> Float[Array, "*image 3"]:
    """Return camera-frame directions (x right, y up, -z ahead) through pixel coordinates, which start at the top left.

    Panoramas and lidars get unit vectors; pinholes and the faces of cubes, depth 1 along their axes. Cubes get a
    leading axis of faces, as in `CUBE_FACES`. Orthographic lenses are not supported.
    """
    if lens.model in ("panorama", "lidar"):
        return _sphere_directions(column, row, lens)
    x, y = _plane_coordinates(column, row, lens, half_height(camera, lens))
    if lens.model == "fisheye" or lens.distortion:
        return _bent_directions(x, y, lens)
    if lens.model == "pinhole":
        return jnp.stack([x, y, -jnp.ones_like(x)], axis=-1)
    weight = jnp.stack([x, y, jnp.ones_like(x)], axis=-1)
    return jnp.sum(jnp.asarray(CUBE_FACES)[:, None, None] * weight[None, ..., None], axis=-2)


def _bent_directions(x: Float[Array, "h w"], y: Float[Array, "h w"], lens: Lens) -> Float[Array, "h w 3"]:
    """Return directions of a fisheye (unit vectors) or distorted pinhole (depth 1) at coordinates over focal length."""
    radius = jnp.maximum(jnp.hypot(x, y), 1e-12)
    found = undistort(radius, lens.distortion)
    if lens.model == "pinhole":
        return jnp.stack([x * (found / radius), y * (found / radius), -jnp.ones_like(x)], axis=-1)
    angle = jnp.clip(found, 0.0, np.pi)
    side = jnp.sin(angle) / radius
    return jnp.stack([x * side, y * side, -jnp.cos(angle)], axis=-1)


def half_height(camera: Camera, lens: Lens) -> Float[Array, ""]:
    """Return half the image height over the focal length: 1 for a cube, tan(fovy / 2) for a pinhole."""
    if lens.model == "fisheye":
        return distort(camera.fovy / 2, lens.distortion)
    return jnp.ones_like(camera.fovy) if lens.model == "cube" else jnp.tan(camera.fovy / 2)


def _plane_coordinates(
    column: Float[Array, "h w"], row: Float[Array, "h w"], lens: Lens, half: Float[Array, ""]
) -> tuple[Float[Array, "h w"], Float[Array, "h w"]]:
    """Map pixel coordinates to ones right and up from the image's centre, in the unit of its half height `half`.

    The origin of pixel coordinates is the image's top left corner.
    """
    x, y = column * (2 / lens.width) - 1, 1 - row * (2 / lens.height)
    return x * half * (lens.width / lens.height), y * half


def _sphere_directions(column: Float[Array, "h w"], row: Float[Array, "h w"], lens: Lens) -> Float[Array, "h w 3"]:
    """Return unit directions of a panorama or lidar (x right, y up, -z ahead) at pixel coordinates from top left.

    Columns turn from behind to the left, ahead, and to the right. Rows of a panorama go from up to down. Centres of a
    lidar's first and last row have its highest and lowest elevation; a single row, the mean.
    """
    left = (0.5 - column / lens.width) * (2 * np.pi)
    if lens.model == "panorama":
        up = (0.5 - row / lens.height) * np.pi
    else:
        low, high = np.deg2rad(lens.elevation).tolist()
        share = (row - 0.5) / max(lens.height - 1, 1) if lens.height > 1 else jnp.full_like(row, 0.5)
        up = high - (high - low) * share
    return jnp.stack([-jnp.sin(left) * jnp.cos(up), jnp.sin(up), -jnp.cos(left) * jnp.cos(up)], axis=-1)


def _rotate(turn: Float[Array, "3 3"], local: Float[Array, "*image 3"]) -> Float[Array, "*image 3"]:
    """Multiply vectors by a rotation matrix, in full float32 precision on accelerators."""
    # Not a matrix product: accelerators may compute those with reduced precision.
    return jnp.sum(turn.reshape((1,) * (local.ndim - 1) + (3, 3)) * local[..., None, :], axis=-1)
