"""Common interface of all house generators: by version, and by names of generated houses."""

from home_mjx.datasets.generators.generate import generate_dataset
from home_mjx.datasets.generators.names import ProceduralHouses

__all__ = ["ProceduralHouses", "generate_dataset"]
