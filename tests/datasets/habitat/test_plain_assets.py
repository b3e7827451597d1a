"""Assets without nodes, as files of their formats' specifications: PLY, COLLADA, and the images of OBJ files."""

import struct

import numpy as np
import pytest
from PIL import Image

from home_mjx.core.color import decode_srgb
from home_mjx.datasets.habitat.build import asset_files
from home_mjx.datasets.habitat.plain_assets import read_plain_asset
from home_mjx.errors import DatasetError

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


@pytest.mark.parametrize(
    ("up", "unit", "low", "high"),
    [
        ("Y", "", (0, 0, 3), (1, 0, 5)),
        ("Z", '<unit name="centimeter" meter="0.01"/>', (0, 0.03, 0), (0.01, 0.05, 0)),
        ("X", "<unit meter='2'/>", (0, 0, 6), (0, 2, 10)),
    ],
)
def test_collada_is_in_metres_and_y_up(tmp_path, up, unit, low, high):
    pytest.importorskip("collada", reason="pycollada is not installed")
    (tmp_path / "a.dae").write_text(DAE.format(up=up, unit=unit))
    mesh = read_plain_asset(tmp_path / "a.dae", strict=True)
    assert mesh.vertices.min(axis=0) == pytest.approx(low)
    assert mesh.vertices.max(axis=0) == pytest.approx(high)
    (material,) = mesh.materials
    assert decode_srgb(np.array(material.diffuse)) == pytest.approx(decode_srgb(np.array([1, 0.5, 0])), abs=0.01)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 9\nend_header\n", "PLY|no triangles"),
        ("a.dae", b'<!DOCTYPE a [<!ENTITY b "c">]><COLLADA/>', "entities"),
        ("a.ply", ply("ascii").replace(b"1.0 2.0", b"nan 2.0"), "not finite"),
    ],
)
def test_broken_files_are_typed_errors(tmp_path, name, data, message):
    (tmp_path / name).write_bytes(data)
    with pytest.raises(DatasetError, match=message):
        read_plain_asset(tmp_path / name, strict=False)


def test_files_of_an_obj_are_its_libraries_and_their_images(tmp_path):
    (tmp_path / "a.obj").write_text("mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl oak\nf 1 2 3\n")
    (tmp_path / "a.mtl").write_text("newmtl oak\nmap_Kd wood.png\nnewmtl lost\nmap_Kd lost.png\n")
    Image.new("RGB", (2, 2), (9, 9, 9)).save(tmp_path / "wood.png")
    assert [path.name for path in asset_files(tmp_path / "a.obj")] == ["a.obj", "a.mtl", "wood.png"]
