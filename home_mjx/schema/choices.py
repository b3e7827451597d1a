"""Option values shared by several packages, importable by the command line without JAX."""

CAMERA_MODELS = ("pinhole", "panorama", "cube", "orthographic", "lidar")
COLLISIONS = ("box", "exact")  # collision geometry of objects in an exported house
