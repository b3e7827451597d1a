"""Camera of a film: the first agent's view, and the poses of agents and objects."""

from typing import NamedTuple

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float, UInt8

from home_mjx import physics
from home_mjx.core.progress import show_compile
from home_mjx.raycast_render.cameras.camera import Lens
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.state import EnvParams, State
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.rules.features import current_boxes
from home_mjx.viewer.episodes.viewpoints import EpisodeCamera

VIEW_CONE_HALF_ANGLE = 35.0  # [degrees] half angle of an agent's view cone on a plan


class CameraShot(NamedTuple):
    """View of the first agent and positions of all agents and objects at one step."""

    view: UInt8[np.ndarray, "h w 3"]
    pos: Float[np.ndarray, "a 3"]  # [m]
    yaw: Float[np.ndarray, " a"]  # [rad]
    boxes: Float[np.ndarray, "i 2 3"]  # [m], of all instances


class FilmCamera:
    """Camera at the first agent's eyes, independent of its observations.

    Args:
        env: The environment.
        width: Width of the image [px].
        height: Height of the image [px].
        samples: Rays per pixel.
    """

    def __init__(self, env: Env[HouseholdEnv], width: int = 480, height: int = 360, samples: int = 1) -> None:
        self.env, self._camera = env, EpisodeCamera(env)
        self._lens = Lens(width, height, samples=samples)
        self._see, self._is_compiled = jax.jit(self._seen), False

    def capture(self, state: State) -> CameraShot:
        """Render the first agent's view in a state of one environment; return it as NumPy arrays with the positions."""
        if self._is_compiled:
            return self._capture(state)
        self._is_compiled = True
        with show_compile("the film's camera", self.env.core.progress):
            return self._capture(state)

    def _capture(self, state: State) -> CameraShot:
        return CameraShot(*(np.asarray(x) for x in self._see(self.env.params, state)))

    def _seen(self, params: EnvParams, state: State) -> tuple[Array, Array, Array, Array]:
        """Return, in JAX arrays, the fields of `CameraShot`."""
        snapshot = self.env.core.snapshot(params, state)
        view = self._camera.see(snapshot, self._lens, "rgb", "lit")
        return view, snapshot.pose.pos, snapshot.pose.yaw, current_boxes(snapshot)


def scene_without_agents(env: Env[HouseholdEnv], state: State) -> Scene:
    """Build the scene of one environment's state without agents, which are drawn as markers instead."""
    template = env.core.template(env.bank)
    pos, quat = physics.body_pose(template, state.physics)
    nobody = jnp.zeros((0, 3), jnp.float32), jnp.zeros((0, 4), jnp.float32)
    angle = physics.door_angle(template, state.physics)
    return make_scene(env.bank, state.world.house, pos, quat, *nobody, env.config.backend, angle)
