"""Observations: images, ids, sound, own state and goal, by name.

For one environment with A agents every value has a leading agent axis:

* `pixels/head_<kind>` for rgb (uint8, H W 3), depth (float32 [m], H W 1, clipped) and normal (float32, H W 3)
* `ids/head_<kind>` int32 (H W): instance, fine, coarse, nyu40, room, level, material; -1 on a miss
* `camera/head_intrinsics` float32 (3, 3), `camera/head_pose` float32 (4, 4): world from camera; `camera/head_valid`
* the same of further cameras, by their names
* `audio` float32 (2, frame): left and right ear [pressure re 1 m of the source]
* `state` float32 (10,): x, y, z [m], cos and sin of yaw, pitch [rad], forward and left speed [m/s], yaw rate [rad/s],
  1 while touching anything but the floor
* `goal` float32 (3,): distance [m], cosine and sine of the bearing in the agent's frame, left positive
"""

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Bool, Float, Int

from home_mjx.audio_jax.auralization.response import impulse_response
from home_mjx.audio_jax.auralization.sources import clip_samples
from home_mjx.audio_jax.auralization.stream import sound_frame
from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.raycast_render.cameras.camera import Camera, intrinsics, world_from_camera
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.config import CAMERA_KINDS, PIXEL_KINDS, AgentCamera, EnvConfig
from home_mjx.tasks.base.keys import SOUND, fold
from home_mjx.tasks.base.pose import AgentPose
from home_mjx.tasks.base.state import World


def eye_position(config: EnvConfig, pose: AgentPose) -> Float[Array, "a 3"]:
    """Camera and ears of every agent [m]; the pose is the capsule's centre."""
    rise = jnp.array([0.0, 0.0, config.eye_height - config.physics.agent_height / 2], jnp.float32)
    return pose.pos + rise[None]


def agent_ids(bank: HouseBank, num_agents: int) -> Array:
    """Object id of every agent: they follow the houses' instances."""
    return bank.spec.num_instances + jnp.arange(num_agents, dtype=jnp.int32)


def observe_images(config: EnvConfig, bank: HouseBank, scene: Scene, pose: AgentPose) -> dict[str, Array]:
    """The camera sensors of every agent."""
    own = agent_ids(bank, config.physics.num_agents)
    obs: dict[str, Array] = {}
    for view in config.views:

        def look(camera: Camera, own: Array, view: AgentCamera = view) -> dict[str, Array]:
            return _look(config, view, bank, scene, camera, own)

        obs |= _over_agents(look, place_cameras(config, view, pose), own)
    return obs


def place_cameras(config: EnvConfig, view: AgentCamera, pose: AgentPose) -> Camera:
    """One of the cameras of every agent, with a leading agent axis."""
    yaw = pose.yaw + float(np.deg2rad(view.yaw))
    pitch = float(np.deg2rad(view.pitch)) + (pose.pitch if view.looks else jnp.zeros_like(pose.pitch))
    forward, left, up = view.offset
    shift = jnp.stack(
        [
            forward * jnp.cos(pose.yaw) - left * jnp.sin(pose.yaw),
            forward * jnp.sin(pose.yaw) + left * jnp.cos(pose.yaw),
            jnp.full_like(pose.yaw, up),
        ],
        axis=-1,
    )
    size = view.fovy if view.lens.model == "orthographic" else float(np.deg2rad(view.fovy))
    fovy = jnp.full(pose.yaw.shape, size, jnp.float32)
    return jax.vmap(Camera)(eye_position(config, pose) + shift, jax.vmap(camera_quat)(yaw, pitch), fovy)


def _look(
    config: EnvConfig, view: AgentCamera, bank: HouseBank, scene: Scene, camera: Camera, own: Array
) -> dict[str, Array]:
    """What one camera of one agent gives, by the names of the observations."""
    images = render(
        bank,
        scene,
        camera,
        view.lens,
        kinds=tuple(kind for kind in view.kinds if kind not in ("intrinsics", "pose")),
        preset=config.rgb_preset,
        exclude=own,
        depth_max=config.depth_max,
        executor=config.executor,
    )
    if "intrinsics" in view.kinds:
        images["intrinsics"] = intrinsics(camera, view.lens)
    if "pose" in view.kinds:
        images["pose"] = world_from_camera(camera)
    return {_name(view.name, kind): images[kind] for kind in view.kinds}


def _over_agents(function: Callable[..., Any], *args: Any) -> Any:
    """`vmap` over the agent axis; a single agent goes without: XLA gathers twice as fast with one axis less."""
    if jax.tree.leaves(args)[0].shape[0] > 1:
        return jax.vmap(function)(*args)
    return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], args)))


def _name(camera: str, kind: str) -> str:
    folder = "pixels" if kind in PIXEL_KINDS else "camera" if kind in CAMERA_KINDS else "ids"
    return f"{folder}/{camera}_{kind}"


def hear(config: EnvConfig, bank: HouseBank, scene: Scene, pose: AgentPose, world: World) -> Float[Array, "a 2 l"]:
    """Impulse response from the source to both ears of every agent."""
    # One key per house and source, not per step: successive responses stay coherent, so the tail does not flutter.
    keys = jax.random.split(fold(world.key, SOUND), pose.yaw.shape[0])
    own = agent_ids(bank, config.physics.num_agents)

    def one(ears: Array, quat: Array, key: Array, own: Array) -> Array:
        return impulse_response(
            bank, scene, world.source, ears, quat, key, config.audio, exclude=own, executor=config.executor
        )

    heads = jax.vmap(camera_quat)(pose.yaw, jnp.zeros_like(pose.pitch))
    return _over_agents(one, eye_position(config, pose), heads, keys, own)


def observe_sound(
    config: EnvConfig, world: World, old: Float[Array, "a 2 l"], new: Float[Array, "a 2 l"]
) -> Float[Array, "a 2 n"]:
    """One frame of stereo sound per agent, fading from the old response to the new one."""
    clip = jnp.asarray(_clip(config))
    return jax.vmap(lambda a, b: sound_frame(clip, world.phase, a, b, config.audio))(old, new)


def next_phase(config: EnvConfig, phase: Int[Array, ""]) -> Int[Array, ""]:
    """Position in the clip one frame later."""
    return (phase + config.audio.frame) % len(_clip(config))


def _clip(config: EnvConfig) -> Float[np.ndarray, " n"]:
    return clip_samples(config.clip, config.audio)


def observe_state(pose: AgentPose, velocity: Float[Array, "a 3"], contact: Bool[Array, " a"]) -> Float[Array, "a 10"]:
    """The agent's own pose, velocity and contact flag."""
    angles = jnp.stack([jnp.cos(pose.yaw), jnp.sin(pose.yaw), pose.pitch], axis=-1)
    return jnp.concatenate([pose.pos, angles, velocity, contact.astype(jnp.float32)[:, None]], axis=-1)
