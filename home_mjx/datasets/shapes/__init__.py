"""Solids built from outlines: slabs and wall prisms."""
