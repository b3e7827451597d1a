"""Size classes of objects relative to their category, from the models in the dataset's tables."""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Metadata, ModelInfo

SIZES = ("tiny", "small", "normal", "large", "huge")
SIZE_LIMITS = (-2.0, -1.0, 1.0, 2.0)  # [standard deviations], limits between size classes, as in HoME
NORMAL = SIZES.index("normal")
MIN_PEERS = 5  # minimum number of models of a category for a comparison
MIN_SPREAD = 0.1  # minimum standard deviation of log volume; differences below 10 % are ignored
HOME_FRONT = (0.0, 0.0, 1.0)


@dataclass(frozen=True)
class SizeTable:
    """Volumes [m^3] of the boxes of all models of a dataset, by category."""

    fine: dict[str, Float[np.ndarray, " _"]]
    coarse: dict[str, Float[np.ndarray, " _"]]
    home: dict[str, Float[np.ndarray, " _"]]  # by coarse category, only models that face +z

    def log_volume_size(self, volume: float, info: ModelInfo) -> str:
        """Return one of `SIZES` by the logarithm of volume, since volumes differ by factors; "" with too few peers.

        Args:
            volume: Volume of the object as placed [m^3].
            info: Its categories.
        """
        for peers in (self.fine.get(info.fine), self.coarse.get(info.coarse)):
            if peers is not None and len(peers) >= MIN_PEERS and info.coarse != "unknown":
                logs = np.log(peers)
                return _size((np.log(volume) - logs.mean()) / max(float(logs.std()), MIN_SPREAD))
        return ""

    def home_size(self, info: ModelInfo) -> str:
        """Return the size class by HoME's rule, which is never `tiny`; "" for models that it could not compare.

        Args:
            info: The model's row.
        """
        peers = self.home.get(info.coarse)
        if peers is None or info.dims is None or info.front != HOME_FRONT:
            return ""
        above = math.prod(info.dims) - float(peers.mean())
        spread = float(peers.std())
        if above < SIZE_LIMITS[1] * spread:
            return "small"
        return SIZES[NORMAL + (above > SIZE_LIMITS[2] * spread) + (above > SIZE_LIMITS[3] * spread)]


def size_table(metadata: Metadata) -> SizeTable:
    """Collect the volumes of all models.

    Args:
        metadata: The dataset's tables; models without a box, or with a flat one, are ignored.
    """
    sized = [(info, math.prod(info.dims)) for info in metadata.models.values() if info.dims is not None]
    solid = [(info, volume) for info, volume in sized if volume > 0]
    return SizeTable(
        fine=_grouped([(info.fine, volume) for info, volume in solid]),
        coarse=_grouped([(info.coarse, volume) for info, volume in solid]),
        home=_grouped([(info.coarse, volume) for info, volume in sized if info.front == HOME_FRONT]),
    )


def _grouped(items: Sequence[tuple[str, float]]) -> dict[str, Float[np.ndarray, " _"]]:
    groups: dict[str, list[float]] = defaultdict(list)
    for category, volume in items:
        groups[category].append(volume)
    return {category: np.array(volumes) for category, volumes in groups.items()}


def _size(deviation: float) -> str:
    return SIZES[int(np.searchsorted(SIZE_LIMITS, deviation))]
