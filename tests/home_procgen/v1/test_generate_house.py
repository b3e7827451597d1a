"""Furnished houses: nothing overlaps, everything can be reached, the radio is there, ids are stable."""

from collections import Counter

import numpy as np
import pytest
from generated import built
from scipy import ndimage

from home_mjx.datasets.seeds import house_id
from home_mjx.schema.house import House, ObjectNode
from home_procgen.v1.furniture import library

SEEDS = range(10)
CELL = 0.05  # [m]


@pytest.fixture(scope="module")
def houses():
    return [built(seed) for seed in SEEDS]


def placed_vertices(house: House, node: ObjectNode):
    return house.models[node.model_key].vertices @ node.transform[:3, :3].T + node.transform[:3, 3]


def boxes_of(house: House):
    """Boxes of the base models, as in house.json."""
    points = [
        house.models[o.model_id].vertices @ o.transform[:3, :3].T + o.transform[:3, 3] for o in house.levels[0].objects
    ]
    return np.array([[p.min(0), p.max(0)] for p in points])


def penetration(one, others):
    return (np.minimum(one[1], others[:, 1]) - np.maximum(one[0], others[:, 0])).min(-1)


def fine(node: ObjectNode):
    return library()[node.model_id].fine


def test_nothing_overlaps_by_more_than_two_centimetres(houses):
    for house in houses:
        boxes = boxes_of(house)
        for i, box in enumerate(boxes):
            depth = penetration(box, boxes)
            depth[i] = -1
            worst = depth.argmax()
            names = house.levels[0].objects[i].model_id, house.levels[0].objects[worst].model_id
            assert depth[worst] <= 0.02, (house.id, names)


def test_furniture_stays_out_of_walls_floors_and_ceilings(houses):
    for house in houses:
        walls, slabs = [], []
        for room in house.levels[0].rooms:
            for group in range(len(room.walls.groups)):
                points = room.walls.vertices[np.unique(room.walls.faces[room.walls.group == group])]
                walls.append([points.min(0), points.max(0)])
            slabs += [room.floor.vertices[:, 1].max(), room.ceiling.vertices[:, 1].min()]
        for node, box in zip(house.levels[0].objects, boxes_of(house), strict=True):
            if fine(node) not in ("door", "window"):
                assert penetration(box, np.array(walls)).max() <= 0.02, (house.id, node.model_id)
                assert box[0, 1] >= slabs[0] - 1e-6
                assert box[1, 1] <= slabs[1] + 1e-6


def test_rugs_end_at_walls_and_do_not_overlap(houses):
    """They are too thin for the tests above: seen from above, their corners are in one room and off other rugs."""
    for house in houses:
        nodes, boxes = house.levels[0].objects, boxes_of(house)
        rugs = np.array([box for node, box in zip(nodes, boxes, strict=True) if fine(node) == "rug"])
        for i, (low, high) in enumerate(rugs):
            corners = np.array([[x, z] for x in (low[0], high[0]) for z in (low[2], high[2])])
            assert any(on_floor(room, corners).all() for room in house.levels[0].rooms)
            others = np.delete(rugs, i, 0)
            overlap = np.minimum(high, others[:, 1]) - np.maximum(low, others[:, 0])
            assert not (overlap[:, [0, 2]].min(-1) > 0.02).any()


def occupied(house: House, low, shape):
    """Cells that anything between ankle and head of an agent covers, by the boxes of all triangles in that range."""
    grid = np.zeros(shape, bool)
    corners = [room.walls.vertices[room.walls.faces] for room in house.levels[0].rooms]
    corners += [placed_vertices(house, o)[house.models[o.model_key].faces] for o in house.levels[0].objects]
    corners = np.concatenate(corners)
    bottom, top = corners[..., 1].min(1), corners[..., 1].max(1)
    corners = corners[(bottom < 1.65) & (top > 0.1)][..., [0, 2]]
    first = np.floor((corners.min(1) - low) / CELL).astype(int)
    last = np.floor((corners.max(1) - low) / CELL).astype(int) + 1
    for (i0, j0), (i1, j1) in zip(np.maximum(first, 0), last, strict=True):
        grid[i0:i1, j0:j1] = True
    return grid


@pytest.mark.parametrize("radius", [0.1, 0.2])
def test_an_agent_can_walk_from_any_room_to_any_other(houses, radius):
    for house in houses:
        floors = [room.floor.vertices[:, [0, 2]] for room in house.levels[0].rooms]
        low, high = np.min([f.min(0) for f in floors], 0) - 0.5, np.max([f.max(0) for f in floors], 0) + 0.5
        grid = occupied(house, low, tuple(np.ceil((high - low) / CELL).astype(int)))
        free = ndimage.distance_transform_edt(~grid) * CELL > radius
        label, _ = ndimage.label(free)
        centre = (np.argwhere(free) + 0.5) * CELL + low
        rooms = np.stack([on_floor(room, centre) for room in house.levels[0].rooms])
        indoors = label[free][rooms.any(0)]
        main = np.bincount(indoors)[1:].argmax() + 1
        for room, here in zip(house.levels[0].rooms, rooms, strict=True):
            reached = (label[free][here] == main).sum() * CELL**2
            assert reached > 0.2, (house.id, room.types)
        assert (indoors == main).mean() > 0.8, house.id


def on_floor(room, points):
    corners = room.floor.vertices[room.floor.faces][..., [0, 2]]
    return np.any([((c.min(0) < points) & (points < c.max(0))).all(-1) for c in corners], axis=0)


def test_a_radio_plays_in_every_house(houses):
    for house in houses:
        assert any(fine(node) == "loudspeaker" for node in house.levels[0].objects), house.id


def test_houses_use_many_models_and_differ(houses):
    for house in houses:
        assert len({node.model_id for node in house.levels[0].objects}) >= 12
    assert len({node.model_id for house in houses for node in house.levels[0].objects}) >= 60
    assert len({tuple(np.round(house.levels[0].rooms[0].floor.vertices.ravel(), 3)) for house in houses}) == len(houses)


def test_rooms_hold_what_they_are_for(houses):
    expected = {"Bedroom": "double_bed", "Kitchen": "sink", "Bathroom": "toilet", "Living_Room": "sofa"}
    lamps = rooms = 0
    for house in houses:
        kinds = {node.index: fine(node) for node in house.levels[0].objects}
        for room in house.levels[0].rooms:
            members = {kinds[i] for i in room.members}
            if needed := expected.get(room.types[0]):
                assert needed in members, house.id
            lamps += "chandelier" in members
            rooms += 1
    assert lamps >= 0.95 * rooms


def test_members_are_the_objects_in_the_room_and_each_has_one_owner(houses):
    for house in houses:
        level = house.levels[0]
        owners = Counter(i for room in level.rooms for i in room.members)
        assert set(owners) == {node.index for node in level.objects}
        assert set(owners.values()) == {1}
        for room in level.rooms:
            floor = np.array([room.floor.vertices.min(0), room.floor.vertices.max(0)])
            for node in level.objects:
                if node.index in room.members:
                    x, z = node.transform[[0, 2], 3]
                    assert floor[0, 0] - 1e-6 <= x <= floor[1, 0] + 1e-6
                    assert floor[0, 2] - 1e-6 <= z <= floor[1, 2] + 1e-6


def test_transforms_are_those_of_suncg(houses):
    """Yaw times scale along the model's axes; determinants of both signs occur, and the closed entrance."""
    nodes = [node for house in houses for node in house.levels[0].objects]
    assert {node.is_mirrored for node in nodes} == {False, True}
    assert sum(node.model_key != node.model_id for house in houses for node in house.levels[0].objects) == len(houses)
    for node in nodes:
        linear = node.transform[:3, :3]
        assert linear[1].tolist() == [0, linear[1, 1], 0]
        assert linear[:, 1].tolist() == [0, linear[1, 1], 0]
        gram = linear.T @ linear
        assert np.abs(gram - np.diag(np.diag(gram))).max() < 1e-9
        assert (np.sqrt(np.diag(gram)) >= 0.8).all()
        assert (np.sqrt(np.diag(gram)) <= 1.2).all()


def test_materials_match_the_slots(houses):
    for house in houses:
        for node in house.levels[0].objects:
            assert [material.name for material in node.materials] == list(library()[node.model_id].slots)
    looks = {(m.texture, m.diffuse) for house in houses for node in house.levels[0].objects for m in node.materials}
    assert len(looks) >= 30


def test_windows_are_not_hidden_by_tall_furniture(houses):
    for house in houses:
        nodes, all_boxes = house.levels[0].objects, boxes_of(house)
        for node, box in zip(nodes, all_boxes, strict=True):
            if fine(node) != "window":
                continue
            across = 0 if np.ptp(box[:, 0]) < np.ptp(box[:, 2]) else 2
            sight = box.copy()
            sight[:, across] += (-0.2, 0.2)
            sight[0, 1] += 0.2
            for other, other_box in zip(nodes, all_boxes, strict=True):
                if other is not node and fine(other) != "door":
                    assert penetration(sight, other_box[None])[0] <= 0.02, (house.id, other.model_id)


def test_ids_are_stable_and_unlike_those_of_suncg():
    assert house_id(0) == house_id(0)
    ids = [house_id(seed) for seed in range(1000)]
    assert len(set(ids)) == 1000
    assert all(len(name) == 32 and set(name) <= set("0123456789abcdef") for name in ids)
    assert all(name.startswith("686f6d65") for name in ids)


def test_houses_are_not_centred(houses):
    for house in houses:
        assert house.levels[0].rooms[0].floor.vertices[:, [0, 2]].min() > 25
