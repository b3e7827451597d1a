"""Skins of glTF files in the pose of their joints."""

import numpy as np
import pytest
from gltf_files import GltfFile, read_scene

from home_mjx.datasets.gltf.decode import skins
from home_mjx.datasets.gltf.decode.accessors import read_accessor
from home_mjx.errors import DatasetError

CORNERS = np.array([[0, 0, 0], [1, 0, 0], [0, 2, 0]], float)


def skinned(sets, weights, bind, **skin) -> GltfFile:
    """A triangle with two joints: one at x = 10, and its child turned by 90 degrees about z and doubled."""
    file = GltfFile()
    attributes = {f"JOINTS_{i}": file.accessor(rows, "uint8") for i, rows in enumerate(sets)}
    attributes |= {f"WEIGHTS_{i}": file.accessor(rows) for i, rows in enumerate(weights)}
    mesh = file.mesh(CORNERS, attributes=attributes)
    hand = file.node(root=False, rotation=[0, 0, 0.5**0.5, 0.5**0.5], scale=[2, 2, 2], translation=[0, 0, 1])
    arm = file.node(translation=[10, 0, 0], children=[hand])
    matrices = file.accessor(np.reshape(bind, (2, 16)))
    file.add("skins", **{"joints": [arm, hand], "inverseBindMatrices": matrices, **skin})
    file.node(mesh=mesh, skin=0, translation=[100, 100, 100], scale=[0.01, 0.01, 0.01])  # does not count
    return file


def test_vertices_follow_the_weights_of_their_joints_and_not_their_node(tmp_path):
    inverse = np.tile(np.eye(4), (2, 1, 1))
    inverse[1, 3, :3] = [-1, 0, 0]  # column-major: the hand is bound one metre along x
    joints = [[0, 1, 0, 0]] * 3
    weights = [[1, 0, 0, 0], [0, 1, 0, 0], [0.25, 0.75, 0, 0]]
    ((placed,), meshes) = read_scene(skinned([joints], [weights], inverse).write(tmp_path / "a.glb"), tmp_path)
    points = placed.mesh.vertices @ placed.matrix[:3, :3].T + placed.matrix[:3, 3]

    def hand(p):
        x, y, z = np.subtract(p, [1, 0, 0]) * 2
        return np.array([10 - y, x, z + 1])

    arm = CORNERS[2] + [10, 0, 0]
    expected = [[10, 0, 0], hand([1, 0, 0]), 0.25 * arm + 0.75 * hand(CORNERS[2])]
    np.testing.assert_allclose(points, expected, atol=1e-6)
    assert any("pose of its nodes" in note for note in meshes.notes.values())


def test_second_sets_of_joints_count_and_weights_are_normalized(tmp_path):
    zero, none = [[0, 0, 0, 0]] * 3, [[0.0] * 4] * 3
    second = [[1, 0, 0, 0]] * 3
    file = skinned([zero, second], [none, [[0.5, 0, 0, 0]] * 3], np.tile(np.eye(4), (2, 1, 1)))
    ((placed,), _) = read_scene(file.write(tmp_path / "a.glb"), tmp_path)
    np.testing.assert_allclose(placed.mesh.vertices[1], [10, 2, 1], atol=1e-6)


def test_nodes_share_the_poses_of_a_skin_and_have_the_name_of_its_mesh(tmp_path, monkeypatch):
    file = skinned([[[1, 0, 0, 0]] * 3], [[[1.0, 0, 0, 0]] * 3], np.tile(np.eye(4), (2, 1, 1)))
    file.json["meshes"][0]["name"] = "person"
    file.node(mesh=0, skin=0)
    read = []
    monkeypatch.setattr(skins, "read_accessor", lambda *given: read.append(given) or read_accessor(*given))
    placed, _ = read_scene(file.write(tmp_path / "a.glb"), tmp_path)
    assert [one.name for one in placed] == ["person", "person"]
    np.testing.assert_array_equal(placed[0].mesh.vertices, placed[1].mesh.vertices)
    assert len(read) == 1


@pytest.mark.parametrize(
    ("joint", "skin", "message"),
    [
        (7, {}, "beyond the 2"),
        (0, {"joints": [0, 1, 0]}, "each of the 3 joints"),
        (0, {"joints": [9, 1]}, "index into"),
    ],
)
def test_broken_skins_are_located(tmp_path, joint, skin, message):
    file = skinned([[[joint, 0, 0, 0]] * 3], [[[1.0, 0, 0, 0]] * 3], np.tile(np.eye(4), (2, 1, 1)), **skin)
    with pytest.raises(DatasetError, match=message):
        read_scene(file.write(tmp_path / "a.glb"), tmp_path)
