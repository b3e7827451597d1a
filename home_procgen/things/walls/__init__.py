"""Heaters, fences, fans and other fixed equipment."""
