"""Doorways of generated houses against the plans that they were made from."""

import numpy as np
import pytest
from door_states import other_state, with_doors
from generated import generate_flats
from scipy.spatial import cKDTree

from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.box_fit import sample_surface
from home_mjx.geometry.meshes import transform, triangles_z_up
from home_mjx.scene_compile.architecture.rooms import find_frame
from home_mjx.scene_compile.objects.doorways import find_doorways, shut_outer_doors
from home_mjx.scene_compile.objects.placed_objects import place_objects


@pytest.fixture(scope="module")
def dataset(tmp_path_factory):
    root = tmp_path_factory.mktemp("generated")
    generate_flats(root, range(2))
    return open_dataset(root)


@pytest.fixture(params=range(2))
def house(dataset, request):
    """All doors stand open, the entrance too."""
    house = dataset.load_house(dataset.house_ids[request.param])
    return with_doors(dataset, house, closed=False)


def test_only_the_entrance_leads_outdoors(dataset, house):
    frame = find_frame(house)
    objects = place_objects(frame, dataset.metadata)
    doorways = find_doorways(objects, frame.rooms)
    assert [d.leaf for d in doorways] == [(i, -1) for i in range(len(doorways))]
    outer = [d for d in doorways if d.leads_outdoors]
    assert len(outer) == 1
    members = [room.members for room in house.levels[0].rooms]
    doors = [o for o in objects if o.info.coarse == "door"]
    for doorway, item in zip(doorways, doors, strict=True):
        owners = {i for i, nodes in enumerate(members) if item.node.index in nodes}
        assert owners <= set(doorway.room)


def test_outer_doors_are_shut_as_their_closed_variant(dataset, house):
    frame = find_frame(house)
    before = place_objects(frame, dataset.metadata)
    after = shut_outer_doors(before, frame.rooms)
    (door,) = [o for o in after if o.is_shut]
    assert door.leaves == ()
    assert sum(len(o.leaves) for o in after) == sum(len(o.leaves) for o in before) - 1
    assert [o.instance for o in after] == [o.instance for o in before]
    np.testing.assert_array_equal(door.poses[0], door.pose)
    surface = sample_surface(transform(door.pose, triangles_z_up(other_state(dataset, door.node))), 0.02)
    leaf = transform(door.poses[1], door.parts[1].triangle.astype(float)).reshape(-1, 3)
    assert cKDTree(surface).query(leaf)[0].max() < 0.02
    as_placed = transform(door.pose, door.parts[1].triangle.astype(float)).reshape(-1, 3)
    assert cKDTree(surface).query(as_placed)[0].max() > 0.5
    corners = leaf[:, :2] - door.shut_leaves.center[0, :2]
    assert (abs(corners).max(axis=0) <= door.shut_leaves.half[0].max() + 0.1).all()
    assert len(door.shut_leaves) == 1


def test_rows_of_leaves_are_those_of_doors_that_turn(dataset, house):
    frame = find_frame(house)
    doorways = find_doorways(shut_outer_doors(place_objects(frame, dataset.metadata), frame.rooms), frame.rooms)
    inner = [d.leaf for d in doorways if not d.leads_outdoors]
    assert inner == [(i, -1) for i in range(len(doorways) - 1)]
    assert [d.leaf for d in doorways if d.leads_outdoors] == [(-1, -1)]
