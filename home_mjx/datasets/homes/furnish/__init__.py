"""Furniture of homes: the recipes of the first generator, and recipes for the rooms that it does not know."""

from home_mjx.datasets.homes.furnish.level import furnish_home

__all__ = ["furnish_home"]
