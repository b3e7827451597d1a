"""Observer that shows episodes in browser pages: scene, picture, sound and state of each step."""

import dataclasses
import json
import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from home_mjx.core.progress import say
from home_mjx.raycast_render.cameras.camera import Camera
from home_mjx.tasks.base.state import State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.tasks.sensors.selection import state_owners
from home_mjx.viewer.browser.live_camera import MIN_SIZE, LiveCamera, PictureOptions, PicturePace, encode_jpeg
from home_mjx.viewer.browser.scene.scene_tree import SceneObserver, SceneTree
from home_mjx.viewer.browser.serving.server import ViewServer
from home_mjx.viewer.browser.tiles import TileCamera, count_columns, encode_tiles
from home_mjx.viewer.episodes.episode import format_status
from home_mjx.viewer.episodes.observers import SOUND_STATE
from home_mjx.viewer.episodes.viewpoints import FREE

REFINE_SECONDS = 0.3  # [s], without a step before a picture of full size follows a smaller one
TILE_SECONDS = 0.25  # [s], between grids of several environments
SOUND_DELAY = 0.35  # [s], of sound that pages store before they play it


class Broadcast(Observer):
    """Scene, picture, sound and state of each step, for all pages of a server.

    Pictures are rendered, and sound is sent, only while a page is open.

    Args:
        server: The server.
        tree: The scene.
        options: Options of the picture.

    Attributes:
        options: Options of the picture; set them and call `draw` to show the same state with others.
        env: The environment of the run.
        step: The last step.
        picture_seconds: Time to render and encode the last picture [s].
        agent_of: Function that returns the agent whose picture a page shows, by the page's number.
        adapts: Whether pictures of steps are smaller if they are slow; `refine` must then be called between steps.
    """

    def __init__(self, server: ViewServer, tree: SceneTree, options: PictureOptions) -> None:
        self.server, self.tree, self.options = server, tree, options
        self._scene = SceneObserver(tree)
        self.env: Env[HouseholdEnv] | None = None
        self.step: EpisodeStep | None = None
        self.picture_seconds, self.adapts = 0.0, False
        self.state: dict[str, Any] = {}
        self.agent_of: Callable[[int], int] = lambda page: 0
        self._ears: dict[int, int] = {}  # agents by page of sound
        self._late: set[int] = set()  # agents whose picture is not drawn, as its program compiles
        self._picture: bytes | None = None
        self._free: Camera | None = None
        self._tile_camera: TileCamera | None = None
        self._tiled_at = self._drawn_at = 0.0
        self._pace, self._look, self._is_coarse = PicturePace(), options, False

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment, and make the programs for its poses and pictures."""
        assert start.env is not None
        env, self.name = start.env, start.name
        self.env, self.step, self._camera = env, None, LiveCamera(env)
        self._cameras = {0: self._camera}
        self._camera.free, self._tile_camera = self._free, TileCamera(env)
        self._late.clear()
        self._scene.on_run_start(start)
        has_sound = SOUND_STATE in {sensor.name for sensor in state_owners(env.core.sensors)}
        self.has_sound = has_sound
        self.tell(sound=has_sound)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Show the instruction."""
        self.tell(instruction=start.instruction)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Move the scene, load another house if there is one, and send picture, sound and status."""
        assert self.env is not None
        is_repeated = self.step is not None and self.step.index == step.index  # such as after a door was opened
        self.step = step
        self._scene.on_episode_step(step)
        if self.has_sound and step.index and not is_repeated and self.server.sound.num_pages:
            self._publish_sound(step.state.world.sensor_states[SOUND_STATE].frame)
        self.draw(is_moving=step.index > 0)
        self.tell(status=format_status(self.env, step, self.name))

    def draw(self, is_moving: bool = False) -> None:
        """Render and send the picture of the last step, if a page is open; a smaller one if it moves and is slow."""
        if self.env is None or self.step is None or not self.server.live.num_pages:
            return
        options = self._reduced(self.step.state) if is_moving and self.adapts else self.options
        is_first, began = not self._camera.is_ready(options), time.perf_counter()
        self._picture = encode_jpeg(self._camera.capture(self.step.state, options))
        self._drawn_at, self._is_coarse = time.perf_counter(), options.size < self.options.size
        self.picture_seconds = self._drawn_at - began
        if not is_first:  # that compiled
            self._pace.record(options.size, self.picture_seconds)
        pages = self._pages_by_agent()
        self._late.clear()  # of agents whose pages were closed
        self.server.live.publish(self._picture, pages.pop(0, ()) if pages else None)
        for agent, others in pages.items():
            self._draw_other(agent, others, options)
        shader = f", {options.shader}" if options.kind == "colours" else ""
        self.tell(caption=f"{options.viewpoint}: {options.kind}{shader}, {options.size} px")

    def _pages_by_agent(self) -> dict[int, list[int]]:
        """Return the pages that show each agent's picture; {} if all show the first one's."""
        found: dict[int, list[int]] = {}
        for page in self.server.live.pages:
            found.setdefault(min(self.agent_of(page), self._num_agents - 1), []).append(page)
        return found if set(found) != {0} else {}

    def _draw_other(self, agent: int, pages: list[int], options: PictureOptions) -> None:
        """Render another agent's picture, and send it to its pages."""
        assert self.env is not None
        assert self.step is not None
        if agent not in self._cameras:
            self._cameras[agent] = LiveCamera(self.env, agent)
        camera = self._cameras[agent]
        camera.free = self._free
        if self.adapts and not camera.is_ready(options):  # the program of the whole size serves until then
            camera.prepare(self.step.state, options)
            options = self.options
            if not camera.is_ready(options):
                self._late.add(agent)
                return
        self.server.live.publish(encode_jpeg(camera.capture(self.step.state, options)), pages)

    def _publish_sound(self, frame: Any) -> None:
        """Send each page the sound at the ears of its agent."""
        pages = self.server.sound.pages
        chosen = {page: min(self._ears.get(page, 0), len(frame) - 1) for page in pages}
        for agent in sorted(set(chosen.values())):
            own = [page for page in pages if chosen[page] == agent]
            self.server.sound.publish(encode_sound(frame, agent), own)

    def listen(self, message: dict[str, Any]) -> None:
        """Handle a message of a page's sound: `listen` with an agent, or `leave`."""
        if message.get("type") == "listen" and isinstance(message.get("agent"), int):
            self._ears[message["page"]] = max(message["agent"], 0)
        elif message.get("type") == "leave":
            self._ears.pop(message["page"], None)

    @property
    def _num_agents(self) -> int:
        """Number of acting agents."""
        assert self.env is not None
        return self.env.core.num_agents

    def prepare(self) -> None:
        """Compile the program of pictures in a thread, before the first page opens."""
        if self.step is not None and not self._camera.is_ready(self.options):
            self._camera.prepare(self.step.state, self.options)

    def refine(self) -> None:
        """Draw the last step at full size, once nothing has moved for `REFINE_SECONDS` since a smaller picture.

        Also draw it for agents whose program is compiled now.
        """
        is_due = self._is_coarse and time.perf_counter() - self._drawn_at > REFINE_SECONDS
        if is_due or any(self._cameras[agent].is_ready(self.options) for agent in self._late):
            self.draw()

    def _reduced(self, state: State) -> PictureOptions:
        """Return options of a size that is fast enough; the full one while a smaller one still compiles."""
        look = dataclasses.replace(self.options, size=MIN_SIZE)
        if look != self._look:
            self._look, self._pace = look, PicturePace()
        options = dataclasses.replace(self.options, size=self._pace.choose(self.options.size))
        if options != self.options and not self._camera.is_ready(options):
            self._camera.prepare(state, options)
            return self.options
        return options

    def draw_tiles(self, numbers: Sequence[int], watched: int, get_states: Callable[[], State]) -> None:
        """Render and send the grid of several environments, if a page is open and the last grid is old enough.

        Args:
            numbers: Numbers of the environments in the grid.
            watched: Number of the watched one.
            get_states: Function that returns their states as a batch; called only if the grid is drawn.
        """
        known = {"numbers": [int(n) for n in numbers], "columns": count_columns(len(numbers)), "watched": int(watched)}
        is_due = time.perf_counter() - self._tiled_at > TILE_SECONDS or known != self.state.get("tiles")
        if self._tile_camera is None or not self.server.live.num_pages or not is_due:
            return
        self.tell(tiles=known)
        self.server.live.publish(encode_tiles(self._tile_camera.capture(get_states(), self.options.viewpoint)))
        self._tiled_at = time.perf_counter()

    def set_free_camera(self, camera: Camera) -> None:
        """Replace the free camera, and draw if the picture is its."""
        self._free = self._camera.free = camera
        if self.options.viewpoint == FREE:
            self.draw()

    def tell(self, **state: Any) -> None:
        """Change entries of the page's state, and send those that differ."""
        changed = {name: value for name, value in state.items() if self.state.get(name) != value}
        self.state.update(changed)
        if changed:
            self.server.live.publish(json.dumps(changed))

    def tell_page(self, page: int, **state: Any) -> None:
        """Send entries to one page, which others do not get."""
        self.server.live.publish(json.dumps(state), (page,))

    def warn(self, text: str) -> None:
        """Show an error on all pages, and on stderr."""
        say(text)
        for client in self.server.scene.get_clients().values():
            client.add_notification("error", text, color="red", auto_close_seconds=15.0)

    def sound_format(self) -> str:
        """Return the format of the sound that pages receive first, as JSON."""
        rate = 16000 if self.env is None else self.env.config.timing.sample_rate
        return json.dumps({"rate": rate, "delay": SOUND_DELAY})


def encode_sound(frame: Any, agent: int = 0) -> bytes:
    """Return an agent's part of the sound, (A, 2, n), as interleaved float32 samples, left first.

    Example:
        >>> np.frombuffer(encode_sound(np.array([[[1, 2], [3, 4]]])), "<f4").tolist()
        [1.0, 3.0, 2.0, 4.0]
    """
    return np.asarray(frame, "<f4")[agent, :2].T.tobytes()
