"""Size of a model with a missing mesh, from the metadata tables or an object's bounding box in the file."""

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import ModelInfo

SQUARE_WEIGHT = 1e-3  # weight of "length = width", which decides for objects at 45 degrees, where both are undetermined
MIN_EDGE = 0.005  # [m], minimum length of an edge

Bounds = Float[np.ndarray, "2 3"]


def model_box(info: ModelInfo, transform: Float[np.ndarray, "4 4"], bbox: Bounds | None) -> Bounds | None:
    """Return the box of a model in its own frame [m, Y up]; None if it is unknown.

    Args:
        info: Row of the model in the metadata tables.
        transform: Scene from model, of an object with this model.
        bbox: Bounding box of that object in the scene [m].
    """
    if info.low is not None and info.dims is not None:
        low = np.array(info.low)
        return np.stack([low, low + np.maximum(info.dims, MIN_EDGE)])
    return None if bbox is None else _turned_back(transform, bbox)


def _turned_back(transform: Float[np.ndarray, "4 4"], bbox: Bounds) -> Bounds:
    """Return the box whose image under the transform has the bounding box `bbox`.

    Half edges h of the model yield half edges |A| h of the object. If that hardly distinguishes two edges, they are
    taken as equal.
    """
    linear = transform[:3, :3]
    size = np.linalg.norm(linear, axis=0)
    middle = np.linalg.solve(linear, bbox.mean(axis=0) - transform[:3, 3])
    even = SQUARE_WEIGHT * np.array([[size[0], 0.0, -size[2]]])
    rows, wanted = np.concatenate([abs(linear), even]), np.append(np.ptp(bbox, axis=0) / 2, 0.0)
    half = np.maximum(np.linalg.lstsq(rows, wanted, rcond=None)[0], MIN_EDGE / 2)
    return np.stack([middle - half, middle + half])
