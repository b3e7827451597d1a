"""Level surfaces of models that support objects, and the bases of objects on them."""

from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float

from home_procgen.floor_plan.placed_model import PlacedModel
from home_procgen.model_store import library_model

MIN_TOP_HEIGHT, MIN_TOP_AREA = 0.15, 0.015  # minimum height [m] and minimum area [m^2] of a surface
BASE_HEIGHT = 0.006  # [m], height above an object's lowest point below which its vertices form its base
EDGE_TOLERANCE = 1e-6
MAX_OVERHANG = 0.05  # [m], of an object beyond the edge of the surface; boxes that overhang more creep in MuJoCo
# [m], maximum height range of a level triangle, and height of the test for space above
LEVEL_TOLERANCE, FREE_TEST_HEIGHT = 1e-6, 0.004


class SupportSurface(NamedTuple):
    """A level surface of a model."""

    height: float  # [m] above the model's origin
    triangles: Float[np.ndarray, "t 3 2"]  # (x, z) [m]
    area: float  # [m^2]
    low: Float[np.ndarray, " 2"]  # minimum (x, z) [m]
    high: Float[np.ndarray, " 2"]  # maximum (x, z) [m]
    starts: Float[np.ndarray, "2 3 t 1"]  # x and z of the triangles' corners [m]
    edges: Float[np.ndarray, "2 3 t 1"]  # from each corner to the next [m]


@cache
def find_support_surfaces(model_id: str) -> tuple[SupportSurface, ...]:
    """Return the upward level surfaces of a model with free space above, in descending order of area."""
    model = library_model(model_id)
    corners = model.mesh.vertices[model.mesh.faces]
    corners = corners[(np.ptp(corners[..., 1], axis=1) < LEVEL_TOLERANCE) & (corners[:, 0, 1] > MIN_TOP_HEIGHT)]
    a, b, c = np.moveaxis(corners[..., [0, 2]], 1, 0)
    twice = (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0]) - (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1])
    kept = (twice > 0) & ~_covered_mask(corners.mean(axis=1), model.parts)
    heights, flat, areas = np.round(corners[kept][:, 0, 1], 4), corners[kept][..., [0, 2]], twice[kept] / 2
    found = [_top(float(h), flat[heights == h], areas[heights == h]) for h in np.unique(heights)]
    return tuple(sorted((top for top in found if top.area > MIN_TOP_AREA), key=lambda top: -top.area))


def _top(height: float, triangles: Float[np.ndarray, "t 3 2"], areas: Float[np.ndarray, " t"]) -> SupportSurface:
    points = triangles.reshape(-1, 2)
    starts = np.ascontiguousarray(triangles.transpose(2, 1, 0))[..., None]
    ways = starts[:, [1, 2, 0]] - starts
    return SupportSurface(height, triangles, float(areas.sum()), points.min(axis=0), points.max(axis=0), starts, ways)


def _covered_mask(points: Float[np.ndarray, "p 3"], parts: Float[np.ndarray, "q 2 3"]) -> Bool[np.ndarray, " p"]:
    """Return a mask of the points with a part right above them."""
    above = points[:, None] + (0.0, FREE_TEST_HEIGHT, 0.0)
    inside = np.asarray(((above > parts[:, 0]) & (above < parts[:, 1])).all(axis=-1))
    return np.asarray(inside.any(axis=-1))


@cache
def base_points(model_id: str) -> Float[np.ndarray, "9 3"]:
    """Return the corners, side middles and centre, at height 0, of the rectangle around a model's base [m]."""
    vertices = library_model(model_id).mesh.vertices
    return _rectangle_points(vertices[vertices[:, 1] < vertices[:, 1].min() + BASE_HEIGHT])


@cache
def _outline_points(model_id: str) -> Float[np.ndarray, "9 3"]:
    """Return the same points of the rectangle around the whole model [m]."""
    return _rectangle_points(library_model(model_id).mesh.vertices)


def _rectangle_points(vertices: Float[np.ndarray, "v 3"]) -> Float[np.ndarray, "9 3"]:
    (x0, _, z0), (x1, _, z1) = vertices.min(axis=0).tolist(), vertices.max(axis=0).tolist()
    return np.array([[x, 0.0, z] for x in (x0, (x0 + x1) / 2, x1) for z in (z0, (z0 + z1) / 2, z1)])


def can_support(anchor: PlacedModel, top: SupportSurface, item: PlacedModel) -> bool:
    """Return whether the whole base of an object is above a surface, and overhangs are at most `MAX_OVERHANG`."""
    # The transpose of a rotation times a scale, over its squared column lengths, is its inverse.
    inverse = anchor.linear / (anchor.linear**2).sum(axis=0)
    shift = np.subtract(item.position, anchor.position)
    base, outline = (
        (points(item.model.id) @ item.linear.T + shift) @ inverse for points in (base_points, _outline_points)
    )
    margin = MAX_OVERHANG / np.array([anchor.scale[0], anchor.scale[2]])
    if (outline[:, [0, 2]] < top.low - margin).any() or (outline[:, [0, 2]] > top.high + margin).any():
        return False
    return bool(_inside_mask(base[:, 0], base[:, 2], top).any(axis=0).all())


def _inside_mask(
    x: Float[np.ndarray, " p"], z: Float[np.ndarray, " p"], top: SupportSurface
) -> Bool[np.ndarray, "t p"]:
    """Return a mask (triangle, point) of the points in each triangle of a surface, edges included."""
    inner = top.edges[1] * (x - top.starts[0]) - top.edges[0] * (z - top.starts[1]) >= -EDGE_TOLERANCE
    return inner[0] & inner[1] & inner[2]
