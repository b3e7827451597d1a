"""Decoder of glTF files: container, accessors, images, materials, meshes and the scene graph."""
