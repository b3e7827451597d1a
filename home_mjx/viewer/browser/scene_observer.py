"""Observers of the 3D scene: one moves it with an episode, one records episodes as a page without a server."""

import contextlib
import io
from pathlib import Path
from typing import TYPE_CHECKING, Any

import jax
import numpy as np

from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeResult, EpisodeStart, EpisodeStep, Observer, RunStart
from home_mjx.viewer.browser.house_scene import HouseScene
from home_mjx.viewer.browser.models import ModelLibrary
from home_mjx.viewer.browser.overlays import Overlays
from home_mjx.viewer.browser.scene_tree import SceneTree
from home_mjx.viewer.browser.server import load_viser

if TYPE_CHECKING:
    import viser

FINAL_SECONDS = 1.5  # [s], display time of the last step of an episode


class SceneObserver(Observer):
    """Scene that follows the first environment of a run: another house is loaded, poses are moved.

    Args:
        tree: The scene.
    """

    def __init__(self, tree: SceneTree) -> None:
        self.tree, self._house = tree, -1
        self._library: tuple[Any, ModelLibrary] | None = None

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment, and make the program for its poses."""
        assert start.env is not None
        env: Env[HouseholdEnv] = start.env
        if self._library is None or self._library[0] is not env.params.bank:
            self._library = env.params.bank, ModelLibrary(env.bank)
            self._house = -1
        self._env = env
        self._moving = jax.jit(lambda params, state: env.core.snapshot(params, state).scene.moving)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Move the scene, or load another house."""
        assert self._library is not None
        moving = jax.tree.map(np.asarray, self._moving(self._env.params, step.state))
        house = int(step.state.world.house)
        if house == self._house:
            self.tree.move(moving)
        else:
            self._house = house
            self.tree.load(HouseScene(self._env.bank, house, moving, self._library[1]))


class PageRecorder(Observer):
    """Recorder of episodes as one HTML file: the moving 3D scene with paths and goals, without server or network.

    The page has viser's viewer in it, with a time line. It has no pictures of our renderer, and no sound.

    Args:
        name: Name of the file, without suffix.

    Raises:
        ConfigError: The extra `view` is not installed.

    Example:
        >>> run_play(options, observers=[PageRecorder("walk")])  # doctest: +SKIP
    """

    def __init__(self, name: str) -> None:
        self.name = name
        with contextlib.redirect_stdout(io.StringIO()):  # viser prints an address that nobody needs
            self._server: viser.ViserServer = load_viser().ViserServer("127.0.0.1", 0, verbose=False)
        self._overlays = Overlays(self._server)
        self._scene = SceneObserver(SceneTree(self._server, lambda group, index: None))
        self._recording = self._server.get_scene_serializer()

    def on_run_start(self, start: RunStart) -> None:
        """Store the environment."""
        assert start.env is not None
        self._dt = start.env.dt
        self._scene.on_run_start(start)
        self._overlays.on_run_start(start)

    def on_episode_start(self, start: EpisodeStart) -> None:
        """Clear the path."""
        self._overlays.on_episode_start(start)

    def on_episode_step(self, step: EpisodeStep) -> None:
        """Record a step, and the time until the next one."""
        self._scene.on_episode_step(step)
        self._overlays.on_episode_step(step)
        self._recording.insert_sleep(self._dt)

    def on_episode_end(self, result: EpisodeResult) -> None:
        """Hold the last step."""
        self._recording.insert_sleep(FINAL_SECONDS)

    def write(self, folder: Path) -> None:
        """Write `<self.name>.html`."""
        (folder / f"{self.name}.html").write_text(self._recording.as_html(dark_mode=True))

    def close(self) -> None:
        """Stop viser's server, which no page has used."""
        with contextlib.redirect_stdout(io.StringIO()):
            self._server.stop()
