"""Rays in houses: `cast` and `occluded`, scenes of placed objects and agents, cameras and images."""

from home_mjx.raycast_render.camera import Camera
from home_mjx.raycast_render.cast import cast, occluded
from home_mjx.raycast_render.render import KINDS, render
from home_mjx.raycast_render.scene import make_scene
from home_mjx.raycast_render.types import Hit, Moving, Rays, Scene

__all__ = ["KINDS", "Camera", "Hit", "Moving", "Rays", "Scene", "cast", "make_scene", "occluded", "render"]
