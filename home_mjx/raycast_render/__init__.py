"""Rays in houses: `cast` and `occluded`, scenes of placed objects and agents, cameras and images."""

from home_mjx.raycast_render.cast import cast, occluded
from home_mjx.raycast_render.image.camera import (
    Camera,
    Lens,
    camera_rays,
    depth_points,
    intrinsics,
    world_from_camera,
)
from home_mjx.raycast_render.image.noise import kinect_depth, sensor_rgb
from home_mjx.raycast_render.image.preset import Lit, Preset
from home_mjx.raycast_render.image.render import KINDS, render
from home_mjx.raycast_render.image.schedule import render_every, render_some
from home_mjx.raycast_render.scene import make_scene
from home_mjx.raycast_render.types import Hit, Moving, Rays, Scene

__all__ = [
    "KINDS",
    "Camera",
    "Hit",
    "Lens",
    "Lit",
    "Moving",
    "Preset",
    "Rays",
    "Scene",
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
