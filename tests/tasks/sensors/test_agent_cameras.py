"""Several cameras on one agent: names, shapes, where they look."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox
from lit_scenes import scene_of

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.shaders.lit import LitShader
from home_mjx.tasks.base.config import AgentCamera
from home_mjx.tasks.base.options import make_config
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.sensors.cameras import earlier_pose, render_images

CAMERAS = (
    AgentCamera("back", ("depth", "instance"), Lens(9, 9), yaw=180.0),
    AgentCamera("around", ("depth", "valid"), Lens(16, 4, "lidar", elevation=(0.0, 0.0)), follow_pitch=False),
    AgentCamera(
        "plan", ("instance", "pose"), Lens(8, 8, "orthographic"), 4.0, (0.5, 0.0, 0.0), pitch=-90.0, follow_pitch=False
    ),
)


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=(Furniture((-2.0, 0.0), (0.4, 0.4, 2.0)),))])


def observe(bank, yaw=0.0, pitch=0.0, **options):
    config = make_config(
        **{"sensors": ("depth", "intrinsics", "pose"), "width": 9, "height": 9, "cameras": CAMERAS} | options
    )
    pose = AgentPose(jnp.array([[0.0, 0.0, 0.8]]), jnp.array([yaw]), jnp.array([pitch]))
    bodies = bank.physics.body_pos[0], bank.physics.body_quat[0]
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        scene = make_scene(bank, jnp.int32(0), *bodies, pose.pos, jnp.array([[1.0, 0, 0, 0]]))
        images = jax.jit(lambda s: render_images(config, s, pose))(scene)
    return {name: np.asarray(value)[0] for name, value in images.items()}


def test_each_camera_gives_what_it_was_asked_for(bank):
    shapes = {name: value.shape for name, value in observe(bank).items()}
    assert shapes == {
        "pixels/head_depth": (9, 9, 1),
        "camera/head_intrinsics": (3, 3),
        "camera/head_pose": (4, 4),
        "pixels/back_depth": (9, 9, 1),
        "ids/back_instance": (9, 9),
        "pixels/around_depth": (4, 16, 1),
        "camera/around_valid": (),
        "ids/plan_instance": (8, 8),
        "camera/plan_pose": (4, 4),
    }


def test_cameras_look_where_they_should(bank):
    """The room is 6 m x 5 m; the agent in its middle looks along +x, a post stands 2 m behind it."""
    images = observe(bank)
    assert images["pixels/head_depth"][4, 4, 0] == pytest.approx(3.0, abs=1e-5)
    assert images["pixels/back_depth"][4, 4, 0] == pytest.approx(1.8, abs=1e-5)
    assert images["ids/back_instance"][4, 4] == 0
    around = images["pixels/around_depth"][..., 0]
    angle = np.pi - (np.arange(16) + 0.5) / 16 * 2 * np.pi
    walls = np.minimum(3 / abs(np.cos(angle)), 2.5 / abs(np.sin(angle)))
    np.testing.assert_allclose(around[:, 2:-2], np.broadcast_to(walls[2:-2], (4, 12)), rtol=1e-5)
    np.testing.assert_allclose(images["camera/head_pose"][:3, 3], [0, 0, 1.5], atol=1e-6)
    np.testing.assert_allclose(images["camera/head_pose"][:3, :3] @ [0, 0, -1], [1, 0, 0], atol=1e-6)
    np.testing.assert_allclose(images["camera/plan_pose"][:3, :3] @ [0, 0, -1], [0, 0, -1], atol=1e-6)
    np.testing.assert_allclose(images["camera/plan_pose"][:3, 3], [0.5, 0, 1.5], atol=1e-6)


def test_only_cameras_that_look_follow_the_head(bank):
    level, up = observe(bank), observe(bank, pitch=0.5)
    np.testing.assert_array_equal(level["pixels/around_depth"], up["pixels/around_depth"])
    # The ceiling is 1.5 m above the eyes; the middle ray climbs by tan(0.5) a metre and meets the wall at 3 m first.
    assert up["pixels/head_depth"][4, 4, 0] == pytest.approx(min(3 / np.cos(0.5), 1.5 / np.sin(0.5)), rel=1e-5)
    turned = observe(bank, yaw=np.pi / 2)
    assert turned["pixels/head_depth"][4, 4, 0] == pytest.approx(2.5, abs=1e-5)
    np.testing.assert_allclose(turned["camera/plan_pose"][:3, 3], [0, 0.5, 1.5], atol=1e-6)


def test_cameras_with_a_shutter_move_as_their_agent_did(bank):
    """The lower edge of a rolling picture is that of now, the upper one that of a step earlier."""
    lens = Lens(9, 9, readout=1.0)
    config = make_config(sensors=("depth",), width=9, height=9, cameras=(AgentCamera("eye", ("rgb",), lens),))
    pose = AgentPose(jnp.array([[0.0, 0.0, 0.8]]), jnp.array([0.6]), jnp.array([-0.7]))
    velocity, dt = jnp.array([[1.0, 0.5, 2.0]]), 0.1
    before = earlier_pose(pose, velocity, dt)
    np.testing.assert_allclose(before.yaw, 0.4, rtol=1e-6)
    way = np.array([np.cos(0.6) - 0.5 * np.sin(0.6), np.sin(0.6) + 0.5 * np.cos(0.6), 0]) * dt
    np.testing.assert_allclose(before.pos[0], pose.pos[0] - way, atol=1e-6)
    scene = scene_of(bank)
    look = jax.jit(lambda *poses: render_images(config, scene, poses[0], None, *poses[1:])["pixels/eye_rgb"][0])
    rolling, now, then = look(pose, before), look(pose), look(before)
    np.testing.assert_array_equal(rolling[-1], now[-1])
    np.testing.assert_array_equal(rolling[0], then[0])
    assert (now[0] != then[0]).any()


def test_environments_draw_with_the_preset_of_their_choice(bank):
    """The room has no lights but daylight from nowhere, so the lit image is black where the fast one is not."""
    options = {"sensors": ("rgb",), "cameras": ()}
    fast, lit = (observe(bank, shader=preset, **options)["pixels/head_rgb"] for preset in ("fast", "lit"))
    assert (fast.max(axis=-1) > 50).all()
    assert (lit == 0).all()
    light = bank.replace(lights=bank.lights.replace(ambient=jnp.ones_like(bank.lights.ambient)))
    assert (observe(light, shader=LitShader(sun=0.0), **options)["pixels/head_rgb"].max(axis=-1) > 50).all()


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: AgentCamera("a", kinds=("rgbb",)), "Did you mean `rgb`"),
        (lambda: AgentCamera("a", fovy=180.0), "`fovy` of camera `a`"),
        (lambda: make_config(cameras=(AgentCamera("head"),)), "distinct names"),
        (lambda: make_config(shader="list"), "Did you mean `lit`"),
        (lambda: make_config(cameras=(AgentCamera("a"), AgentCamera("a"))), "distinct names"),
    ],
)
def test_wrong_cameras_are_refused(make, words):
    with pytest.raises(ConfigError, match=words):
        make()
