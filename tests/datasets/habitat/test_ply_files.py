"""PLY files as the format's description allows them: elements in any order, lists of any length, strips and colours."""

import struct

import numpy as np
import pytest

from home_mjx.datasets.habitat.plain.plain_assets import read_plain_asset
from home_mjx.errors import DatasetError

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0], [2, 0, 0]], float)  # a rectangle, and one corner more
VERTEX = "element vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
FACE = "element face {count}\nproperty uchar flags\nproperty list {length} {kind} vertex_index\nproperty short mark\n"
TEXT = "".join(f"{x:g} {y:g} {z:g}\n" for x, y, z in POINTS)


def area(mesh) -> np.ndarray:
    corners = mesh.vertices[mesh.faces]
    return np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) / 2


def read(tmp_path, data):
    path = tmp_path / "a.ply"
    path.write_bytes(data.encode() if isinstance(data, str) else data)
    return read_plain_asset(path, strict=True)


@pytest.mark.parametrize("order", ["little", "big"])
@pytest.mark.parametrize(
    "faces", [[(1, 4, 2), (0, 1, 2, 3)], [(0, 1, 2, 3), (1, 4, 2)], [(0, 1, 4, 2, 3)], [(1, 4, 2)]]
)
@pytest.mark.parametrize("is_first", [True, False])
def test_binary_polygons_of_any_lengths_before_or_after_their_vertices(tmp_path, order, faces, is_first):
    sign, form = ("<", "binary_little_endian") if order == "little" else (">", "binary_big_endian")
    head = FACE.format(count=len(faces), length="ushort", kind="uint")
    body = b"".join(struct.pack(f"{sign}BH{len(f)}Ih", 7, len(f), *f, -3) for f in faces)
    points = POINTS.astype(f"{sign}f4").tobytes()
    heads, bodies = ([head, VERTEX], [body, points]) if is_first else ([VERTEX, head], [points, body])
    text = f"ply\nformat {form} 1.0\nobj_info from a test\n{''.join(heads)}end_header\n"
    mesh = read(tmp_path, text.encode() + b"".join(bodies))
    expected = 1.0 * (any(4 in f for f in faces)) + 2.0 * (any(3 in f for f in faces))
    np.testing.assert_allclose(area(mesh).sum(axis=0), [0, 0, expected], atol=1e-9)
    assert len(mesh.faces) == sum(len(f) - 2 for f in faces)


def test_text_with_other_line_ends_edges_and_colours_of_faces(tmp_path):
    head = f"ply\nformat ascii 1.0\n{VERTEX}element edge 1\nproperty int vertex1\nproperty int vertex2\n"
    head += "element face 3\nproperty list uchar int vertex_indices\n"
    head += "".join(f"property uchar {color}\n" for color in ("red", "green", "blue"))
    faces = "4 0 1 2 3 255 0 0\n3 1 4 2 0 0 1\n2 0 1 9 9 9\n"
    mesh = read(tmp_path, f"{head}end_header\n{TEXT}0 1\n{faces}".replace("\n", "\r\n"))
    colors = np.array([mesh.materials[slot].diffuse for slot in mesh.slot])
    np.testing.assert_allclose(colors, [[1, 0, 0], [1, 0, 0], [0, 0, 1 / 255]], atol=1e-5)


@pytest.mark.parametrize(("names", "scale"), [("diffuse_red diffuse_green diffuse_blue", 255), ("red green blue", 1)])
def test_colours_of_vertices_are_bytes_or_reals(tmp_path, names, scale):
    kind = "uchar" if scale == 255 else "float"
    head = f"ply\nformat ascii 1.0\n{VERTEX}{''.join(f'property {kind} {name}{chr(10)}' for name in names.split())}"
    rows = "".join(f"{line} 0 {scale} 0\n" for line in TEXT.splitlines())
    mesh = read(tmp_path, f"{head}element face 1\nproperty list uchar int vertex_indices\nend_header\n{rows}3 0 1 2\n")
    assert mesh.materials[0].diffuse == pytest.approx((0, 1, 0))


def test_strips_are_wound_alike_and_end_with_minus_one(tmp_path):
    head = f"ply\nformat ascii 1.0\n{VERTEX}element tristrips 1\nproperty list int int vertex_indices\nend_header\n"
    mesh = read(tmp_path, f"{head}{TEXT}9 0 1 3 2 -1 1 4 2 -1\n")
    np.testing.assert_allclose(area(mesh), [[0, 0, 1]] * 3)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (f"ply\nformat ascii 1.0\n{VERTEX}element face 1\nproperty list uchar int vertex_indices\n", "no header"),
        (f"ply\nformat ascii 1.0\n{VERTEX}property half a\nend_header\n", "unknown line.*half"),
        (f"ply\nformat ascii 1.0\n{VERTEX}end_header\n{TEXT[:-2]}", "shorter"),
        (f"ply\nformat ascii 1.0\n{VERTEX}end_header\n{TEXT}z", "other words"),
        ("ply\nformat binary_little_endian 1.0\nelement vertex 99999999999\nproperty char x\nend_header\n", "shorter"),
        ("ply\nformat binary_odd_endian 1.0\nend_header\n", "expected a PLY header"),
    ],
)
def test_broken_files_are_located(tmp_path, data, message):
    with pytest.raises(DatasetError, match=message):
        read(tmp_path, data)


@pytest.mark.parametrize("index", ["5", "-1"])
def test_indices_beyond_the_vertices_are_errors(tmp_path, index):
    head = f"ply\nformat ascii 1.0\n{VERTEX}element face 1\nproperty list uchar int vertex_indices\nend_header\n"
    with pytest.raises(DatasetError, match="beyond the 5 vertices"):
        read(tmp_path, f"{head}{TEXT}3 0 1 {index}\n")
