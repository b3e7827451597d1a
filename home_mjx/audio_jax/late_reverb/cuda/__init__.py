"""Baking of late sound on NVIDIA GPUs."""
