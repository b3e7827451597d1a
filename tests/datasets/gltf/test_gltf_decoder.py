"""Decoding of glTF: files written by hand, the shared sample, and trimesh as an oracle of plain scenes."""

import base64
import importlib.util
import json
from pathlib import Path

import numpy as np
import pytest
import trimesh
from gltf_files import CUBE, GltfFile, read_scene, triangles_of

from home_mjx.datasets.gltf.decode import primitives
from home_mjx.errors import DatasetError, MissingFileError

SAMPLE = Path(__file__).parents[4] / "shared" / "data" / "gltf_sample"
needs_sample = pytest.mark.skipif(not SAMPLE.is_dir(), reason="the shared glTF sample is not here")
SQUARE = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 0]]


@pytest.fixture
def read(tmp_path: Path):
    """Read a handmade file."""
    return lambda file, **options: read_scene(file.write(tmp_path / "scene.glb"), tmp_path / "images", **options)


def test_a_sparse_accessor_replaces_elements(read):
    file = GltfFile()
    mesh = file.mesh(SQUARE[:3])
    rows, values = file.view(np.array([2], "<u2").tobytes()), file.view(np.array([[0, 5, 0]], "<f4").tobytes())
    file.json["accessors"][0]["sparse"] = {
        "count": 1,
        "indices": {"bufferView": rows, "componentType": 5123},
        "values": {"bufferView": values},
    }
    file.node(mesh=mesh)
    assert triangles_of(read(file)[0]).tolist() == [[[0, 0, 0], [1, 0, 0], [0, 5, 0]]]
    del file.json["accessors"][0]["bufferView"]  # then all others are zero
    file.json["meshes"][0]["primitives"][0]["attributes"] = {"POSITION": 0, "NORMAL": file.accessor(SQUARE[:3])}
    assert read(file)[0] == []  # no triangle has an area


@pytest.mark.parametrize(
    ("mode", "expected"),
    [(5, [[0, 1, 2], [1, 3, 2], [2, 3, 4]]), (6, [[1, 2, 0], [2, 3, 0], [3, 4, 0]]), (4, [[0, 1, 2]])],
)
def test_strips_and_fans_are_wound_as_specified(read, mode, expected):
    points = np.random.default_rng(0).normal(size=(5, 3)).astype(np.float32)
    file = GltfFile()
    file.node(mesh=file.mesh(points, mode=mode))
    assert np.array_equal(triangles_of(read(file)[0]), points[np.array(expected)])


def test_points_and_lines_are_noted(read):
    file = GltfFile()
    file.node(mesh=file.mesh(SQUARE, mode=1))
    placed, reader = read(file)
    assert placed == []
    assert reader.notes == {"meshes[0].primitives[0]": "points and lines are not shown"}


def morphed(weights) -> GltfFile:
    """Return a triangle whose two targets raise and shift it, with weights of its mesh."""
    file = GltfFile()
    mesh = file.mesh(SQUARE[:3])
    targets = [{"POSITION": file.accessor([move] * 3)} for move in ([0, 0, 2], [4, 0, 0])]
    file.json["meshes"][mesh].update(weights=weights)
    file.json["meshes"][mesh]["primitives"][0]["targets"] = targets
    file.node(mesh=mesh)
    return file


@pytest.mark.parametrize(("weights", "move"), [([0.5, 0], [0, 0, 1]), ([-1, 0.25], [1, 0, -2]), ([0, 0], [0, 0, 0])])
def test_morph_targets_have_the_weights_of_their_mesh(read, weights, move):
    placed, reader = read(morphed(weights))
    np.testing.assert_allclose(triangles_of(placed)[0], np.array(SQUARE[:3]) + move)
    assert reader.notes == {}
    file = morphed(weights)
    file.json["nodes"][0]["weights"] = [1, 1]
    assert list(read(file)[1].notes) == ["nodes[0]"]


def test_weights_must_fit_their_targets(read):
    with pytest.raises(DatasetError, match=r"3 weights, its primitive 2 targets.*meshes\[0\]"):
        read(morphed([1, 1, 1]))


def test_primitives_without_positions_are_skipped(read):
    file = GltfFile()
    file.node(mesh=file.mesh(SQUARE[:3]))
    file.json["meshes"][0]["primitives"].append({"attributes": {}})
    placed, reader = read(file)
    assert len(triangles_of(placed)) == 1
    assert list(reader.notes) == ["meshes[0].primitives[1]"]


def test_strides_offsets_and_normalized_integers(read):
    """Positions in signed bytes with a stride, as KHR_mesh_quantization has them, beside 16-bit coordinates."""
    file = GltfFile()
    packed = b"".join(
        bytes([7, 7]) + np.array(p, "i1").tobytes() + b"\7" for p in ([127, 0, 0], [0, -128, 0], [0, 0, 64])
    )
    view = file.view(packed + bytes(2), byteStride=6)
    position = file.add(
        "accessors", bufferView=view, byteOffset=2, componentType=5120, count=3, type="VEC3", normalized=True
    )
    uv = file.accessor([[0, 65535], [65535, 0], [13107, 0]], "uint16", normalized=True)
    file.add("meshes", primitives=[{"attributes": {"POSITION": position, "TEXCOORD_0": uv}}])
    file.node(mesh=0)
    file.json["extensionsRequired"] = ["KHR_mesh_quantization"]
    (placed,), _ = read(file)
    assert np.allclose(placed.mesh.vertices, [[1, 0, 0], [0, -1, 0], [0, 0, 64 / 127]], atol=1e-12)
    assert np.allclose(placed.mesh.uv[0], [[0, 0], [1, 1], [0.2, 1]], atol=1e-12)


def test_texture_coordinates_of_the_second_set_are_moved_by_the_texture_transform(read):
    """Offset, then rotation by 90 degrees against the clock with v down, then scale."""
    file = GltfFile()
    file.add("images", bufferView=file.view(one_pixel()), mimeType="image/png")
    file.add("textures", source=0)
    moved = {"offset": [0.25, 0.5], "rotation": np.pi / 2, "scale": [2, 4], "texCoord": 1}
    texture = {"index": 0, "extensions": {"KHR_texture_transform": moved}}
    file.add("materials", pbrMetallicRoughness={"baseColorTexture": texture})
    sets = {
        "TEXCOORD_0": file.accessor([[9, 9]] * 3),
        "TEXCOORD_1": file.accessor([[0, 0], [1, 0], [0, 1]]),
    }
    file.node(mesh=file.mesh(SQUARE[:3], attributes=sets, material=0))
    (placed,), _ = read(file)
    # u' = 4 v + 0.25, v' = -2 u + 0.5 from the top
    assert np.allclose(placed.mesh.uv[0] * [1, -1] + [0, 1], [[0.25, 0.5], [0.25, -1.5], [4.25, 0.5]], atol=1e-6)
    (material,) = placed.mesh.materials
    assert material.texture is not None
    assert material.texture.read_bytes() == one_pixel()


def one_pixel() -> bytes:
    """Return a PNG of one red pixel."""
    text = "iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAIAAACQd1PeAAAADElEQVR4nGP4z8AAAAMBAQDJ/pLvAAAAAElFTkSuQmCC"
    return base64.b64decode(text)


def test_materials_keep_colour_gloss_and_opacity(read):
    """Factors are linear light, records sRGB: 0.214041 is 0.5 in sRGB."""
    file = GltfFile()
    plain = {"baseColorFactor": [0.214041, 0.0, 1.0, 0.25], "metallicFactor": 0.0, "roughnessFactor": 0.5}
    glass = {"KHR_materials_transmission": {"transmissionFactor": 0.9}}
    gloss = {"diffuseFactor": [1, 0, 0, 1], "specularFactor": [0.1, 0.2, 0.3], "glossinessFactor": 0.0}
    for material in (
        {"name": "paint", "pbrMetallicRoughness": plain},
        {"pbrMetallicRoughness": plain, "alphaMode": "BLEND"},
        {"extensions": glass},
        {"extensions": {"KHR_materials_pbrSpecularGlossiness": gloss}},
        {"extensions": {"KHR_materials_unlit": {}}},
        {"pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 0, 1], "metallicFactor": 1.0}},
    ):
        file.node(mesh=file.mesh(SQUARE[:3], material=file.add("materials", **material)))
    paint, blend, pane, glossy, unlit, gold = (m.mesh.materials[0] for m in read(file)[0])
    assert paint.name == "paint"
    assert np.allclose(paint.diffuse, [0.5, 0, 1], atol=1e-5)
    assert paint.opacity == 1
    assert np.allclose(paint.specular, 0.04)
    assert paint.shininess == pytest.approx(30)
    assert (blend.opacity, pane.opacity) == (0.25, pytest.approx(0.1))
    assert glossy.specular == (0.1, 0.2, 0.3)
    assert glossy.shininess == 1
    assert unlit.specular == (0, 0, 0)
    assert gold.specular == (1, 0.5, 0)


def test_vertex_colours_multiply_the_material_by_slots(read):
    file = GltfFile()
    colors = file.accessor([[1, 0, 0, 1]] * 3 + [[0, 1, 0, 1]] * 3)
    material = file.add("materials", pbrMetallicRoughness={"baseColorFactor": [1, 0.214041, 1, 1]})
    corners = [*SQUARE[:3], *SQUARE[1:]]
    file.node(mesh=file.mesh(corners, attributes={"COLOR_0": colors}, material=material))
    (placed,), _ = read(file)
    tints = np.array([placed.mesh.materials[slot].diffuse for slot in placed.mesh.slot])
    assert np.allclose(tints, [[1, 0, 0], [0, 0.5, 0]], atol=1e-5)


def test_nodes_apply_matrices_and_trs_from_the_root_down(read):
    """A quarter turn about z within a scaled and moved parent, and a mirror by a matrix."""
    file = GltfFile()
    half = float(np.sqrt(0.5))
    mesh = file.mesh([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    child = file.node(root=False, mesh=mesh, rotation=[0, 0, half, half], translation=[1, 0, 0])
    file.node(children=[child], scale=[2, 2, 2], translation=[0, 0, 10])
    mirror = np.diag([-1.0, 1, 1, 1])
    mirror[:3, 3] = [0, 5, 0]
    file.node(mesh=mesh, matrix=mirror.T.ravel().tolist())
    first, second = triangles_of(read(file)[0])
    assert np.allclose(first, [[2, 2, 10], [0, 0, 10], [2, 0, 12]], atol=1e-6)
    assert np.allclose(second, [[-1, 5, 0], [0, 6, 0], [0, 5, 1]], atol=1e-6)


def test_instances_of_a_node_are_turned_and_scaled_before_the_node_and_flat_ones_are_left_out(read, monkeypatch):
    file = GltfFile()
    half = float(np.sqrt(0.5))
    rows = {
        "TRANSLATION": file.accessor([[0, 0, 0], [0, 0, 7], [0, 0, 0]]),
        "ROTATION": file.accessor([[0, 0, 0, 1], [0, 0, half, half], [0, 0, 0, 1]]),
        "SCALE": file.accessor([[1, 1, 1], [2, 2, 2], [1, 0, 1]]),
    }
    mesh = file.mesh([[1, 0, 0], [0, 1, 0], [0, 0, 1]])
    many = {"EXT_mesh_gpu_instancing": {"attributes": rows}}
    file.node(mesh=mesh, translation=[10, 0, 0], extensions=many)
    file.json["extensionsRequired"] = ["EXT_mesh_gpu_instancing"]
    placed, reader = read(file)
    first, second = triangles_of(placed)
    assert list(reader.notes) == ["nodes[0]"]
    assert np.allclose(first, [[11, 0, 0], [10, 1, 0], [10, 0, 1]])
    assert np.allclose(second, [[10, 2, 7], [8, 0, 7], [10, 0, 9]], atol=1e-6)
    monkeypatch.setattr("home_mjx.datasets.gltf.decode.scene.MAX_SHOWN", 1)
    with pytest.raises(DatasetError, match="more than 1 triangles"):
        read(file)
    rows["SCALE"] = file.accessor([[1, 1, 1]])
    with pytest.raises(DatasetError, match="one length"):
        read(file)


def test_hidden_nodes_fallback_buffers_and_layers_of_materials(read):
    """The first box is hidden with its child; the second is compressed by meshopt, and as it is in the buffer."""
    file = GltfFile()
    child = file.node(root=False, mesh=file.mesh(CUBE))
    file.node(children=[child], extensions={"KHR_node_visibility": {"visible": False}})
    file.node(mesh=file.mesh(CUBE))
    file.json["extensionsRequired"] = ["KHR_node_visibility", "KHR_materials_clearcoat"]
    file.json["bufferViews"][1]["extensions"] = {"EXT_meshopt_compression": {"buffer": 0}}
    placed, reader = read(file)
    assert len(triangles_of(placed)) == 12
    assert reader.notes == {"nodes[1]": "node is not visible: left out"}


def test_embedded_files_do_not_count_as_json(tmp_path, monkeypatch):
    monkeypatch.setattr("home_mjx.datasets.gltf.decode.container.MAX_JSON_BYTES", 2000)
    file = GltfFile()
    file.node(mesh=file.mesh(np.tile(CUBE, (3, 1, 1))))
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(file.data)).decode()
    file.json["buffers"] = [{"byteLength": len(file.data), "uri": uri}]
    (tmp_path / "scene.gltf").write_text(json.dumps(file.json))
    assert len(triangles_of(read_scene(tmp_path / "scene.gltf", tmp_path)[0])) == 36
    file.json["asset"]["copyright"] = "x" * 2000
    (tmp_path / "scene.gltf").write_text(json.dumps(file.json))
    with pytest.raises(DatasetError, match="at most 2000"):
        read_scene(tmp_path / "scene.gltf", tmp_path)


def test_plain_scenes_are_as_trimesh_reads_them(tmp_path):
    """Instances at random rigid, scaled and mirrored poses, exported and read by trimesh."""
    rng = np.random.default_rng(3)
    scene = trimesh.Scene()
    for number in range(6):
        matrix = trimesh.transformations.random_rotation_matrix(rng.random(3))
        matrix[:3, :3] *= rng.uniform(0.5, 2) * (-1 if number == 5 else 1)
        matrix[:3, 3] = rng.normal(size=3)
        scene.add_geometry(trimesh.creation.icosphere(1), transform=matrix)
    path = tmp_path / "scene.glb"
    scene.export(path)
    mine = triangles_of(read_scene(path, tmp_path)[0])
    other = trimesh.load_scene(path).to_mesh()
    assert np.allclose(
        *(np.sort(np.sort(t.reshape(-1, 9), axis=1), axis=0) for t in (mine, other.triangles)), atol=1e-5
    )


def test_buffers_and_images_beside_the_file_and_in_data_uris(tmp_path):
    file = GltfFile()
    file.add("images", uri="pictures/a%20b.png")
    file.add("textures", source=0)
    file.add("materials", name="oak floor", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    file.node(mesh=file.mesh(SQUARE[:3], material=0))
    (tmp_path / "pictures").mkdir()
    (tmp_path / "pictures" / "a b.png").write_bytes(one_pixel())
    uri = "data:application/octet-stream;base64," + base64.b64encode(bytes(file.data)).decode()
    for name in ("mesh.bin", uri):
        file.json["buffers"] = [{"byteLength": len(file.data), "uri": name}]
        (tmp_path / "mesh.bin").write_bytes(bytes(file.data))
        (tmp_path / "scene.gltf").write_text(json.dumps(file.json))
        (placed,), _ = read_scene(tmp_path / "scene.gltf", tmp_path / "cache")
        texture = placed.mesh.materials[0].texture
        assert texture is not None
        assert texture.name.startswith("wood_")
        assert texture.parent == tmp_path / "cache"


@pytest.mark.parametrize(
    "uri",
    ["../secret.bin", "/etc/passwd", "http://example.org/a.bin", "file:///etc/passwd", "link.bin", "a\0b", "%2e%2e/x"],
)
def test_files_out_of_the_folder_are_refused(tmp_path, uri):
    (tmp_path / "secret.bin").write_bytes(bytes(36))
    folder = tmp_path / "scene"
    folder.mkdir()
    (folder / "link.bin").symlink_to(tmp_path / "secret.bin")
    file = GltfFile()
    file.node(mesh=file.mesh(SQUARE[:3]))
    file.json["buffers"] = [{"byteLength": 36, "uri": uri}]
    (folder / "scene.gltf").write_text(json.dumps(file.json))
    with pytest.raises(DatasetError, match=r"relative path|out of the folder") as caught:
        read_scene(folder / "scene.gltf", tmp_path)
    assert caught.value.element == "buffers[0].uri"


def cyclic(file: GltfFile) -> None:
    file.json["nodes"][0]["children"] = [0]


def broken(file: GltfFile, **changes) -> None:
    file.json["accessors"][0].update(changes)


CHANGES = {
    "ancestor": cyclic,
    "not finite": lambda f: f.data.__setitem__(slice(0, 4), np.float32(np.nan).tobytes()),
    "a finite number": lambda f: f.json["nodes"][0].update(translation=[float("nan"), 0, 0]),
    "expected an affine matrix": lambda f: f.json["nodes"][0].update(matrix=[1.0] * 16),
    "no length": lambda f: f.json["nodes"][0].update(rotation=[0, 0, 0, 0]),
    "end at byte": lambda f: broken(f, count=4),
    "no data": lambda f: (broken(f, count=30_000_000), f.json["accessors"][0].pop("bufferView")),
    "expected 1 to": lambda f: broken(f, count=0),
    "expected one of 5120": lambda f: broken(f, componentType=5130),
    "expected one of SCALAR": lambda f: broken(f, type="MAT2"),
    "three coordinates": lambda f: broken(f, type="VEC2"),
    "index into the 1 `meshes`": lambda f: f.json["nodes"][0].update(mesh=1),
    "index is beyond": lambda f: f.json["meshes"][0]["primitives"][0].update(indices=f.accessor([0, 1, 7], "uint8")),
    "expected a mode": lambda f: f.json["meshes"][0]["primitives"][0].update(mode=9),
    "coordinates up to": lambda f: f.data.__setitem__(slice(0, 4), np.float32(1e9).tobytes()),
    "got version": lambda f: f.json["asset"].update(version="1.0"),
    "needs a reader of glTF `2.1`": lambda f: f.json["asset"].update(version="2.1", minVersion="2.1"),
    "requires the extension `KHR_texture_basisu`": lambda f: f.json.update(extensionsRequired=["KHR_texture_basisu"]),
    "`EXT_meshopt_compression` is not supported": lambda f: (
        f.json["bufferViews"][0].update(extensions={"EXT_meshopt_compression": {}}),
        f.json.update(buffers=[{"byteLength": 36, "extensions": {"EXT_meshopt_compression": {"fallback": True}}}]),
    ),
    "a stride of 4 to 252": lambda f: f.json["bufferViews"][0].update(byteStride=3),
    "OPAQUE, MASK or BLEND": lambda f: (
        f.add("materials", alphaMode="HAZE"),
        f.json["meshes"][0]["primitives"][0].update(material=0),
    ),
}


@pytest.mark.parametrize("message", CHANGES)
def test_errors_name_the_file_and_mostly_the_element(read, tmp_path, message):
    file = GltfFile()
    file.node(mesh=file.mesh(SQUARE[:3]))
    CHANGES[message](file)
    with pytest.raises(DatasetError, match=message) as caught:
        read(file)
    assert caught.value.file == str(tmp_path / "scene.glb")
    assert caught.value.element


def test_a_flat_transform_leaves_its_node_out_and_a_shared_child_is_shown_twice(read):
    file = GltfFile()
    child = file.node(root=False, mesh=file.mesh(CUBE))
    file.node(children=[child], scale=[1, 0, 1])
    file.node(children=[child])
    file.node(children=[child], translation=[3, 0, 0])
    placed, reader = read(file)
    assert len(triangles_of(placed)) == 24
    assert list(reader.notes) == ["nodes[1]"]


def test_a_missing_image_is_a_fallback_or_strictly_an_error(read):
    file = GltfFile()
    file.add("images", uri="lost.png")
    file.add("textures", source=0)
    file.add("materials", pbrMetallicRoughness={"baseColorTexture": {"index": 0}})
    file.node(mesh=file.mesh(SQUARE[:3], material=0))
    (placed,), reader = read(file, strict=False)
    assert placed.mesh.materials[0].texture is None
    (fallback,) = reader.materials.images.fallbacks
    assert (fallback.kind, fallback.name, fallback.element) == ("texture", "lost.png", "images[0]")
    with pytest.raises(MissingFileError, match=r"missing.*images\[0\]"):
        read(file)


# Triangles and bounds (x, y, z; minimum and maximum) of the sample's README; None: not stated there.
COUNTS = {
    "draco/Box/glTF/Box.gltf": (12, [[-0.5, -0.5, 1.5], [0.5, 0.5, 2.5]]),
    "draco/Box/glTF_Binary/Box.glb": (12, [[-0.5] * 3, [0.5] * 3]),
    "draco/Triangle/glTF/Triangle_translation_only_matrix.gltf": (1, [[1, 0, 0], [2, 1, 0]]),
    "draco/one_face_123_mirror.gltf": (1, [[-3, None, None], [-1, None, None]]),
    "draco/CubeScaledInstances/glTF/cube_att.gltf": (48, [[-2, 0, None], [4, 6, None]]),
    "draco/KhronosSampleModels/SimpleSparseAccessor/glTF/SimpleSparseAccessor.gltf": (12, [[0, 0, 0], [6, 4, 0]]),
    "draco/KhronosSampleModels/UnlitTest/glTF/UnlitTest.gltf": (88, None),
    "draco/sphere.gltf": (224, [[-1] * 3, [1] * 3]),
    "draco/sphere_lights.gltf": (224, None),
    "trimesh/BoxInterleaved.glb": (12, None),
    "trimesh/BoxTextured.glb": (12, None),
    "trimesh/nested.glb": (36, [[-1.167, -2.337, None], [0.269, 1, None]]),
    "trimesh/no_indices_3storybuilding.glb": (72, [[None, 0, None], [None, 9, None]]),
    "trimesh/rgb_cube_with_primitives.gltf": (12, None),
    "trimesh/cubevc.glb": (48, None),
    "trimesh/pins.glb": (3408, None),
    "trimesh/empty_nodes.glb": (0, None),
}


@needs_sample
@pytest.mark.parametrize("name", COUNTS)
def test_the_sample_has_the_counts_and_bounds_of_its_readme(tmp_path, name):
    count, bounds = COUNTS[name]
    found = triangles_of(read_scene(SAMPLE / name, tmp_path)[0])
    assert len(found) == count
    if bounds is not None:
        stated = np.array(bounds, float)
        mine = np.stack([found.min(axis=(0, 1)), found.max(axis=(0, 1))])
        assert np.allclose(np.where(np.isnan(stated), mine, stated), mine, atol=1e-3)


@needs_sample
@pytest.mark.parametrize("name", ["draco/ZeroLengthBufferView", "trimesh/Mesh_PrimitiveMode_04.gltf"])
def test_a_sample_without_its_buffer_names_it(tmp_path, name):
    path = SAMPLE / name
    path = next(path.rglob("*.gltf")) if path.is_dir() else path
    with pytest.raises(MissingFileError, match=r"\.bin"):
        read_scene(path, tmp_path)


@needs_sample
def test_draco_is_decoded_or_refused_by_name(tmp_path):
    path = SAMPLE / "draco/Box/glTF_Binary/Box_Draco.glb"
    if importlib.util.find_spec("DracoPy") is None:
        with pytest.raises(DatasetError, match=r"KHR_draco_mesh_compression needs DracoPy.*\[gltf\]"):
            read_scene(path, tmp_path)
    else:
        found = triangles_of(read_scene(path, tmp_path)[0])
        assert len(found) == 12
        assert np.allclose(abs(found), 0.5, atol=1e-6)


def test_morph_targets_of_opposite_infinities_are_refused(tmp_path):
    file = GltfFile()
    far = [file.accessor(np.full((3, 3), sign * 1e30)) for sign in (1, -1)]
    file.node(mesh=file.mesh(np.eye(3), targets=[{"POSITION": row} for row in far]))
    file.json["meshes"][0]["weights"] = [1e300, 1e300]
    with pytest.raises(DatasetError, match="beyond all limits"), np.errstate(all="ignore"):
        read_scene(file.write(tmp_path / "a.glb"), tmp_path)


def test_rows_of_accessors_are_bounded_and_shared_ones_are_read_once(tmp_path, monkeypatch):
    monkeypatch.setattr(primitives, "MAX_ROWS", 12)
    file = GltfFile()
    shared, index = file.accessor(np.eye(3)), file.accessor([0, 1, 2], "uint16")
    part = {"attributes": {"POSITION": shared}, "indices": index}
    file.add("meshes", primitives=[part] * 20)
    file.node(mesh=0)
    (placed,), _ = read_scene(file.write(tmp_path / "a.glb"), tmp_path)
    assert len(placed.mesh.faces) == 20
    file.json["meshes"][0] |= {"primitives": [part | {"targets": [{"POSITION": shared}] * 3}], "weights": [1, 1, 1]}
    with pytest.raises(DatasetError, match="more than 12 rows"):
        read_scene(file.write(tmp_path / "b.glb"), tmp_path)
