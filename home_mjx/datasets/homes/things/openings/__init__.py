"""Doors, windows, fences, screens, fireplaces, radiators: what belongs to walls."""
