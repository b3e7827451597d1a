"""Polygons of OBJ files: concave, bent, with bridges to holes, degenerate and crossing themselves."""

import numpy as np
import pytest
import trimesh

from home_mjx.datasets.suncg.formats.obj import read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError
from home_mjx.geometry.faces import MAX_POLYGON_CORNERS, FaceError, triangulate_faces
from home_mjx.geometry.meshes import surface_areas

L_SHAPE = [(0, 0), (0.2, 0), (0.2, 0.7), (0.6, 0.7), (0.6, 1.0), (0, 1.0)]
COMB = [(0, 0), (5, 0), (5, 2), (4, 2), (4, 1), (3, 1), (3, 2), (2, 2), (2, 1), (1, 1), (1, 2), (0, 2)]
SPIRAL = [(0, 0), (3, 0), (3, 1), (1, 1), (1, 2), (3, 2), (3, 3), (0, 3), (0, 2.9), (0.1, 2.9), (0.1, 0.1), (0, 0.1)]
FRAME = [(0, 0), (4, 0), (4, 3), (0, 3), (0, 0), (1, 1), (1, 2), (3, 2), (3, 1), (1, 1)]  # a hole of 2 x 1 m
TWO_HOLES = [
    *[(0, 0), (1, 0), (1, 1), (1, 2), (2, 2), (2, 1), (1, 1), (1, 0), (3, 0)],
    *[(3, 1), (3, 2), (4, 2), (4, 1), (3, 1), (3, 0), (5, 0), (5, 3), (0, 3)],
]
TOUCHING = [(0, 0), (4, 0), (4, 4), (0, 4), (0, 0), (1, 2), (2, 2), (2, 1)]  # a hole that shares a corner with the edge
BRIDGED = [(0, 0), (1, 0), (1, 1), (2, 1), (2, 0), (3, 0), (3, 1), (2, 1), (1, 1), (0, 1)]  # joined by a line
TAIL = [(0, 0), (2, 0), (2, 2), (3, 3), (2, 2), (0, 2)]  # an edge out and back
AREAS = [
    (L_SHAPE, 0.32), (COMB, 8.0), (SPIRAL, 6.72), (FRAME, 10.0), (TWO_HOLES, 13.0), (TOUCHING, 14.0), (BRIDGED, 2.0),
    (TAIL, 4.0), ([*L_SHAPE[:3], L_SHAPE[2], *L_SHAPE[3:]], 0.32),
]  # fmt: skip
TWICE_ROUND = [((1 + 0.05 * i) * np.cos(i * np.pi / 4), (1 + 0.05 * i) * np.sin(i * np.pi / 4)) for i in range(13)]
CROSSING = [
    [(0, 0), (1, 0), (1, 1), (0, 1)] * 2,
    [(0, 0), (1, 0), (1, 1), (0, 1)] * 3,
    TWICE_ROUND,
    TWICE_ROUND[::-1],
    [*TWICE_ROUND, TWICE_ROUND[-1], TWICE_ROUND[0]],
    [(0, 0), (1, 1), (1, 0), (0, 1)],
    [(0, 0), (2, 2), (2, 0), (0, 1)],
    [(0, 0), (4, 0), (4, 1), (1, 1), (1, -1), (0, -1)],
    [*FRAME[:5], (3, 1), (3, 2), (6, 2), (6, 1), (3, 1)],  # a hole that leaves its polygon
    [(np.cos(a), np.sin(a)) for a in np.arange(5) * 4 * np.pi / 5],
]


def area_of(points, faces):
    return float(surface_areas(np.asarray(points, float)[faces]).sum())


def write(tmp_path, points, *faces):
    path = tmp_path / "a.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in np.asarray(points, float).tolist()]
    path.write_text("\n".join([*lines, *faces, ""]))
    return path


def turned(rng, polygon):
    """A polygon somewhere in space."""
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return np.c_[polygon, np.zeros(len(polygon))] @ turn.T + rng.normal(size=3)


@pytest.mark.parametrize(("polygon", "area"), AREAS)
@pytest.mark.parametrize("reverse", [False, True])
def test_a_concave_polygon_has_its_own_area_from_every_first_corner(polygon, area, reverse, tmp_path, rng):
    points = turned(rng, polygon)
    order = np.arange(len(polygon))[:: -1 if reverse else 1]
    vector = np.cross(points[order], np.roll(points[order], -1, axis=0)).sum(axis=0) / 2
    for first in range(len(polygon)):
        face = np.roll(order, -first)
        path = write(tmp_path, points, "f " + " ".join(map(str, face + 1)))
        mesh = read_obj(path, TextureLookup(tmp_path))
        assert area_of(mesh.vertices, mesh.faces) == pytest.approx(area, rel=1e-6)
        corners = mesh.vertices[mesh.faces]
        normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2
        np.testing.assert_allclose(normal.sum(axis=0), vector, atol=1e-6)  # the side that it faces


def test_a_prism_with_concave_caps(tmp_path):
    count, height = len(L_SHAPE), 0.5
    points = [(x, y, z) for z in (0, height) for x, y in L_SHAPE]
    sides = [(i, (i + 1) % count, (i + 1) % count + count, i + count) for i in range(count)]
    faces = [range(count - 1, -1, -1), range(count, 2 * count), *sides]
    mesh = read_obj(
        write(tmp_path, points, *("f " + " ".join(str(i + 1) for i in face) for face in faces)), TextureLookup(tmp_path)
    )
    solid = trimesh.Trimesh(mesh.vertices, mesh.faces)
    assert (solid.is_watertight, solid.volume) == (True, pytest.approx(0.32 * height))
    assert solid.area == pytest.approx(2 * 0.32 + height * 3.2)


def test_texture_coordinates_and_materials_stay_with_their_corners(tmp_path):
    (tmp_path / "a.mtl").write_text("newmtl a\nnewmtl b\n")
    corners = " ".join(f"{i}/{i}" for i in (2, 3, 4, 5, 6, 1))
    lines = [f"vt {x} {y}" for x, y in L_SHAPE]
    path = write(
        tmp_path, np.c_[L_SHAPE, np.zeros(6)], "mtllib a.mtl", *lines, "usemtl b", f"f {corners}", "usemtl a", "f 1 2 3"
    )
    mesh = read_obj(path, TextureLookup(tmp_path))
    np.testing.assert_allclose(mesh.uv[:4], mesh.vertices[mesh.faces][:4, :, :2], atol=1e-6)
    assert mesh.slot.tolist() == [1, 1, 1, 1, 0]


def test_a_bent_polygon_is_cut_as_seen_along_its_vector_area(rng):
    for polygon, area in AREAS[:5]:
        points = np.c_[polygon, 0.02 * rng.normal(size=len(polygon))]
        points[:, 2] = [dict(zip(map(tuple, polygon), points[:, 2], strict=True))[tuple(p)] for p in polygon]
        faces, _ = triangulate_faces(points, np.array([len(points)]))
        flat = points * [1, 1, 0]
        assert area_of(flat, faces) == pytest.approx(area, rel=5e-3)


@pytest.mark.parametrize("polygon", CROSSING)
def test_a_polygon_that_crosses_itself_is_refused_with_its_line(polygon, tmp_path):
    points = np.c_[polygon, np.zeros(len(polygon))]
    path = write(tmp_path, points, "f 1 2 3", "f " + " ".join(str(i + 1) for i in range(len(polygon))))
    with pytest.raises(DatasetError, match="crosses itself") as caught:
        read_obj(path, TextureLookup(tmp_path))
    assert (caught.value.file, caught.value.element) == (str(path), f"line {len(polygon) + 2}")
    assert caught.value.hint == "Triangulate the model in the program that wrote it."
    assert len(read_obj(path, TextureLookup(tmp_path, tolerant=True)).faces) == 1 + len(polygon) - 2  # partial copies


@pytest.mark.parametrize("first", range(13))
def test_a_polygon_that_winds_twice_round_a_point_is_no_fan_of_any_corner(first):
    points = np.roll(np.c_[TWICE_ROUND, np.zeros(13)], first, axis=0)
    with pytest.raises(FaceError, match="crosses itself"):
        triangulate_faces(points, np.array([13]))


@pytest.mark.parametrize("count", [5, 9, 40])
def test_a_fan_of_a_corner_inside_a_slit_makes_one_turn(count):
    """A disc with a slit from its rim to its middle, where the fan makes a whole turn."""
    angle = np.linspace(0, 2 * np.pi, count + 1)
    points = np.c_[[(0, 0), *np.stack([np.cos(angle), np.sin(angle)], axis=1)], np.zeros(count + 2)]
    faces, _ = triangulate_faces(points, np.array([count + 2]))
    assert area_of(points, faces) == pytest.approx(count / 2 * np.sin(2 * np.pi / count))


def test_a_twisted_quad_of_suncg_stays_a_fan():
    quad = np.array([[0, 0, 0], [2.05, 0, 1.32], [2.05, -2.66, 10.23], [2.89, -2.66, 8.91]]) * 1e-3
    assert triangulate_faces(quad, np.array([4]))[0].tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize(
    "points",
    [
        [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0)],
        [(0, 0, 0), (2, 0, 0), (1, 0, 0), (3, 0, 0), (0, 0, 0)],
        [(1, 1, 1)] * 5,
        [(0, 0, 0), (1, 0, 0), (1, 0, 0), (0, 0, 0)],
    ],
)
def test_polygons_without_area_are_kept_as_fans(points):
    faces, face = triangulate_faces(np.array(points, float), np.array([len(points)]))
    assert faces.tolist() == [[0, k, k + 1] for k in range(1, len(points) - 1)]
    assert face.tolist() == [0] * (len(points) - 2)


def test_random_polygons_between_others(rng):
    """Histograms of random heights: concave, with no corner that sees all; convex ones and triangles between them."""
    points, sides, areas = [], [], []
    for _ in range(200):
        heights = rng.uniform(0.1, 1, rng.integers(1, 9))
        top = [(x + step, h) for x, h in enumerate(heights) for step in (0, 1)][::-1]
        polygon = turned(rng, [(0, 0), (len(heights), 0), *top])
        points.append(np.roll(polygon, rng.integers(len(polygon)), axis=0))
        areas.append(heights.sum())
    sides = np.array([len(p) for p in points])
    faces, face = triangulate_faces(np.concatenate(points), sides)
    assert (np.diff(face) >= 0).all()
    found = np.bincount(face, surface_areas(np.concatenate(points)[faces]))
    np.testing.assert_allclose(found, areas, rtol=1e-6)
    first = np.repeat(np.cumsum(sides) - sides, np.bincount(face))
    assert ((faces >= first[:, None]) & (faces < first[:, None] + sides[face][:, None])).all()


def test_a_polygon_with_too_many_corners_is_refused_at_once(rng):
    with pytest.raises(FaceError, match=f"at most {MAX_POLYGON_CORNERS} are cut"):
        triangulate_faces(rng.normal(size=(100_000, 3)), np.array([100_000]))
