"""Observations: images, ids, sound, own state and goal, by name.

For one environment with A agents every value has a leading agent axis:

* `pixels/head_<kind>` for rgb (uint8, H W 3), depth (float32 [m], H W 1, clipped) and normal (float32, H W 3)
* `ids/head_<kind>` int32 (H W): instance, fine, coarse, nyu40, room, level, material; -1 on a miss
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

from home_mjx.audio_jax import clip_samples, impulse_response, sound_frame
from home_mjx.raycast_render import Camera, render
from home_mjx.raycast_render.types import Scene
from home_mjx.scene_compile.bank import HouseBank
from home_mjx.tasks.config import PIXEL_KINDS, EnvConfig
from home_mjx.tasks.keys import SOUND, fold
from home_mjx.tasks.pose import AgentPose, camera_quat
from home_mjx.tasks.state import World


def eye_position(config: EnvConfig, pose: AgentPose) -> Float[Array, "a 3"]:
    """Camera and ears of every agent [m]; the pose is the capsule's centre."""
    rise = jnp.array([0.0, 0.0, config.eye_height - config.physics.agent_height / 2], jnp.float32)
    return pose.pos + rise[None]


def agent_ids(bank: HouseBank, num_agents: int) -> Array:
    """Object id of every agent: they follow the houses' instances."""
    return bank.spec.num_instances + jnp.arange(num_agents, dtype=jnp.int32)


def observe_images(config: EnvConfig, bank: HouseBank, scene: Scene, pose: AgentPose) -> dict[str, Array]:
    """The camera sensors of every agent."""
    if not config.image_kinds:
        return {}
    fovy = jnp.full(pose.yaw.shape, jnp.deg2rad(jnp.float32(config.fovy)))
    camera = jax.vmap(Camera)(eye_position(config, pose), jax.vmap(camera_quat)(pose.yaw, pose.pitch), fovy)

    def view(camera: Camera, own: Array) -> dict[str, Array]:
        return render(
            bank,
            scene,
            camera,
            width=config.width,
            height=config.height,
            kinds=config.image_kinds,
            exclude=own,
            depth_max=config.depth_max,
            executor=config.executor,
        )

    own = agent_ids(bank, config.physics.num_agents)
    images = _over_agents(view, camera, own)
    return {_name(kind): images[kind] for kind in config.image_kinds}


def _over_agents(function: Callable[..., Any], *args: Any) -> Any:
    """`vmap` over the agent axis; a single agent goes without: XLA gathers twice as fast with one axis less."""
    if jax.tree.leaves(args)[0].shape[0] > 1:
        return jax.vmap(function)(*args)
    return jax.tree.map(lambda x: x[None], function(*jax.tree.map(lambda x: x[0], args)))


def _name(kind: str) -> str:
    return f"pixels/head_{kind}" if kind in PIXEL_KINDS else f"ids/head_{kind}"


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
