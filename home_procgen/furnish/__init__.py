"""Furniture of homes: recipes of each room type, and the placement of objects."""

from home_procgen.furnish.level import furnish_home

__all__ = ["furnish_home"]
