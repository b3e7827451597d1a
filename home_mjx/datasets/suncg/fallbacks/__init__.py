"""Fallbacks for missing parts of a partial dataset: models, room meshes, metadata rows."""
