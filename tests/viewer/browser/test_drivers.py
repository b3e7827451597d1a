"""Seats and what their drivers hold: changes of agent, and gamepads whose messages are not sent."""

import json
import shutil
import subprocess
from importlib import resources

import pytest
from handmade import shoebox

import home_mjx
from home_mjx.bank.bank import HouseBank
from home_mjx.tasks.env.observers import RunStart
from home_mjx.viewer.browser.serving.drivers import Drivers

NODE = shutil.which("node")
POLLS = """
import {{ Gamepads }} from "{module}";
globalThis.setInterval = () => 0;
const pad = {{ connected: true, axes: [0, 0, 0, 0], buttons: [] }}, sent = [];
let isOpen = false, hasFocus = true;
globalThis.document = {{ hasFocus: () => hasFocus }};
Object.defineProperty(globalThis, "navigator", {{ value: {{ getGamepads: () => [pad] }}, configurable: true }});
const pads = new Gamepads((message) => isOpen && sent.push(message) > 0);
pad.axes = [0, -1, 0, 0];
pad.buttons[0] = {{ pressed: true }};
pads.poll();  // while the socket is closed
isOpen = true;
pads.poll();
pads.poll();
hasFocus = false;
pad.axes = [0, 0.5, 0, 0];
pads.poll();  // of another window
hasFocus = true;
pads.poll();
isOpen = false;
pad.axes = [0, 0, 0, 0];
pads.poll();
isOpen = true;
pads.poll();
console.log(JSON.stringify(sent));
"""


@pytest.fixture(scope="module")
def env():
    bank = HouseBank.from_compiled([shoebox()])
    return home_mjx.make("PointNav-v0", bank, sensors=("state",), impl="kinematic", num_agents=2)


def start(env, name: str) -> RunStart:
    return RunStart(name, env, "episodes", 1)


def test_nothing_is_held_after_a_change_of_agent(env):
    drivers = Drivers(lambda **state: None, lambda page, **state: None)
    drivers.on_run_start(start(env, "human"))
    drivers.handle({"page": 7, "type": "axes", "values": {"forward": 0.5}})
    drivers.handle({"page": 8, "type": "keydown", "key": "w"})
    assert drivers.keys[0].tilts() == {"forward": 0.5}
    assert drivers.keys[1].held() == ("w",)
    drivers.on_run_start(start(env, "random"))
    drivers.on_run_start(start(env, "human"))
    assert not drivers.keys[0].tilts()
    assert not drivers.keys[1].held()


@pytest.mark.skipif(NODE is None, reason="needs Node")
def test_sticks_and_buttons_are_sent_again_until_they_are_sent(tmp_path):
    page = resources.files("home_mjx.viewer.browser") / "page" / "gamepads.js"
    (tmp_path / "gamepads.mjs").write_text(page.read_text())
    (tmp_path / "polls.mjs").write_text(POLLS.format(module="./gamepads.mjs"))
    assert NODE is not None
    done = subprocess.run([NODE, str(tmp_path / "polls.mjs")], capture_output=True, text=True, check=True, timeout=60)
    walk, down = {"type": "axes", "values": {"forward": 1}}, {"type": "keydown", "key": "p"}
    back, none = {"type": "axes", "values": {"forward": -0.5}}, {"type": "axes", "values": {}}
    assert json.loads(done.stdout) == [walk, down, back, down, none]
