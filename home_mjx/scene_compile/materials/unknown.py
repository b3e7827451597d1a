"""Share of a house's surfaces whose material neither a texture name nor the category determines."""

import numpy as np

from home_mjx.schema.compiled import CompiledHouse

MAX_UNKNOWN_SHARE = 0.2  # maximum share of the area


def unknown_material_share(house: CompiledHouse) -> float:
    """Return the share (0 to 1) of a house's surface area without a known kind of material; 0 without any area.

    Example:
        >>> unknown_material_share(house) > MAX_UNKNOWN_SHARE  # doctest: +SKIP
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
