"""Rounded and padded solids."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Float, Int

from home_procgen.primitives.detail import is_sharp, limit_steps, simplify_grid
from home_procgen.primitives.grid import round_shape
from home_procgen.primitives.solids import Solid, Vector, box, lathe, make_solid, move
from home_procgen.shapes.sweep import triangulate

_MERGE = 7  # decimals of a metre to which corners must agree to be merged


def weld(material: str, vertices: Float[np.ndarray, "v 3"], faces: Int[np.ndarray, "f 3"]) -> Solid:
    """Return a solid with vertices merged that are equal to `_MERGE` decimals, and degenerate triangles removed."""
    unique, index = np.unique(np.round(round_shape(vertices), _MERGE) + 0.0, axis=0, return_inverse=True)
    faces = index.reshape(-1)[faces]
    kept = (faces != np.roll(faces, 1, 1)).all(1)
    return make_solid(material, unique, faces[kept])


def rounded_box(
    material: str, size: Vector, at: Vector = (0.0, 0.0, 0.0), radius: float = 0.02, steps: int = 2
) -> Solid:
    """Return a box with rounded edges and corners.

    Args:
        material: Slot name.
        size: Extents along x, y, z [m].
        at: Centre of the bottom face [m].
        radius: Radius of the edges, limited to half of the smallest extent [m].
        steps: Facets per quarter turn.
    """
    half = np.asarray(size, float) / 2
    r = min(radius, float(half.min()))
    if is_sharp(r):
        return box(material, size, at)
    steps = limit_steps(steps)
    quarter = np.linspace(0, np.pi / 2, steps + 1)
    latitude = np.concatenate([-quarter[::-1], quarter])
    longitude = (quarter + np.pi / 2 * np.arange(4)[:, None]).reshape(-1)
    lift = np.repeat([-1.0, 1.0], steps + 1)
    quadrant = np.repeat(np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]], float), steps + 1, 0)
    normal = np.stack(
        [
            np.cos(latitude)[:, None] * np.cos(longitude),
            np.repeat(np.sin(latitude)[:, None], len(longitude), 1),
            np.cos(latitude)[:, None] * np.sin(longitude),
        ],
        -1,
    )
    corner = np.stack(np.broadcast_arrays(quadrant[:, 0], lift[:, None], quadrant[:, 1]), -1)
    vertices = corner * (half - r) + r * normal
    return move(_grid_ball(material, vertices), np.array([0, half[1], 0]) + at)


def _grid_ball(material: str, rows: Float[np.ndarray, "r c 3"]) -> Solid:
    """Return the solid of rings of points around the vertical axis, from the bottom up, with both ends capped."""
    count, around = rows.shape[:2]
    i = np.arange(around)
    first = np.arange(count - 1)[:, None] * around
    a, b = first + i, first + (i + 1) % around
    quads = [np.stack([a, a + around, b], -1), np.stack([b, a + around, b + around], -1)]
    fan = np.stack([np.zeros(around - 2, int), i[1:-1], i[2:]], -1)
    caps = [fan, fan[:, ::-1] + (count - 1) * around]
    return weld(material, rows.reshape(-1, 3), np.concatenate([*(q.reshape(-1, 3) for q in quads), *caps]))


def padded_block(
    material: str, size: Vector, at: Vector = (0.0, 0.0, 0.0), power: float = 7.0, steps: int = 5
) -> Solid:
    """Return a padded block whose faces bulge slightly: a superellipsoid.

    Args:
        material: Slot name.
        size: Extents along x, y, z [m].
        at: Centre of the bottom [m].
        power: Exponent; higher values are closer to a box.
        steps: Facets along each edge.
    """
    steps = limit_steps(steps)
    line = np.sin(np.linspace(-np.pi / 2, np.pi / 2, steps + 1))
    u, v = np.meshgrid(line, line, indexing="ij")
    faces, points = [], []
    cells = np.arange((steps + 1) ** 2).reshape(steps + 1, steps + 1)
    a, b, c, d = cells[:-1, :-1], cells[1:, :-1], cells[1:, 1:], cells[:-1, 1:]
    quads = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    for axis in range(3):
        for sign in (-1.0, 1.0):
            side = np.roll(np.stack([np.full_like(u, sign), u, v], -1), axis, -1).reshape(-1, 3)
            faces.append((quads if sign > 0 else quads[:, ::-1]) + len(points) * len(side))
            points.append(side)
    cube = np.concatenate(points)
    ball = cube / (np.abs(cube) ** power).sum(1, keepdims=True) ** (1 / power)
    half = np.asarray(size, float) / 2
    return move(weld(material, ball * half, np.concatenate(faces)), np.array([0, half[1], 0]) + at)


def pillow(material: str, size: Vector, at: Vector = (0.0, 0.0, 0.0), steps: int = 8, sag: float = 0.0) -> Solid:
    """Return a stuffed case with thin seams and pointed corners, on its larger face.

    Args:
        material: Slot name.
        size: Extents along x, y (maximum thickness), z [m].
        at: Centre of the bottom [m].
        steps: Facets along each edge.
        sag: Relative depth of the dent in the middle, as by a head.
    """
    line = np.sin(np.linspace(-np.pi / 2, np.pi / 2, steps + 1))
    u, v = np.meshgrid(line, line, indexing="ij")
    bulge = ((1 - u**2) * (1 - v**2)) ** 0.42 * (1 - sag * np.exp(-4 * (u**2 + v**2)))
    x, z = u * (1 - 0.07 * (1 - v**2)), v * (1 - 0.07 * (1 - u**2))
    half = np.asarray(size, float) / 2
    under, upper = (np.stack([x, t * (0.05 + 0.95 * bulge), z], -1) * half for t in (-1.0, 1.0))
    return move(join_grids(material, under, upper), np.array([0, half[1], 0]) + at)


def join_grids(material: str, under: Float[np.ndarray, "n m 3"], upper: Float[np.ndarray, "n m 3"]) -> Solid:
    """Return the solid between two grids of corresponding points [m], closed around their rims."""
    under, upper = np.split(simplify_grid(np.concatenate([under, upper], -1)), 2, -1)
    n, m = under.shape[:2]
    cells = np.arange(n * m).reshape(n, m)
    a, b, c, d = cells[:-1, :-1], cells[1:, :-1], cells[1:, 1:], cells[:-1, 1:]
    front = np.concatenate([np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)])
    rim = np.concatenate([cells[:-1, 0], cells[-1, :-1], cells[:0:-1, -1], cells[0, :0:-1]])
    following = np.roll(rim, -1)
    edge = [np.stack([rim, rim + n * m, following], -1), np.stack([following, rim + n * m, following + n * m], -1)]
    faces = np.concatenate([front[:, ::-1], front + n * m, *(e[:, ::-1] for e in edge)])
    return make_solid(material, np.concatenate([under.reshape(-1, 3), upper.reshape(-1, 3)]), faces)


def ball(material: str, radius: float | Vector, at: Vector, sides: int = 12, rings: int = 6) -> Solid:
    """Return an ellipsoid around `at`; `radius` is one value or one per axis [m]."""
    x, y, z = radius if isinstance(radius, tuple) else (radius, radius, radius)
    angle = np.linspace(-np.pi / 2, np.pi / 2, rings + 1)
    profile = [(float(x * np.cos(a)) if 0 < i < rings else 0.0, float(y * np.sin(a))) for i, a in enumerate(angle)]
    return lathe(material, profile, at, sides, stretch=z / x)


def join_loops(material: str, loops: Sequence[Float[np.ndarray, "n 3"]], closed: bool = False) -> Solid:
    """Return a solid whose surface joins successive loops of points.

    The first and last loops are joined if `closed`, else capped; their outlines in (x, z) must be simple polygons.
    """
    grid = simplify_grid(np.stack(loops))
    count, around = grid.shape[:2]
    i = np.arange(around)
    first = np.arange(count if closed else count - 1)[:, None] * around
    a, b = first + i, first + (i + 1) % around
    c, d = (b + around) % (count * around), (a + around) % (count * around)
    sides = [np.stack([a, b, c], -1).reshape(-1, 3), np.stack([a, c, d], -1).reshape(-1, 3)]
    if not closed:
        cap = triangulate(grid[0][:, [0, 2]]), triangulate(grid[-1][:, [0, 2]])
        flat = grid[0][:, [0, 2]]
        turn = (flat[:, 0] * np.roll(flat[:, 1], -1) - np.roll(flat[:, 0], -1) * flat[:, 1]).sum() > 0
        sides += [cap[0][:, ::-1] if turn else cap[0], (cap[1] if turn else cap[1][:, ::-1]) + (count - 1) * around]
        if not turn:
            sides[0], sides[1] = sides[0][:, ::-1], sides[1][:, ::-1]
            sides[2], sides[3] = sides[2][:, ::-1], sides[3][:, ::-1]
    return make_solid(material, grid.reshape(-1, 3), np.concatenate(sides))
