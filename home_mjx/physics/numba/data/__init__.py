"""Sizes, parameters and memory of the fused step."""
