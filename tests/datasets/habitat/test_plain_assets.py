"""Assets without nodes, as files of their formats' specifications: PLY, COLLADA, and the images of OBJ files."""

import struct
from importlib.util import find_spec

import numpy as np
import pytest
from PIL import Image

from home_mjx.core.color import decode_srgb
from home_mjx.datasets.habitat.build import asset_files
from home_mjx.datasets.habitat.plain.collada import collada_frame
from home_mjx.datasets.habitat.plain.plain_assets import read_plain_asset
from home_mjx.errors import DatasetError

needs_collada = pytest.mark.skipif(find_spec("collada") is None, reason="pycollada is not installed")
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 2, 0], [0, 2, 0]], float)
PLY = """ply
format {form} 1.0
comment a square, its left half red
element vertex 4
property {real} x
property {real} y
property {real} z
property uchar red
property uchar green
property uchar blue
element face 1
property list uchar int vertex_indices
end_header
"""
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset>{unit}<up_axis>{up}_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert>
<diffuse><color>1 0.5 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="9">0 0 0 1 0 0 0 0 2</float_array><technique_common>
<accessor source="#pa" count="3" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles material="s" count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w"><node id="n"><translate>0 0 3</translate><instance_geometry url="#g">
<bind_material><technique_common><instance_material symbol="s" target="#m"/></technique_common></bind_material>
</instance_geometry></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>
"""


def ply(form: str, real: str = "float", color=(255, 0, 0)) -> bytes:
    head = PLY.format(form=form, real=real).encode()
    if form == "ascii":
        rows = [f"{x} {y} {z} {' '.join(map(str, color))}" for x, y, z in CORNERS]
        return head + "\n".join([*rows, "4 0 1 2 3", ""]).encode()
    order = "<" if "little" in form else ">"
    kind = "f" if real == "float" else "d"
    body = b"".join(struct.pack(f"{order}3{kind}3B", *corner, *color) for corner in CORNERS)
    return head + body + struct.pack(f"{order}B4i", 4, 0, 1, 2, 3)


@pytest.mark.parametrize("form", ["ascii", "binary_little_endian", "binary_big_endian"])
@pytest.mark.parametrize("real", ["float", "double"])
def test_quads_of_ply_are_triangles_in_the_colour_of_their_vertices(tmp_path, form, real):
    (tmp_path / "a.ply").write_bytes(ply(form, real))
    mesh = read_plain_asset(tmp_path / "a.ply", strict=True)
    corners = mesh.vertices[mesh.faces]
    assert np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).sum(axis=0) == pytest.approx(
        [0, 0, 4]
    )
    (material,) = mesh.materials
    assert material.diffuse == pytest.approx((1, 0, 0))


@needs_collada
@pytest.mark.parametrize(
    ("up", "unit", "low", "high"),
    [
        ("Y", "", (0, 0, 3), (1, 0, 5)),
        ("Z", '<unit name="centimeter" meter="0.01"/>', (0, 0.03, 0), (0.01, 0.05, 0)),
        ("X", "<unit meter='2'/>", (0, 0, 6), (0, 2, 10)),
    ],
)
def test_collada_is_in_metres_and_y_up(tmp_path, up, unit, low, high):
    (tmp_path / "a.dae").write_text(DAE.format(up=up, unit=unit))
    mesh = read_plain_asset(tmp_path / "a.dae", strict=True)
    assert mesh.vertices.min(axis=0) == pytest.approx(low)
    assert mesh.vertices.max(axis=0) == pytest.approx(high)
    (material,) = mesh.materials
    assert decode_srgb(np.array(material.diffuse)) == pytest.approx(decode_srgb(np.array([1, 0.5, 0])), abs=0.01)


def nodes(depth: int) -> bytes:
    """Return a scene that shows a geometry 2^depth times: each node has two instances of the next one."""
    text = DAE.format(up="Y", unit="")
    library = "".join(
        f'<node id="n{i}"><instance_node url="#n{i + 1}"/><instance_node url="#n{i + 1}"/></node>' for i in range(depth)
    )
    library += f'<node id="n{depth}"><instance_geometry url="#g"/></node>'
    text = text.replace("<library_visual_scenes>", f"<library_nodes>{library}</library_nodes><library_visual_scenes>")
    return text.replace(
        '<instance_geometry url="#g">\n', '<instance_node url="#n0"/><instance_geometry url="#g">\n'
    ).encode()


WHOLE = DAE.format(up="Y", unit="").encode()


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nend_header\n", "PLY|no triangles"),
        ("a.ply", ply("ascii").replace(b"1.0 2.0", b"nan 2.0"), "not finite"),
        ("a.ply", ply("ascii").split(b"element face")[0] + b"end_header\n" + b"0 0 0 1 1 1\n" * 4, "no triangles"),
        ("a.stl", b"solid a\nendsolid a\n", "STL|no triangles"),
        ("a.stl", bytes(84), "no triangles"),
        ("a.stl", bytes(80) + b"\x03\0\0\0" + bytes(60), "STL file of 3 triangles has 144 bytes, expected 234"),
        ("a.stl", b"solid a\nvertex 0 0 zero\nvertex 1 0 0\nvertex 0 1 0\n", "other words than numbers"),
        ("a.stl", b"solid a\nvertex 0 0 0\nvertex 1 0 0\n", "2 vertices, which are no triangles"),
        ("a.dae", b'<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>', "entities"),
        ("a.dae", b"PK\x03\x04" + bytes(99), "not an XML document in UTF-8"),
        ("a.dae", b'<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>'.decode().encode("utf-16"), "in UTF-8"),
        ("a.dae", WHOLE.replace(b'"1.0"', b'"1.0" encoding="UTF-7"'), "in UTF-8"),
        ("a.dae", WHOLE[:-20], "not an XML document"),
        ("a.dae", b"<svg/>", "expected a COLLADA document"),
        (
            "a.dae",
            b"<COLLADA>" + b"<geometry>" * 300 + b"</geometry>" * 300 + b"</COLLADA>",
            "more than 200 levels deep",
        ),
        ("a.dae", nodes(30), "instances show more than"),
        ("a.dae", nodes(2).replace(b'url="#n2"', b'url="#n0"'), "its own ancestor"),
        ("a.dae", WHOLE.replace(b'url="#g"', b'url="other.dae#g"'), r"instance of `other.dae#g`.*<instance_geometry>"),
        ("a.dae", WHOLE.replace(b"<instance_geometry", b'<instance_controller url="#c"/><instance_geometry'), "skins"),
        pytest.param(
            *("a.dae", WHOLE.replace(b'<instance_visual_scene url="#w"/>', b""), "DAE|no triangles"),
            marks=needs_collada,
        ),
        ("a.dae", WHOLE.replace(b"Y_UP", b"W_UP"), "expected an axis"),
        ("a.dae", WHOLE.replace(b"<up_axis>", b'<unit meter="-1"/><up_axis>'), "a unit in metres"),
    ],
)
def test_broken_files_are_typed_errors(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(DatasetError, match=message):
        read_plain_asset(tmp_path / name, strict=False)


@needs_collada
def test_instances_of_nodes_are_shown_once_each(tmp_path):
    (tmp_path / "a.dae").write_bytes(nodes(3))
    assert len(read_plain_asset(tmp_path / "a.dae", strict=True).faces) == 2**3 + 1


def test_a_long_unit_is_read_in_linear_time(tmp_path):
    unit = "<unit " + "meter " * 100_000
    with pytest.raises(DatasetError, match="not an XML document"):
        collada_frame(tmp_path / "a.dae", WHOLE.replace(b"<up_axis>", unit.encode() + b"<up_axis>"))


def test_an_image_of_ply_is_not_logged_as_an_error(tmp_path, caplog):
    (tmp_path / "a.ply").write_bytes(ply("ascii").replace(b"comment a", b"comment TextureFile none.png\ncomment a"))
    assert len(read_plain_asset(tmp_path / "a.ply", strict=True).faces) == 2
    assert not caplog.records


FACET = "facet normal 0 0 1\nouter loop\nvertex 0 0 {z}\nvertex 1.5E0 0 {z}\nvertex 0 +2. {z}\nendloop\nendfacet\n"
RECORD = struct.pack("<12fH", 0, 0, 1, 0, 0, 3, 1.5, 0, 3, 0, 2, 3, 0x801F)


@pytest.mark.parametrize(
    ("data", "heights"),
    [
        (f"solid a\n{FACET.format(z=0)}endsolid a\nsolid b\n{FACET.format(z=3)}endsolid b\n".encode(), [0, 3]),
        (f"  SOLID a\r\n{FACET.format(z=3).upper()}ENDSOLID".encode(), [3]),
        (b"solid, but binary".ljust(80) + b"\1\0\0\0" + RECORD, [3]),
        (bytes(80) + b"\2\0\0\0" + RECORD * 2 + b"more", [3, 3]),
    ],
    ids=["solids", "capitals", "binary", "trailing bytes"],
)
def test_text_and_binary_files_of_stl(tmp_path, data, heights):
    (tmp_path / "a.stl").write_bytes(data)
    mesh = read_plain_asset(tmp_path / "a.stl", strict=True)
    expected = [[[0, 0, z], [1.5, 0, z], [0, 2, z]] for z in heights]
    np.testing.assert_allclose(mesh.vertices[mesh.faces], expected)


def test_files_of_an_obj_are_its_libraries_and_their_images(tmp_path):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl oak\nf 1 2 3\n")
    (tmp_path / "a.mtl").write_text("newmtl oak\nmap_Kd wood.png\nnewmtl lost\nmap_Kd lost.png\n")
    Image.new("RGB", (2, 2), (9, 9, 9)).save(tmp_path / "wood.png")
    assert [path.name for path in asset_files(tmp_path / "a.obj")] == ["a.obj", "a.mtl", "wood.png"]
