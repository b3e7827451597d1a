"""Furniture for houses that other programs planned: own models by category and size, doors, worktops, surfaces."""
