"""Camera rays follow MuJoCo's convention."""

import jax
import jax.numpy as jnp
import mujoco
import numpy as np
import pytest

from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import (
    Camera,
    Lens,
    camera_rays,
    intrinsics,
    pixel_footprint,
    world_from_camera,
)


def rays(quat, fovy=np.pi / 2, width=4, height=4):
    camera = Camera(jnp.zeros(3), jnp.asarray(quat, jnp.float32), jnp.float32(fovy))
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(camera_rays(camera, Lens(width, height))[1])


def test_an_unturned_camera_looks_along_minus_z_with_y_up_and_x_right():
    d = rays([1, 0, 0, 0])
    np.testing.assert_allclose(d[0, 0], [-0.75, 0.75, -1], atol=1e-6)  # top left
    np.testing.assert_allclose(d[0, 3], [0.75, 0.75, -1], atol=1e-6)  # top right
    np.testing.assert_allclose(d[3, 0], [-0.75, -0.75, -1], atol=1e-6)  # bottom left


@pytest.mark.parametrize("shape", [(5, 3), (3, 5)])
def test_pixels_are_square_and_fovy_is_vertical(shape):
    height, width = shape
    d = rays([1, 0, 0, 0], fovy=1.0, width=width, height=height)
    step = 2 * np.tan(0.5) / height
    np.testing.assert_allclose(np.diff(d[..., 0], axis=1), step, rtol=1e-5)
    np.testing.assert_allclose(np.diff(d[..., 1], axis=0), -step, rtol=1e-5)
    np.testing.assert_allclose(d.mean(axis=(0, 1)), [0, 0, -1], atol=1e-6)


def test_turned_cameras_agree_with_mujoco_s_camera_frame(rng):
    quat = rng.normal(size=4)
    quat /= np.linalg.norm(quat)
    spec = mujoco.MjSpec()
    spec.worldbody.add_camera(name="eye", quat=quat)
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    frame = data.cam_xmat[0].reshape(3, 3)
    np.testing.assert_allclose(rays(quat), rays([1, 0, 0, 0]) @ frame.T, atol=1e-6)


def pixel_of(lens, point, fovy):
    """Fractional column and row of a point in the camera's frame, from the definition of each model."""
    x, y, z = point
    if lens.model == "lidar":
        low, high = lens.elevation
        row = (high - np.rad2deg(np.arctan2(y, np.hypot(x, z)))) / max(high - low, 1e-9)
        row = row * (lens.height - 1) + 0.5
        return (0.5 - np.arctan2(-x, -z) / (2 * np.pi)) * lens.width, row
    if lens.model == "panorama":
        azimuth, elevation = np.arctan2(-x, -z), np.arctan2(y, np.hypot(x, z))
        return (0.5 - azimuth / (2 * np.pi)) * lens.width, (0.5 - elevation / np.pi) * lens.height
    focal = lens.height / fovy if lens.model == "orthographic" else lens.height / 2 / np.tan(fovy / 2)
    depth = 1 if lens.model == "orthographic" else -z
    return lens.width / 2 + focal * x / depth, lens.height / 2 - focal * y / depth


def some_camera(rng, fovy=1.2):
    quat = rng.normal(size=4)
    pos = rng.normal(size=3)
    return Camera(*(jnp.asarray(x, jnp.float32) for x in (pos, quat / np.linalg.norm(quat), fovy)))


@pytest.mark.parametrize(
    "lens",
    [
        Lens(7, 5),
        Lens(16, 8, "panorama"),
        Lens(6, 9, "orthographic"),
        Lens(12, 5, "lidar", elevation=(-30, 10)),
        Lens(12, 1, "lidar", elevation=(5, 5)),
    ],
    ids=lambda lens: f"{lens.model}{lens.height}",
)
def test_a_ray_through_a_pixel_meets_what_projects_there(rng, lens):
    camera = some_camera(rng)
    matrix = np.asarray(world_from_camera(camera), float)
    for at in ((0.5, 0.5), (0.1, 0.8)) if lens.model != "lidar" else ((0.5, 0.5),):
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            origin, direction = (np.asarray(x, float) for x in camera_rays(camera, lens, at))
        assert direction.shape == (*lens.shape, 3)
        points = origin + 2.5 * direction
        local = (points - matrix[:3, 3]) @ matrix[:3, :3]
        for row, column in np.ndindex(lens.shape):
            found = pixel_of(lens, local[row, column], 1.2)
            if lens.height == 1:
                assert np.rad2deg(np.arcsin(local[row, column, 1] / 2.5)) == pytest.approx(5, abs=1e-3)
                found = found[0], at[1]
            np.testing.assert_allclose(found, (column + at[0], row + at[1]), atol=2e-4)
        if lens.model != "pinhole":
            np.testing.assert_allclose(np.linalg.norm(direction, axis=-1), 1, atol=1e-5)


def test_the_faces_of_a_cube_map_are_pinholes_turned_by_right_angles(rng):
    camera, lens = some_camera(rng), Lens(4, 4, "cube")
    turn = np.asarray(world_from_camera(camera))[:3, :3]
    _, direction = camera_rays(camera, lens)
    middle = np.asarray(direction).mean(axis=(1, 2)) @ turn
    ahead, right, up = [0, 0, -1], [1, 0, 0], [0, 1, 0]
    expected = [ahead, right, np.negative(ahead), np.negative(right), up, np.negative(up)]
    np.testing.assert_allclose(middle, expected, atol=1e-6)
    front = camera_rays(camera.replace(fovy=jnp.float32(np.pi / 2)), Lens(4, 4))[1]
    np.testing.assert_allclose(direction[0], front, atol=1e-6)
    # Edges of neighbouring faces lie beside one another: their directions turn by less than two pixels.
    for side in (direction[0][:, -1] - direction[1][:, 0], direction[0][0] - direction[4][-1]):
        assert np.linalg.norm(np.asarray(side), axis=-1).max() < 2 * 2 / 4
    # Together they see every direction once.
    solid = np.sum(np.linalg.norm(np.asarray(direction), axis=-1) ** -3) * (2 / 4) ** 2
    assert solid == pytest.approx(4 * np.pi, rel=0.02)


def test_intrinsics_project_what_the_rays_see(rng):
    camera, lens = some_camera(rng), Lens(7, 5)
    matrix, inverse = np.asarray(intrinsics(camera, lens), float), np.linalg.inv(np.asarray(world_from_camera(camera)))
    origin, direction = (np.asarray(x, float) for x in camera_rays(camera, lens))
    local = (origin + 3 * direction) @ inverse[:3, :3].T + inverse[:3, 3]
    ahead = local * [1, -1, -1]  # x right, y down, z ahead
    pixel = ahead @ matrix.T
    columns, rows = np.meshgrid(np.arange(7) + 0.5, np.arange(5) + 0.5)
    np.testing.assert_allclose(pixel[..., 0] / pixel[..., 2], columns, atol=1e-4)
    np.testing.assert_allclose(pixel[..., 1] / pixel[..., 2], rows, atol=1e-4)
    with pytest.raises(ConfigError, match="panorama"):
        intrinsics(camera, Lens(8, 4, "panorama"))


@pytest.mark.parametrize("lens", [Lens(9, 6), Lens(9, 6, "orthographic")])
def test_the_width_of_a_pixel_is_the_distance_of_neighbouring_rays(rng, lens):
    camera = some_camera(rng)
    first, growth = pixel_footprint(camera, lens)
    origin, direction = camera_rays(camera, lens)
    for t in (0.0, 2.0):
        points = np.asarray(origin + t * direction)
        np.testing.assert_allclose(np.linalg.norm(np.diff(points, axis=0), axis=-1), first + t * growth, rtol=1e-3)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"width": 0}, "`width of a camera` must be a whole number of at least 1, got 0"),
        ({"height": -3}, "`height of a camera`"),
        ({"samples": 0}, "`samples of a camera`"),
        ({"model": "pinehole"}, "Did you mean `pinhole`"),
        ({"model": "cube", "width": 8, "height": 4}, "square"),
        ({"model": "lidar", "elevation": (10.0, -10.0)}, "`elevation`"),
    ],
)
def test_lenses_that_make_no_image_are_refused(options, words):
    with pytest.raises(ConfigError, match=words):
        Lens(**options)
