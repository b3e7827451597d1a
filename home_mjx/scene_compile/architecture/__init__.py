"""Rooms, walls, floors and ceilings of a house, and reflection planes for room acoustics."""
