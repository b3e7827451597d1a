"""Seeded procedural houses in SUNCG's on-disk format: floor plans, parametric furniture, textures."""

from home_mjx.datasets.procedural.build import build_house
from home_mjx.datasets.procedural.dataset import VERSION, generate_dataset

__all__ = ["VERSION", "build_house", "generate_dataset"]
