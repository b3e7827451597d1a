"""Smooth normals where surfaces are round, flat ones where they have edges."""

import numpy as np
import pytest
import trimesh

from home_mjx.datasets.suncg.formats.obj import read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.geometry import meshes
from home_mjx.geometry.meshes import box_triangles, crease_normals
from home_mjx.scene_compile.objects.placed_objects import library_model


def flat(triangles):
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def test_a_cube_keeps_its_edges():
    triangles = box_triangles(np.array([1.0, 2, 3]), np.array([0.5, 0.2, 0.9]))
    np.testing.assert_allclose(crease_normals(triangles), np.repeat(flat(triangles)[:, None], 3, axis=1), atol=1e-12)


def test_a_sphere_is_round():
    sphere = trimesh.creation.icosphere(subdivisions=3, radius=0.4)
    normals = crease_normals(np.asarray(sphere.triangles))
    outward = np.asarray(sphere.triangles) / 0.4
    assert np.sum(normals * outward, axis=-1).min() > 0.9995
    faces = np.repeat(flat(np.asarray(sphere.triangles))[:, None], 3, axis=1)
    assert np.sum(faces * outward, axis=-1).min() < 0.997


def test_a_cylinder_is_round_around_and_has_edges_at_its_ends():
    cylinder = trimesh.creation.cylinder(radius=0.3, height=1.0, sections=24)
    triangles = np.asarray(cylinder.triangles)
    normals = crease_normals(triangles)
    cap = abs(flat(triangles)[:, 2]) > 0.9
    np.testing.assert_allclose(normals[cap], np.repeat(flat(triangles)[cap][:, None], 3, axis=1), atol=1e-9)
    side = normals[~cap]
    np.testing.assert_allclose(side[..., 2], 0, atol=1e-9)
    radial = triangles[~cap][..., :2] / 0.3
    assert np.sum(side[..., :2] * radial, axis=-1).min() > 0.99


def test_back_to_back_sheets_keep_their_sides(rng):
    sheet = rng.normal(size=(1, 3, 3))
    both = np.concatenate([sheet, sheet[:, ::-1]])
    np.testing.assert_allclose(crease_normals(both), np.repeat(flat(both)[:, None], 3, axis=1), atol=1e-12)


def test_triangles_without_area_have_no_normal_and_spoil_none():
    flat_one = np.array([[[0.0, 0, 0], [1, 0, 0], [2, 0, 0]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]]])
    normals = crease_normals(flat_one)
    assert (normals[0] == 0).all()
    np.testing.assert_array_equal(normals[1], [[0, 0, 1]] * 3)


def test_normals_do_not_depend_on_how_many_pairs_are_compared_at_a_time(monkeypatch):
    triangles = trimesh.creation.cylinder(1, 2, sections=24).triangles
    whole = crease_normals(triangles)
    monkeypatch.setattr(meshes, "MAX_PAIRS", 7)
    np.testing.assert_array_equal(crease_normals(triangles), whole)


def test_no_triangles():
    assert crease_normals(np.zeros((0, 3, 3))).shape == (0, 3, 3)


SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"


def read_square(tmp_path, normals, faces="f 1//1 2//2 3//3 4//4\n"):
    path = tmp_path / "a.obj"
    path.write_text(SQUARE + normals + faces)
    return read_obj(path, TextureLookup(tmp_path)).normal


def test_normals_of_a_file_are_kept_corner_by_corner(tmp_path):
    found = read_square(tmp_path, "vn 0 0 2\nvn 1 0 1\nvn 0 1 1\nvn 0 0 1\n")
    half = 0.5**0.5
    expected = [[0, 0, 1], [half, 0, half], [0, half, half], [0, 0, 1]]
    np.testing.assert_allclose(
        found, [[expected[0], expected[1], expected[2]], [expected[0], expected[2], expected[3]]]
    )
    model = library_model("a", read_obj(tmp_path / "a.obj", TextureLookup(tmp_path)))
    np.testing.assert_allclose(model.normal[:, 0], [[0, -1, 0]] * 2, atol=1e-6)  # Z up: the square now faces -y


@pytest.mark.parametrize(
    "normals", ["", "vn 0 0 1\n" * 4, "vn 0 0 1\n" * 3 + "vn nan 0 1\n", "vn 0 0 1\n" * 3 + "vn -1.#IND 0 1\n"]
)
def test_flat_or_broken_normals_are_left_out(tmp_path, normals):
    faces = "f 1//1 2//2 3//3 4//4\n" if normals else "f 1 2 3 4\n"
    assert read_square(tmp_path, normals, faces) is None
