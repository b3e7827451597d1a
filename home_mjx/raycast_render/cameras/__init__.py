"""Cameras: rays, sampling, sensor noise, and rendering on some steps only."""
