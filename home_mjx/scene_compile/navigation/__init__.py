"""Navigation meshes as grids: free space, regions, portals, stairs and geodesic distances."""
