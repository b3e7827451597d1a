"""Furniture of homes: what goes into each room, and where."""

from home_procgen.furnish.level import furnish_home

__all__ = ["furnish_home"]
