"""Cameras: their rays, how they sample, their noise, when they look."""
