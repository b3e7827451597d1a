"""Furniture of homes: what goes into each room, and where."""

from home_mjx.datasets.homes.furnish.level import furnish_home

__all__ = ["furnish_home"]
