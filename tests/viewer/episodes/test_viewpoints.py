"""Cameras of films and pages: what they see in a room of known sizes, with its ceiling cut."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.images.render import render
from home_mjx.viewer.browser.free_camera import convert_camera
from home_mjx.viewer.browser.live_camera import LiveCamera, PictureOptions, PicturePace
from home_mjx.viewer.browser.tiles import TileCamera, stack_states
from home_mjx.viewer.episodes.viewpoints import FIRST, FREE, THIRD, TOP, EpisodeCamera
from home_mjx.viewer.pictures.top_view import CUT_HEIGHT

HEIGHT = 0.8  # [m], of the box
LENS = Lens(49, 49)
BOX = 0  # object id


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([shoebox(furniture=(Furniture((1.0, 0.0), (0.6, 0.6, HEIGHT)),))])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic")


@pytest.fixture(scope="module")
def state(env):
    """The agent stands west of the box, and looks along +x."""
    state = jax.jit(env.core.reset)(env.params, jax.random.key(0))
    return place(state, -0.5)


def place(state, x: float):
    qpos = state.physics.qpos.at[:2].set(jnp.array([x, 0.0])).at[3].set(0.0)
    return state.replace(physics=state.physics.replace(qpos=qpos))


def see(env, state, kind: str, viewpoint: str, spot=None) -> np.ndarray:
    camera = EpisodeCamera(env)

    @jax.jit
    def look(params, state, spot):
        return camera.see(env.core.snapshot(params, state), LENS, kind, "fast", viewpoint, spot)

    return np.asarray(look(env.params, state, spot))


def test_nothing_is_seen_above_the_cut(env, state):
    scene = env.core.snapshot(env.params, state).scene
    above = convert_camera(np.array([1.0, 0.0, 6.0]), np.array([0.0, 1.0, 0.0, 0.0]), np.deg2rad(60))  # looks down
    images = {
        cut: render(scene, above, LENS, kinds=("depth",), depth_max=None, cut_height=cut)
        for cut in (None, CUT_HEIGHT, 0.5)
    }
    middle = {cut: float(image["depth"][24, 24, 0]) for cut, image in images.items()}
    assert middle[None] < 3.5
    assert middle[CUT_HEIGHT] == pytest.approx(6.0 - HEIGHT, abs=1e-4)
    assert middle[0.5] == pytest.approx(6.0, abs=0.11)  # the box is cut open; it ends at the floor
    below = convert_camera(np.array([-1.0, 0.5, 1.0]), np.array([1.0, 0.0, 0.0, 0.0]), np.deg2rad(20))  # looks up
    assert np.isinf(render(scene, below, LENS, kinds=("depth",), depth_max=None, cut_height=CUT_HEIGHT)["depth"]).all()
    assert np.isfinite(render(scene, below, LENS, kinds=("depth",), depth_max=None)["depth"]).all()


@pytest.mark.parametrize("x", [-0.5, -1.5])  # free, and with the back to a wall
def test_the_third_person_sees_the_agent_and_what_is_before_it(env, state, x: float):
    image = see(env, place(state, x), "instance", THIRD)
    agent = env.bank.spec.num_instances
    rows, columns = np.nonzero(image == agent)
    assert 24 in columns
    assert abs(columns.mean() - 24) < 1.5
    boxes = np.nonzero(image == BOX)[0]
    assert len(boxes)
    assert boxes.mean() < rows.mean()  # farther ahead is higher in the picture
    assert agent not in see(env, state, "instance", FIRST)


def test_the_view_from_above_is_to_scale(env, state):
    camera = EpisodeCamera(env)
    spot = camera.place_overview(0)
    image = see(env, state, "instance", TOP, spot)
    metres = float(spot.fovy) / LENS.height
    rows, columns = np.nonzero(image == BOX)
    assert len(rows) * metres**2 == pytest.approx(0.36, rel=0.25)
    assert (columns.mean() - 24) * metres == pytest.approx(1.0 - float(spot.pos[0]), abs=metres)
    agent = np.argwhere(image == env.bank.spec.num_instances).mean(axis=0)
    assert (24 - agent[0]) * metres == pytest.approx(-float(spot.pos[1]), abs=metres)
    colours = see(env, state, "rgb", TOP, spot)
    assert (colours.max(axis=-1) < 50).mean() > 0.01  # cut walls are dark


def test_the_free_camera_is_that_of_the_page(env, state):
    camera, options = LiveCamera(env), PictureOptions("object ids", size=32, viewpoint=FREE)
    before = camera.capture(state, options)
    assert np.array_equal(before, camera.capture(state, PictureOptions("object ids", size=32, viewpoint=TOP)))
    camera.free = convert_camera(np.array([1.0, 0.0, 4.0]), np.array([0.0, 1.0, 0.0, 0.0]), np.deg2rad(8))
    seen = camera.capture(state, options)
    assert (seen == seen[16, 16]).all()  # nothing but the box
    assert (before == seen[16, 16]).all(axis=-1).any()


def test_a_tile_of_the_grid_is_its_environment(env, state):
    states = [place(state, x) for x in (-2.0, -1.0, 0.0)]
    tiles = TileCamera(env, size=64)
    single = LiveCamera(env)
    for viewpoint in (FIRST, TOP):
        grid = tiles.capture(stack_states(states), viewpoint)
        assert grid.shape == (128, 128, 3)
        cells = [grid[:64, :64], grid[:64, 64:], grid[64:, :64]]
        for cell, one in zip(cells, states, strict=True):
            expected = single.capture(one, PictureOptions(size=64, viewpoint=viewpoint))
            assert np.abs(cell.astype(float) - expected).mean() < 0.5  # rounding under vmap
        assert not np.array_equal(*cells[:2])
        assert (grid[64:, 64:] == 0).all()


def test_pictures_shrink_while_they_are_slow_and_grow_again():
    pace, cost = PicturePace(), 4e-7  # [s] per pixel: 105 ms at 512 px
    for _ in range(30):
        size = pace.choose(512)
        pace.record(size, cost * size**2)
    assert size == 256
    for _ in range(30):
        size = pace.choose(512)
        pace.record(size, cost / 10 * size**2)
    assert size == 512
    pace.record(512, 60.0)
    assert pace.choose(512) == 128
