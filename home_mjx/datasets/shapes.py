"""Triangles of round shapes about z, counter-clockwise outwards; circles become polygons of the same mean radius."""

import numpy as np
from jaxtyping import Float

MAX_SAGITTA = 1e-4  # [m], maximum distance of a circle from the sides of its polygon
MIN_SIDES, MAX_SIDES = 12, 128  # number of sides of the polygon of a circle
Triangles = Float[np.ndarray, "t 3 3"]


def cylinder_triangles(radius: float, half: float) -> Triangles:
    """Return a cylinder of a radius and half its length along z [m]."""
    return _lathe(np.array([[0, -half], [radius, -half], [radius, half], [0, half]]))


def capsule_triangles(radius: float, half: float) -> Triangles:
    """Return a capsule of a radius and half the length of its straight part along z [m]."""
    arc = _arc(radius)
    return _lathe(arc + np.repeat([[0, -half], [0, half]], len(arc) // 2, axis=0))


def cone_triangles(radius: float, half: float) -> Triangles:
    """Return a cone of a base radius and half its height along z, with its tip above [m]."""
    return _lathe(np.array([[0, -half], [radius, -half], [0, half]]))


def sphere_triangles(radius: float) -> Triangles:
    """Return a sphere of a radius [m]."""
    return _lathe(_arc(radius))


def _sides(radius: float) -> int:
    """Return the even number of sides of the polygon of a circle."""
    angle = np.arccos(np.clip(1 - MAX_SAGITTA / max(radius, 1e-9), -1, 1))
    return 2 * int(np.clip(np.ceil(np.pi / max(angle, 1e-3)), MIN_SIDES, MAX_SIDES) / 2 + 0.5)


def _arc(radius: float) -> Float[np.ndarray, "n 2"]:
    """Return (radius, height) of an even number of points on a half circle, from below; the equator is twice there."""
    count = _sides(radius) // 4 + 1
    angle = np.linspace(-np.pi / 2, 0, count)
    angle = np.concatenate([angle, -angle[::-1]])
    return radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)


def _lathe(profile: Float[np.ndarray, "n 2"]) -> Triangles:
    """Return the surface of revolution about z of a profile of (radius, height), from below, without flat bands."""
    sides = _sides(float(profile[:, 0].max()))
    turn = 2 * np.pi * np.arange(sides + 1) / sides
    mean = 2 / (1 + np.cos(np.pi / sides))  # so that the polygon is as much outside of the circle as inside
    x, y = (mean * profile[:, :1] * f(turn) for f in (np.cos, np.sin))
    points = np.stack([x, y, np.broadcast_to(profile[:, 1:], x.shape)], axis=-1)
    found = grid_triangles(points)
    return found[np.linalg.norm(np.cross(found[:, 1] - found[:, 0], found[:, 2] - found[:, 0]), axis=1) > 1e-14]


def grid_triangles(points: Float[np.ndarray, "r c 3"]) -> Triangles:
    """Return the two triangles of each cell of a grid of points, divided from its first to its last corner."""
    a, b, c, d = points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]
    return np.concatenate([np.stack(t, axis=2).reshape(-1, 3, 3) for t in ((a, b, c), (a, c, d))])
