"""Lamps and their bulbs."""
