"""Surroundings of a home: roof, garden, street and neighbours."""

from home_procgen.outside.surroundings import Outside, draw_outside

__all__ = ["Outside", "draw_outside"]
