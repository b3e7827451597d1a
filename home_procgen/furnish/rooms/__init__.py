"""Recipes: the objects of each room type in order of placement."""
