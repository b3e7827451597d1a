"""USD scenes as houses: files written here, and those of the shared sample; needs usd-core."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from gltf_files import BOXES
from PIL import Image

pytest.importorskip("pxr", reason="usd-core is not installed")

from home_mjx.datasets import open_dataset
from home_mjx.datasets.usd import prims
from home_mjx.datasets.usd.layers import open_scene
from home_mjx.datasets.usd.lights import read_lights
from home_mjx.datasets.usd.prims import PrimReader
from home_mjx.errors import DatasetError
from home_mjx.schema.house import House

SAMPLE = Path(__file__).parents[4] / "shared" / "data" / "usd_sample"
needs_sample = pytest.mark.skipif(not SAMPLE.is_dir(), reason="the shared USD sample is not here")
NO_POINTS = """def Mesh "a" {
point3f[] points = [(0,0,0)]
int[] faceVertexCounts = [3]
int[] faceVertexIndices = [0,1,2]
}"""
LOOK = """def Material "oak" {
token outputs:surface.connect = </oak/s.outputs:surface>
def Shader "s" {
uniform token info:id = "UsdPreviewSurface"
color3f inputs:diffuseColor = (1, 0.25, 0)
float inputs:opacity = 0.5
token outputs:surface
}
}
"""

BOUND_SPHERE = """def Sphere "a" (prepend apiSchemas = ["MaterialBindingAPI"]) {
rel material:binding = </oak>
}
"""


@pytest.fixture(autouse=True)
def cache(tmp_path, monkeypatch):
    monkeypatch.setenv("HOME_MJX_CACHE", str(tmp_path / "cache"))


def write(path: Path, body: str, head: str = 'upAxis = "Y"; metersPerUnit = 1') -> Path:
    path.write_text(f"#usda 1.0\n({head})\n{body}\n")
    return path


def boxes(scale: float = 1.0, z_up: bool = False) -> str:
    """Return the flat of two rooms as cubes of edge 2, placed and scaled."""
    text = ""
    for name, (low, high) in BOXES.items():
        middle, half = (np.array(low) + high) / 2 * scale, (np.array(high) - low) / 2 * scale
        if z_up:
            middle, half = middle[[0, 2, 1]] * [1, -1, 1], half[[0, 2, 1]]
        text += f'def Cube "{name.replace(".", "_")}" {{\ndouble size = 2\n'
        text += (
            f"double3 xformOp:translate = {tuple(middle.tolist())}\ndouble3 xformOp:scale = {tuple(half.tolist())}\n"
        )
        text += 'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n}\n'
    return text


def read(path: Path) -> House:
    dataset = open_dataset(f"usd:{path}")
    return dataset.load_house(dataset.house_ids[0])


@pytest.mark.parametrize(
    ("scale", "z_up", "head"),
    [(1, False, 'upAxis = "Y"; metersPerUnit = 1'), (100, True, 'upAxis = "Z"'), (0.1, False, "metersPerUnit = 10")],
)
def test_rooms_and_objects_are_in_metres_with_y_up(tmp_path, scale, z_up, head):
    (level,) = read(write(tmp_path / "flat.usda", boxes(scale, z_up), head)).levels
    assert [room.shape.ceiling for room in level.rooms] == pytest.approx([2.6, 2.6], abs=1e-4)
    found = {o.model_id: o.transform[:3, 3] for o in level.objects if o.model_id != "structure"}
    assert sorted(found) == ["chair", "dining_table"]
    assert found["chair"] == pytest.approx([1.25, 0.46, 1.25], abs=1e-4)


def points(path: Path) -> tuple[np.ndarray, PrimReader]:
    reader = PrimReader(open_scene(path))
    placed = list(reader.read())
    return np.concatenate([p.mesh.vertices @ p.matrix[:3, :3].T + p.matrix[:3, 3] for p in placed]), reader


def test_polygons_materials_hidden_prims_and_instances(tmp_path):
    quad = "point3f[] points = [(0,0,0),(1,0,0),(1,1,0),(0,1,0)]\nint[] faceVertexCounts = [4]\n"
    quad += 'int[] faceVertexIndices = [0,1,2,3]\nuniform token orientation = "leftHanded"\n'
    quad += 'texCoord2f[] primvars:st = [(0,0),(1,0),(1,1),(0,1)] (interpolation = "vertex")\n'
    bound = f'def Mesh "a" (prepend apiSchemas = ["MaterialBindingAPI"]) {{\n{quad}rel material:binding = </oak>\n}}\n'
    hidden = f'def Mesh "b" {{\n{quad}token visibility = "invisible"\n}}\n'
    one = 'def Xform "c" (instanceable = true; prepend references = </class>) {\ndouble3 xformOp:translate = (5,0,0)\n'
    one += 'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'
    kind = f'class Xform "class" {{\ndef Mesh "m" {{\n{quad}}}\n}}\n'
    path = write(tmp_path / "a.usda", LOOK + bound + hidden + kind + one)
    first, second = PrimReader(open_scene(path)).read()
    assert first.mesh.vertices[first.mesh.faces].tolist()[0] == [[0, 0, 0], [1, 1, 0], [1, 0, 0]]
    assert first.mesh.uv[0].tolist() == [[0, 0], [1, 1], [1, 0]]
    (material,) = first.mesh.materials
    assert (material.opacity, material.diffuse) == (0.5, pytest.approx((1, 0.537, 0), abs=1e-3))
    assert second.matrix[:3, 3].tolist() == [5, 0, 0]


def test_subsets_of_faces_have_materials_of_their_own_and_capsules_their_size(tmp_path):
    mesh = """def Mesh "a" (prepend apiSchemas = ["MaterialBindingAPI"]) {
point3f[] points = [(0,0,0),(1,0,0),(1,1,0),(0,1,0),(2,0,0),(3,0,0),(2,1,0)]
int[] faceVertexCounts = [4, 3]
int[] faceVertexIndices = [0,1,2,3,4,5,6]
color3f[] primvars:displayColor = [(0, 0, 1)]
def GeomSubset "s" (prepend apiSchemas = ["MaterialBindingAPI"]) {
uniform token elementType = "face"
uniform token familyName = "materialBind"
int[] indices = [%d]
rel material:binding = </oak>
}
}
def Capsule "b" {
double height = 2
double radius = 0.5
uniform token axis = "X"
}
"""
    first, second = PrimReader(open_scene(write(tmp_path / "a.usda", LOOK + mesh % 1))).read()
    assert first.mesh.slot.tolist() == [0, 0, 1]
    assert [material.name for material in first.mesh.materials] == ["display", "oak"]
    assert np.ptp(second.mesh.vertices, axis=0) == pytest.approx([3, 1, 1], abs=1e-3)
    with pytest.raises(DatasetError, match="indices of the 2 faces"):
        list(PrimReader(open_scene(write(tmp_path / "b.usda", LOOK + mesh % 2))).read())


def test_references_of_other_units_are_scaled(tmp_path):
    write(tmp_path / "part.usda", 'def Cube "cube" {\ndouble size = 2\n}', 'defaultPrim = "cube"; metersPerUnit = 0.01')
    body = 'def "box" (prepend references = @./part.usda@) {}\n'
    found, _ = points(write(tmp_path / "whole.usda", body))
    assert [found.min(), found.max()] == pytest.approx([-0.01, 0.01])


def cube(name: str, middle, half, inner: str = "") -> str:
    """Return a cube of half extents `half` around `middle`."""
    text = f'def Cube "{name}" {{\ndouble size = 2\ndouble3 xformOp:translate = {tuple(middle)}\n'
    text += f"double3 xformOp:scale = {tuple(half)}\n"
    return text + f'uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:scale"]\n{inner}}}\n'


def joint(kind: str, name: str, carrier: str, moved: str, **values: str) -> str:
    """Return a joint of UsdPhysics; values are attributes without their namespace."""
    bodies = enumerate((carrier, moved))
    named = "".join(f"rel physics:body{side} = <{path}>\n" for side, path in bodies if path)
    types = {"axis": "uniform token", "localRot0": "quatf", "localRot1": "quatf"}
    types |= dict.fromkeys(("localPos0", "localPos1"), "point3f")
    lines = "".join(f"{types.get(key, 'float')} physics:{key} = {text}\n" for key, text in values.items())
    return f'def Physics{kind}Joint "{name}" {{\n{named}{lines}}}\n'


def test_joints_of_physics_move_parts_of_their_objects(tmp_path):
    """A cupboard with a door on z, its handle fixed to it, and a drawer; a door on the wall; centimetres, Z up."""
    cupboard = cube("body", (0, 0, 50), (30, 20, 50)) + cube("leaf", (0, -21, 75), (30, 1, 25))
    cupboard += cube("tray", (0, -21, 25), (28, 1, 20)) + cube("grip", (25, -23, 75), (1, 1, 3))
    local = {"localPos0": "(-1, -1.05, 0.5)", "localPos1": "(-1, 0, 0)"}  # in units of the scaled cubes
    cupboard += joint("Revolute", "hinge", "/c/body", "/c/leaf", axis='"Z"', lowerLimit="-100", upperLimit="0", **local)
    cupboard += joint("Fixed", "grip_mount", "/c/leaf", "/c/grip")
    local = {"localPos0": "(0, -1.05, -0.5)", "localPos1": "(0, 0, 0)", "localRot0": "(0.7071068, 0, 0, -0.7071068)"}
    local["localRot1"] = local["localRot0"]
    cupboard += joint("Prismatic", "rail", "/c/body", "/c/tray", axis='"X"', lowerLimit="0", upperLimit="30", **local)
    body = 'def Xform "c" (kind = "component") {\ndouble3 xformOp:translate = (600, -30, 0)\n'
    body += f'uniform token[] xformOpOrder = ["xformOp:translate"]\n{cupboard}}}\n'
    body = body.replace('"c"', '"cupboard"').replace("/c/", "/cupboard/")
    body += cube("door", (400, -195, 105), (2, 44, 104))
    world = {"localPos0": "(400, -239, 0)", "localPos1": "(0, -1, 0)", "localRot1": "(0.9659258, 0, 0, -0.258819)"}
    body += joint("Revolute", "way", "", "/door", axis='"Z"', lowerLimit="-90", upperLimit="30", **world)
    house = read(write(tmp_path / "flat.usda", boxes(100, True) + body, 'upAxis = "Z"'))
    found = {o.model_id: o for o in house.levels[0].objects if o.joints}
    (item,) = [o for name, o in found.items() if name != "door"]
    hinge, rail = item.joints
    mesh = house.models[item.model_key]

    def place(points):
        return points @ item.transform[:3, :3].T + item.transform[:3, 3]

    assert place(np.array(hinge.point)) == pytest.approx([5.7, 0.75, 0.51], abs=1e-5)
    assert (hinge.axis, rail.axis) == (pytest.approx((0, 1, 0), abs=1e-6), pytest.approx((0, 0, 1), abs=1e-6))
    assert (hinge.low, hinge.high, rail.high) == pytest.approx((np.deg2rad(-100), 0, 30))  # in units of the model
    assert [len(faces) for faces in (hinge.faces, rail.faces, mesh.faces)] == [
        24,
        12,
        48,
    ]  # the grip moves with the leaf
    (way,) = found["door"].joints  # it is shown 30 degrees before the zero of its file, which is shut
    assert (way.low, way.high, way.closed) == pytest.approx(np.deg2rad([-60, 60, 30]), abs=1e-4)
    assert not [problem for problem in house.problems if "joint" in problem.message]


DOOR = cube("door", (4, 1.05, 1.95), (0.02, 1.04, 0.44))


@pytest.mark.parametrize(
    ("first", "second", "limits"), [("/World", "/World/door", (0, 90)), ("/World/door", "", (-90, 0))]
)
def test_a_joint_with_the_scene_or_the_world_moves_the_door_alone(tmp_path, first, second, limits):
    """Limits are for motions of the second body; the scene is above all objects, and carries none of them."""
    local = {"localPos0": "(4, 0, 2.39)", "localPos1": "(0, -1, 1)"}
    local = local if second else {"localPos0": "(0, -1, 1)", "localPos1": "(4, 0, 2.39)"}
    way = joint("Revolute", "way", first, second, axis='"Y"', lowerLimit="0", upperLimit="90", **local)
    house = read(write(tmp_path / "flat.usda", f'def Xform "World" {{\n{boxes()}{DOOR}{way}}}'))
    (found,) = [o for o in house.levels[0].objects if o.joints]
    (moved,) = found.joints
    assert found.model_id == "door"
    assert (moved.low, moved.high) == pytest.approx(np.deg2rad(limits), abs=1e-5)


def test_joints_without_bodies_or_limits_are_noted(tmp_path):
    joints = joint("Prismatic", "rail", "", "/door", axis='"Y"') + joint("Revolute", "far", "/none", "/door")
    joints += joint("Revolute", "bare", "", "") + joint("Fixed", "screw", "", "/door")
    house = read(write(tmp_path / "flat.usda", boxes() + DOOR + joints))
    noted = {problem.element for problem in house.problems if "joint" in problem.message}
    assert noted == {"/rail", "/far", "/bare"}


def textured(*inputs: str, files: tuple[str, ...] = ("none.png",)) -> str:
    """Return two triangles of a material whose inputs are fed by the images of these names, in turn."""
    feeds = "".join(f"color3f inputs:{key}.connect = </oak/t{i}.outputs:rgb>\n" for i, key in enumerate(inputs))
    shader = f'def Shader "s" {{\nuniform token info:id = "UsdPreviewSurface"\n{feeds}token outputs:surface\n}}\n'
    for i, name in enumerate(files):
        shader += f'def Shader "t{i}" {{\nuniform token info:id = "UsdUVTexture"\n'
        shader += f"asset inputs:file = @./{name}@\nfloat3 outputs:rgb\n}}\n"
    mesh = NO_POINTS.replace("(0,0,0)", "(0,0,0),(1,0,0),(0,1,0)").replace(
        '"a"', '"a" (prepend apiSchemas = ["MaterialBindingAPI"])'
    )
    mesh = mesh.replace("{\n", "{\nrel material:binding = </oak>\n", 1)
    look = f'def Material "oak" {{\ntoken outputs:surface.connect = </oak/s.outputs:surface>\n{shader}}}\n'
    return look + mesh + "\n" + mesh.replace('"a"', '"b"', 1)


def test_a_missing_texture_is_one_fallback(tmp_path):
    _, reader = points(write(tmp_path / "a.usda", textured("diffuseColor")))
    assert [fallback.name for fallback in reader.materials.fallbacks] == ["./none.png"]


def test_a_broken_image_of_emission_is_a_fallback_and_does_not_glow(tmp_path):
    Image.fromarray(np.random.default_rng(0).integers(0, 255, (64, 64, 3), np.uint8)).save(tmp_path / "whole.png")
    data = (tmp_path / "whole.png").read_bytes()
    (tmp_path / "cut.png").write_bytes(data[: len(data) // 2])
    files = ("whole.png", "cut.png")
    reader = PrimReader(open_scene(write(tmp_path / "a.usda", textured("diffuseColor", "emissiveColor", files=files))))
    (material,) = {placed.mesh.materials[0] for placed in reader.read()}
    assert material.texture == tmp_path / "whole.png"
    assert material.maps is None
    (fallback,) = reader.materials.fallbacks
    assert (fallback.name, fallback.replacement) == ("./cut.png", "no emission")


def test_lost_images_that_only_exports_use_are_notes(tmp_path):
    _, reader = points(write(tmp_path / "a.usda", textured("normal", "occlusion", files=("none.png", "map.exr"))))
    assert reader.materials.fallbacks == []
    assert list(reader.materials.notes) == ["/oak/t0", "/oak/t1"]


@pytest.mark.parametrize(
    ("body", "head", "message"),
    [
        ('def "a" (prepend references = @../../etc/a.usda@) {}', "", "leads out of"),
        ('def "a" (prepend references = @/etc/a.usda@) {}', "", "expected a relative path"),
        ('def "a" (prepend references = @http://host/a.usda@) {}', "", "expected a relative path"),
        ("def Cube", "", "not a USD layer"),
        ('def Cube "a" {}', 'upAxis = "X"', "not legal"),
        ('def Cube "a" {}', "metersPerUnit = 0", "out of range"),
        (NO_POINTS, "", "indices of the 1 points"),
        ('def Xform "a" {}', "", "shows nothing"),
    ],
)  # fmt: skip
def test_broken_scenes_are_refused(tmp_path, body, head, message):
    with pytest.raises(DatasetError, match=message):
        read(write(tmp_path / "a.usda", body, head))


@needs_sample
def test_axes_units_and_the_teapot_of_the_sample(tmp_path):
    """Its files name others as in the repository that they are from, where they are one folder deeper."""
    shutil.copytree(SAMPLE / "stage_configuration", tmp_path / "foundation" / "stage_configuration")
    shutil.copytree(SAMPLE / "_common", tmp_path / "_common")
    for name in ("upAxis_Y", "upAxis_Z", "upAxis_invalid"):
        scene = open_scene(next(tmp_path.rglob(f"{name}.usda")), tmp_path)
        assert ("upAxis" in scene.notes) == (name == "upAxis_invalid")
        assert len(scene.layers) == 2
        assert list(PrimReader(scene).read())
    with pytest.raises(DatasetError, match="not legal"):
        open_scene(next(tmp_path.rglob("upAxis_X.usda")), tmp_path)
    found, _ = points(SAMPLE / "Teapot" / "Teapot.usd")
    assert [found.min(axis=0), found.max(axis=0)] == [
        pytest.approx([-0.153, 0, -0.262], abs=0.02),
        pytest.approx([0.153, 0.230, 0.229], abs=0.02),
    ]


def test_lights_have_the_power_of_their_surfaces_and_hang_on_objects(tmp_path):
    lights = """
def RectLight "panel" {
float inputs:width = 0.5
float inputs:height = 0.4
float inputs:intensity = 100
float inputs:exposure = 10
double3 xformOp:translate = (2, 2.4, 2)
float xformOp:rotateX = -90
uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:rotateX"]
}
def SphereLight "bulb" {
float inputs:radius = 0.1
bool inputs:normalize = true
float inputs:intensity = 6830
double3 xformOp:translate = (2, 1, 2)
uniform token[] xformOpOrder = ["xformOp:translate"]
}
def DomeLight "sky" {}
"""
    house = read(write(tmp_path / "flat.usda", boxes() + lights))
    panel, bulb = sorted(
        ((light, o) for level in house.levels for o in level.objects for light in o.lights),
        key=lambda p: p[0].kind,
        reverse=True,
    )
    assert (panel[0].kind, bulb[0].kind) == ("spot", "point")
    assert panel[0].power == pytest.approx(np.pi * 100 * 2**10 * 0.2 / 683)
    assert bulb[0].power == pytest.approx(np.pi * 6830 / 683)
    aim = panel[1].transform[:3, :3] @ np.array(panel[0].direction)
    np.testing.assert_allclose(aim / np.linalg.norm(aim), [0, -1, 0], atol=1e-6)
    assert any("DomeLight" in p.message for p in house.problems)


def test_animated_scenes_are_read_at_their_first_sample(tmp_path):
    body = 'def Cube "a" {\ndouble size.timeSamples = { 5: 4, 9: 8 }\n'
    body += "double3 xformOp:translate.timeSamples = { 5: (1, 0, 0), 9: (7, 0, 0) }\n"
    body += 'token visibility.timeSamples = { 5: "inherited", 9: "invisible" }\n'
    found, _ = points(write(tmp_path / "a.usda", body + 'uniform token[] xformOpOrder = ["xformOp:translate"]\n}\n'))
    assert [found.min(axis=0).tolist(), found.max(axis=0).tolist()] == [[-1, -2, -2], [3, 2, 2]]


def test_inputs_of_materials_feed_shaders_and_images_are_beside_the_layer_that_names_them(tmp_path):
    (tmp_path / "parts").mkdir()
    Image.new("RGB", (2, 2), (9, 9, 9)).save(tmp_path / "parts" / "wood.png")
    part = textured("diffuseColor", files=("wood.png",)).replace(
        'def Material "oak" {', 'def Material "oak" {\nasset inputs:image = @./wood.png@\nfloat inputs:metal = 0.5'
    )
    part = part.replace("asset inputs:file = @./wood.png@", "asset inputs:file.connect = </oak.inputs:image>")
    part = part.replace("color3f inputs", "float inputs:metallic.connect = </oak.inputs:metal>\ncolor3f inputs", 1)
    part = part.replace("</oak", "</all/oak")
    write(
        tmp_path / "parts" / "part.usda", f'def Xform "all" {{\n{part}\n}}\n', 'defaultPrim = "all"; metersPerUnit = 1'
    )
    body = 'def "box" (prepend references = @./parts/part.usda@) {}\n'
    reader = PrimReader(open_scene(write(tmp_path / "a.usda", body)))
    (material,) = {placed.mesh.materials[0] for placed in reader.read()}
    assert material.texture == tmp_path / "parts" / "wood.png"
    assert material.maps.metallic == 0.5
    assert reader.materials.fallbacks == []


POINT_INSTANCER = """def Xform "shelf" {
double3 xformOp:translate = (10, 0, 0)
uniform token[] xformOpOrder = ["xformOp:translate"]
def PointInstancer "books" {
rel prototypes = [</shelf/books/kinds/thin>, </shelf/books/kinds/thick>]
int[] protoIndices = [0, 1, 1, 0]
point3f[] positions = [(0, 0, 0), (0, 5, 0), (0, 9, 0), (0, 0, 7)]
quath[] orientations = [(1, 0, 0, 0), (0.7071, 0, 0, 0.7071), (1, 0, 0, 0), (1, 0, 0, 0)]
float3[] scales = [(1, 1, 1), (2, 1, 1), (1, 1, 1), (1, 1, 1)]
int64[] invisibleIds = [2]
def Scope "kinds" {
def Cube "thin" {
double size = 1
}
def Cube "thick" {
double size = 2
double3 xformOp:translate = (1, 0, 0)
uniform token[] xformOpOrder = ["xformOp:translate"]
}
}
}
}
"""


def test_point_instancers_show_the_prototypes_of_their_visible_instances_alone(tmp_path):
    placed = list(PrimReader(open_scene(write(tmp_path / "a.usda", POINT_INSTANCER))).read())
    middles = [one.mesh.vertices.mean(axis=0) @ one.matrix[:3, :3].T + one.matrix[:3, 3] for one in placed]
    np.testing.assert_allclose(middles, [[10, 0, 0], [10, 7, 0], [10, 0, 7]], atol=2e-3)
    assert len({one.chain[-2].element for one in placed}) == 3
    broken = POINT_INSTANCER.replace("[0, 1, 1, 0]", "[0, 1, 2, 0]")
    with pytest.raises(DatasetError, match="do not fit their positions"):
        list(PrimReader(open_scene(write(tmp_path / "b.usda", broken))).read())


@pytest.mark.parametrize("axis", "XYZ")
def test_planes_have_the_extent_that_usd_computes_and_face_along_their_axis(tmp_path, axis):
    from pxr import Usd, UsdGeom

    body = f'def Plane "a" {{\ndouble width = 2\ndouble length = 4\nuniform token axis = "{axis}"\n}}\n'
    scene = open_scene(write(tmp_path / "a.usda", body))
    (placed,) = PrimReader(scene).read()
    plane = UsdGeom.Plane(scene.stage.GetPrimAtPath("/a"))
    extent = UsdGeom.Boundable.ComputeExtentFromPlugins(plane, Usd.TimeCode.Default())
    vertices = placed.mesh.vertices
    np.testing.assert_allclose([vertices.min(axis=0), vertices.max(axis=0)], extent)
    a, b, c = vertices[placed.mesh.faces].transpose(1, 0, 2)
    np.testing.assert_allclose(np.cross(b - a, c - a), [8.0 * np.eye(3)["XYZ".index(axis)]] * 2)


def test_holes_other_geometry_and_other_shaders_are_left_out_or_noted(tmp_path):
    body = """def Material "mdl" {
}
def Xform "x" (prepend apiSchemas = ["MaterialBindingAPI"]) {
rel material:binding:full = </mdl>
color3f[] primvars:displayColor = [(0, 1, 0)]
def Mesh "a" {
point3f[] points = [(0,0,0),(1,0,0),(1,1,0),(0,1,0),(2,0,0)]
int[] faceVertexCounts = [4, 3]
int[] faceVertexIndices = [0,1,2,3,1,4,2]
int[] holeIndices = [0]
texCoord2f[] primvars:UVMap = [(0,0),(1,0),(1,1),(0,1),(0.5,0.25)] (interpolation = "vertex")
}
}
def BasisCurves "hair" {}
"""
    reader = PrimReader(open_scene(write(tmp_path / "a.usda", body)))
    (placed,) = reader.read()
    assert placed.mesh.vertices.tolist() == [[1, 0, 0], [2, 0, 0], [1, 1, 0]]
    assert placed.mesh.uv.tolist() == [[[1, 0], [0.5, 0.25], [1, 1]]]
    assert placed.mesh.materials[0].diffuse == (0, 1, 0)
    assert set(reader.materials.notes) == {"/mdl", "/hair"}


@pytest.mark.parametrize(
    ("interpolation", "colors"),
    [
        ("uniform", "(1,0,0),(0,0,1),(9,9,9)"),
        ("vertex", "(1,0,0),(1,0,0),(1,0,0),(1,0,0),(0,0,1),(0,0,1),(0,0,1)"),
        ("faceVarying", "(1,0,0),(1,0,0),(1,0,0),(1,0,0),(0,0,1),(0,0,1),(0,0,1),(9,9,9),(9,9,9),(9,9,9)"),
    ],
)
def test_display_colours_of_faces_vertices_and_corners_are_slots(tmp_path, interpolation, colors):
    """A red quad, a blue triangle, and a triangle with a material of its own."""
    body = f"""{LOOK}def Mesh "a" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
point3f[] points = [(0,0,0),(1,0,0),(1,1,0),(0,1,0),(2,0,0),(3,0,0),(2,1,0)]
int[] faceVertexCounts = [4, 3, 3]
int[] faceVertexIndices = [0,1,2,3,4,5,6,4,6,5]
color3f[] primvars:displayColor = [{colors}] (interpolation = "{interpolation}")
def GeomSubset "s" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
uniform token elementType = "face"
uniform token familyName = "materialBind"
int[] indices = [2]
rel material:binding = </oak>
}}
}}
"""
    (placed,) = PrimReader(open_scene(write(tmp_path / "a.usda", body))).read()
    shown = [placed.mesh.materials[slot] for slot in placed.mesh.slot]
    assert [material.name for material in shown] == ["display"] * 3 + ["oak"]
    assert [material.diffuse for material in shown[:3]] == [(1, 0, 0), (1, 0, 0), (0, 0, 1)]


@pytest.mark.parametrize(
    ("text", "element"),
    [
        ('def Sphere "a" {\nstring radius = "x"\n}', "/a.radius"),
        ('def Sphere "a" {\ndouble radius = nan\n}', "/a"),
        (
            'def Sphere "a" {\nstring xformOp:translate = "x"\nuniform token[] xformOpOrder = ["xformOp:translate"]\n}',
            "/a",
        ),
        ('def Sphere "a" {\ncolor3f primvars:displayColor = (1, 0, 0)\n}', "/a.primvars:displayColor"),
        (
            BOUND_SPHERE + LOOK.replace("color3f inputs:diffuseColor = (1, 0.25, 0)", "float inputs:diffuseColor = 1"),
            "/oak/s",
        ),
        (
            BOUND_SPHERE + LOOK.replace("float inputs:opacity = 0.5", 'string inputs:opacity = "x"'),
            "/oak/s.inputs:opacity",
        ),
    ],
)
def test_values_of_other_types_than_the_schema_are_located(tmp_path, text, element):
    with pytest.raises(DatasetError) as caught:
        list(PrimReader(open_scene(write(tmp_path / "a.usda", text))).read())
    assert str(caught.value.element).startswith(element)


def test_texture_coordinates_of_three_numbers_lose_the_third(tmp_path):
    mesh = NO_POINTS.replace("[(0,0,0)]", "[(0,0,0),(1,0,0),(0,1,0)]").removesuffix("}")
    mesh += 'texCoord3f[] primvars:st = [(0,0,9),(1,0,9),(0,1,9)] (interpolation = "vertex")\n}'
    (placed,) = PrimReader(open_scene(write(tmp_path / "a.usda", mesh))).read()
    assert placed.mesh.uv[0].tolist() == [[0, 0], [1, 0], [0, 1]]


def test_triangles_of_instances_are_counted_and_prototypes_read_once(tmp_path, monkeypatch):
    text = 'def Cube "c" {\n}\ndef PointInstancer "p" {\nrel prototypes = [</c>]\nint[] protoIndices = [0, 0, 0]\n'
    text += "point3f[] positions = [(0,0,0),(3,0,0),(6,0,0)]\n}"
    path = write(tmp_path / "a.usda", text)
    placed = list(PrimReader(open_scene(path)).read())
    assert (len(placed), len({id(one.mesh) for one in placed})) == (4, 1)
    monkeypatch.setattr(prims, "MAX_SHOWN", 47)
    with pytest.raises(DatasetError, match="more than 47 triangles"):
        list(PrimReader(open_scene(path)).read())


def test_normalized_lights_are_divided_by_the_area_in_units_of_the_scene(tmp_path):
    text = (
        'def SphereLight "a" {\nfloat inputs:radius = 20\nfloat inputs:intensity = 6830\nbool inputs:normalize = %d\n}'
    )
    powers = []
    for flag in (1, 0):
        reader = PrimReader(open_scene(write(tmp_path / f"{flag}.usda", text % flag, "metersPerUnit = 0.01")))
        list(reader.read())
        (light,) = read_lights(reader.lights, 0.01, {})
        powers.append(light.light.power)
    assert powers[1] / powers[0] == pytest.approx(4 * np.pi * 20**2)
    assert powers[1] == pytest.approx(np.pi * 10 * 4 * np.pi * 0.2**2)


def test_bytes_that_are_no_text_are_located(tmp_path):
    path = tmp_path / "a.usda"
    path.write_bytes(b'#usda 1.0\ndef \x9c "a" {}\n')
    with pytest.raises(DatasetError, match="not UTF-8"):
        open_scene(path)


def test_lights_from_before_inputs_had_a_prefix_have_the_same_power(tmp_path):
    new = 'def RectLight "a" {\nfloat inputs:width = 2\nfloat inputs:intensity = 50\n'
    new += "color3f inputs:color = (1, 0.5, 0)\n}"
    powers = []
    for name, text in (("new", new), ("old", new.replace("inputs:", ""))):
        reader = PrimReader(open_scene(write(tmp_path / f"{name}.usda", text)))
        list(reader.read())
        (light,) = read_lights(reader.lights, 1.0, {})
        powers.append((light.light.power, light.light.color))
    assert powers[0] == powers[1]
    assert powers[0][0] == pytest.approx(np.pi * 50 * 2 / 683)
