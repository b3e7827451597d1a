"""Viewer in a web browser: 3D scene, our own images, sound and controls of a running environment (extra `view`)."""
