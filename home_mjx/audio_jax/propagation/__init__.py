"""Paths of sound: direct, mirrored, traced."""
