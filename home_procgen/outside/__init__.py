"""What is around a home: its roof, a garden, a street, neighbours."""

from home_procgen.outside.surroundings import Outside, draw_outside

__all__ = ["Outside", "draw_outside"]
