"""Houses from outlines: as the reader, the validator and the compiler want them."""

from dataclasses import replace

import numpy as np
import pytest
import trimesh

from home_mjx.datasets.outlines import RoomOutline, WallOpening, outline_house
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.storeys import stack_levels
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.datasets.suncg.write.house import write_house, write_library
from home_mjx.errors import ConfigError
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.house import BoxNode

ROOMS = (
    RoomOutline("Living_Room", [(0, 0), (5, 0), (5, 4), (0, 4)]),
    RoomOutline("Bedroom", [(5, 4), (8, 4), (8, 0), (5, 0)]),  # the other way round
)
DOORWAY = WallOpening((5, 1.5), (5, 2.5))


def cabin(openings=(DOORWAY,), boxes=()):
    return outline_house("cabin", ROOMS, openings, boxes)


def compiled(tmp_path, house):
    write_library(tmp_path, [], {})
    write_house(tmp_path, house)
    dataset = open_dataset(tmp_path)
    assert {finding.rule for finding in validate_house(dataset, "cabin")} <= {"unreachable-storey"}
    return compile_house(dataset.load_house("cabin"), dataset.metadata)


def test_two_rooms_are_joined_by_their_doorway(tmp_path):
    table = BoxNode("", 0, "", None, dimensions=np.array([1, 0.7, 1]), transform=np.eye(4))
    table.transform[:3, 3] = 2, 0.4, 2
    house = compiled(tmp_path, cabin(boxes=[table]))
    # 20 m² and 12 m² less walls, the table, and 0.15 m around each; the doorway adds what it is wide and deep
    (area,) = house.navigation.region_area
    assert area == pytest.approx(4.6 * 3.6 + 2.6 * 3.6 - 1.3**2 + 0.7 * 0.4, abs=0.5)
    assert house.navigation.portals.room.tolist() == [[0, 1]]
    assert house.report["objects"] == 1


def test_without_an_opening_the_rooms_are_apart(tmp_path):
    house = compiled(tmp_path, cabin(openings=[]))
    np.testing.assert_allclose(house.navigation.region_area, [4.6 * 3.6, 2.6 * 3.6], atol=0.8)


def test_parts_are_watertight_and_lie_on_the_side_of_their_room():
    for room, middle in zip(cabin().levels[0].rooms, ([2.5, 2.0], [6.5, 2.0]), strict=True):
        for mesh in (room.floor, room.ceiling, room.walls):
            solid = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
            assert solid.is_watertight
            assert solid.volume > 0
        assert len(room.walls.groups) == 2 * 4
        inside, outside = (
            np.array([_middle(room.walls, g) for g, name in enumerate(room.walls.groups) if kind in name])
            for kind in ("WallInside", "WallOutside")
        )
        assert (np.linalg.norm(inside - middle, axis=1) < np.linalg.norm(outside - middle, axis=1)).all()


def _middle(walls, group):
    corners = walls.vertices[walls.faces[walls.group == group]].reshape(-1, 3)[:, [0, 2]]
    return (corners.min(0) + corners.max(0)) / 2


def test_an_opening_is_cut_out_of_both_copies_of_a_wall():
    """Volume of a hole: width, height, and two layers of half the depth in each room."""
    volumes = [
        sum(trimesh.Trimesh(r.walls.vertices, r.walls.faces, process=False).volume for r in house.levels[0].rooms)
        for house in (cabin(openings=[]), cabin())
    ]
    assert volumes[0] - volumes[1] == pytest.approx(1.0 * 2.1 * 2 * 0.1, rel=1e-6)


def test_an_outline_that_crosses_itself_is_refused():
    with pytest.raises(ConfigError, match=r"outline of room 0: .*rooms\[0\]"):
        outline_house("x", [RoomOutline("Bedroom", [(0, 0), (4, 3), (4, 0), (1, 3)])])
    with pytest.raises(ConfigError, match="no area"):
        outline_house("x", [RoomOutline("Bedroom", [(0, 0), (4, 0)])])


def test_stacked_levels_have_heights_and_names_of_their_own(tmp_path):
    table = BoxNode("", 0, "", None, dimensions=np.array([1, 0.7, 1]), transform=np.eye(4))
    table.transform[:3, 3] = 2, 0.4, 2
    plain = cabin(boxes=[table])
    house = compiled(tmp_path, replace(plain, levels=stack_levels(plain.levels * 3, 2.8)))
    np.testing.assert_allclose(house.rooms.floor, [0.05, 0.05, 2.85, 2.85, 5.65, 5.65], atol=1e-6)
    assert house.rooms.level.tolist() == [0, 0, 1, 1, 2, 2]
    read = open_dataset(tmp_path).load_house("cabin")
    nodes = [node for level in read.levels for node in (*level.rooms, *level.boxes)]
    assert len({node.id for node in nodes}) == len(nodes) == 9
    walls = [room.walls for level in read.levels for room in level.rooms]
    assert len({name for mesh in walls for name in mesh.groups}) == sum(len(mesh.groups) for mesh in walls)
    np.testing.assert_allclose([level.boxes[0].transform[1, 3] for level in read.levels], [0.4, 3.2, 6.0], atol=1e-6)
