"""Shading of hits: textures, lights, glass and mirrors."""
