"""Meshes that replace missing models: those of an installed provider, else plain boxes.

A provider is an entry point of the group `home_mjx.fallback_models`: a function with the arguments of `fallback_model`,
and an attribute `version`, which is part of the cache key of houses that may use it.
"""

from functools import cache
from importlib.metadata import entry_points
from pathlib import Path
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float

from home_mjx.datasets.suncg.fallbacks.rooms import slab_mesh
from home_mjx.errors import ConfigError
from home_mjx.schema.house import Material, Mesh, ModelInfo

GROUP = "home_mjx.fallback_models"
Bounds = Float[np.ndarray, "2 3"]
UNKNOWN_BOX = np.array([[-0.25, 0.0, -0.25], [0.25, 0.5, 0.25]])  # [m], of a model without any metadata
GREY = Material("material_0", (0.7, 0.7, 0.7), None, 1.0)
SQUARE_WEIGHT = 1e-3  # weight of "length = width", which decides for objects at 45 degrees, where both are undetermined
MIN_EDGE = 0.005  # [m], minimum length of an edge


@runtime_checkable
class FallbackModels(Protocol):
    """A provider of meshes for missing models."""

    version: str  # changes whenever the same arguments would return another mesh

    def __call__(self, path: Path, fine: str, bounds: Bounds | None, closed: bool) -> tuple[Mesh, str]:
        """Return a mesh and its description; see `fallback_model`."""
        ...


class BoxModels:
    """Plain boxes, where no provider is installed."""

    version = "boxes-1"

    def __call__(self, path: Path, fine: str, bounds: Bounds | None, closed: bool) -> tuple[Mesh, str]:
        """Return a box with the bounds of the missing model, `UNKNOWN_BOX` if they are None, and its description."""
        (x0, y0, z0), (x1, y1, z1) = (UNKNOWN_BOX if bounds is None else bounds).tolist()
        corners = np.array([[x0, z0], [x1, z0], [x1, z1], [x0, z1]])
        mesh = slab_mesh("box", corners, (y0, y1), path, (), GREY, outset=0.0)
        return mesh, f"a box of {x1 - x0:.2f} x {y1 - y0:.2f} x {z1 - z0:.2f} m"


@cache
def _provider() -> FallbackModels:
    """Return the first installed provider; `BoxModels` if there is none.

    Raises:
        ConfigError: The provider cannot be imported.
    """
    for point in entry_points(group=GROUP):
        try:
            return point.load()
        except (ImportError, AttributeError) as error:
            raise ConfigError(f"fallback models of `{point.value}` cannot be loaded: {error}") from error
    return BoxModels()


def fallback_version() -> str:
    """Return the `version` of the installed provider or of `BoxModels`; part of cache keys."""
    return _provider().version


def fallback_model(path: Path, fine: str, bounds: Bounds | None, closed: bool) -> tuple[Mesh, str]:
    """Return the installed provider's mesh for a missing model, or a box of `BoxModels`, and its description.

    Args:
        path: Path of the missing OBJ file.
        fine: Fine category of the model.
        bounds: Its bounding box, of a door that of its open state [m, Y up]; None if unknown.
        closed: Whether the mesh shows a door closed.

    Example:
        >>> bounds = np.array([[-0.3, 0, -0.3], [0.3, 1, 0.3]])
        >>> mesh, words = BoxModels()(Path("9.obj"), "chair", bounds, False)
        >>> words, np.ptp(mesh.vertices, axis=0).round(6).tolist()
        ('a box of 0.60 x 1.00 x 0.60 m', [0.6, 1.0, 0.6])
    """
    return _provider()(path, fine, bounds, closed)


def model_box(info: ModelInfo, transform: Float[np.ndarray, "4 4"], bbox: Bounds | None) -> Bounds | None:
    """Return the box of a model in its own frame [m, Y up], from its row or else `bbox`; None if neither has it.

    Its edges have at least `MIN_EDGE`.

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
    """Return the box in the model's frame whose image under the transform has, about, the bounding box `bbox`.

    Half edges h of the model yield half edges |A| h of the object. If that hardly distinguishes two edges, they are
    taken as equal. Edges have at least `MIN_EDGE`.
    """
    linear = transform[:3, :3]
    size = np.linalg.norm(linear, axis=0)
    middle = np.linalg.solve(linear, bbox.mean(axis=0) - transform[:3, 3])
    even = SQUARE_WEIGHT * np.array([[size[0], 0.0, -size[2]]])
    rows, wanted = np.concatenate([abs(linear), even]), np.append(np.ptp(bbox, axis=0) / 2, 0.0)
    half = np.maximum(np.linalg.lstsq(rows, wanted, rcond=None)[0], MIN_EDGE / 2)
    return np.stack([middle - half, middle + half])
