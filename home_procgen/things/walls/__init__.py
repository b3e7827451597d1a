"""Heaters, fences, fans and other things of walls."""
