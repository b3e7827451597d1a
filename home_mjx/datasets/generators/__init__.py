"""All generators of houses behind one door: by version, and by names of houses."""

from home_mjx.datasets.generators.generate import generate_dataset
from home_mjx.datasets.generators.names import ProceduralHouses

__all__ = ["ProceduralHouses", "generate_dataset"]
