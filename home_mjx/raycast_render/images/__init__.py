"""Images of a scene from a camera."""
