"""Where agents can stand and walk: free space, regions, portals, stairs, distances."""
