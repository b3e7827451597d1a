"""Images of some environments, or of some steps; and cameras whose pose is no number."""

import functools

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

from home_mjx.bank.bank import HouseBank
from home_mjx.errors import ConfigError
from home_mjx.raycast_render.cameras.camera import Camera, Lens, depth_points
from home_mjx.raycast_render.cameras.schedule import render_every, render_some
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.scene import make_scene

LEVEL = jnp.array([0.5**0.5, 0.5**0.5, 0, 0])
KINDS = ("rgb", "depth", "instance", "normal", "valid")
NUM = 4


@pytest.fixture(scope="module")
def bank():
    return HouseBank.from_compiled([shoebox(furniture=(Furniture((1.0, 1.0), mass=4.0), Furniture((-1.0, 1.0))))])


@pytest.fixture(scope="module")
def look(bank):
    """Images of one environment whose camera stands at x and whose movable body is at `body`."""

    def images(x, body, backend=None):
        pos = bank.physics.body_pos[0].at[0].set(body)
        nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
        scene = make_scene(bank, jnp.int32(0), pos, bank.physics.body_quat[0], *nobody, backend=backend)
        eye = jnp.stack([x, jnp.float32(-1.0), jnp.float32(1.2)])
        camera = Camera(eye, LEVEL, jnp.float32(1.5))
        return render(scene, camera, Lens(8, 8), kinds=KINDS, depth_max=None)

    return images


@pytest.fixture(scope="module")
def batch():
    return jnp.linspace(-1, 1, NUM), jnp.broadcast_to(jnp.array([1.0, 1.0, 0.25]), (NUM, 3))


def test_only_the_chosen_environments_are_drawn(look, batch):
    all_of_them = jax.jit(jax.vmap(look))(*batch)
    blank = jax.tree.map(jnp.zeros_like, all_of_them)
    some = jax.jit(lambda chosen, last: render_some(chosen, look, last, *batch))(jnp.array([2, 0, NUM, -1]), blank)
    for kind in KINDS:
        np.testing.assert_array_equal(some[kind][jnp.array([0, 2])], all_of_them[kind][jnp.array([0, 2])])
        assert not np.asarray(some[kind][jnp.array([1, 3])]).any()


def test_nobody_may_be_chosen(look, batch):
    blank = jax.tree.map(jnp.zeros_like, jax.eval_shape(lambda: jax.vmap(look)(*batch)))
    none = jax.jit(lambda last: render_some(jnp.zeros(0, jnp.int32), look, last, *batch))(blank)
    jax.tree.map(np.testing.assert_array_equal, none, blank)


def test_images_are_drawn_on_every_nth_step_only(look, batch):
    draw = jax.jit(lambda step, last: render_every(3, step, lambda: jax.vmap(look)(*batch), last))
    first = draw(jnp.int32(0), jax.tree.map(jnp.zeros_like, jax.eval_shape(lambda: jax.vmap(look)(*batch))))
    assert first["valid"].all()
    marked = jax.tree.map(jnp.zeros_like, first)
    for step in (1, 2, 4):
        assert not draw(jnp.int32(step), marked)["valid"].any()
    np.testing.assert_array_equal(draw(jnp.int32(3), marked)["rgb"], first["rgb"])
    with pytest.raises(ConfigError, match="interval"):
        render_every(0, jnp.int32(0), dict, {})


@pytest.mark.parametrize("backend", ["xla", pytest.param("cpu", marks=pytest.mark.cpu)])
@pytest.mark.parametrize("broken", ["camera", "body"])
def test_a_pose_that_is_no_number_is_flagged_and_leaves_its_neighbours_alone(look, batch, broken, backend):
    x, body = batch
    views = jax.jit(jax.vmap(functools.partial(look, backend=backend)))
    good = views(x, body)
    bad = (x.at[1].set(jnp.nan), body) if broken == "camera" else (x, body.at[1, 2].set(jnp.nan))
    found = views(*bad)
    np.testing.assert_array_equal(found["valid"], [True, False, True, True])
    assert (found["instance"][1] == -1).all()
    assert np.isinf(found["depth"][1]).all()
    assert (found["normal"][1] == 0).all()
    keep = jnp.array([0, 2, 3])
    for kind in KINDS:
        np.testing.assert_array_equal(found[kind][keep], good[kind][keep])


@pytest.mark.parametrize(
    "lens",
    [Lens(24, 16), Lens(12, 12, "cube"), Lens(32, 16, "panorama"), Lens(32, 8, "lidar"), Lens(24, 16, "orthographic")],
    ids=lambda lens: lens.model,
)
def test_depth_becomes_points_on_the_walls(bank, lens):
    """The room is 6 x 5 x 3 m and has two boxes: every point lies on one of its planes."""
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    scene = make_scene(bank, jnp.int32(0), bank.physics.body_pos[0], bank.physics.body_quat[0], *nobody)
    quat = np.array([0.9, 0.3, -0.2, 0.4])
    fovy = 2.0 if lens.model == "orthographic" else 1.2
    camera = Camera(
        jnp.array([0.3, -0.4, 1.4]), jnp.asarray(quat / np.linalg.norm(quat), jnp.float32), jnp.float32(fovy)
    )
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        images = render(scene, camera, lens, kinds=("depth", "distance", "instance"), depth_max=None)
        points = np.asarray(depth_points(camera, lens, images["depth"]), float)
    assert images["depth"].shape == (*lens.shape, 1)
    away = np.linalg.norm(points - np.asarray(camera.pos), axis=-1)
    if lens.model != "orthographic":
        np.testing.assert_allclose(images["distance"][..., 0], away, atol=1e-4)
    walls = np.stack(
        [abs(abs(points[..., 0]) - 3), abs(abs(points[..., 1]) - 2.5), abs(abs(points[..., 2] - 1.5) - 1.5)]
    )
    house = np.asarray(images["instance"]) == -1
    assert house.mean() > 0.5
    assert walls.min(axis=0)[house].max() < 1e-3
