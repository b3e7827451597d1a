"""OBJ and MTL files of every shape that the format allows, and those that it does not."""

import numpy as np
import pytest

from home_mjx.core import files
from home_mjx.datasets.suncg.formats.obj import DEFAULT_MATERIAL, read_obj
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Material

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
RED_BLUE = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nTr 0.25\n"


@pytest.fixture
def read(tmp_path):
    """Reads an OBJ text that lies at object/m/m.obj of a dataset, with m.mtl beside it."""
    folder = tmp_path / "object" / "m"
    folder.mkdir(parents=True)
    (tmp_path / "texture").mkdir()

    def read_text(obj, mtl=RED_BLUE):
        (folder / "m.mtl").write_bytes(mtl if isinstance(mtl, bytes) else mtl.encode())
        (folder / "m.obj").write_bytes(obj if isinstance(obj, bytes) else obj.encode())
        return read_obj(folder / "m.obj", TextureLookup(tmp_path))

    return read_text


def refused(read, obj: str | bytes, mtl: str | bytes = RED_BLUE):
    with pytest.raises(DatasetError) as caught:
        read(obj, mtl)
    assert caught.value.hint
    return caught.value


def test_polygons_become_fans(read):
    angle = np.linspace(0, 2 * np.pi, 7, endpoint=False)
    lines = [f"v {np.cos(a)} {np.sin(a)} 0" for a in angle]
    mesh = read("\n".join([*lines, "f 1 2 3", "f 1 2 3 4", "f " + " ".join(str(i) for i in range(1, 8))]))
    assert mesh.faces.tolist() == [[0, 1, 2], [0, 1, 2], [0, 2, 3], *([0, k, k + 1] for k in range(1, 6))]
    heptagon = mesh.vertices[mesh.faces[3:]]
    area = 0.5 * np.linalg.norm(np.cross(heptagon[:, 1] - heptagon[:, 0], heptagon[:, 2] - heptagon[:, 0]), axis=1)
    assert area.sum() == pytest.approx(3.5 * np.sin(2 * np.pi / 7))  # n/2 sin(2 pi/n)


@pytest.mark.parametrize(
    "faces", ["f 1 2 3", "f 1/1 2/2 3/3", "f 1//1 2//1 3//1", "f 1/1/1 2/2/1 3/3/1", "f -4 -3 -2", "f -4/-3/-1 2/2/1 3"]
)
def test_forms_of_a_corner(read, faces):
    mesh = read(f"{SQUARE}vt 0 0\nvt 1 0\nvt 1 0.5\nvn 0 0 1\n{faces}\n")
    assert mesh.faces.tolist() == [[0, 1, 2]]
    textured = "/" in faces and "//" not in faces
    last = [1, 0.5] if textured and not faces.endswith(" 3") else [0, 0]
    assert mesh.uv.tolist() == [[[0, 0], [1, 0] if textured else [0, 0], last]]


def test_negative_indices_count_from_the_line_of_their_face(read):
    mesh = read(f"{SQUARE}f -4 -3 -2\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf -3 -2 -1\n")
    assert mesh.faces.tolist() == [[0, 1, 2], [4, 5, 6]]


def test_materials_are_slots_in_the_order_of_the_mtl(read):
    text = f"mtllib m.mtl\n{SQUARE}usemtl blue\nf 1 2 3 4\nusemtl red\nf 1 2 3\nusemtl blue\nf 2 3 4\n"
    mesh = read(text)
    assert mesh.slot.tolist() == [1, 1, 0, 1]
    assert mesh.materials == (
        Material("red", (1.0, 0.0, 0.0), None, 1.0),
        Material("blue", (0.0, 0.0, 1.0), None, 0.75),
    )


def test_faces_above_the_first_usemtl_are_plain(read):
    mesh = read(f"mtllib m.mtl\n{SQUARE}f 1 2 3\nusemtl red\nf 2 3 4\n")
    assert mesh.slot.tolist() == [2, 0]
    assert mesh.materials[2] == DEFAULT_MATERIAL


def test_mesh_without_materials_is_plain(read):
    mesh = read(f"{SQUARE}f 1 2 3\n")
    assert (mesh.slot.tolist(), mesh.materials, mesh.group.tolist(), mesh.groups) == (
        [0],
        (DEFAULT_MATERIAL,),
        [-1],
        (),
    )


@pytest.mark.parametrize("keyword", ["o", "g"])
def test_groups_by_name(read, keyword):
    text = f"{SQUARE}f 1 2 3\n{keyword} A#0_0\nf 1 2 3 4\n{keyword} B c\nf 1 2 3\n{keyword} A#0_0\nf 2 3 4\n"
    mesh = read(text)
    assert mesh.groups == ("A#0_0", "B c")
    assert mesh.group.tolist() == [-1, 0, 0, 1, 0]


def test_objects_go_before_groups(read):
    assert read(f"{SQUARE}g inner\no Floor#0_0\nf 1 2 3\n").groups == ("Floor#0_0",)


def test_line_ends_comments_tabs_and_byte_order_mark(read):
    plain = read(f"mtllib m.mtl\n{SQUARE}usemtl red\nf 1 2 3\n")
    text = f"\ufeff# head\nmtllib m.mtl\n\n{SQUARE}vn 0 0 1\ns off\nusemtl red\n  f\t1 2  3 # tail"
    odd = read(text.replace("\n", "\r\n").replace("v ", "v\t"), RED_BLUE.replace("\n", "\r\n"))
    np.testing.assert_array_equal(odd.vertices, plain.vertices)
    assert (odd.faces.tolist(), odd.materials) == (plain.faces.tolist(), plain.materials)


def test_numbers_beyond_the_coordinates_are_ignored(read):
    mesh = read("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nvt .5 .25 0\nf 1/1 2/1 3/1\n")
    assert mesh.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
    assert mesh.uv[0, 0].tolist() == [0.5, 0.25]


def test_large_mesh_against_a_plain_loop(read, rng):
    count, faces = 500, 2_000
    sides = rng.integers(3, 7, faces)
    around = [np.sort(rng.choice(count, n, replace=False)) + 1 for n in sides]  # in order round a circle: convex
    corners = [np.stack([corner, rng.integers(1, count + 1, len(corner))], axis=1) for corner in around]
    angle, uv = np.linspace(0, 2 * np.pi, count, endpoint=False), rng.random((count, 2))
    points = np.stack([np.cos(angle), np.sin(angle), np.cos(angle) / 2], axis=1)
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in points.tolist()] + [f"vt {u!r} {v!r}" for u, v in uv.tolist()]
    lines += ["f " + " ".join(f"{v}/{t}" for v, t in face) for face in corners]
    mesh = read("\n".join(lines))
    fan = [(face[0], face[k], face[k + 1]) for face in corners for k in range(1, len(face) - 1)]
    np.testing.assert_array_equal(mesh.vertices, points)
    np.testing.assert_array_equal(mesh.faces, [[v - 1 for v, _ in tri] for tri in fan])
    np.testing.assert_array_equal(mesh.uv, np.array([[uv[t - 1] for _, t in tri] for tri in fan], np.float32))


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("v 1 2", "expected 3 numbers, got `1 2`"),
        ("v 1 2 x", "expected 3 numbers, got `1 2 x`"),
        ("v", "expected 3 numbers"),
        ("v 1 nan 0", "expected finite numbers"),
        ("v inf 0 0", "expected finite numbers"),
        ("v 0 0 1e999", "expected finite numbers"),
        ("vt 0", "expected 2 numbers"),
        ("vt 0 nan", "expected finite numbers"),
        ("f 1 2", "expected a face"),
        ("f", "expected a face"),
        ("f 1 2 x", "expected a face"),
        ("f 1/1/1/1 2 3", "expected a face"),
        ("f 1/ 2/ 3/", "expected a face"),
        ("f 1 2 1.5", "expected a face"),
        ("f 1 2 99999999999999999999", "expected a face"),
        ("f 1 2 5", "face refers to `v` 5, but the file has 4"),
        ("f 1 2 0", "face refers to `v` 0, but the file has 4"),
        ("f 1 2 -5", "face refers to `v` -5, but the file has 4"),
        ("f 1/1 2/1 3/2", "face refers to `vt` 2, but the file has 1"),
        ("f 1/1 2/1 3/-2", "face refers to `vt` -2, but the file has 1"),
        ("f 1//1 2//1 3//1", "face refers to `vn` 1, but the file has 0"),
        ("v 1_0 0 0", "expected 3 numbers, got `1_0 0 0`"),
        ("v ١ 0 0", "expected 3 numbers"),
        ("v 0,5 0 0", "expected 3 numbers, got `0,5 0 0`"),
        ("v 1.#QNAN 0 0", "expected 3 numbers"),
        ("f 1 2 1_0", "expected a face"),
        ("surf 0 1 0 1 1 2 3 4", "`surf` is a free-form surface, which is not read"),
        ("bzp 1 2 3 4", "`bzp` is a Bezier patch, which is not read"),
        ("call other.obj", "`call` is the content of another file, which is not read"),
        ("csh -rm x", "`csh` is the output of a program, which is not read"),
        ("usemtl green", "material `green` is not in the material library"),
    ],
)
def test_broken_lines(read, line, message):
    error = refused(read, f"mtllib m.mtl\n{SQUARE}vt 0 0\nusemtl red\nf 1/1 2/1 3/1\n{line}\nf 2 3 4\n")
    assert error.file is not None
    assert error.file.endswith("m.obj")
    assert error.element == "line 9"
    assert message in error.message


def test_unknown_material_names_the_closest(read):
    error = refused(read, f"mtllib m.mtl\n{SQUARE}usemtl bleu\nf 1 2 3\n")
    assert error.hint == "Did you mean `blue`? Known: blue, red"


def test_usemtl_without_library(read):
    assert refused(read, f"{SQUARE}usemtl red\nf 1 2 3\n").hint == "Add a `mtllib` line that names an MTL file."


@pytest.mark.parametrize("text", ["", "# nothing\n", SQUARE])
def test_empty_mesh(read, text):
    error = refused(read, text)
    assert error.message == "mesh has no faces"
    assert "remove the nodes" in (error.hint or "")


def test_missing_material_library(read):
    error = refused(read, f"{SQUARE}mtllib other.mtl\nf 1 2 3\n")
    assert error.message == "file is missing"
    assert error.file is not None
    assert error.file.endswith("other.mtl")
    assert "m.obj needs it" in (error.hint or "")


@pytest.mark.parametrize("path", ["../../../secret.mtl", "/etc/passwd", "..\\..\\..\\secret.mtl"])
def test_material_library_outside_the_dataset(read, path):
    error = refused(read, f"{SQUARE}f 1 2 3\nmtllib {path}\n")
    assert error.element == "line 6"
    assert "leads out of the dataset" in error.message


@pytest.mark.parametrize("which", ["obj", "mtl"])
def test_not_utf8(read, which):
    obj, mtl = f"mtllib m.mtl\n{SQUARE}f 1 2 3\n".encode(), RED_BLUE.encode()
    broken = {"obj": (obj + b"# caf\xe9\n", mtl), "mtl": (obj, mtl + b"# caf\xe9\n")}[which]
    error = refused(read, broken[0], broken[1])
    assert error.file is not None
    assert error.file.endswith(f"m.{which}")
    assert error.element == "line 7" if which == "obj" else "line 6"
    assert error.hint == "Save the file as UTF-8."


def test_file_too_large(read, monkeypatch):
    monkeypatch.setattr(files, "MAX_BYTES", 50)
    error = refused(read, SQUARE * 10)
    assert error.message == "file has 320 bytes, at most 50 are read"


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("Kd 1 0", "expected 3 finite number(s), got `1 0`"),
        ("Kd a b c", "expected 3 finite number(s)"),
        ("Kd 1 nan 0", "expected 3 finite number(s)"),
        ("d", "expected 1 finite number(s)"),
        ("Tr inf", "expected 1 finite number(s)"),
        ("newmtl", "`newmtl` without a name"),
        ("newmtl red", "material `red` is defined twice"),
        ("map_Kd", "expected a file name"),
        ("map_Kd -s 2 2 2 wood.png", "texture `wood` is missing"),
        ("map_Kd -s", "expected a file name, got `-s`"),
        ("map_Kd -s 2 2 2", "texture `2` is missing"),
        ("map_Kd -s x wood.png", "expected a finite number after an option"),
        ("map_Kd -s nan 1 1 wood.png", "expected a finite number after an option"),
        ("map_Kd -gain 2 wood.png", "expected a file name, got `-gain 2 wood.png`"),
        ("map_Kd -mm 0.2 2 wood.png", "option `-mm 0.2 2` of `map_Kd` is not read"),
        ("map_Kd -t 0.1 wood.png", "option `-t 0.1` of `map_Kd` is not read"),
        ("map_Kd -imfchan r wood.png", "option `-imfchan r` of `map_Kd` is not read"),
        ("map_Kd -type sphere wood.png", "option `-type sphere` of `map_Kd` is not read"),
        ("Kd 1_0 0 0", "expected 3 finite number(s)"),
        ("Kd spectral file.rfl 1", "expected 3 finite number(s)"),
        ("map_Kd ../../texture/none.png", "texture `none` is missing"),
        ("map_Kd ../../../none.png", "leads out of the dataset"),
        ("map_Kd /etc/passwd", "leads out of the dataset"),
    ],
)
def test_broken_material_lines(read, line, message):
    error = refused(read, f"mtllib m.mtl\n{SQUARE}f 1 2 3\n", f"newmtl red\n{line}\n")
    assert error.file is not None
    assert error.file.endswith("m.mtl")
    assert error.element == "line 2"
    assert message in error.message


def test_property_above_the_first_material(read):
    assert refused(read, f"mtllib m.mtl\n{SQUARE}f 1 2 3\n", "Kd 1 0 0\n").message == "`Kd` before the first `newmtl`"


def test_material_values_are_clipped_and_later_lines_win(read):
    (material,) = read(
        f"mtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 3\n", "newmtl a\nKd 1.5 -1 0.5\nd 0.5\nTr 0.75\n"
    ).materials
    assert (material.diffuse, material.opacity) == ((1.0, 0.0, 0.5), 0.25)


@pytest.mark.parametrize(
    ("relative", "found"),
    [
        ("../../texture//wood_8.jpg", "wood_8.jpg"),
        ("..\\..\\texture\\wood_8.jpg", "wood_8.jpg"),
        ("../texture/wood_8.jpg", "wood_8.jpg"),  # not there: the stem is looked up in texture/
        ("wood_8.bmp", "wood_8.jpg"),
        ("../../texture/leaf.tga", "leaf.png"),  # png goes first
        ("../../texture/77.jpg", "s/77.jpg"),
        ("../../texture/WOOD_8.JPG", "wood_8.jpg"),
        ("../../texture/bark.jpg", "Bark.JPG"),
    ],
)
def test_color_maps(read, tmp_path, relative, found):
    (tmp_path / "texture" / "s").mkdir()
    for name in ("wood_8.jpg", "leaf.jpg", "leaf.png", "s/77.jpg", "Bark.JPG"):
        (tmp_path / "texture" / name).touch()
    (material,) = read(f"mtllib m.mtl\n{SQUARE}usemtl a\nf 1 2 3\n", f"newmtl a\nmap_Kd {relative}\n").materials
    assert material.texture == tmp_path / "texture" / found
