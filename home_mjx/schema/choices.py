"""Names of what can be chosen in several packages: one list each, so that the command line need load no JAX for it."""

CAMERA_MODELS = ("pinhole", "panorama", "cube", "orthographic", "lidar")
PRESETS = ("fast", "lit")  # of how colours are lit
COLLISIONS = ("box", "exact")  # what objects of an exported house collide by
