"""Domain-independent helpers: option checks, pytrees, transforms, colour, files, images, paths and worker processes."""
