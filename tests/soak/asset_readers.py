"""Files of meshes and lights as inputs of the fuzzer: rich glTF documents, USD, PLY, STL and COLLADA."""

import base64
import importlib
import json
import os
from pathlib import Path

import numpy as np
from PIL import Image
from scene_readers import Prepare, Read, reader_of

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], float)
QUAD = """point3f[] points = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]
int[] faceVertexCounts = [4, 3]
int[] faceVertexIndices = [0, 1, 2, 3, 0, 1, 2]
"""
USD = f"""#usda 1.0
(
metersPerUnit = 0.01
upAxis = "Z"
)
def Material "oak" {{
token outputs:surface.connect = </oak/s.outputs:surface>
def Shader "s" {{
uniform token info:id = "UsdPreviewSurface"
color3f inputs:diffuseColor = (1, 0.25, 0)
color3f inputs:emissiveColor = (1, 0, 0)
float inputs:opacity = 0.5
float inputs:metallic = 0.5
token outputs:surface
}}
}}
def Mesh "m" (prepend apiSchemas = ["MaterialBindingAPI"]) {{
{QUAD}
int[] holeIndices = [1]
texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] ( interpolation = "vertex" )
rel material:binding = </oak>
}}
def Mesh "painted" {{
{QUAD}
color3f[] primvars:displayColor = [(0, 0, 1), (1, 0, 0)] ( interpolation = "uniform" )
}}
def Capsule "c" {{
double height = 2
uniform token axis = "X"
}}
def PointInstancer "p" {{
rel prototypes = [ </c> ]
int[] protoIndices = [0, 0]
point3f[] positions = [(0, 0, 0), (1, 1, 1)]
quath[] orientations = [(1, 0, 0, 0), (1, 0, 0, 0)]
float3[] scales = [(1, 1, 1), (1, 1, 1)]
int64[] invisibleIds = [1]
}}
def RectLight "r" {{
float inputs:intensity = 100
float inputs:width = 1
bool inputs:normalize = 1
double3 xformOp:translate = (1, 2, 1)
uniform token[] xformOpOrder = ["xformOp:translate"]
}}
def PhysicsRevoluteJoint "j" {{
rel physics:body0 = </m>
rel physics:body1 = </painted>
float physics:lowerLimit = 0
float physics:upperLimit = 90
}}
"""
DAE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset> <unit meter="0.01"/> <up_axis>Z_UP</up_axis> </asset>
<library_geometries> <geometry id="g"> <mesh>
<source id="p"> <float_array id="pa" count="9"> 0 0 0 1 0 0 0 0 2 </float_array> <technique_common>
<accessor source="#pa" count="3" stride="3"> <param name="X" type="float"/> <param name="Y" type="float"/>
<param name="Z" type="float"/> </accessor> </technique_common> </source>
<vertices id="v"> <input semantic="POSITION" source="#p"/> </vertices>
<triangles material="s" count="1"> <input semantic="VERTEX" source="#v" offset="0"/> <p> 0 1 2 </p> </triangles>
</mesh> </geometry> </library_geometries>
<library_visual_scenes> <visual_scene id="w"> <node id="n"> <instance_geometry url="#g"/> </node> </visual_scene>
</library_visual_scenes>
<scene> <instance_visual_scene url="#w"/> </scene> </COLLADA>
"""
PLY = """ply
format ascii 1.0
comment odd
element vertex 4
property float x
property float y
property float z
property uchar red
property uchar green
property uchar blue
element face 2
property list uchar int vertex_indices
element tristrips 1
property list int int vertex_indices
end_header
0 0 0 255 0 0
1 0 0 255 0 0
1 1 0 0 0 9
0 1 0 0 0 9
4 0 1 2 3
3 0 1 2
5 0 1 2 -1 3
"""
STL = """solid a
facet normal 0 0 1
outer loop
vertex 0 0 0
vertex 1.5 0 0
vertex 0 2 0
endloop
endfacet
endsolid a
"""


def parts(folder: Path) -> tuple[list[bytes], Read]:
    """A flat with a skin, morph targets, instances, lights and maps, as a JSON document with its data in it."""
    from gltf_files import two_rooms
    from png_files import encoded

    from home_mjx.datasets.registry import open_dataset

    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    file, path = two_rooms(), folder / "data" / "flat.gltf"
    path.parent.mkdir()
    joints = {
        "JOINTS_0": file.accessor([[0, 1, 0, 0]] * 4, "uint8"),
        "WEIGHTS_0": file.accessor([[0.5, 0.5, 0, 0]] * 4),
    }
    index, moved = file.accessor([0, 1, 2, 0, 2, 3], "uint16"), file.accessor(CORNERS * 0.1)
    place = {"index": 0, "extensions": {"KHR_texture_transform": {"scale": [2, 2], "rotation": 1}}}
    maps = {"emissiveTexture": place, "emissiveFactor": [1, 0, 0], "normalTexture": place, "alphaMode": "MASK"}
    strength = {"KHR_materials_emissive_strength": {"emissiveStrength": 4}}
    shade = {"metallicRoughnessTexture": place, "metallicFactor": 0.5}
    file.add("materials", pbrMetallicRoughness=shade, extensions=strength, **maps)
    file.add("textures", source=0)
    file.add("images", bufferView=file.view(encoded(Image.new("RGB", (2, 2), (9, 99, 9)))), mimeType="image/png")
    mesh = file.mesh(CORNERS, attributes=joints, indices=index, targets=[{"POSITION": moved}], material=0)
    file.json["meshes"][mesh]["weights"] = [0.5]
    hand = file.node(root=False, rotation=[0, 0, 0.6, 0.8], scale=[2, 2, 2])
    arm = file.node(translation=[1, 1, 1], children=[hand])
    matrices = file.accessor(np.tile(np.eye(4).reshape(16), (2, 1)))
    file.add("skins", joints=[arm, hand], inverseBindMatrices=matrices)
    file.node(mesh=mesh, skin=0)
    spread = {"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": file.accessor(CORNERS), "SCALE": moved}}}
    file.node(mesh=mesh, extensions=spread)
    spot = {"type": "spot", "intensity": 100, "spot": {"innerConeAngle": 0.1, "outerConeAngle": 0.5}}
    file.json["extensions"] = {"KHR_lights_punctual": {"lights": [spot, {"type": "point", "color": [1, 0.5, 0]}]}}
    file.node(translation=[2, 2, 2], extensions={"KHR_lights_punctual": {"light": 0}})
    file.node(translation=[6, 2, 2], extensions={"KHR_lights_punctual": {"light": 1}})
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(file.data)).decode()
    text = json.dumps({**file.json, "buffers": [{"byteLength": len(file.data), "uri": uri}]})

    def read() -> object:
        dataset = open_dataset(f"gltf:{path}")
        return dataset.load_house(dataset.house_ids[0])

    return [text.encode()], reader_of(path, read)


def usd(folder: Path) -> tuple[list[bytes], Read]:
    importlib.import_module("pxr")
    from home_mjx.datasets.registry import open_dataset

    os.dup2(os.open(os.devnull, os.O_WRONLY), 2)  # the library writes each warning there
    os.environ["HOME_MJX_CACHE"] = str(folder / "cache")
    path = folder / "data" / "flat.usda"
    path.parent.mkdir()

    def read() -> object:
        from home_mjx.datasets.usd.lights import read_lights
        from home_mjx.datasets.usd.prims import PrimReader

        reader = PrimReader(open_dataset(f"usd:{path}")._open(path))
        return list(reader.read()), reader.joints, read_lights(reader.lights, 0.01, {})

    return [USD.encode()], reader_of(path, read)


def plain(name: str, *originals: bytes, package: str = "numpy") -> Prepare:
    """An asset without nodes."""

    def prepare(folder: Path) -> tuple[list[bytes], Read]:
        from home_mjx.datasets.habitat.plain.plain_assets import read_plain_asset

        importlib.import_module(package)
        path = folder / name
        return list(originals), reader_of(path, lambda: read_plain_asset(path, strict=False))

    return prepare


def binary_ply(order: str) -> bytes:
    """Polygons of mixed lengths in a byte order, little or big."""
    sign = "<" if order == "little" else ">"
    head = PLY.partition("end_header")[0].replace("ascii", f"binary_{order}_endian")
    head = head.replace("element tristrips 1\nproperty list int int vertex_indices\n", "")
    body = b"".join(row.astype(f"{sign}f4").tobytes() + bytes((255, 0, 9)) for row in CORNERS)
    faces = (bytes((len(face),)) + np.array(face, f"{sign}i4").tobytes() for face in ((0, 1, 2, 3), (0, 1, 2)))
    return head.encode() + b"end_header\n" + body + b"".join(faces)


def binary_stl() -> bytes:
    """One triangle."""
    return bytes(80) + b"\1\0\0\0" + np.arange(12, dtype="<f4").tobytes() + b"\0\0"
