"""Running the viewer: an environment, its session and the server, until a person ends it."""

import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

from home_mjx.bank.records.acoustics import LATE_REVERB
from home_mjx.env_factory import make
from home_mjx.registry import find_spec
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep, Observer, ObserverGroup
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.clicks import ObjectConditions, find_door, find_switch, toggle_door, toggle_switch
from home_mjx.viewer.browser.live_camera import PictureOptions
from home_mjx.viewer.browser.object_card import format_card
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.panels import Panels
from home_mjx.viewer.browser.scene.house_scene import InstanceGroup
from home_mjx.viewer.browser.scene.scene_tree import SceneTree
from home_mjx.viewer.browser.serving.drivers import Drivers
from home_mjx.viewer.browser.serving.server import DEFAULT_PORT, LOCAL_NAMES, ViewServer
from home_mjx.viewer.browser.session import Session
from home_mjx.viewer.browser.tiles import choose_tiles, stack_states
from home_mjx.viewer.episodes.command_loop import CommandLoop
from home_mjx.viewer.episodes.policies import check_agent
from home_mjx.viewer.episodes.run import AGENT_NAMES, HUMAN, default_sensors

T = TypeVar("T", bound="PageViewer")


@dataclass(frozen=True)
class ViewOptions:
    """Options of the viewer.

    Attributes:
        agent: One of `AGENT_NAMES`.
        checkpoint: Checkpoint of agent `trained`, or a folder, whose newest one is shown as training writes it.
        seed: Seed of the first episode and of actions.
        picture: Options of the picture.
        host: Name or address to bind.
        port: Port; the next free one is used if it is taken.
        num_envs: Number of environments; with several, a grid shows up to `MAX_TILES` of them.
        observers: Further observers of the session, such as a recorder.
    """

    agent: str = HUMAN
    checkpoint: Path | None = None
    seed: int = 0
    picture: PictureOptions = field(default_factory=PictureOptions)
    host: str = "localhost"
    port: int = DEFAULT_PORT
    num_envs: int = 1
    observers: tuple[Observer, ...] = ()


class PageViewer:
    """A loop that is shown in browser pages; use it as a context. A subclass makes the attributes, the server first.

    Attributes:
        server: The server; `server.address` is the page's.
        broadcast: Scene, picture and sound of the pages.
        session: The loop.
    """

    server: ViewServer
    broadcast: Broadcast
    session: CommandLoop

    def __enter__(self: T) -> T:
        return self

    def __exit__(self, *error: object) -> None:
        self.close()

    def close(self) -> None:
        """Close the server."""
        self.server.close()

    def run(self) -> None:
        """Run the loop in real time until `stop` or an interrupt."""
        self.broadcast.prepare()
        self.broadcast.adapts, self.session.between_steps = True, self.broadcast.refine
        self.session.run()

    def stop(self) -> None:
        """End `run`; from any thread."""
        self.session.post(self.session.stop)

    def _greet(self) -> str:
        """Return the state for a new page, and have its picture drawn."""
        if hasattr(self, "session"):
            self.session.post(self._redraw)
        return json.dumps(self.broadcast.state if hasattr(self, "broadcast") else {})

    def _redraw(self) -> None:
        """Draw the last step again, for a new page."""
        self.broadcast.draw()

    def _greet_sound(self) -> str:
        """Return the format of the sound."""
        return self.broadcast.sound_format()


class Viewer(PageViewer):
    """An environment in browser pages; `run` is its loop. Use it as a context.

    Args:
        env: The environment.
        options: Options of the viewer.

    Attributes:
        session: The session.
        server: The server; `server.address` is the page's.

    Raises:
        ConfigError: The extra `view` is not installed, no port is free, or the agent cannot play the environment.

    Example:
        >>> with Viewer(home_mjx.make("PointNav-v0")) as viewer:  # doctest: +SKIP
        ...     print(viewer.server.address)
        ...     viewer.run()
    """

    session: Session

    def __init__(self, env: Env[HouseholdEnv], options: ViewOptions | None = None) -> None:
        self.options = options or ViewOptions()
        self.server = ViewServer(
            self.options.host, self.options.port, self._handle, self._greet, self._greet_sound, self._listen
        )
        try:
            tree = SceneTree(self.server.scene, self._show_object)
            self.broadcast = Broadcast(self.server, tree, self.options.picture)
            self.drivers = Drivers(self.broadcast.tell, self.broadcast.tell_page)
            self.broadcast.agent_of = self.drivers.agent_of
            agents = tuple(name for name in AGENT_NAMES if name != "trained" or self.options.checkpoint is not None)
            self.panels = Panels(self.server.scene, self.broadcast, agents, self._load_task)
            overlays = Overlays(self.server.scene)
            self._tiles, self._conditions = _Tiles(self), None
            own = (self.broadcast, self._tiles, overlays, self.drivers, self.panels, *self.options.observers)
            self.session = Session(
                env,
                self.options.agent,
                ObserverGroup(own),
                self.drivers.keys,
                self.options.checkpoint,
                self.options.seed,
                self.broadcast.warn,
                self.options.num_envs,
            )
            self.panels.attach(self.session, overlays)
        except BaseException:
            self.server.close()
            raise

    def close(self) -> None:
        """Close the server, and the observers of the session."""
        super().close()
        self.session.observer.close()

    def _handle(self, message: dict[str, Any]) -> None:
        """Handle a message of a page: a click on a tile, a key or a stick; on the server's thread."""
        number = message.get("number")
        if message.get("type") == "watch" and isinstance(number, int):
            self.session.post(lambda: self.session.watch(number))
        elif hasattr(self, "drivers"):
            before = self.drivers.agent_of(message["page"])
            self.drivers.handle(message)
            if self.drivers.agent_of(message["page"]) != before and hasattr(self, "session"):
                self.session.post(self.broadcast.draw)

    def _listen(self, message: dict[str, Any]) -> None:
        """Choose the agent at whose ears a page listens; on the server's thread."""
        if hasattr(self, "broadcast"):
            self.broadcast.listen(message)

    def _redraw(self) -> None:
        """Draw picture and grid of the last step again, for a new page."""
        super()._redraw()
        self._tiles.on_episode_step(self.session.episode.step)

    def _load_task(self, name: str) -> None:
        """Load another task in the same houses; a trained agent stays behind."""
        self.broadcast.tell(status=f"loading {name}")
        bank, sensors = self.session.env.bank, default_sensors(find_spec(name))
        is_traced = "audio" in sensors and LATE_REVERB not in bank.bakes  # the houses were loaded for a silent task
        late: dict[str, Any] = {"late": "traced"} if is_traced else {}
        env = make(name, bank, sensors=sensors, **late)
        self.session.load(env, HUMAN if self.session.agent == "trained" else self.session.agent)

    def _show_object(self, group: InstanceGroup, index: int) -> None:
        """Show the card of a clicked object, and open, close or switch it if that is possible; on a viser thread."""
        self.session.post(lambda: self._handle_click(group, index))

    def _handle_click(self, group: InstanceGroup, index: int) -> None:
        """Handle a click on the session's thread."""
        session, state = self.session, self.session.episode.step.state
        house = int(state.world.house)
        env, bank = session.env, session.env.bank
        door, switch = find_door(bank, house, group, index), find_switch(bank, house, int(group.objects[index]))
        if door is not None and not state.done:
            state = toggle_door(env, state, door)
        elif switch is not None and state.world.switch_on is not None and not state.done:
            state = toggle_switch(state, switch)
        if self._conditions is None or self._conditions.env is not env:
            self._conditions = ObjectConditions(env)
        self.panels.show_card(format_card(bank, house, group, index, self._conditions.describe(state, group, index)))
        if state is not session.episode.step.state:
            session.replace_state(state)


class _Tiles(Observer):
    """Observer that draws the grid of a session of several environments."""

    def __init__(self, viewer: Viewer) -> None:
        self._viewer = viewer

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Draw the grid, if one is due."""
        if self._viewer.options.num_envs > 1 and hasattr(self._viewer, "session"):
            session = self._viewer.session
            numbers = choose_tiles(session.watched, session.num_envs)
            states = [session.episodes[n].step.state for n in numbers]
            self._viewer.broadcast.draw_tiles(numbers.tolist(), session.watched, lambda: stack_states(states))


def run_view(env: Env[HouseholdEnv], options: ViewOptions, print_line: Callable[[str], Any]) -> None:
    """Serve the viewer of an environment, print its address, and run until an interrupt.

    Args:
        env: The environment.
        options: Options of the viewer.
        print_line: Callback for lines of text: a warning if other machines can connect, another port, the address.

    Raises:
        ConfigError: As of `Viewer`.
    """
    check_agent(options.agent, options.checkpoint, AGENT_NAMES)
    with Viewer(env, options) as viewer:
        print_address(options, viewer.server, print_line)
        viewer.run()


def print_address(options: ViewOptions, server: ViewServer, print_line: Callable[[str], Any]) -> None:
    """Print the address of a page; before it a warning if other machines can connect, and another port."""
    if options.port not in (0, server.port):
        print_line(f"port {options.port} is taken, using {server.port}")
    if options.host not in LOCAL_NAMES:
        print_line(f"warning: other machines can connect to {options.host}; the address has a secret token")
    print_line(f"View at {server.address}")
