"""Beds, made and unmade."""
