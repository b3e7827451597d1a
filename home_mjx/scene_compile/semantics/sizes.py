"""Size classes of objects relative to their category, from the models in the dataset's tables."""

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import Metadata, ModelInfo
from home_mjx.schema.semantic import SIZES

SIZE_LIMITS = (-2.0, -1.0, 1.0, 2.0)  # [standard deviations], limits between size classes, as in HoME
NORMAL = SIZES.index("normal")
MIN_PEERS = 5  # minimum number of models of a category for a comparison
MIN_SPREAD = 0.1  # minimum standard deviation of log volume; differences below 10 % are ignored


@dataclass(frozen=True)
class SizeTable:
    """Volumes [m^3] of the boxes of all models of a dataset, by category."""

    fine: dict[str, Float[np.ndarray, " _"]]
    coarse: dict[str, Float[np.ndarray, " _"]]

    def log_volume_size(self, volume: float, info: ModelInfo) -> str:
        """Return one of `SIZES` by log volume relative to peers; "" with too few peers or coarse category `unknown`.

        Peers are the models of the fine category or, if those are too few, of the coarse one.

        Args:
            volume: Volume of the object as placed [m^3].
            info: Its categories.
        """
        for peers in (self.fine.get(info.fine), self.coarse.get(info.coarse)):
            if peers is not None and len(peers) >= MIN_PEERS and info.coarse != "unknown":
                logs = np.log(peers)
                return _size((np.log(volume) - logs.mean()) / max(float(logs.std()), MIN_SPREAD))
        return ""


def size_table(metadata: Metadata) -> SizeTable:
    """Collect the box volumes of all models of a dataset by fine and by coarse category.

    Args:
        metadata: The dataset's tables; models without a box, or with a flat one, are ignored.
    """
    sized = [(info, math.prod(info.dims)) for info in metadata.models.values() if info.dims is not None]
    solid = [(info, volume) for info, volume in sized if volume > 0]
    return SizeTable(
        fine=_grouped([(info.fine, volume) for info, volume in solid]),
        coarse=_grouped([(info.coarse, volume) for info, volume in solid]),
    )


def _grouped(items: Sequence[tuple[str, float]]) -> dict[str, Float[np.ndarray, " _"]]:
    """Return the volumes by category."""
    groups: dict[str, list[float]] = defaultdict(list)
    for category, volume in items:
        groups[category].append(volume)
    return {category: np.array(volumes) for category, volumes in groups.items()}


def _size(deviation: float) -> str:
    """Return the size class of a deviation from the mean in standard deviations; a limit is in the smaller class."""
    return SIZES[int(np.searchsorted(SIZE_LIMITS, deviation))]
