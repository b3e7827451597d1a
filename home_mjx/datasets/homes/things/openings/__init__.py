"""Doors, windows, arches."""
