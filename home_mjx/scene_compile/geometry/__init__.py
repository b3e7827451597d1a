"""Meshes, boxes, polygons and bounding volume hierarchies."""
