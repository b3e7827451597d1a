"""Pictures of a broadcast without a page: smaller while they move and are slow, whole once they rest."""

import io
from collections.abc import Callable, Iterator
from types import SimpleNamespace

import jax
import pytest

pytest.importorskip("viser", reason="needs the extra `view`")

from handmade import shoebox
from PIL import Image

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.env.observers import EpisodeStep
from home_mjx.viewer.browser import broadcast
from home_mjx.viewer.browser.live_camera import LiveCamera, PictureOptions
from home_mjx.viewer.browser.scene.scene_tree import SceneTree
from home_mjx.viewer.browser.serving.channel import Channel
from home_mjx.viewer.browser.serving.server import ViewServer


@pytest.fixture
def server() -> Iterator[ViewServer]:
    with ViewServer(port=0) as server:
        yield server


def test_a_slow_picture_is_refined_once_nothing_moves(server: ViewServer, monkeypatch):
    bank = HouseBank.from_compiled([shoebox()])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic")
    state = jax.jit(env.core.reset)(env.params, jax.random.key(0))
    sent, clock = [], [0.0]
    monkeypatch.setattr(Channel, "num_pages", 1)
    monkeypatch.setattr(server.live, "publish", lambda message, pages=None: sent.append(message))
    monkeypatch.setattr(broadcast, "time", SimpleNamespace(perf_counter=lambda: clock[0]))
    shown = broadcast.Broadcast(server, SceneTree(server.scene, lambda group, index: None), PictureOptions(size=64))
    shown.env, shown.step, shown._camera = env, EpisodeStep(5, state, None, 0.0), LiveCamera(env)
    shown.adapts = True

    def sizes() -> list[int]:
        return [Image.open(io.BytesIO(data)).width for data in sent if isinstance(data, bytes)]

    shown.prepare()
    shown.draw(is_moving=True)
    assert shown._camera._see._cache_size() == 1  # compiled once, in the thread
    shown._pace.record(64, 1.0)
    shown.draw(is_moving=True)  # the small one compiles in a thread
    shown._camera._thread.join()
    shown.draw(is_moving=True)
    shown.refine()
    assert sizes() == [64, 64, 16]
    clock[0] = 1.0
    shown.refine()
    shown.refine()
    assert sizes() == [64, 64, 16, 64]


@pytest.fixture
def two_pages(server: ViewServer, monkeypatch) -> tuple[broadcast.Broadcast, Callable[[], list]]:
    """A broadcast whose pages 1 and 2 show an agent each, and a function that lists the pages of its pictures."""
    bank = HouseBank.from_compiled([shoebox()])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", num_agents=2)
    state, sent = jax.jit(env.core.reset)(env.params, jax.random.key(0)), []
    monkeypatch.setattr(Channel, "pages", (1, 2))
    monkeypatch.setattr(Channel, "num_pages", 2)
    monkeypatch.setattr(server.live, "publish", lambda message, pages=None: sent.append((type(message), pages)))
    shown = broadcast.Broadcast(server, SceneTree(server.scene, lambda group, index: None), PictureOptions(size=16))
    shown.agent_of, shown.adapts = lambda page: page - 1, True
    shown.env, shown.step, shown._camera = env, EpisodeStep(5, state, None, 0.0), LiveCamera(env)
    shown._cameras = {0: shown._camera}
    return shown, lambda: [pages for kind, pages in sent if kind is bytes]


def test_the_first_picture_of_another_agent_compiles_in_a_thread(two_pages):
    shown, pictures = two_pages
    shown.draw()
    assert pictures() == [[1]]
    shown._cameras[1]._thread.join()
    shown.refine()
    shown.refine()
    assert pictures() == [[1], [1], [2]]


def test_an_agent_whose_page_is_closed_while_its_program_compiles_is_not_drawn_again(two_pages, monkeypatch):
    shown, pictures = two_pages
    shown.draw()
    monkeypatch.setattr(Channel, "pages", (1,))
    shown._cameras[1]._thread.join()
    shown.refine()
    drawn = len(pictures())
    shown.refine()
    assert len(pictures()) == drawn <= 2
