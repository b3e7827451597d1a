"""Light and colour at surfaces: textures, lamps, sun and sky, baked light, highlights, glass and mirrors."""
