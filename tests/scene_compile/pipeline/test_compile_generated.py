"""What must hold in every house, on some that the generator made."""

import numpy as np
import pytest
from generated import generate_flats
from house_checks import cell_points, crossed_partitions, mujoco_contacts, nearest, obstacle_points

from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.rotations import plane_matrix
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse
from home_mjx.schema.semantic import Semantic

TOUCH = 2e-4  # [m]: what lies on something touches it


@pytest.fixture(scope="module")
def houses(tmp_path_factory) -> list[CompiledHouse]:
    root = tmp_path_factory.mktemp("generated")
    ids = generate_flats(root, range(2))
    dataset = open_dataset(root)
    return [compile_house(dataset.load_house(i), dataset.metadata) for i in ids]


def test_all_rooms_are_connected(houses):
    for house in houses:
        assert set(house.navigation.room[house.navigation.home_mask].tolist()) == set(range(house.report["rooms"]))
        assert house.report["rooms"] >= 3


def test_nothing_of_the_meshes_is_in_free_space(houses):
    for house in houses:
        points = obstacle_points(house, ("curtain", "rug", "door"))
        assert nearest(points, cell_points(house)[house.navigation.home_mask]).min() > 0.15 - 0.01


def test_nobody_starts_where_a_leaf_may_stand(houses):
    """By dense samples of each leaf as placed, closed and wide open; where ways lead through, agents can stand."""
    for house in houses:
        doors, n = house.doors, house.navigation
        across = np.stack(np.meshgrid(*[np.linspace(-1, 1, 60)] * 2), axis=-1).reshape(-1, 2)
        samples = []
        for row in range(len(doors.instance)):
            for angle in (0.0, doors.closed[row], doors.fully_open[row]):
                yaw = 2 * np.arctan2(doors.quat[row, 3], doors.quat[row, 0])
                plan = across * doors.size[row, :2] @ plane_matrix(yaw).T + doors.pos[row, :2] - doors.pivot[row]
                samples.append(plan @ plane_matrix(angle).T + doors.pivot[row])
        samples = np.concatenate(samples)
        assert nearest(samples, n.start[:, :2]).min() > 0.1
        assert nearest(samples, n.goal[:, :2]).min() > 0.15 - 0.01
        assert nearest(samples, cell_points(house)[n.home_mask]).min() < n.cell / 2


def test_bodies_stand_free(houses):
    for house in houses:
        assert len(house.bodies.mass) > 0
        assert [c for c in mujoco_contacts(house) if c[2] < -TOUCH] == []


def test_a_way_through_a_wall_crosses_one_partition(houses):
    """From one side of a wall to the other, away from where walls meet: all copies of it are one."""
    for house in houses:
        planes, ways = house.planes, 0
        wall = abs(planes.normal[:, 2]) < 0.5
        for i in np.flatnonzero(wall):
            across = wall & (abs(planes.normal @ planes.normal[i]) < 0.1)
            for share in (-0.6, 0.0, 0.35):
                point = planes.center[i] + 0.9 * planes.axis_v[i] + share * planes.axis_u[i]  # above all openings
                gaps = abs(np.einsum("pd,pd->p", planes.center[across] - point, planes.normal[across]))
                if gaps.min() > 0.2:
                    way = point + 0.11 * planes.normal[i], point - 0.21 * planes.normal[i]
                    assert len(crossed_partitions(house, *way)) == 1
                    ways += 1
        assert ways > wall.sum()


def test_semantic_rows_name_their_instances(houses):
    for house in houses:
        rows = house.semantics[house.instances.semantic[1:]]
        np.testing.assert_array_equal(rows[:, Semantic.OBJECT_ID], house.instances.object_id[1:])
        np.testing.assert_array_equal(rows[:, Semantic.MOVABLE], house.instances.body[1:])
        # One instance per object, and one more for each leaf of its doors.
        leaves = len(house.doors.instance) + house.report["shut_leaves"]
        assert len(set(house.instances.object_id.tolist())) == len(house.instances.model) - leaves


def test_compiling_again_gives_the_same(houses, tmp_path):
    ids = generate_flats(tmp_path, [0])
    dataset = open_dataset(tmp_path)
    again = compile_house(dataset.load_house(ids[0]), dataset.metadata)
    for record, field in (("navigation", "start"), ("colliders", "pos"), ("bodies", "mass"), ("planes", "center")):
        a, b = (getattr(getattr(h, record), field) for h in (houses[0], again))
        assert a.tobytes() == b.tobytes()
    assert again.models.keys() == houses[0].models.keys()
