"""The viewer's page in a real browser: picture, scene, keys and sound."""

import io
import threading
import time
from collections.abc import Iterator

import jax
import numpy as np
import pytest
from PIL import Image

pytest.importorskip("viser", reason="needs the extra `view`")
pytest.importorskip("playwright", reason="needs Playwright")

from browser_pages import CHROMIUM, open_browser, run_viewer, wait_until
from handmade import Furniture, shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.env.observers import RunStart
from home_mjx.viewer.browser.broadcast import SOUND_DELAY, encode_sound
from home_mjx.viewer.browser.live_camera import PictureOptions
from home_mjx.viewer.browser.run import Viewer, ViewOptions
from home_mjx.viewer.episodes.episode import EpisodeRunner
from home_mjx.viewer.replay.page import PageRecorder
from home_mjx.viewer.replay.recorder import ReplayRecorder
from home_mjx.viewer.replay.run import ReplayViewer

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
RATE = 16_000


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    red = Furniture((1.0, 0.0), (0.6, 0.6, 0.8), color=(0.9, 0.1, 0.1))
    bank = HouseBank.from_compiled([shoebox(furniture=(red,))])
    env = home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", episode_length=100_000)
    with run_viewer(Viewer(env, ViewOptions(port=0, picture=PictureOptions(size=64)))) as viewer:
        yield viewer


@pytest.fixture(scope="module")
def page(viewer: Viewer) -> Iterator[object]:
    with open_browser() as open_page:
        yield open_page(viewer.server.address)


def shot(page, selector: str) -> bytes:
    return page.screenshot(clip=page.locator(selector).first.bounding_box())


def contrast(image: bytes) -> float:
    return float(np.asarray(Image.open(io.BytesIO(image)).convert("L"), float).std())


def test_picture_and_scene_are_not_blank(page):
    assert contrast(page.locator("#picture").screenshot()) > 5
    frame = page.frame_locator("#scene")
    canvas = frame.locator("canvas").first
    canvas.wait_for()
    wait_until(lambda: contrast(canvas.screenshot()) > 8)
    assert "go to the point" in page.inner_text("#instruction")
    assert "w forward" in page.inner_text("#keys")
    assert page.errors == []


def test_keys_move_the_agent_and_its_picture(viewer: Viewer, page):
    def pose() -> np.ndarray:
        return np.asarray(viewer.broadcast.step.state.physics.qpos[:4])

    before, frames = pose(), page.evaluate("window.viewer.frames")
    page.keyboard.down("a")
    wait_until(lambda: abs(pose()[3] - before[3]) > 0.3)
    page.keyboard.up("a")
    page.keyboard.down("w")
    wait_until(lambda: np.linalg.norm(pose()[:2] - before[:2]) > 0.3)
    page.keyboard.up("w")
    assert page.evaluate("window.viewer.frames") > frames
    wait_until(lambda: not viewer.drivers.keys[0].held())


def test_the_worklet_plays_the_sound_that_is_sent(viewer: Viewer, page):
    assert page.locator("#sound").is_disabled()
    viewer.broadcast.tell(sound=True)
    wait_until(lambda: page.locator("#sound").is_enabled())
    page.click("#sound")
    wait_until(lambda: page.evaluate("Boolean(window.viewer.sound.node)"))
    left = 0.2 * np.sin(2 * np.pi * 440 * np.arange(RATE // 10) / RATE)
    chunk = encode_sound(np.stack([left, left / 4])[None])
    loudest = [0.0, 0.0]

    def is_heard() -> bool:
        viewer.server.sound.publish(chunk)
        level = page.evaluate("window.viewer.sound.stats?.level ?? [0, 0]")
        loudest[:] = np.maximum(loudest, level)
        return loudest[0] > 0.12

    wait_until(is_heard)
    stats = page.evaluate("window.viewer.sound.stats")
    assert stats["received"] >= SOUND_DELAY * RATE
    assert loudest[0] < 0.2
    assert loudest[1] == pytest.approx(loudest[0] / 4, rel=0.05)
    wait_until(
        lambda: loudest_frequency(page, lambda: viewer.server.sound.publish(chunk)) == pytest.approx(440, rel=0.1)
    )
    page.click("#sound")
    wait_until(lambda: viewer.server.sound.num_pages == 0)


def loudest_frequency(page, send) -> float:
    """Return the frequency of the brightest row of the spectrogram's last columns [Hz]."""
    for _ in range(4):
        send()
        time.sleep(0.1)
    rows = page.evaluate("""() => { const {canvas} = window.viewer.sound.spectrum, {width, height} = canvas;
        const data = window.viewer.sound.spectrum.getImageData(width - 4, 0, 4, height).data;
        return Array.from({length: height}, (_, y) => data.slice(16 * y, 16 * y + 16).reduce((a, b) => a + b)); }""")
    row = len(rows) - 1 - int(np.argmax(rows))
    return 60.0 * (RATE / 2 / 60.0) ** (row / (len(rows) - 1))


def test_a_click_on_an_object_opens_its_card(viewer: Viewer, page):
    scene = viewer.server.scene
    (client,) = scene.get_clients().values()
    client.camera.position, client.camera.look_at = (1.0, -1.5, 2.5), (1.0, 0.0, 0.4)
    box = page.locator("#scene").bounding_box()
    card = page.frame_locator("#scene").get_by_text("An ottoman is here.")

    def is_open() -> bool:
        page.mouse.click(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
        time.sleep(0.3)
        return card.count() > 0

    wait_until(is_open)
    assert page.frame_locator("#scene").get_by_text("0.60 × 0.60 × 0.80 m").count() > 0


def test_a_recorded_episode_opens_from_disk_without_network(viewer: Viewer, page, tmp_path):
    runner, recorder = EpisodeRunner(viewer.session.env), PageRecorder("walk")
    recorder.on_run_start(RunStart("human", runner.env, "episodes", 1))
    episode = runner.begin(1, jax.random.key(0), None, 0)
    recorder.on_episode_start(episode.start)
    recorder.on_episode_step(episode.step)
    for _ in range(3):
        recorder.on_episode_step(episode.advance(np.array([1, 0, 0, 0], np.float32)))
    recorder.on_episode_end(episode.result())
    recorder.write(tmp_path)
    recorder.close()
    asked = []
    page.on("request", lambda request: asked.append(request.url))
    page.goto((tmp_path / "walk.html").as_uri())
    page.locator("canvas").first.wait_for()
    wait_until(lambda: page.evaluate("document.getElementById('film').readyState") >= 2)
    wait_until(lambda: page.evaluate("window.episode.scene") == 0)
    page.evaluate("document.getElementById('film').currentTime = 2.5 * window.episode.dt")
    wait_until(lambda: page.evaluate("window.episode.frame") == 2)
    assert page.evaluate("window.episode.scene") == 2
    wait_until(lambda: page.locator("#root input.mantine-NumberInput-input").input_value() in ("0.2", "0.3"))
    wait_until(lambda: contrast(shot(page, "#root canvas")) > 8)
    (seen,) = [frame.mean(axis=(0, 1)) for frame in recorder._video.frames[2:3]]
    assert mean_colour(page) == pytest.approx(seen, abs=12)
    assert page.evaluate("document.getElementById('film').currentSrc").startswith("data:video/mp4")
    page.evaluate("""() => { const film = document.getElementById("film"); film.querySelector("source").remove();
        film.load(); film.currentTime = 2.5 * window.episode.dt; }""")  # a browser without H.264
    wait_until(lambda: page.evaluate("document.getElementById('film').readyState") >= 2)
    assert page.evaluate("document.getElementById('film').currentSrc").startswith("data:video/webm")
    wait_until(lambda: mean_colour(page) == pytest.approx(seen, abs=12))
    assert contrast(shot(page, "#plots")) > 5
    assert page.inner_text("#title") == "1: go to the point"
    assert not [url for url in asked if url.startswith(("http", "ws"))]
    page.screenshot(path=tmp_path / "page.png")


def mean_colour(page) -> np.ndarray:
    """Return the mean colour of the film's picture in the page of an episode."""
    film = """() => { const canvas = document.createElement("canvas"), g = canvas.getContext("2d");
        g.drawImage(document.getElementById("film"), 0, 0, 300, 150);
        return Array.from(g.getImageData(0, 0, 300, 150).data); }"""
    return np.reshape(page.evaluate(film), (150, 300, 4))[..., :3].mean(axis=(0, 1))


def test_a_replay_scrubs(viewer: Viewer, page, tmp_path, monkeypatch):
    monkeypatch.setattr("home_mjx.viewer.replay.page.VIEW_WIDTH", 64)
    monkeypatch.setattr("home_mjx.viewer.replay.page.VIEW_HEIGHT", 48)
    runner, recorder = EpisodeRunner(viewer.session.env), ReplayRecorder()
    recorder.on_run_start(RunStart("human", runner.env, "episodes", 1))
    episode = runner.begin(1, jax.random.key(0), None, 0)
    recorder.on_episode_start(episode.start)
    recorder.on_episode_step(episode.step)
    for _ in range(20):
        recorder.on_episode_step(episode.advance(np.array([1, 0, 0, 0], np.float32)))
    recorder.on_episode_end(episode.result())
    options = ViewOptions(port=0, picture=PictureOptions(size=64))
    with ReplayViewer(runner.env, recorder.replay, options) as replayed:
        replayed.session.is_paused = True
        thread = threading.Thread(target=replayed.run, daemon=True)
        thread.start()
        page.goto(replayed.server.address)
        slider = page.frame_locator("#scene").get_by_role("slider").first
        slider.wait_for()
        wait_until(lambda: page.evaluate("window.viewer?.frames ?? 0") > 0)
        before = page.evaluate("document.getElementById('picture').toDataURL()")
        slider.press("End")
        wait_until(lambda: replayed.session.index == 20)
        wait_until(lambda: page.evaluate("document.getElementById('picture').toDataURL()") != before)
        state = replayed.broadcast.step.state
        assert np.array_equal(state.physics.qpos, np.asarray(episode.step.state.physics.qpos))
        wait_until(lambda: page.frame_locator("#scene").get_by_text("20 of 20").count() == 1)
        page.screenshot(path=tmp_path / "replay.png")
        panel = page.frame_locator("#scene")
        choice = panel.locator("xpath=//label[text()='export']/following::input[1]")
        choice.click()
        panel.get_by_role("option", name="HTML page").click()
        with page.expect_download(timeout=240_000) as download:
            panel.get_by_role("button", name="export this episode").click()
        assert download.value.suggested_filename == "episode_1.html"
        text = download.value.path().read_text()
        assert "data:video/webm;base64,GkXf" in text  # EBML, as which WebM begins
        assert "1: go to the point" in text
        replayed.stop()
        thread.join(30)


def test_another_task_chosen_in_the_viewer_has_sound(viewer: Viewer, monkeypatch):
    loaded = []
    monkeypatch.setattr(viewer.session, "load", lambda env, agent: loaded.append(env))
    viewer._load_task("AudioNav-v0")
    viewer._load_task("PointNav-v0")
    assert ["audio" in env.config.sensors for env in loaded] == [True, False]


def test_a_lost_connection_comes_back(viewer: Viewer, page):
    page.goto(viewer.server.address)
    wait_until(lambda: page.evaluate("window.viewer?.frames ?? 0") > 0)
    page.reload()
    wait_until(lambda: page.evaluate("window.viewer?.frames ?? 0") > 0)
    steps = viewer.broadcast.step.index
    wait_until(lambda: viewer.broadcast.step.index > steps)
