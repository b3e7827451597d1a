"""Cameras of films and pages on an episode: at an agent's eyes, behind it, above its house, or anywhere."""

from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.core.checks import check_known
from home_mjx.core.transforms import camera_quat
from home_mjx.raycast_render.cameras.camera import Camera, Lens, camera_rays
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.images.view import interval_below
from home_mjx.raycast_render.lighting.texture import encode_srgb
from home_mjx.raycast_render.shaders.base import ShaderSpec
from home_mjx.tasks.base.config import AgentCamera
from home_mjx.tasks.base.snapshot import Snapshot
from home_mjx.tasks.env.env import Env
from home_mjx.tasks.env.household import HouseholdEnv
from home_mjx.tasks.sensors.cameras import agent_ids, eye_position, place_cameras
from home_mjx.viewer.pictures.top_view import CUT_HEIGHT, CUT_WALL_GREY, frame_house, is_in_wall

FIRST, THIRD, TOP, FREE = "first person", "third person", "top-down", "free"
VIEWPOINTS = (FIRST, THIRD, TOP, FREE)
FOVY = 75.0  # [degrees] vertical field of view
RISE_ABOVE_CUT = 1.2  # [m], of the third person's camera above the cut
MIN_BEHIND, MAX_BEHIND = 0.4, 2.4  # [m], horizontal distance of that camera from the agent
WALL_CLEARANCE = 0.1  # [m], between a wall behind the agent and where the line of sight passes the cut
AIM_AHEAD, AIM_HEIGHT = 0.5, 0.7  # [m], point that camera looks at: before the agent, and above its feet
MAX_WALL = 1.0  # [m], thickness of a wall whose cut is drawn dark


class EpisodeCamera:
    """Camera on an environment's agent, independent of its observations.

    Ceilings and upper storeys do not hide what cameras from outside see: nothing is drawn above `CUT_HEIGHT` over the
    agent's feet. A free camera below that height sees all.

    Args:
        env: The environment.
        agent: Number of the agent.
    """

    def __init__(self, env: Env[HouseholdEnv], agent: int = 0) -> None:
        self.env, self.agent = env, agent
        self._overviews: dict[int, Camera] = {}

    def place_overview(self, house: int) -> Camera:
        """Return the orthographic camera that frames a house from above, at height 0 (host only)."""
        if house not in self._overviews:
            low, _, side = frame_house(self.env.bank, house)
            middle = jnp.asarray([*(low + side / 2), 0.0], jnp.float32)
            self._overviews[house] = Camera(middle, jnp.eye(1, 4, dtype=jnp.float32)[0], jnp.float32(side))
        return self._overviews[house]

    def see(
        self, snapshot: Snapshot, lens: Lens, kind: str, shader: ShaderSpec, viewpoint: str = FIRST, spot: Any = None
    ) -> Array:
        """Render an image of one kind (JAX).

        Args:
            snapshot: The environment.
            lens: Resolution and samples of the image.
            kind: Kind of the image, as of `render`.
            shader: Shader of colours.
            viewpoint: One of `VIEWPOINTS`.
            spot: Camera of a free viewpoint, or the overview of the house from `place_overview` for `top-down`.

        Raises:
            UnknownNameError: The viewpoint is unknown.
        """
        check_known("camera", [viewpoint], VIEWPOINTS)
        own = agent_ids(snapshot.bank, self.env.core.config.num_agents)[self.agent]
        options: dict[str, Any] = {"kinds": (kind,), "shader": shader, "depth_max": self.env.core.config.max_depth}
        if viewpoint == FIRST:
            camera = self._at_eyes(snapshot, lens, shader)
            return render(snapshot.scene, camera, lens, **options, exclude=own)[kind]
        cut = snapshot.feet[self.agent, 2] + CUT_HEIGHT
        camera = self._behind(snapshot, own) if viewpoint == THIRD else spot
        if viewpoint == TOP:
            lens = Lens(lens.width, lens.height, "orthographic", lens.samples)
            camera = spot.replace(pos=spot.pos.at[2].set(cut + RISE_ABOVE_CUT))
        image = render(snapshot.scene, camera, lens, **options, cut_height=cut)[kind]
        return darken_cut_walls(snapshot, camera, lens, cut, image) if kind == "rgb" else image

    def _at_eyes(self, snapshot: Snapshot, lens: Lens, shader: ShaderSpec) -> Camera:
        """Return the camera at the agent's eyes."""
        view = AgentCamera("viewer", ("rgb",), lens, fovy=FOVY, shader=shader)
        cameras = place_cameras(self.env.core.config, view, snapshot.pose, snapshot.camera_offsets)
        return jax.tree.map(lambda x: x[self.agent], cameras)

    def _behind(self, snapshot: Snapshot, own: Array) -> Camera:
        """Return a camera behind and above the agent, nearer before a wall, so that no wall is between them."""
        eye = eye_position(self.env.core.config, snapshot.pose)[self.agent]
        feet, yaw = snapshot.feet[self.agent], snapshot.pose.yaw[self.agent]
        ahead = jnp.stack([jnp.cos(yaw), jnp.sin(yaw), jnp.zeros_like(yaw)])
        free = jnp.minimum(cast(snapshot.scene, eye, -ahead, exclude=own).t, MAX_BEHIND) - WALL_CLEARANCE
        below = jnp.maximum(feet[2] + CUT_HEIGHT - eye[2], 0.1)  # the line of sight rises by this before the cut
        behind = jnp.clip(free * (below + RISE_ABOVE_CUT) / below, MIN_BEHIND, MAX_BEHIND)
        height = CUT_HEIGHT + RISE_ABOVE_CUT
        pitch = -jnp.arctan2(height - AIM_HEIGHT, behind + AIM_AHEAD)
        place = (feet - behind * ahead).at[2].add(height)
        return Camera(place, camera_quat(yaw, pitch), jnp.float32(np.deg2rad(FOVY)))


def darken_cut_walls(snapshot: Snapshot, camera: Camera, lens: Lens, cut: Float[Array, ""], image: Array) -> Array:
    """Return a colour image with the pixels dark whose rays enter a wall at the cut (JAX)."""
    origin, direction = camera_rays(camera, lens)
    start, _ = interval_below(cut, origin, direction)
    entry = origin + start[..., None] * direction
    is_cut = is_in_wall(snapshot.scene, entry, jnp.where(start > 0, MAX_WALL, -1.0))
    return jnp.where(is_cut[..., None], encode_srgb(jnp.float32(CUT_WALL_GREY)), image)
