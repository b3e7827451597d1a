"""Colour of what rays hit: textures, lights, glass and mirrors."""
