"""Rooms, walls and openings of a procedural house."""
