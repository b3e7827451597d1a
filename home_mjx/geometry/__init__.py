"""Host geometry on NumPy arrays: boxes, meshes, polygons, solids from outlines, trees, distance fields on grids."""
