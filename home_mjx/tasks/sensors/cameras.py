"""Images of the cameras on every agent's head.

Per camera, for one agent: `pixels/<camera>_<kind>` for rgb (uint8, H W 3), depth (float32 [m], H W 1, clipped) and
normal (float32, H W 3); `ids/<camera>_<kind>` (int32, H W; -1 on a miss); `camera/<camera>_intrinsics` (3, 3),
`camera/<camera>_pose` (4, 4): world from camera, `camera/<camera>_valid` ().
"""

import functools
import itertools

import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Array, Float

from home_mjx.bank.bank import HouseBank
from home_mjx.core.transforms import camera_quat
from home_mjx.raycast_render.cameras.camera import Camera, intrinsics, world_from_camera
from home_mjx.raycast_render.cameras.shutter import is_instant
from home_mjx.raycast_render.images.render import render
from home_mjx.raycast_render.scene.types import Scene
from home_mjx.tasks.base.config import CAMERA_KINDS, PIXEL_KINDS, AgentCamera, EnvConfig
from home_mjx.tasks.base.sensor import Sensor
from home_mjx.tasks.base.snapshot import AgentPose, Snapshot, map_agents
from home_mjx.tasks.base.specs import ArraySpec, Specs
from home_mjx.tasks.variation.noise import add_depth_noise, add_rgb_noise, add_stereo_noise
from home_mjx.tasks.variation.sample import IMAGE_NOISE, STEREO_NOISE, CameraOffsets, VariationSample

MAX_ID = float(np.iinfo(np.int32).max)


class Cameras(Sensor):
    """All cameras of every agent; `EnvConfig.all_cameras` lists them and the kinds of their images."""

    name = "cameras"
    casts_rays = True

    def spec(self, config: EnvConfig) -> Specs:
        """Return the specs of one observation per camera and kind, see `observation_name`."""
        return {
            observation_name(view.name, kind): _spec(config, view, kind)
            for view in config.all_cameras
            for kind in view.kinds
        }

    def observe(self, config: EnvConfig, snapshot: Snapshot, state: tuple) -> dict[str, Array]:
        """Render all kinds of every camera from one cast, by observation name; with noise if the episode has any."""
        moving = not all(is_instant(view.lens) for view in config.all_cameras)
        before = earlier_pose(snapshot.pose, snapshot.velocity, config.timing.ctrl_dt) if moving else None
        seen = render_images(config, snapshot.scene, snapshot.pose, snapshot.camera_offsets, before)
        return seen if snapshot.variation is None else _add_noise(config, snapshot, snapshot.variation, seen)


def _spec(config: EnvConfig, view: AgentCamera, kind: str) -> ArraySpec:
    """Return the spec of one kind of a camera's observations for one agent; unknown kinds are id images."""
    shape = view.lens.shape
    known = {
        "rgb": ArraySpec((*shape, 3), "uint8", 0, 255, "sRGB, row 0 at the top"),
        "radiance": ArraySpec((*shape, 3), "float32", 0.0, text="linear light before exposure"),
        "depth": ArraySpec((*shape, 1), "float32", 0.0, config.max_depth, "along the optical axis [m], clipped"),
        "normal": ArraySpec((*shape, 3), "float32", -1.0, 1.0, "unit normal facing the camera; 0 on a miss"),
        "intrinsics": ArraySpec((3, 3), "float32", text="intrinsic matrix [px]"),
        "pose": ArraySpec((4, 4), "float32", text="world from camera [m]"),
        "valid": ArraySpec((), "bool", 0, 1, "all poses are finite"),
    }
    return known.get(kind) or ArraySpec(shape, "int32", -1, MAX_ID, f"{kind}; -1 on a miss")


def eye_position(config: EnvConfig, pose: AgentPose) -> Float[Array, "a 3"]:
    """Return the world position of every agent's eyes, which are its camera and ears [m], from the capsule's centre."""
    rise = jnp.array([body.eye_height - body.height / 2 for body in config.agents], jnp.float32)
    return pose.pos.at[:, 2].add(rise)


def agent_ids(bank: HouseBank, num_agents: int) -> Array:
    """Return the object ids of agents: `num_instances` of the bank's spec, and those that follow."""
    return bank.spec.num_instances + jnp.arange(num_agents, dtype=jnp.int32)


def earlier_pose(pose: AgentPose, velocity: Float[Array, "a 3"], dt: float) -> AgentPose:
    """Return where agents were `dt` [s] ago at their present velocity: forward and left [m/s], yaw rate [rad/s].

    The pitch is that of now.
    """
    cos, sin = jnp.cos(pose.yaw), jnp.sin(pose.yaw)
    forward, left = velocity[:, 0], velocity[:, 1]
    way = jnp.stack([forward * cos - left * sin, forward * sin + left * cos, jnp.zeros_like(cos)], axis=-1)
    return pose.replace(pos=pose.pos - way * dt, yaw=pose.yaw - velocity[:, 2] * dt)


def render_images(
    config: EnvConfig,
    scene: Scene,
    pose: AgentPose,
    mount: CameraOffsets | None = None,
    before: AgentPose | None = None,
) -> dict[str, Array]:
    """Render the images of every agent's cameras without noise, by observation name, with an agent axis first.

    Cameras whose lens has a `shutter` or `readout` move from the pose `before`; None: they rest.
    """
    own = agent_ids(scene.bank, config.num_agents)
    obs: dict[str, Array] = {}
    for view in config.all_cameras:

        def look(own: Array, camera: Camera, *before: Camera, view: AgentCamera = view) -> dict[str, Array]:
            """Render one agent's camera."""
            return _render_camera(config, view, scene, camera, own, *before)

        poses = [pose] if before is None or is_instant(view.lens) else [pose, before]
        obs |= map_agents(look, own, *(place_cameras(config, view, at, mount) for at in poses))
    return obs


def _add_noise(
    config: EnvConfig, snapshot: Snapshot, drawn: VariationSample, seen: dict[str, Array]
) -> dict[str, Array]:
    """Return images by name, with sensor noise in depth and RGB of pinhole cameras; others unchanged."""
    key = drawn.noise_key(snapshot.step, IMAGE_NOISE)
    noises = {
        "depth": (drawn.depth_noise, lambda level, key, x: add_depth_noise(level, key, x, config.max_depth)),
        "rgb": (drawn.color_noise, add_rgb_noise),
    }
    noisy = dict(seen)
    for number, (view, kind) in enumerate(itertools.product(config.all_cameras, noises)):
        (level, noise), name = noises[kind], observation_name(view.name, kind)
        if level is not None and name in seen and view.lens.model == "pinhole":
            keys = jax.random.split(jax.random.fold_in(key, number), config.num_agents)
            noisy[name] = jax.vmap(functools.partial(noise, level))(keys, noisy[name])
    if drawn.stereo_noise is None:
        return noisy
    return _add_stereo_noise(config, snapshot, drawn.noise_key(snapshot.step, STEREO_NOISE), drawn.stereo_noise, noisy)


def _add_stereo_noise(
    config: EnvConfig, snapshot: Snapshot, key: Array, level: Float[Array, ""], seen: dict[str, Array]
) -> dict[str, Array]:
    """Return images by name, with noise of a stereo camera in depth of pinhole cameras; others unchanged."""
    noisy = dict(seen)
    for number, view in enumerate(config.all_cameras):
        name = observation_name(view.name, "depth")
        if name in seen and view.lens.model == "pinhole":
            keys = jax.random.split(jax.random.fold_in(key, number), config.num_agents)
            fovy = place_cameras(config, view, snapshot.pose, snapshot.camera_offsets).fovy
            add = functools.partial(add_stereo_noise, level, depth_max=config.max_depth)
            noisy[name] = jax.vmap(lambda key, depth, fovy, add=add: add(key, depth, fovy))(keys, noisy[name], fovy)
    return noisy


def place_cameras(config: EnvConfig, view: AgentCamera, pose: AgentPose, mount: CameraOffsets | None = None) -> Camera:
    """Return the camera `view` of every agent in the world, agent axis first; `mount`: the episode's offsets, or 0.

    Its offset and yaw turn with the agent, its pitch only with `follow_pitch`. The field of view is in radians, or the
    image's height [m] if orthographic; that of pinhole cameras alone varies with `mount`.
    """
    mount = mount or CameraOffsets()
    yaw = pose.yaw + float(np.deg2rad(view.yaw))
    pitch = float(np.deg2rad(view.pitch)) + (pose.pitch if view.follow_pitch else jnp.zeros_like(pose.pitch))
    pitch = pitch if mount.pitch is None else pitch + mount.pitch
    forward, left, up = view.offset
    up = up if mount.height is None else up + mount.height
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
    if mount.fovy is not None and view.lens.model == "pinhole":
        fovy = fovy + mount.fovy
    return jax.vmap(Camera)(eye_position(config, pose) + shift, jax.vmap(camera_quat)(yaw, pitch), fovy)


def _render_camera(
    config: EnvConfig, view: AgentCamera, scene: Scene, camera: Camera, own: Array, before: Camera | None = None
) -> dict[str, Array]:
    """Render one camera of one agent, whose object id `own` rays ignore; by observation name, without agent axis."""
    images = render(
        scene,
        camera,
        view.lens,
        kinds=tuple(kind for kind in view.kinds if kind not in ("intrinsics", "pose")),
        shader=view.shader,
        exclude=own,
        depth_max=config.max_depth,
        before=before,
    )
    if "intrinsics" in view.kinds:
        images["intrinsics"] = intrinsics(camera, view.lens)
    if "pose" in view.kinds:
        images["pose"] = world_from_camera(camera)
    return {observation_name(view.name, kind): images[kind] for kind in view.kinds}


def observation_name(camera: str, kind: str) -> str:
    """Return `<folder>/<camera>_<kind>`: `pixels` for rgb, depth, normal; `camera` for its parameters; else `ids`."""
    folder = "pixels" if kind in PIXEL_KINDS else "camera" if kind in CAMERA_KINDS else "ids"
    return f"{folder}/{camera}_{kind}"
