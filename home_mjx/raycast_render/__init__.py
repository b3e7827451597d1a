"""Ray casting in houses: `cast` and `occluded`, scenes of posed objects and agents, cameras and images."""

from home_mjx.raycast_render.cameras.camera import (
    Camera,
    Lens,
    camera_rays,
    depth_points,
    intrinsics,
    world_from_camera,
)
from home_mjx.raycast_render.cameras.projection import project
from home_mjx.raycast_render.cameras.schedule import render_every, render_some
from home_mjx.raycast_render.casting.cast import cast, occluded
from home_mjx.raycast_render.images.flow import optical_flow
from home_mjx.raycast_render.images.noise import kinect_depth, sensor_rgb, stereo_depth
from home_mjx.raycast_render.images.render import KINDS, render
from home_mjx.raycast_render.lighting.texture import albedo
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.raycast_render.scene.surface import unit_normals
from home_mjx.raycast_render.scene.types import DynamicInstances, Hit, Rays, Scene
from home_mjx.raycast_render.scene.vec import Vec
from home_mjx.raycast_render.shaders.base import (
    CameraRays,
    Shader,
    ShaderSpec,
    register_shader,
    resolve_shader,
    shader_names,
)
from home_mjx.raycast_render.shaders.fast import FastShader
from home_mjx.raycast_render.shaders.lit import LitShader

__all__ = [
    "KINDS",
    "Camera",
    "CameraRays",
    "DynamicInstances",
    "FastShader",
    "Hit",
    "Lens",
    "LitShader",
    "Rays",
    "Scene",
    "Shader",
    "ShaderSpec",
    "Vec",
    "albedo",
    "camera_rays",
    "cast",
    "depth_points",
    "intrinsics",
    "kinect_depth",
    "make_scene",
    "occluded",
    "optical_flow",
    "project",
    "register_shader",
    "render",
    "render_every",
    "render_some",
    "resolve_shader",
    "sensor_rgb",
    "shader_names",
    "stereo_depth",
    "unit_normals",
    "world_from_camera",
]
