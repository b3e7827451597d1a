"""Sound propagation: direct and diffracted paths, image sources, ray tracing."""
