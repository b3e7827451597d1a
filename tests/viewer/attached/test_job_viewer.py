"""Viewers of running jobs: what they show, and that they take nothing without a page."""

import dataclasses
import io
import json
import time

import jax
import jax.numpy as jnp
import numpy as np
import pytest

pytest.importorskip("viser", reason="needs the extra `view`")

from handmade import Furniture, shoebox
from PIL import Image
from websockets.sync.client import connect

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.observers import EpisodeStep, RunStart
from home_mjx.viewer.attached.job_viewer import JobViewer
from home_mjx.viewer.browser.live_camera import LiveCamera, PictureOptions
from home_mjx.viewer.browser.run import ViewOptions
from home_mjx.viewer.browser.tiles import TILE_MARK
from home_mjx.viewer.episodes.episode import EpisodeRunner

OPTIONS = PictureOptions(size=32)
NUM_ENVS = 64


@pytest.fixture(scope="module")
def env():
    red = Furniture((1.0, 0.0), (0.6, 0.6, 0.8), color=(0.9, 0.1, 0.1))
    bank = HouseBank.from_compiled([shoebox(furniture=(red,))])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic")


@pytest.fixture(scope="module")
def states(env):
    one = jax.jit(env.core.reset)(env.params, jax.random.key(0))
    turned = jnp.linspace(-3, 3, NUM_ENVS)
    many = jax.tree.map(lambda x: jnp.repeat(x[None], NUM_ENVS, axis=0), one)
    return many.replace(physics=many.physics.replace(qpos=many.physics.qpos.at[:, 3].set(turned)))


def test_a_job_without_a_page_is_not_touched(env):
    viewer = JobViewer(ViewOptions(port=0, picture=OPTIONS), lambda line: None)
    viewer.on_run_start(RunStart("ppo", env, "steps", 100))
    nothing = State.build_unchecked()  # reading any field of it would raise
    viewer.on_states(nothing)
    viewer.on_episode_step(EpisodeStep(1, nothing, None, 0.0))
    viewer.close()


def test_the_watched_environment_is_shown_and_changed_at_once(env, states):
    lines = []
    viewer = JobViewer(ViewOptions(port=0, picture=OPTIONS), lines.append)
    viewer.on_run_start(RunStart("ppo", env, "steps", 100))
    camera = LiveCamera(env)

    def expected(number: int) -> np.ndarray:
        return camera.capture(jax.tree.map(lambda x: x[number], states), OPTIONS).astype(float)

    with connect(f"ws://localhost:{viewer.server.port}/live") as page:

        def picture() -> np.ndarray:
            while isinstance(data := page.recv(timeout=30), str):
                texts.update(json.loads(data))
            return np.asarray(Image.open(io.BytesIO(data)), float)

        texts = {}
        viewer.on_states(states)
        assert np.abs(picture() - expected(0)).mean() < 6
        began = time.perf_counter()
        viewer.watch(40)
        shown = picture()
        assert time.perf_counter() - began < 0.2
        assert np.abs(shown - expected(40)).mean() < 6 < np.abs(shown - expected(0)).mean()
        assert texts["instruction"].startswith("environment 40 of 64: ") or page.recv(timeout=5)
        viewer.panels.num_tiles = 4
        viewer.watch(41)
        while not (isinstance(data := page.recv(timeout=60), bytes) and data[:1] == TILE_MARK):
            texts.update(json.loads(data) if isinstance(data, str) else {})
        assert texts["tiles"] == {"numbers": [40, 41, 42, 43], "columns": 2, "watched": 41}
        page.send(json.dumps({"type": "watch", "number": texts["tiles"]["numbers"][2]}))
        while texts["tiles"]["watched"] != 42:
            data = page.recv(timeout=30)
            texts.update(json.loads(data) if isinstance(data, str) else {})
        assert viewer.watched == 42
    viewer.on_log({"steps": 10.0, "success": 0.5, "return": 1.0})
    viewer.close()
    assert lines == [f"View at http://localhost:{viewer.server.port}/"]


def test_terms_of_rewards_are_plotted_step_by_step(env):
    viewer = JobViewer(ViewOptions(port=0, picture=OPTIONS), lambda line: None)
    viewer.on_run_start(RunStart("expert", env, "episodes", 1))
    runner = EpisodeRunner(env)
    episode = runner.begin(1, jax.random.key(0), None, 0)
    with connect(f"ws://localhost:{viewer.server.port}/live"):
        while not viewer.server.live.num_pages:
            time.sleep(0.01)
        viewer.on_episode_start(episode.start)
        viewer.on_episode_step(episode.step)
        for _ in range(3):
            viewer.on_episode_step(episode.advance(np.array([1, 0, 0, 0], np.float32)))
    rows = viewer.panels._terms._rows
    viewer.close()
    assert [row["step"] for row in rows] == [1, 2, 3]
    for row in rows:
        terms = {name: x for name, x in row.items() if name not in ("step", "reward", "return")}
        assert len(terms) >= 2
        assert sum(terms.values()) == pytest.approx(row["reward"], abs=1e-5)


def test_an_environment_opens_itself_and_a_notebook_shows_it(env):
    with env.view(agent="random", port=0, picture=OPTIONS) as viewer:
        assert f'src="{viewer.address}"' in viewer._repr_html_()
        with connect(viewer.address.replace("http", "ws") + "live") as page:
            while isinstance(data := page.recv(timeout=30), str):
                pass
        assert Image.open(io.BytesIO(data)).size == (32, 32)
    assert not viewer._thread.is_alive()
    with pytest.raises(OSError, match="refused"):
        connect(viewer.address.replace("http", "ws") + "live")


def test_ids_and_path_are_those_of_the_watched_house():
    """Nobody tells a viewer of a batch where episodes begin: overlays of the first house stayed."""
    houses = [shoebox(furniture=(Furniture((x, 0.5)),)) for x in (1.0, -1.0)]
    bank = HouseBank.from_compiled([dataclasses.replace(house, id=f"box {n}") for n, house in enumerate(houses)])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic")
    one = [jax.jit(env.core.reset)(env.params, jax.random.key(house), house) for house in (0, 1)]
    viewer = JobViewer(ViewOptions(port=0, picture=OPTIONS), lambda line: None)
    viewer._budget.share = 1e9
    viewer.on_run_start(RunStart("ppo", env, "steps", 100))
    viewer.overlays.is_shown["object ids"] = True

    def labels() -> list[float]:
        return [float(handle.position[0]) for handle in viewer.overlays._layers["object ids"]]

    with connect(f"ws://localhost:{viewer.server.port}/live"):
        viewer.on_states(jax.tree.map(lambda *x: jnp.stack(x), *one))
        assert labels() == pytest.approx([1.0])
        viewer.watch(1)
        assert labels() == pytest.approx([-1.0])
        assert np.allclose(viewer.overlays._path, viewer.overlays._path[0])  # no line from one house to the other
        viewer.on_states(jax.tree.map(lambda *x: jnp.stack(x), *one[::-1]))  # the watched one is reset in another house
        assert labels() == pytest.approx([1.0])
    viewer.close()
