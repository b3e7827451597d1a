"""Statements that exporters write: all of OBJ and MTL, alone and together, and options of colour maps."""

import numpy as np
import pytest

from home_mjx.datasets.suncg.formats.mtl import MISSING_COLOR, read_mtl
from home_mjx.datasets.suncg.formats.obj import read_obj
from home_mjx.datasets.suncg.formats.statements import MTL_IGNORED, OBJ_IGNORED
from home_mjx.datasets.suncg.formats.texture_paths import TextureLookup
from home_mjx.errors import DatasetError
from home_mjx.schema.house import Material

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
UV = "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"
RED = Material("red", (1.0, 0.0, 0.0), None, 1.0)
BLUE = Material("blue", (0.0, 0.0, 1.0), None, 0.75)
RED_BLUE = "newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\nTr 0.25\n"
PLAIN = f"mtllib m.mtl\n{SQUARE}usemtl blue\nf 1 2 3 4\nusemtl red\nf 1 2 3\n"


@pytest.fixture
def read(tmp_path):
    """Reads an OBJ text at object/m/m.obj of a dataset, with MTL files beside it."""
    folder = tmp_path / "object" / "m"
    folder.mkdir(parents=True)
    (tmp_path / "texture").mkdir()

    def read_text(obj, tolerant=False, **libraries):
        for name, text in {"m": RED_BLUE, **libraries}.items():
            (folder / f"{name}.mtl").write_bytes(text if isinstance(text, bytes) else text.encode())
        (folder / "m.obj").write_bytes(obj if isinstance(obj, bytes) else obj.encode())
        return read_obj(folder / "m.obj", TextureLookup(tmp_path, tolerant))

    return read_text


def same(mesh, other):
    assert (mesh.faces.tolist(), mesh.slot.tolist(), mesh.materials) == (
        other.faces.tolist(),
        other.slot.tolist(),
        other.materials,
    )
    np.testing.assert_array_equal(mesh.vertices, other.vertices)
    np.testing.assert_array_equal(mesh.uv, other.uv)


@pytest.mark.parametrize("keyword", [*sorted(OBJ_IGNORED), "vp", "usemap", "maplib", "unknown", "F3", "#MRGB", "é"])
def test_an_odd_statement_of_an_obj_changes_nothing(read, keyword):
    """Points, lines, groups of smoothing, curves and unknown words, at every place of a file."""
    lines = PLAIN.splitlines()
    for row in range(len(lines) + 1):
        same(read("\n".join([*lines[:row], f"{keyword} 1 2 -1", *lines[row:]])), read(PLAIN))


@pytest.mark.parametrize("tolerant", [False, True])
@pytest.mark.parametrize("keyword", [*sorted(MTL_IGNORED), "map_d", "map_opacity", "unknown", "é", "#x"])
def test_an_odd_statement_of_an_mtl_changes_nothing(read, keyword, tolerant):
    """Of all lobes, maps and illumination models, with values that another statement could not have."""
    lines = RED_BLUE.splitlines()
    for row in range(1, len(lines) + 1):
        odd = "\n".join([*lines[:row], f"{keyword} -bm 0.2 none such.png", *lines[row:]])
        assert read(PLAIN, tolerant, m=odd).materials == (RED, BLUE)


def test_continued_lines(read):
    odd = PLAIN.replace("f 1 2 3 4", "f 1 2 \\\n 3 \\\r\n4").replace("v 1 0 0", "v 1 \\\n0 0")
    same(read(odd.replace("usemtl red", "usemtl \\\nred"), m=RED_BLUE.replace("Kd 1", "Kd \\\n 1")), read(PLAIN))
    same(read(f"# a path C:\\models\\\n{PLAIN}"), read(PLAIN))
    same(read(f"{PLAIN}s off \\"), read(PLAIN))


@pytest.mark.parametrize("end", ["\n", "\r\n"])
def test_a_backslash_at_the_end_of_a_comment_or_name_continues_nothing(read, end):
    comment = PLAIN.replace("usemtl red\n", "usemtl red # C:\\mats\\\n").replace("v 1 0 0\n", "v 1 0 0 # C:\\\n")
    same(read(comment.replace("\n", end), m=RED_BLUE.replace("Kd 1 0 0", "Kd 1 0 0 # \\")), read(PLAIN))
    for statement in ("g C:\\mats\\", "o C:\\mats\\", "G a b\\ "):
        mesh = read(PLAIN.replace("f 1 2 3 4\n", f"{statement}\nf 1 2 3 4\n").replace("\n", end))
        assert (mesh.faces.tolist(), mesh.slot.tolist()) == (read(PLAIN).faces.tolist(), read(PLAIN).slot.tolist())
    named = read(PLAIN.replace("usemtl red", "usemtl C:\\red\\"), m=RED_BLUE.replace("newmtl red", "newmtl C:\\red\\"))
    assert [m.diffuse for m in named.materials] == [RED.diffuse, BLUE.diffuse]
    assert named.slot.tolist() == read(PLAIN).slot.tolist()


def test_the_line_of_an_error_is_that_of_the_file(read):
    with pytest.raises(DatasetError) as caught:
        read(PLAIN.replace("v 1 0 0", "v 1 \\\n0 \\\n0").replace("f 1 2 3\n", "f 1 2 x\n"))
    assert caught.value.element == "line 11"


@pytest.mark.parametrize("end", ["\r\n", "\r", " \r\n", "\t\n", "\n\n"])
def test_line_ends(read, end):
    same(read(PLAIN.replace("\n", end), m=RED_BLUE.replace("\n", end)), read(PLAIN))


def test_tabs_upper_case_indices_from_the_end_and_colours_of_vertices(read):
    odd = (
        PLAIN.replace("v 0 0 0", "V\t0 0 0 1 .5 .5").replace("f 1 2 3 4", "fo -4 -3\t-2 -1").replace("usemtl", "UseMtl")
    )
    same(read(odd, m=RED_BLUE.replace("Kd", "KD").replace("Tr", "tr")), read(PLAIN))


def test_names_with_spaces_signs_letters_and_comments(read):
    names = ["Material #25", "hêtre clair", "木", "a/b:c", "x # y", '"quoted"']
    library = "".join(f"newmtl {name}\t \nKd 0.{i} 0 0\n" for i, name in enumerate(names, 1))
    faces = "".join(f"usemtl  {name} \nf 1 2 3\n" for name in names)
    mesh = read(f"mtllib m.mtl\n{SQUARE}{faces}", m=library)
    assert mesh.slot.tolist() == list(range(len(names)))
    assert [m.name for m in mesh.materials] == names
    commented = read(PLAIN.replace("usemtl red", "usemtl red # of the door").replace("m.mtl", "m.mtl # library"))
    same(commented, read(PLAIN))
    assert read(PLAIN, m=RED_BLUE.replace("red", "red # paint")).slot.tolist() == [1, 1, 0]


@pytest.mark.parametrize(
    "line",
    ["mtllib a.mtl b c.mtl", "mtllib b c.mtl a.mtl", "mtllib a.mtl\nmtllib b c.mtl", 'mtllib "a.mtl" "b c.mtl"',
     "mtllib ./a.mtl .\\b c.mtl", "mtllib\ta.mtl\tb c.mtl"],
)  # fmt: skip
def test_several_libraries(read, line):
    files = {"a": "newmtl red\nKd 1 0 0\n", "b c": "newmtl blue\nKd 0 0 1\nTr 0.25\n"}
    mesh = read(PLAIN.replace("mtllib m.mtl", line), **files)
    assert {m.name: m for m in mesh.materials} == {"red": RED, "blue": BLUE}
    assert [mesh.materials[slot].name for slot in mesh.slot] == ["blue", "blue", "red"]


def test_of_two_materials_of_one_name_the_first_library_counts(read):
    mesh = read(PLAIN.replace("m.mtl", "m.mtl a.mtl"), a="newmtl red\nKd 0 1 0\n")
    assert mesh.materials[mesh.slot[-1]] == RED


def test_a_library_that_is_missing_is_named_whole(read):
    with pytest.raises(DatasetError, match="file is missing") as caught:
        read(PLAIN.replace("m.mtl", "my wood.mtl"))
    assert str(caught.value.file).endswith("my wood.mtl")


@pytest.mark.parametrize(
    ("lines", "opacity"),
    [("d 0.25\nTr 0.75", 0.25), ("Tr 0.75\nd 0.25", 0.25), ("d 1\nTr 1", 1.0), ("d 0\nTr 0", 0.0), ("d 1.0\nTr 0", 1.0),
     ("d -halo 0.5", 0.5), ("Tr 1.000000\nillum 2\nNs 0", 1.0), ("Tr 1\nTf 1 1 1\nillum 4\nNi 1.5", 1.0),
     ("Tr 1\nd 0", 0.0), ("d 0\nTr 1", 0.0), ("Tr 0", 1.0), ("d 0.3\nTr 0.3", 0.3)],
)  # fmt: skip
def test_opacity_by_d_and_tr(read, lines, opacity):
    assert read(PLAIN, m=f"newmtl red\n{lines}\nnewmtl blue\n").materials[0].opacity == opacity


@pytest.mark.parametrize(
    ("options", "uv"),
    [
        ("", [1, 1]),
        ("-s 2 3 1", [2, 3]),
        ("-s 2", [2, 1]),
        ("-o 0.25 0.5 0", [1.25, 1.5]),
        ("-s 2 3 1 -o .25 .5", [2.25, 3.5]),
        ("-o 1 -s -1 -1 1", [0, -1]),
        ("-S 2 2", [2, 2]),
        ("-clamp on", [1, 1]),
        ("-blendu on -blendv off -boost 2 -texres 512 -cc on -bm 0.3 -clamp off", [1, 1]),
        ("-mm 0 1 -t 0 0 0 -colorspace sRGB", [1, 1]),
    ],
)
@pytest.mark.parametrize("name", ["wood 8.png", "wood.png", "77.png", "-s 2.png", "é.png", "a # b.png"])
def test_options_of_colour_maps(read, tmp_path, options, uv, name):
    image = tmp_path / "texture" / name
    image.touch()
    mtl = f"newmtl red\nmap_Kd {options} ../../texture/{name}\nnewmtl blue\n"
    mesh = read(f"mtllib m.mtl\n{SQUARE}{UV}usemtl red\nf 1/1 2/2 3/3\nusemtl blue\nf 1/1 2/2 3/3\n", m=mtl)
    assert mesh.materials[0].texture == image
    np.testing.assert_allclose(mesh.uv[0, 2], uv)
    np.testing.assert_allclose(mesh.uv[1, 2], [1, 1])


@pytest.mark.parametrize("name", ["wood 8.png", "wood.png", '"wood 8.png"', "../../texture/wood.png", "a.b.png"])
@pytest.mark.parametrize(
    ("before", "behind", "uv"),
    [("", "-s 2 3 1", [2, 3]), ("", "-s 2 3 1 # tiles", [2, 3]), ("-o .25 .5 0", "-s 2 3", [2.25, 3.5]),
     ("", "-s 2 3 -o .25 .5", [2.25, 3.5]), ("", "-clamp on", [1, 1]), ("", "-S 2 2", [2, 2])],
)  # fmt: skip
def test_options_behind_the_name_of_a_colour_map(read, tmp_path, before, behind, uv, name):
    image = tmp_path / "texture" / name.strip('"').split("/")[-1]
    image.touch()
    mtl = f"newmtl red\nmap_Kd {before} {name} {behind}\nnewmtl blue\n"
    mesh = read(f"mtllib m.mtl\n{SQUARE}{UV}usemtl red\nf 1/1 2/2 3/3\n", m=mtl)
    assert mesh.materials[0].texture == image
    np.testing.assert_allclose(mesh.uv[0, 2], uv)


@pytest.mark.parametrize("name", ["a.png -s 2 2.png", "a.b -clamp on.png", "a.png -s 2"])
def test_a_file_whose_name_has_options(read, tmp_path, name):
    image = tmp_path / "object" / "m" / name
    image.touch()
    mesh = read(f"mtllib m.mtl\n{SQUARE}{UV}usemtl red\nf 1/1 2/2 3/3\n", m=f"newmtl red\nmap_Kd -s 3 3 {name}\n")
    assert mesh.materials[0].texture == image
    np.testing.assert_allclose(mesh.uv[0, 2], [3, 3])


def test_options_behind_a_name_that_are_not_read_are_refused(read, tmp_path):
    (tmp_path / "texture" / "wood.png").touch()
    with pytest.raises(DatasetError, match=r"`-mm 0\.2 2` of `map_Kd` is not read"):
        read(PLAIN, m="newmtl red\nmap_Kd wood.png -mm 0.2 2\nnewmtl blue\n")


@pytest.mark.parametrize("line", ["map_Kd -wood.png", "map_Kd -s 2 2 -wood.png", 'map_Kd "-wood.png"'])
def test_names_that_begin_like_options(read, tmp_path, line):
    image = tmp_path / "object" / "m" / "-wood.png"
    image.touch()
    assert read(PLAIN, m=f"newmtl red\n{line}\nnewmtl blue\n").materials[0].texture == image


def test_a_clamped_map_that_would_have_to_repeat_is_refused(read, tmp_path):
    (tmp_path / "texture" / "wood.png").touch()
    with pytest.raises(DatasetError, match="-clamp on") as caught:
        read(
            f"mtllib m.mtl\n{SQUARE}{UV}usemtl red\nf 1/1 2/2 3/3\n",
            m="newmtl red\nmap_Kd -s 2 2 -clamp on wood.png\n",
        )
    assert caught.value.element == "material `red`"


ODD_LINES = ["Kd x", "Kd 1 nan 0", "d", "Ns many", "map_Kd", "map_Kd -s x a.png", "map_Kd -mm 1 2 a.png", "Ks 1 1",
             "map_Kd /etc/x.png", "newmtl", "Tr inf"]  # fmt: skip


@pytest.mark.parametrize("line", ODD_LINES)
def test_in_a_partial_copy_an_odd_line_changes_its_own_material_only(read, line):
    for library in (f"{line}\n{RED_BLUE}", f"{RED_BLUE}newmtl odd\nKd 0 1 0\n{line}\n"):
        mesh = read(f"{PLAIN}usemtl odd\nf 2 3 4\n", True, m=library)
        assert mesh.materials[:2] == (RED, BLUE)
        assert mesh.materials[mesh.slot[-1]].name == "odd"
    assert mesh.materials[2].missing_file == ("" if line.startswith("newmtl") else "m.mtl")
    colour = MISSING_COLOR if line.startswith("Kd") else (0.0, 1.0, 0.0)
    assert mesh.materials[2].diffuse == colour


def test_letters_of_another_encoding(read, tmp_path):
    """Older exporters write the code page of Windows: refused with its line, and read in partial copies."""
    library = f"# für\nnewmtl grün\n{RED_BLUE}".encode("cp1252")
    with pytest.raises(DatasetError, match="not UTF-8") as caught:
        read(PLAIN, m=library)
    assert caught.value.element == "line 1"
    mesh = read(f"# für\n{PLAIN}usemtl grün\nf 2 3 4\n".encode("cp1252"), True, m=library)
    assert [mesh.materials[slot].name for slot in mesh.slot] == ["blue", "blue", "red", "grün"]
    assert mesh.materials[1:] == (RED, BLUE)


@pytest.mark.parametrize("line", ["Kd 0.5", "Kd 0.5 # grey", "Kd 0.5 0.5 0.5"])
def test_a_single_number_is_a_grey(read, line):
    """As in the format's description: green and blue are as red if they are left out."""
    mesh = read(PLAIN, m=RED_BLUE + f"newmtl grey\n{line}\nKs 0.25\nd -HALO 0.5\n")
    assert mesh.materials[2] == Material("grey", (0.5, 0.5, 0.5), None, 0.5, specular=(0.25, 0.25, 0.25))


def test_a_usemtl_without_a_name(read):
    """In a partial copy its faces are plain, and the other materials stay."""
    text = PLAIN + "usemtl\nf 1 2 4\n"
    with pytest.raises(DatasetError, match="`usemtl` without a name") as caught:
        read(text)
    assert caught.value.element == "line 10"
    mesh = read(text, tolerant=True)
    assert [mesh.materials[i].name for i in mesh.slot] == ["blue", "blue", "red", "default"]
    assert mesh.materials[:2] == (RED, BLUE)


def test_a_mtllib_without_a_name(read):
    text = "mtllib\n" + PLAIN
    with pytest.raises(DatasetError, match="`mtllib` without a file name") as caught:
        read(text)
    assert caught.value.element == "line 1"
    assert read(text, tolerant=True).materials == (RED, BLUE)


BLENDER = """# Blender 4.1.0\n# www.blender.org\nmtllib cube two.mtl\no Cube.001\nv 1.000000 1.000000 -1.000000
v 1.000000 -1.000000 -1.000000\nv -1 1 -1\nv -1 -1 -1 0.8 0.2 0.1\nvn -0.0000 1.0000 -0.0000
vt 0.625000 0.500000\nvt 0.375 0.5\ns 0\nusemtl Material.001\nf 1/1/1 3/2/1 4/2/1 2/1/1\nl 1 2\np 3\n"""
BLENDER_MTL = """# Blender 4.1.0 MTL File: 'None'\n# www.blender.org\n\nnewmtl Material.001\nNs 250.000000
Ka 1.000000 1.000000 1.000000\nKd 0.800000 0.400000 0.200000\nKs 0.500000 0.500000 0.500000\nKe 0.000000 0.000000 0.0
Ni 1.450000\nd 1.000000\nillum 2\nPr 0.5\nPm 0.0\nmap_Bump -bm 1.000000 normal map.png\nmap_refl -type sphere s.png\n"""
MAX = """# 3ds Max Wavefront OBJ Exporter v0.97b - (c)2007 guruware\n# File Created: 01.02.2012 12:00:00\n
mtllib cube two.mtl\n\n#\n# object Box001\n#\n\nv  -1.0000 0.0000 1.0000\nv  1 0 1\nv  1 0 -1\nv  -1 0 -1\n# 4 vertices
vn 0.0000 -1.0000 -0.0000\nvt 1.0000 0.0000 0.0000\n\ng Box001\nusemtl Material__25\ns 2\nf 1/1/1 2/1/1 3/1/1 4/1/1
"""
MAX_MTL = """# 3ds Max Wavefront OBJ Exporter v0.97b\nnewmtl Material__25\n\tNs 10.0000\n\tNi 1.5000\n\td 1.0000
\tTr 0.0000\n\tTf 1.0000 1.0000 1.0000 \n\tillum 2\n\tKa 0.5 0.5 0.5\n\tKd 0.8 0.4 0.2\n\tKs 0.5 0.5 0.5\n\tKe 0 0 0
"""
MAYA = """# This file uses centimeters as units for non-parametric coordinates.\n\nmtllib cube two.mtl\ng default
v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5\nvt 0.375 0\nvn 0 0 1\ns off\ng pCube1
usemtl initialShadingGroup
f 1/1/1 2/1/1 3/1/1 4/1/1\n"""
MAYA_MTL = "newmtl initialShadingGroup\nillum 4\nKd 0.80 0.40 0.20\nKa 0.00 0.00 0.00\nTf 1.00 1.00 1.00\nNi 1.00\n"
SKETCHUP = """# Alias OBJ Model File\n# Exported from SketchUp, (c) 2000-2012 Trimble Navigation Limited
# File units = meters
mtllib cube two.mtl\ng Mesh1 Group1 Model\n\nusemtl Wood_Floor_Light\nv 0 0 0\nvt 0 0\nvn 0 0 1\nv 1 0 0\nv 1 1 0
v 0 1 0
f 1/1/1 2/1/1 3/1/1 4/1/1 \n"""
SKETCHUP_MTL = """#\n## Alias OBJ Material File\n# Exported from SketchUp\n\nnewmtl Wood_Floor_Light
Ka 0.000000 0.000000 0.000000
Kd 0.800000 0.400000 0.200000\nKs 0.330000 0.330000 0.330000\n"""
ASSIMP = """# File produced by Open Asset Import Library\n# (assimp v5.2)\n\nmtllib cube two.mtl\n\n# 4 vertex positions
v  0 0 0\nv  1 0 0\nv  1 1 0\nv  0 1 0\n\n# 0 UV coordinates\n\n# 1 vertex normals\nvn 0 0 1\n
# Mesh 'x' with 1 faces\ng x\nusemtl $Material_1\nf  1//1 2//1 3//1 4//1 \nl  1//1 2//1\n\n"""
ASSIMP_MTL = """newmtl $Material_1\nKd 0.8 0.4 0.2\nKa 0 0 0\nKe 0 0 0\nKs 0 0 0\nTf 1 1 1\nTr 0\nd 1\nNs 0\n
illum 1\nbump a.png\nnorm n.png\ndisp h.png\nmap_Pr r.png\n"""


@pytest.mark.parametrize(
    ("obj", "mtl"),
    [(BLENDER, BLENDER_MTL), (MAX, MAX_MTL), (MAYA, MAYA_MTL), (SKETCHUP, SKETCHUP_MTL), (ASSIMP, ASSIMP_MTL)],
    ids=["blender", "3ds-max", "maya", "sketchup", "assimp"],
)
@pytest.mark.parametrize("tolerant", [False, True])
def test_files_as_exporters_write_them(read, obj, mtl, tolerant):
    for end in ("\n", "\r\n"):
        mesh = read(obj.replace("\n", end), tolerant, **{"cube two": mtl.replace("\n", end)})
        (material,) = mesh.materials
        assert (len(mesh.faces), mesh.slot.tolist()) == (2, [0, 0])
        assert (material.diffuse, material.opacity, material.missing_file) == ((0.8, 0.4, 0.2), 1.0, "")


def test_a_library_is_read_by_itself(tmp_path):
    path = tmp_path / "a.mtl"
    path.write_text(RED_BLUE)
    assert read_mtl(path, TextureLookup(tmp_path)) == (RED, BLUE)
