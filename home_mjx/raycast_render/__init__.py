"""Ray casting in houses: `cast` and `occluded`, scenes of posed objects and agents, cameras and images."""

from home_mjx.raycast_render.cameras.camera import (
    Camera,
    Lens,
    camera_rays,
    depth_points,
    intrinsics,
    world_from_camera,
)
from home_mjx.raycast_render.cameras.noise import kinect_depth, sensor_rgb
from home_mjx.raycast_render.cameras.schedule import render_every, render_some
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.images.render import KINDS, render
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.types import DynamicInstances, Hit, Rays, Scene
from home_mjx.raycast_render.shaders.preset import LitShader, ShaderSpec

__all__ = [
    "KINDS",
    "Camera",
    "DynamicInstances",
    "Hit",
    "Lens",
    "LitShader",
    "Rays",
    "Scene",
    "ShaderSpec",
    "camera_rays",
    "cast",
    "depth_points",
    "intrinsics",
    "kinect_depth",
    "make_scene",
    "occluded",
    "render",
    "render_every",
    "render_some",
    "sensor_rgb",
    "world_from_camera",
]
