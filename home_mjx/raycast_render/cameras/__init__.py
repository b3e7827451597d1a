"""Cameras: rays, sampling, noise, and rendering on some steps only."""
