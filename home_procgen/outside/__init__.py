"""Surroundings of a home: roof, garden, street and neighbours."""

from home_procgen.outside.surroundings import Surroundings, draw_surroundings

__all__ = ["Surroundings", "draw_surroundings"]
