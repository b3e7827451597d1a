"""Observer that moves the 3D scene with an episode."""

from typing import Any

import jax
import numpy as np

from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.env.observers import EpisodeStep, Observer, RunStart
from home_mjx.viewer.browser.scene.house_scene import HouseScene
from home_mjx.viewer.browser.scene.models import ModelLibrary
from home_mjx.viewer.browser.scene.scene_tree import SceneTree


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
