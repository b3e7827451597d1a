"""Clicks in a real browser: tiles of the grid, the list of checkpoints, and the free camera."""

import os
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import jax
import numpy as np
import pytest

pytest.importorskip("viser", reason="needs the extra `view`")
pytest.importorskip("playwright", reason="needs Playwright")
pytest.importorskip("flax", reason="needs the extra `train`")

from browser_pages import CHROMIUM, open_browser, run_viewer, wait_until
from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.registry import EnvSpec
from home_mjx.training import save_net
from home_mjx.training.config import PPOConfig, RunConfig
from home_mjx.training.networks.agent import NetworkConfig
from home_mjx.training.ppo import PPO
from home_mjx.viewer.browser.live_camera import PictureOptions
from home_mjx.viewer.browser.run import Viewer, ViewOptions
from home_mjx.viewer.episodes.viewpoints import FREE

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
NUM_ENVS = 4  # a grid of two by two


@pytest.fixture(scope="module")
def viewer(tmp_path_factory) -> Iterator[Viewer]:
    red = Furniture((1.0, 0.0), (0.6, 0.6, 0.8), color=(0.9, 0.1, 0.1))
    bank = HouseBank.from_compiled([shoebox(furniture=(red,))])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state", "goal"), impl="kinematic", episode_length=100_000)
    folder, config = tmp_path_factory.mktemp("run"), PPOConfig(network=NetworkConfig(features=8, memory=8))
    for seed, name in enumerate(("first.npz", "second.npz")):
        net = PPO(env.core, config, jax.devices()[:1]).agent.init_net(jax.random.key(seed))
        save_net(folder / name, net, RunConfig(EnvSpec("PointNav-v0", "home_mjx.tasks.suite:PointNav"), config, 1))
        os.utime(folder / name, ns=(seed * 10**18, seed * 10**18))
    options = ViewOptions("trained", Path(folder), 0, PictureOptions(size=64), port=0, num_envs=NUM_ENVS)
    with run_viewer(Viewer(env, options)) as viewer:
        yield viewer


@pytest.fixture(scope="module")
def page(viewer: Viewer) -> Iterator[Any]:
    with open_browser() as open_page:
        yield open_page(viewer.server.address)


def choose(page: Any, label: str, value: str) -> None:
    """Choose a value of a list in viser's panel."""
    frame = page.frame_locator("#scene")
    field = f"xpath=//label[normalize-space()='{label}']/ancestor::*[.//input][1]//input"
    frame.locator(field).first.click()
    frame.get_by_role("option", name=value, exact=True).first.click()


def test_a_click_on_a_tile_watches_its_environment(viewer: Viewer, page):
    wait_until(lambda: page.evaluate("window.viewer.grids") > 0)
    box = page.locator("#tiles").bounding_box()
    for number, (x, y) in {3: (0.75, 0.75), 1: (0.75, 0.25)}.items():
        page.mouse.click(box["x"] + x * box["width"], box["y"] + y * box["height"])
        wait_until(lambda number=number: viewer.session.watched == number)
    assert page.errors == []


def test_a_checkpoint_of_the_list_is_loaded(viewer: Viewer, page):
    def weights() -> np.ndarray:
        return np.concatenate([np.ravel(x) for x in jax.tree.leaves(viewer.session._players[0].net)])

    assert viewer.session.checkpoints.describe() == "second.npz"
    before = weights()
    choose(page, "checkpoint", "first.npz")
    wait_until(lambda: viewer.session.checkpoints.describe() == "first.npz")
    wait_until(lambda: not np.array_equal(weights(), before))


def test_the_free_camera_follows_the_scene(viewer: Viewer, page):
    viewer.session.is_paused = True
    choose(page, "camera", FREE)
    wait_until(lambda: viewer.broadcast.options.viewpoint == FREE)
    wait_until(lambda: FREE in page.inner_text("#caption"))
    time.sleep(1.0)
    before, place = page.evaluate("document.getElementById('picture').toDataURL()"), viewer.broadcast._free
    page.mouse.move(500, 150)  # above the grid
    page.mouse.down()
    page.mouse.move(600, 190, steps=5)
    page.mouse.up()
    wait_until(lambda: viewer.broadcast._free is not place)
    wait_until(lambda: page.evaluate("document.getElementById('picture').toDataURL()") != before)
    assert page.errors == []
