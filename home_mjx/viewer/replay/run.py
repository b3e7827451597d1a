"""Replaying recorded episodes in the browser: from a replay file, or a data set of trajectories."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

from home_mjx.env_factory import make
from home_mjx.errors import ConfigError
from home_mjx.registry import EnvSpec
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import ObserverGroup
from home_mjx.viewer.browser.broadcast import Broadcast
from home_mjx.viewer.browser.object_card import format_card
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.run import PageViewer, ViewOptions, print_address
from home_mjx.viewer.browser.scene.house_scene import InstanceGroup
from home_mjx.viewer.browser.scene.scene_tree import SceneTree
from home_mjx.viewer.browser.serving.server import ViewServer
from home_mjx.viewer.replay.panels import ReplayPanels
from home_mjx.viewer.replay.session import ReplaySession
from home_mjx.viewer.replay.track import HINT, Replay, read_replay
from home_mjx.viewer.replay.trajectories import is_trajectories, replay_trajectories


class ReplayViewer(PageViewer):
    """Recorded episodes in browser pages; `run` is its loop. Use it as a context.

    Args:
        env: The environment of the episodes.
        replay: The episodes.
        options: Address, and options of the picture.

    Raises:
        ConfigError: The extra `view` is not installed, no port is free, the replay is empty, or has other houses.
        DatasetError: The replay is of another environment.
    """

    session: ReplaySession

    def __init__(self, env: Env[HouseholdEnv], replay: Replay, options: ViewOptions | None = None) -> None:
        if not replay.tracks:
            raise ConfigError("the replay has no episode", hint=HINT)
        self.options = options or ViewOptions()
        self.server = ViewServer(
            self.options.host, self.options.port, greeting=self._greet, sound_greeting=self._greet_sound
        )
        try:
            tree = SceneTree(self.server.scene, self._show_object)
            self.broadcast = Broadcast(self.server, tree, self.options.picture)
            overlays = Overlays(self.server.scene)
            self.panels = ReplayPanels(self.server.scene, self.broadcast, overlays)
            observers = ObserverGroup((self.broadcast, overlays, self.panels))
            self.session = ReplaySession(env, replay, observers, self.broadcast.warn)
            self.panels.attach(self.session)
        except BaseException:
            self.server.close()
            raise

    def _show_object(self, group: InstanceGroup, index: int) -> None:
        """Show the card of a clicked object; on a viser thread."""
        house = list(self.session.env.bank.house_ids).index(self.session.track.notes["house"])
        card = format_card(self.session.env.bank, house, group, index)
        self.session.post(lambda: self.panels.show_card(card))


def load_replay(path: Path, sensors: tuple[str, ...] | None = None) -> tuple[Env[HouseholdEnv], Replay]:
    """Return the environment and the episodes of a replay file, or of a folder of trajectories.

    Trajectories have no states: their episodes are simulated again, see `replay_trajectories`.

    Args:
        path: The file or the folder.
        sensors: Sensors of the environment of trajectories, such as `audio` for sound; None: as recorded.

    Raises:
        MissingFileError: There is no such file.
        DatasetError: It is broken, or of another version.
        ConfigError: Its houses were in memory, or the environment is not registered.
    """
    if is_trajectories(path):
        return replay_trajectories(path, sensors)
    replay = read_replay(path)
    if replay.spec is None:
        raise ConfigError("the houses of the replay were in memory only", file=path, hint="Use `ReplayViewer`.")
    return make_trusted(replay.spec), replay


def make_trusted(text: str) -> Env[HouseholdEnv]:
    """Make the environment of a spec's JSON, whose entry point must be registered here."""
    spec = EnvSpec.from_json(text)
    spec.check_trusted()
    return make(spec)


def run_replay(path: Path, options: ViewOptions, print_line: Callable[[str], Any]) -> None:
    """Serve a replay, print its address, and run until an interrupt; raises as `load_replay` and `ReplayViewer`."""
    with ReplayViewer(*load_replay(path), options) as viewer:
        print_address(options, viewer.server, print_line)
        viewer.run()
