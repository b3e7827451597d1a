"""Habitat's sensor `imagegoal`: the picture that an agent would see at the goal, in a direction of the episode."""

import zlib

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx.adapters.habitat.episodes import NavigationDataset, NavigationEpisode
from home_mjx.core.compile_cache import compiler_options
from home_mjx.errors import DatasetError
from home_mjx.tasks.base.snapshot import AgentPose
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.sensors.cameras import observation_name, render_images


def goal_yaw(episode: NavigationEpisode) -> float:
    """Return the direction of an episode's goal image [rad], uniform over episodes and equal in all processes."""
    name = f"{episode.scene_id} {episode.episode_id}".encode()
    return float(np.random.default_rng(zlib.crc32(name)).uniform(-np.pi, np.pi))


def check_point_goals(dataset: NavigationDataset, path: object) -> None:
    """Raise `DatasetError` if an episode has goal images of its own, as files of InstanceImageNav have."""
    for number, episode in enumerate(dataset.episodes):
        if episode.object_category is not None:
            message = "episode has an object or images of its own, not a point: InstanceImageNav is not replayed"
            hint = "As ObjectNav it is: `get_config('objectnav', ...)`."
            raise DatasetError(message, file=str(path), element=f"episodes[{number}]", hint=hint)


class GoalImages:
    """Pictures at the goals of an environment's episodes.

    Args:
        env: The environment, with tasks to points and a camera `head` of kind `rgb`.
    """

    def __init__(self, env: Env[HouseholdEnv]) -> None:
        core = env.core
        self._places = np.asarray(env.params.tasks.rows.columns["place"])[:, 0]  # [m], on the floor

        def look(params: EnvParams, state: State, place: Float[Array, "3"], yaw: Float[Array, ""]) -> Array:
            """Return the picture from a place on the floor."""
            snapshot = core.snapshot(params, state)
            middle = place.at[2].add(snapshot.config.agents[0].height / 2)
            pose = AgentPose(pos=middle[None], yaw=yaw[None], pitch=jnp.zeros(1, jnp.float32))
            return render_images(snapshot.config, snapshot.scene, pose)[observation_name("head", "rgb")][0]

        self._look = jax.jit(look, compiler_options=compiler_options())

    def image(
        self, params: EnvParams, state: State, number: int, episode: NavigationEpisode
    ) -> UInt8[np.ndarray, "rows columns 3"]:
        """Return the picture of an episode, after its reset; `number` is that of its row."""
        place, yaw = jnp.asarray(self._places[number], jnp.float32), jnp.float32(goal_yaw(episode))
        return np.asarray(self._look(params, state, place, yaw))
