"""Option values shared by several packages, importable by the command line without JAX."""

CAMERA_MODELS = ("pinhole", "panorama", "cube", "orthographic", "lidar")
PRESETS = ("fast", "lit")  # shading presets of colour images
COLLISIONS = ("box", "exact")  # collision geometry of objects in an exported house
