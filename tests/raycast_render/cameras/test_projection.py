"""Lenses against closed forms and each other: fisheye, distortion, projection, and optical flow."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from numpy.testing import assert_allclose

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.errors import ConfigError
from home_mjx.raycast_render import Camera, Lens, camera_rays, intrinsics, make_scene, optical_flow, project, render
from home_mjx.raycast_render.cameras.camera import check_lens

CURVED = (0.05, -0.02, 0.003)
AHEAD = np.pi / 2  # yaw that looks along +y


def camera(pos=(0.3, -0.2, 1.5), yaw=0.4, pitch=-0.2, fovy=1.4):
    return Camera(jnp.array(pos), camera_quat(jnp.float32(yaw), jnp.float32(pitch)), jnp.float32(fovy))


@pytest.mark.parametrize(
    ("lens", "fovy"),
    [
        (Lens(24, 16), 1.4),
        (Lens(24, 16, distortion=(-0.12, 0.02)), 1.2),
        (Lens(16, 16, "fisheye", distortion=CURVED), 3.0),
        (Lens(16, 12, "fisheye"), 3.4),
        (Lens(16, 12, "orthographic"), 4.0),
        (Lens(24, 12, "panorama"), 1.0),
    ],
)
def test_points_along_rays_project_to_the_middles_of_their_pixels(lens, fovy):
    seen = camera(fovy=fovy)
    origin, direction = camera_rays(seen, lens)
    pixel, known = jax.jit(project, static_argnums=1)(seen, lens, origin + 2.5 * direction)
    column, row = np.meshgrid(np.arange(lens.width) + 0.5, np.arange(lens.height) + 0.5)
    assert_allclose(pixel, np.stack([column, row], axis=-1), atol=2e-3)
    assert known.all()


def test_a_fisheye_is_kannala_and_brandts():
    """The distance from the centre is f (t + k1 t^3 + k2 t^5 + ...); the upper edge is half the field of view."""
    lens, seen = Lens(64, 64, "fisheye", distortion=CURVED), camera(yaw=AHEAD, pitch=0.0, fovy=3.0)
    focal = float(intrinsics(seen, lens)[0, 0])
    assert focal * np.polyval([*CURVED[::-1], 1], 1.5**2) * 1.5 == pytest.approx(32, rel=1e-5)
    for angle in (0.1, 0.9, 1.45):
        ahead, side = np.cos(angle), np.sin(angle)
        found, _ = project(seen, lens, seen.pos + jnp.array([side, ahead, 0.0]))
        assert float(found[0]) - 32 == pytest.approx(focal * angle * np.polyval([*CURVED[::-1], 1], angle**2), abs=1e-3)


def test_distortions_that_fold_or_have_no_meaning_are_refused():
    for wrong in ({"distortion": (-0.5,)}, {"distortion": (0.1,) * 5}, {"model": "panorama", "distortion": (0.1,)}):
        with pytest.raises(ConfigError):
            Lens(**wrong)
    with pytest.raises(ConfigError):
        project(camera(), Lens(8, 8, "cube"), jnp.zeros(3))
    bent = Lens(8, 8, "fisheye", distortion=(0.05, -0.02))  # turns back at 1.98 rad
    check_lens(bent, np.deg2rad(120))
    for lens, fovy in ((bent, np.deg2rad(220)), (Lens(8, 8, distortion=(-0.12,)), 2.4)):
        with pytest.raises(ConfigError, match="folds the corners"):
            check_lens(lens, fovy)


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=[Furniture((0.0, 1.5), (0.6, 0.6, 0.6), mass=2.0)])])


def scene(bank, shift=(0.0, 0.0, 0.0)):
    nobody = jnp.zeros((0, 3)), jnp.zeros((0, 4))
    physics = bank.physics
    return make_scene(bank, jnp.int32(0), physics.body_pos[0] + jnp.array(shift), physics.body_quat[0], *nobody)


def test_flow_of_walls_is_that_of_the_camera_and_of_a_box_that_of_both(bank):
    """Depth and poses of cameras give the walls' flow by hand; a box that moves with the camera stands still."""
    lens, step = Lens(24, 24), (0.2, 0.1, 0.0)
    now, then = camera((0.2, -0.9, 0.6), AHEAD, 0.0), camera((0.0, -1.0, 0.6), AHEAD, 0.0)
    flow, known = optical_flow(scene(bank, step), now, scene(bank), then, lens)
    images = render(scene(bank, step), now, lens, kinds=("depth", "instance"), depth_max=None)
    origin, direction = camera_rays(now, lens)
    point = np.asarray(origin + direction * images["depth"])
    x, y, z = np.moveaxis(point - np.asarray(then.pos), -1, 0)
    focal = 12 / np.tan(0.7)
    before = np.stack([12 + focal * x / y, 12 - focal * z / y], axis=-1)
    column, row = np.meshgrid(np.arange(24) + 0.5, np.arange(24) + 0.5)
    wall = np.asarray(images["instance"]) < 0
    assert (~wall).sum() > 10
    assert_allclose(flow[wall], (np.stack([column, row], axis=-1) - before)[wall], atol=1e-2)
    assert_allclose(flow[~wall], 0.0, atol=1e-2)
    assert known.all()


def test_radiance_is_light_before_the_tone_curve(bank):
    """With `fast`, whose curve only clips, its sRGB code is the colour image, also of several samples."""
    for lens in (Lens(8, 8), Lens(8, 8, samples=3)):
        images = render(scene(bank), camera(), lens, kinds=("rgb", "radiance"))
        linear = np.clip(np.asarray(images["radiance"]), 0, 1)
        code = np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * np.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
        assert_allclose(np.asarray(images["rgb"]), np.round(code * 255), atol=1)
