"""Measures of rooms by ISO 3382-1, as functions inside `jit`."""
