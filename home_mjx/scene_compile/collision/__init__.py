"""Boxes that stop bodies, and which objects can be pushed."""
