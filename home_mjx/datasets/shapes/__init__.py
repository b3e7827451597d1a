"""Solids from outlines: slabs and wall prisms."""
