"""Charts: regular grids of texels on plane faces of what stands still, for light that varies along surfaces."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.ndimage import correlate1d
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import KDTree

from home_mjx.light_probes.lattice import ProbeLattice, is_facade
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic

EDGE_GAP = 0.02  # [m], distance of the outermost texels from the bounds of a face
PLANE_UNIT, NORMAL_UNIT = 1e-3, 1e-3  # to which planes are rounded before faces are compared [m], and their normals
MIN_AREA = 1e-8  # [m^2], of a triangle that gets texels
MIN_FACE, MAX_TRIANGLES = 0.04, 2000  # [m^2], of faces of objects with texels; triangles of such objects
NUM_DONORS = 2  # valid texels from which an invalid one gets its light
SMOOTHING = 0.25, 0.5, 0.25  # weights of neighbouring texels
AHEAD = 0.05  # [m], distance in front of a face at which its room's probes must be


@dataclass(frozen=True)
class Charts:
    """Charts of a house. Texels of a chart follow each other, the second axis fastest.

    Attributes:
        start: Row in `of_triangle` of the first triangle of each instance; -1: it has no charts.
        of_triangle: Chart of each triangle of these instances; -1 none.
        frame: Position of the first texel [m], and vectors whose products with an offset from it count texels [1/m].
        count: Numbers of texels along both axes.
        first: First texel of each chart.
        pos: Positions of texels [m].
        normal: Their unit normals.
        room: Their rooms.
        instance: Their instances.
        chart: Their charts.
        inside: Whether they are on a triangle of their chart.
    """

    start: Int[np.ndarray, " i"]
    of_triangle: Int[np.ndarray, " t"]
    frame: Float[np.ndarray, "c 3 3"]
    count: Int[np.ndarray, "c 2"]
    first: Int[np.ndarray, " c"]
    pos: Float[np.ndarray, "x 3"]
    normal: Float[np.ndarray, "x 3"]
    room: Int[np.ndarray, " x"]
    instance: Int[np.ndarray, " x"]
    chart: Int[np.ndarray, " x"]
    inside: Bool[np.ndarray, " x"]


class Faces(NamedTuple):
    """Triangles of instances that may have charts."""

    triangle: Float[np.ndarray, "t 3 3"]
    normal: Float[np.ndarray, "t 3"]
    area: Float[np.ndarray, " t"]
    room: Int[np.ndarray, " t"]
    instance: Int[np.ndarray, " t"]

    def take(self, rows: Int[np.ndarray, " n"]) -> "Faces":
        """Return the triangles `rows`."""
        return Faces(*(x[rows] for x in self))


def place_charts(house: CompiledHouse, lattice: ProbeLattice, density: float) -> Charts:
    """Place about `density` texels per metre on the faces of rooms; with a density of 0 there are none."""
    own = _instances(house) if density > 0 and len(lattice.first) else []
    faces = _faces(house, own)
    sizes = np.array([len(house.models[house.instances.model[i]].triangle) for i in own], np.int64)
    start = np.full(len(house.instances.model), -1, np.int32)
    start[own] = np.cumsum(sizes) - sizes
    used = (faces.room >= 0) & (faces.area > MIN_AREA)
    middle = faces.triangle.mean(axis=1)
    used &= ~is_facade(lattice, middle, faces.normal, faces.room)
    used &= _is_before_room(lattice, middle + AHEAD * faces.normal, faces.room)
    rows = np.flatnonzero(used)
    group = _connect(faces.take(rows))
    total = np.bincount(group, faces.area[rows])[group]
    large = (faces.instance[rows] == ARCHITECTURE) | (total >= MIN_FACE)
    rows, group = rows[large], np.unique(group[large], return_inverse=True)[1]
    of_triangle = np.full(len(faces.area), -1, np.int32)
    of_triangle[rows] = group
    order = np.argsort(group, kind="stable")
    parts = np.split(rows[order], np.flatnonzero(np.diff(group[order])) + 1) if len(rows) else []
    return _join(
        start,
        of_triangle,
        faces.take(np.array([part[0] for part in parts], np.int64)),
        [_place(faces.triangle[part], faces.normal[part[0]], density) for part in parts],
    )


def _instances(house: CompiledHouse) -> list[int]:
    """Return the architecture and the static instances with few triangles."""
    still = house.instances.body < 0
    still[house.doors.instance] = False
    still[house.lights.instance[house.lights.instance > ARCHITECTURE]] = False
    few = [len(house.models[key].triangle) <= MAX_TRIANGLES for key in house.instances.model]
    return [ARCHITECTURE, *np.flatnonzero(still & few & (np.arange(len(few)) > ARCHITECTURE)).tolist()]


def _faces(house: CompiledHouse, own: list[int]) -> Faces:
    """Return the triangles of the instances `own`, in the world."""
    instances, columns = house.instances, []
    for i in own:
        model, pose = house.models[instances.model[i]], instances.pose[i]
        corners = model.triangle @ pose[:, :3].T + pose[:, 3]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        normal *= np.sign(np.linalg.det(pose[:, :3]))  # fronts are fronts in the model's frame
        length = np.linalg.norm(normal, axis=1)
        room = house.semantics[:, Semantic.ROOM][instances.semantic[i] + model.part]
        columns.append(
            (corners, normal / np.maximum(length, 1e-20)[:, None], length / 2, room, np.full(len(length), i))
        )
    if not columns:
        return Faces(np.zeros((0, 3, 3)), np.zeros((0, 3)), np.zeros(0), np.zeros(0, int), np.zeros(0, int))
    return Faces(*map(np.concatenate, zip(*columns, strict=True)))


def _join(start: np.ndarray, of_triangle: np.ndarray, first: Faces, placed: list[tuple[np.ndarray, ...]]) -> Charts:
    """Return the charts that are placed; `first` has one triangle of each."""
    sizes = np.array([np.prod(one[1]) for one in placed], np.int64)
    chart = np.repeat(np.arange(len(placed)), sizes)
    return Charts(
        start,
        of_triangle,
        np.array([one[0] for one in placed]).reshape(-1, 3, 3),
        np.array([one[1] for one in placed], np.int32).reshape(-1, 2),
        np.cumsum(sizes) - sizes,
        np.concatenate([np.zeros((0, 3)), *(one[2] for one in placed)]),
        first.normal[chart],
        first.room[chart],
        first.instance[chart],
        chart,
        np.concatenate([np.zeros(0, bool), *(one[3] for one in placed)]),
    )


def _is_before_room(lattice: ProbeLattice, pos: Float[np.ndarray, "n 3"], room: Int[np.ndarray, " n"]) -> np.ndarray:
    """Return whether points are within the bounds of their room's probes, widened by `AHEAD`."""
    row = np.maximum(room, 0)
    high = lattice.origin[row] + lattice.step[row] * (lattice.count[row] - 1)
    inside = np.all((pos > lattice.origin[row] - 2 * AHEAD) & (pos < high + 2 * AHEAD), axis=1)
    return inside & (lattice.first[row] >= 0)


def _connect(faces: Faces) -> Int[np.ndarray, " n"]:
    """Return numbers of groups of triangles of one instance, plane and room that share corners."""
    number = len(faces.area)
    if number == 0:
        return np.zeros(0, np.int64)
    plane = np.round(np.einsum("ij,ij->i", faces.triangle[:, 0], faces.normal) / PLANE_UNIT)
    key = np.column_stack([np.round(faces.normal / NORMAL_UNIT), plane, faces.room, faces.instance])
    key = np.unique(key.astype(np.int64), axis=0, return_inverse=True)[1].ravel()
    corner = np.round(faces.triangle.reshape(-1, 3) / PLANE_UNIT).astype(np.int64)
    corner = np.column_stack([np.repeat(key, 3), corner])
    owner = np.repeat(np.arange(number), 3)
    shared = np.unique(corner, axis=0, return_inverse=True)[1].ravel()
    graph = coo_matrix((np.ones(len(owner)), (owner, number + shared)), shape=(4 * number, 4 * number))
    return connected_components(graph, directed=False)[1][:number]


def _place(
    triangles: Float[np.ndarray, "n 3 3"], normal: Float[np.ndarray, "3"], density: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Return frame and counts of the chart of coplanar triangles, positions of texels, and which are on triangles."""
    level = np.cross([0.0, 0.0, 1.0] if abs(normal[2]) < 0.99 else [0.0, 1.0, 0.0], normal)
    axes = np.stack([level / np.linalg.norm(level), np.cross(normal, level / np.linalg.norm(level))])
    plan = triangles @ axes.T
    low, high = plan.min(axis=(0, 1)), plan.max(axis=(0, 1))
    gap = np.minimum(EDGE_GAP, (high - low) / 4)
    low, high = low + gap, high - gap
    count = np.maximum(np.round((high - low) * density).astype(int) + 1, 2)
    step = (high - low) / (count - 1)
    grid = np.stack(np.meshgrid(*(np.arange(n) for n in count), indexing="ij"), -1).reshape(-1, 2)
    place = low + grid * step
    pos = place @ axes + normal * (triangles[0, 0] @ normal)
    origin = low @ axes + normal * (triangles[0, 0] @ normal)
    return np.stack([origin, *(axes / step[:, None])]), count, pos, _is_on(plan, place)


def _is_on(triangles: Float[np.ndarray, "n 3 2"], pos: Float[np.ndarray, "m 2"]) -> Bool[np.ndarray, " m"]:
    """Return whether points of a plane are on any of the triangles."""
    found = np.zeros(len(pos), bool)
    for a, b, c in triangles:
        sides = [
            (q[0] - p[0]) * (pos[:, 1] - p[1]) - (q[1] - p[1]) * (pos[:, 0] - p[0]) for p, q in ((a, b), (b, c), (c, a))
        ]
        found |= np.all(np.stack(sides) >= -1e-9, axis=0) | np.all(np.stack(sides) <= 1e-9, axis=0)
    return found


def drop_unused(charts: Charts, of_triangle: Int[np.ndarray, " t"]) -> tuple[np.ndarray, np.ndarray]:
    """Return `start` and `of_triangle` without the triangles of instances that have no chart of those given."""
    start, own = charts.start.copy(), np.flatnonzero(charts.start >= 0)
    parts = np.split(of_triangle, charts.start[own][1:]) if len(own) else []
    kept = [part.max(initial=-1) >= 0 for part in parts]
    start[own] = -1
    sizes = np.array([len(part) for part, keep in zip(parts, kept, strict=True) if keep], np.int64)
    start[own[kept]] = np.cumsum(sizes) - sizes
    used = [part for part, keep in zip(parts, kept, strict=True) if keep]
    return start, np.concatenate([of_triangle[:0], *used])


def fill_invalid(charts: Charts, light: Float[np.ndarray, "x texel_groups 3"], valid: Bool[np.ndarray, " x"]) -> None:
    """Write the mean of the nearest valid texels of the chart into its invalid ones; 0 where a chart has none."""
    missing = np.flatnonzero(~valid)
    light[missing] = 0
    for chart in np.unique(charts.chart[missing]):
        rows = slice(charts.first[chart], charts.first[chart] + np.prod(charts.count[chart]))
        good, bad = (np.flatnonzero(x) + rows.start for x in (valid[rows], ~valid[rows]))
        if len(good):
            near = KDTree(charts.pos[good]).query(charts.pos[bad], min(NUM_DONORS, len(good)))[1]
            light[bad] = light[good[near.reshape(len(bad), -1)]].mean(axis=1)


def smooth(
    charts: Charts, light: Float[np.ndarray, "x groups 3"], valid: Bool[np.ndarray, " x"]
) -> Float[np.ndarray, "x groups 3"]:
    """Return light that is smoothed along both axes of each chart, by `SMOOTHING` between valid texels."""
    out = light.copy()
    for first, count in zip(charts.first, charts.count, strict=True):
        rows = slice(first, first + np.prod(count))
        weight = valid[rows].reshape(*count, 1, 1).astype(np.float32)
        plane = light[rows].reshape(*count, *light.shape[1:]) * weight
        for axis in (0, 1):
            plane, weight = (correlate1d(x, SMOOTHING, axis=axis, mode="constant") for x in (plane, weight))
        out[rows] = (plane / np.maximum(weight, 1e-6)).reshape(-1, *light.shape[1:])
    return out
