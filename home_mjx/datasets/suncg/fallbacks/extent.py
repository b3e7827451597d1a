"""How large a model is whose mesh is lacking: by the tables, else by the box that the file gives around an object."""

import numpy as np
from jaxtyping import Float

from home_mjx.schema.house import ModelInfo

EVEN = 1e-3  # weight of "as long as wide": decides where an object at 45 degrees leaves both open
LEAST = 0.005  # [m], of an edge

Bounds = Float[np.ndarray, "2 3"]


def model_box(info: ModelInfo, transform: Float[np.ndarray, "4 4"], bbox: Bounds | None) -> Bounds | None:
    """The box of a model in its own frame [m, Y up]; None if nothing tells it.

    Args:
        info: Its row in the tables.
        transform: Scene from model, of one object that shows it.
        bbox: Around that object in the scene [m].
    """
    if info.low is not None and info.dims is not None:
        low = np.array(info.low)
        return np.stack([low, low + np.maximum(info.dims, LEAST)])
    return None if bbox is None else _turned_back(transform, bbox)


def _turned_back(transform: Float[np.ndarray, "4 4"], bbox: Bounds) -> Bounds:
    """The box whose image under the transform has the given box around it.

    Half edges h of the model give half edges |A| h around the object; where that hardly tells two of them apart, they
    are taken as equal.
    """
    linear = transform[:3, :3]
    size = np.linalg.norm(linear, axis=0)
    middle = np.linalg.solve(linear, bbox.mean(axis=0) - transform[:3, 3])
    even = EVEN * np.array([[size[0], 0.0, -size[2]]])
    rows, wanted = np.concatenate([abs(linear), even]), np.append(np.ptp(bbox, axis=0) / 2, 0.0)
    half = np.maximum(np.linalg.lstsq(rows, wanted, rcond=None)[0], LEAST / 2)
    return np.stack([middle - half, middle + half])
