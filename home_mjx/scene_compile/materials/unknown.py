"""How much of a house is of materials that nothing tells: neither the name of a texture nor the category."""

import numpy as np

from home_mjx.schema.compiled import CompiledHouse

TOLERABLE = 0.2  # share of the area


def unknown_share(house: CompiledHouse) -> float:
    """Share of the area of all surfaces whose material is the default of its category, or of everything.

    Args:
        house: As compiled, movable things where they are placed.

    Example:
        >>> unknown_share(house) > TOLERABLE  # doctest: +SKIP
        False
    """
    known = np.array([bool(kind) for kind in house.materials.kind])
    whole, unknown = 0.0, 0.0
    for key, pose, first in zip(house.instances.model, house.instances.pose, house.instances.material, strict=True):
        model = house.models[key]
        corner = model.triangle @ pose[:, :3].T
        area = np.linalg.norm(np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]), axis=1) / 2
        whole += float(area.sum())
        unknown += float(area[~known[first + model.slot]].sum())
    return unknown / whole if whole else 0.0
