"""Hinges against doors built around known ones; exported leaves against where the dataset's other state puts them."""

import tracemalloc

import mujoco
import numpy as np
import pytest
from cuboids import cuboid, turned
from door_states import other_state
from generated import generate_flats
from scipy.spatial import cKDTree

from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.read.hinges import find_hinges
from home_mjx.geometry.box_fit import sample_surface
from home_mjx.geometry.meshes import box_triangles, make_model, transform, triangles_z_up
from home_mjx.scene_compile.mjcf.export import to_mjcf
from home_mjx.scene_compile.objects.doors import _cut_out
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.agent import AgentBody

FRAME = (
    cuboid((-0.45, -0.05, 0), (-0.4, 0.05, 2.1)),
    cuboid((0.4, -0.05, 0), (0.45, 0.05, 2.1)),
    cuboid((-0.45, -0.05, 2.05), (0.45, 0.05, 2.1)),
)


def single(angle: float) -> np.ndarray:
    """A leaf with a handle on each side, hinged at its left edge."""
    leaf = np.concatenate(
        [
            cuboid((0, -0.04, 0.05), (0.78, 0, 2.0)),
            cuboid((0.64, 0.01, 1.0), (0.74, 0.03, 1.02)),
            cuboid((0.64, -0.07, 1.0), (0.74, -0.05, 1.02)),
        ]
    )
    return np.concatenate([*FRAME, turned(leaf, angle, (-0.39, 0.02, 0))])


def double(left: float, right: float) -> np.ndarray:
    leaves = [
        turned(cuboid((0, -0.02, 0.05), (0.397, 0.02, 2.0)), left, (-0.398, 0, 0)),
        turned(cuboid((-0.397, -0.02, 0.05), (0, 0.02, 2.0)), right, (0.398, 0, 0)),
    ]
    return np.concatenate([*FRAME, *leaves])


@pytest.mark.parametrize("degrees", [90.0, 47.5, -120.0, 10.0])
def test_hinge_is_the_one_that_the_door_was_built_on(degrees):
    angle = np.deg2rad(degrees)
    for shown, other, turn in ((single(angle), single(0.0), -angle), (single(0.0), single(angle), angle)):
        (hinge,) = find_hinges(shown, other)
        assert hinge.displacement == pytest.approx(turn, abs=0.01)
        np.testing.assert_allclose(hinge.pivot, (-0.39, 0.02), atol=0.003 / abs(np.sin(angle / 2)))
        assert hinge.leaf.tolist() == [False] * 36 + [True] * 36


def test_both_leaves_of_a_double_door_are_found():
    hinges = find_hinges(double(-1.2, 1.4), double(0.0, 0.0))
    found = sorted((float(h.pivot[0]), h.displacement) for h in hinges)
    np.testing.assert_allclose(found, [(-0.398, 1.2), (0.398, -1.4)], atol=0.01)
    assert not (hinges[0].leaf & hinges[1].leaf).any()


def slid(way: tuple[float, float]) -> np.ndarray:
    """A leaf with a handle, shifted in the plan from where it is shut."""
    leaf = np.concatenate([cuboid((-0.39, -0.02, 0.05), (0.39, 0.02, 2.0)), cuboid((0.3, 0.03, 1), (0.32, 0.05, 1.3))])
    return np.concatenate([*FRAME, leaf + np.array([*way, 0.0])])


@pytest.mark.parametrize("degrees", [0.0, 30.0])
@pytest.mark.parametrize("way", [-0.78, 0.4])
def test_a_leaf_that_was_shifted_along_itself_slides(way, degrees):
    """Also in a door that stands askew in its model, in which nothing has turned."""
    shown, other = (turned(door, np.deg2rad(degrees)) for door in (slid((way, 0.0)), slid((0.0, 0.0))))
    (found,) = find_hinges(shown, other)
    assert found.displacement == pytest.approx(abs(way), abs=1e-3)
    along = [np.cos(np.deg2rad(degrees)), np.sin(np.deg2rad(degrees))]
    np.testing.assert_allclose(found.slide, -np.sign(way) * np.array(along), atol=1e-3)
    assert found.leaf.tolist() == [False] * 36 + [True] * 24
    (back,) = find_hinges(other, shown)
    np.testing.assert_allclose(back.slide, -found.slide, atol=1e-3)


def test_both_leaves_of_a_sliding_door_move_apart():
    """In front of fixed panes, as in model 756 of SUNCG."""
    frame = [*FRAME, *(cuboid((x, -0.05, 0), (x + 0.78, -0.02, 2)) for x in (-1.6, 0.82))]

    def door(way):
        leaves = [cuboid((s * (0.4 + way) - 0.39, 0.0, 0.05), (s * (0.4 + way) + 0.39, 0.03, 2)) for s in (-1, 1)]
        return np.concatenate([*frame, *leaves])

    found = find_hinges(door(0.75), door(0.0))
    np.testing.assert_allclose(sorted(h.displacement * h.slide[0] for h in found), [-0.75, 0.75], atol=1e-3)


def test_doors_that_stay_or_are_taken_out_of_their_frames_have_no_hinge():
    assert find_hinges(single(0.0), single(0.0)) == ()
    assert find_hinges(slid((0.0, 0.5)), slid((0.0, 0.0))) == ()
    assert find_hinges(slid((0.05, 0.0)), slid((0.0, 0.0))) == ()


@pytest.mark.parametrize("size", [1e3, 1e7])
def test_a_door_in_a_wrong_unit_costs_no_memory(size):
    """Found by the fuzzer: billions of points stood for its surface."""
    tracemalloc.start()
    assert find_hinges(size * single(1.0), size * single(0.0)) == ()
    assert tracemalloc.get_traced_memory()[1] < 1 << 20
    tracemalloc.stop()


def _points_of(model, data, body):
    first = model.body_geomadr[body]
    points = []
    for geom in range(first, first + model.body_geomnum[body]):
        if model.geom_type[geom] == mujoco.mjtGeom.mjGEOM_MESH:
            mesh = model.geom_dataid[geom]
            vertex = model.mesh_vert[model.mesh_vertadr[mesh] :][: model.mesh_vertnum[mesh]]
            points.append(vertex @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
    return np.concatenate(points)


def _check_house(dataset, house_id):
    """Every leaf, turned to its closed angle in MuJoCo, covers the closed variant of its model."""
    house = dataset.load_house(house_id)
    compiled = compile_house(house, dataset.metadata)
    model = mujoco.MjModel.from_xml_string(*to_mjcf(compiled, agent=AgentBody()))
    data = mujoco.MjData(model)
    nodes = {}
    for level in house.levels:
        nodes |= {node.index: node for node in level.objects}
    doors = compiled.doors
    for row, instance in enumerate(doors.instance):
        object_id = compiled.instances.object_id[instance]
        name = f"object{object_id}_leaf{instance}"
        data.joint(name).qpos[:] = doors.closed[row]
    mujoco.mj_kinematics(model, data)
    for instance in doors.instance:
        object_id = compiled.instances.object_id[instance]
        node = nodes[object_id]
        closed = house.models[node.model_key] if node.model_key != node.model_id else other_state(dataset, node)
        surface = sample_surface(transform(compiled.instances.pose[instance], triangles_z_up(closed)), 0.02)
        away = cKDTree(surface).query(_points_of(model, data, model.body(f"object{object_id}_leaf{instance}").id))[0]
        assert np.quantile(away, 0.95) < 0.02
    return compiled, model


def test_leaves_of_generated_doors_close(tmp_path):
    ids = generate_flats(tmp_path / "houses", [5])
    dataset = open_dataset(tmp_path / "houses")
    compiled, _ = _check_house(dataset, ids[0])
    assert len(compiled.doors.instance) == compiled.report["hinged_leaves"] >= 3
    np.testing.assert_allclose(np.abs(compiled.doors.fully_open - compiled.doors.closed), np.pi / 2, atol=0.02)


@pytest.mark.real
def test_leaves_of_the_real_house_close(suncg_root):
    dataset = open_dataset(suncg_root)
    compiled, _ = _check_house(dataset, dataset.house_ids[0])
    assert len(compiled.doors.instance) == 3
    assert compiled.report["shut_leaves"] == 2  # of the two outer doors
    np.testing.assert_allclose(np.abs(np.rad2deg(compiled.doors.closed)), 49.2, atol=0.2)


def test_agent_pushes_a_leaf_open(tmp_path):
    """Walks straight at a closed leaf; the capsule's 60 kg turn its 13 kg without trouble."""
    ids = generate_flats(tmp_path / "houses", [5])
    dataset = open_dataset(tmp_path / "houses")
    compiled, model = _check_house(dataset, ids[0])
    data = mujoco.MjData(model)
    mujoco.mj_resetDataKeyframe(model, data, 0)
    leaf = next(model.joint(i) for i in range(model.njnt) if "_leaf" in model.joint(i).name)
    data.joint(leaf.name).qpos[:] = closed = compiled.doors.closed[0]
    mujoco.mj_kinematics(model, data)
    box = data.geom(leaf.name)
    normal = box.xmat.reshape(3, 3)[:, np.argmin(model.geom(leaf.name).size)].copy()
    start = box.xpos.copy()
    turned_by = []
    for side in (-1, 1):
        mujoco.mj_resetDataKeyframe(model, data, 0)
        data.joint(leaf.name).qpos[:] = closed
        at = start[:2] - side * 0.25 * normal[:2]
        data.joint("agent0_x").qpos[:], data.joint("agent0_y").qpos[:] = at
        for _ in range(400):
            data.ctrl[:2] = side * 60.0 * normal[:2]
            mujoco.mj_step(model, data)
        turned_by.append(abs(float(data.joint(leaf.name).qpos[0]) - closed))
    # It opens to one side only; from the other the stop holds.
    assert max(turned_by) > np.deg2rad(80)
    assert min(turned_by) < np.deg2rad(1)


def test_pieces_of_a_door_keep_its_normals(rng):
    """Those of the file, which are not recomputed from the faces of a piece."""
    triangles = box_triangles(np.zeros(3), np.array([0.4, 0.02, 1.0]))
    normal = rng.normal(size=(len(triangles), 3, 3))
    door = make_model("door", triangles, normal=normal / np.linalg.norm(normal, axis=-1, keepdims=True))
    kept = np.arange(len(triangles)) % 3 != 0
    piece = _cut_out(door, kept, "leaf")
    order = [int(np.flatnonzero((door.triangle == t).all(axis=(1, 2)))[0]) for t in piece.triangle]
    assert sorted(order) == np.flatnonzero(kept).tolist()
    np.testing.assert_array_equal(piece.normal, door.normal[order])
