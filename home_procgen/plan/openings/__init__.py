"""Doors and windows of storeys."""
