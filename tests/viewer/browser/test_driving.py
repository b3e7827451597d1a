"""Two people at two agents: seats, keys, sticks of a gamepad, and pictures, in a real browser."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

pytest.importorskip("viser", reason="needs the extra `view`")
pytest.importorskip("playwright", reason="needs Playwright")

from browser_pages import CHROMIUM, open_browser, run_viewer, wait_until
from handmade import shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.physics import PhysicsConfig
from home_mjx.tasks.base.config import EnvConfig
from home_mjx.tasks.env.actions import action_names
from home_mjx.viewer.browser.live_camera import PictureOptions
from home_mjx.viewer.browser.run import Viewer, ViewOptions
from home_mjx.viewer.episodes.held_keys import HeldKeys, HeldKeysPlayer

pytestmark = pytest.mark.skipif(CHROMIUM is None, reason="needs Chromium")
GAMEPAD = (
    """window.pad = {connected: true, axes: [0, 0, 0, 0], buttons: []}; navigator.getGamepads = () => [window.pad];"""
)


def press(keys: HeldKeys, key: str) -> None:
    for kind in ("keydown", "keyup"):
        keys.handle({"type": kind, "key": key})


def test_sticks_add_to_keys_and_stay_until_they_move():
    keys = HeldKeys()
    player = HeldKeysPlayer(EnvConfig(), (keys,))
    keys.handle({"type": "axes", "values": {"forward": 0.5, "turn_left": -0.25, "nothing": 1.0, "left": "x"}})
    press(keys, "a")
    assert player.act(None).tolist() == [0.5, 0, 0.75, 0]
    assert player.act(None).tolist() == [0.5, 0, -0.25, 0]
    keys.handle({"type": "axes", "values": {"forward": 7.0}})
    assert player.act(None).tolist() == [0, 0, 0, 0]


def test_a_stick_counts_as_a_key_of_discrete_actions():
    keys, config = HeldKeys(), EnvConfig(actions="discrete")
    player = HeldKeysPlayer(config, (keys,))
    keys.handle({"type": "axes", "values": {"forward": 0.4, "turn_left": 0.4}})
    assert player.act(None) is None
    keys.handle({"type": "axes", "values": {"forward": 0.6, "turn_left": -0.9}})
    assert action_names(config)[int(player.act(None))] == "turn_right"


def test_one_person_s_press_is_a_step_in_which_the_others_do_nothing():
    people, config = (HeldKeys(), HeldKeys()), EnvConfig(actions="discrete", physics=PhysicsConfig(num_agents=3))
    player = HeldKeysPlayer(config, people)
    assert player.act(None) is None
    press(people[1], "w")
    assert player.act(None).tolist() == [-1, 1, -1]
    assert player.act(None) is None


@pytest.fixture(scope="module")
def viewer() -> Iterator[Viewer]:
    bank = HouseBank.from_compiled([shoebox()])
    options = {"sensors": ("state",), "impl": "kinematic", "episode_length": 100_000, "num_agents": 2}
    env = home_mjx.make("PointNav-v0", bank, **options)
    with run_viewer(Viewer(env, ViewOptions(port=0, picture=PictureOptions(size=64)))) as viewer:
        yield viewer


def yaws(viewer: Viewer) -> np.ndarray:
    """Return the heading of both agents [rad]."""
    state = viewer.broadcast.step.state
    return np.asarray(viewer.session.env.core.snapshot(viewer.session.env.params, state).pose.yaw)


def picture(page: Any) -> str:
    return page.evaluate("document.getElementById('picture').toDataURL()")


def test_two_pages_drive_two_agents_and_a_third_is_refused(viewer: Viewer):
    with open_browser() as open_page:
        first, second = (open_page(viewer.server.address, script, False) for script in ("", GAMEPAD))
        wait_until(lambda: first.locator("#seat").is_visible())
        before = yaws(viewer)
        first.keyboard.down("a")
        wait_until(lambda: abs(yaws(viewer)[0] - before[0]) > 0.3)
        first.keyboard.up("a")
        assert yaws(viewer)[1] == before[1]
        wait_until(lambda: first.locator("#seat").input_value() == "0")
        turned = yaws(viewer)[0]
        second.evaluate("window.pad.axes = [0, 0, 0.8, 0]")  # to the right
        wait_until(lambda: yaws(viewer)[1] - before[1] < -0.3)
        second.evaluate("window.pad.axes = [0, 0, 0.1, 0]")  # less than the dead zone
        wait_until(lambda: not viewer.drivers.keys[1].tilts())
        assert abs(yaws(viewer)[0] - turned) < 0.2
        wait_until(lambda: second.locator("#seat").input_value() == "1")
        wait_until(lambda: picture(first) != picture(second))
        third = open_page(viewer.server.address, has_scene=False)
        third.keyboard.press("a")
        wait_until(lambda: "another page drives agent 1 and agent 2" in third.inner_text("#notice"))
        assert third.locator("#seat").input_value() == "-1"
        second.close()
        wait_until(lambda: viewer.server.live.num_pages == 2)
        third.locator("#seat").select_option("1")
        wait_until(lambda: viewer.drivers.agent_of(viewer.server.live.pages[-1]) == 1)
        wait_until(lambda: not third.inner_text("#notice"))
        third.locator("#seat").select_option("-1")
        wait_until(lambda: viewer.drivers.agent_of(viewer.server.live.pages[-1]) == 0)
        assert first.errors == second.errors == third.errors == []
