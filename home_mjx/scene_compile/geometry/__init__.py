"""Meshes, boxes, polygons, bounding volume hierarchies."""
