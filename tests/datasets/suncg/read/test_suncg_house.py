"""What a hand-written house reads as, and which oddities are tolerated and noted."""

import numpy as np
import pytest
import trimesh
from tiny_dataset import (
    DOOR,
    DOOR_AT,
    GROUND,
    HOUSE_ID,
    ROOM_PARTS,
    TABLE,
    TABLE_AT,
    box_of,
    edit_house,
    write_tiny_dataset,
)

from home_mjx.datasets.registry import open_dataset
from home_mjx.schema.house import Material, Problem


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path)


@pytest.fixture
def edited(root):
    """Loads the tiny house after a change of its house.json, given as a function of its nodes or of all of it."""

    def load(change=None, *, document=None):
        if change:
            edit_house(root, lambda doc: change(doc["levels"][0]["nodes"]))
        if document:
            edit_house(root, document)
        return open_dataset(root).load_house(HOUSE_ID)

    return load


def noted(house, element, message):
    """The only problem of the house is this one."""
    assert len(house.problems) == 1, house.problems
    (problem,) = house.problems
    return isinstance(problem, Problem) and problem.element == element and message in problem.message


def node(index, key=""):
    return f"levels[0].nodes[{index}]" + (f".{key}" if key else "")


def test_the_house(edited, root):
    house = edited()
    assert (house.id, house.version, house.problems) == (HOUSE_ID, "suncg@1.0.0", ())
    assert house.path == root / "house" / HOUSE_ID / "house.json"
    (level,) = house.levels
    assert (level.id, level.index) == ("0", 0)
    counts = [len(nodes) for nodes in (level.rooms, level.grounds, level.objects, level.boxes)]
    assert counts == [1, 1, 2, 1]
    nodes = [*level.rooms, *level.grounds, *level.objects, *level.boxes]
    assert [(n.id, n.index, n.path) for n in nodes] == [(f"0_{i}", i, node(i)) for i in range(5)]


def test_room(edited):
    (room,) = edited().levels[0].rooms
    assert (room.model_id, room.types, room.members) == ("fr_0rm_0", ("Living_Room", "Kitchen"), (2, 3, 4))
    assert room.walls.groups == tuple(f"WallInside#0_0_{k}" for k in range(4))
    assert (room.floor.groups, room.ceiling.groups) == (("Floor#0_0",), ("Ceiling#0_0",))
    for mesh, part in ((room.floor, "f"), (room.ceiling, "c"), (room.walls, "w")):
        box = box_of(ROOM_PARTS[part])
        np.testing.assert_array_equal([mesh.vertices.min(0), mesh.vertices.max(0)], [box["min"], box["max"]])


def test_ground(edited):
    (ground,) = edited().levels[0].grounds
    assert ground.model_id == "fr_0gd_1"
    np.testing.assert_array_equal(ground.mesh.vertices.min(0), box_of(GROUND)["min"])


def test_transforms_are_column_major(edited):
    table, door = edited().levels[0].objects
    np.testing.assert_array_equal(table.transform[:3, 3], TABLE_AT)
    np.testing.assert_array_equal(table.transform @ [1, 0, 0, 0], [0, 0, -1, 0])  # 90 degrees about y: x to -z
    np.testing.assert_array_equal(door.transform @ [1, 1, 1, 1], [DOOR_AT[0] - 1, DOOR_AT[1] + 1, DOOR_AT[2] + 1, 1])
    assert (table.is_mirrored, door.is_mirrored) == (False, True)


def test_objects_fill_the_boxes_of_the_file(edited, root):
    house = edited()
    for item in house.levels[0].objects:
        vertices = open_dataset(root).load_model(item.model_id).vertices
        vertices = vertices @ item.transform[:3, :3].T + item.transform[:3, 3]
        np.testing.assert_allclose([vertices.min(0), vertices.max(0)], item.bbox, atol=1e-12)


def test_state_picks_the_variant(edited):
    house = edited()
    table, door = house.levels[0].objects
    assert (table.model_key, door.model_key) == (TABLE, f"{DOOR}_0")
    assert set(house.models) == {TABLE, f"{DOOR}_0"}
    assert np.ptp(house.models[f"{DOOR}_0"].vertices[:, 2]) == pytest.approx(0.14)
    assert edited(lambda nodes: nodes[3].update(state=0)).levels[0].objects[1].model_key == DOOR


def test_models_are_outward(edited):
    house = edited()
    volumes = {key: trimesh.Trimesh(mesh.vertices, mesh.faces).volume for key, mesh in house.models.items()}
    assert volumes[TABLE] == pytest.approx(1.2 * 0.05 * 0.8 + 0.1 * 0.7 * 0.1)
    assert volumes[f"{DOOR}_0"] == pytest.approx(0.8 * 0.1 * 0.14 + 0.74 * 1.95 * 0.04)


def test_materials(edited, root):
    house = edited()
    table, door = house.levels[0].objects
    assert table.materials == (Material("wood", (1.0, 128 / 255, 0.0), root / "texture" / "s" / "123.jpg", None),)
    assert door.materials == (Material("color"),)  # nothing overridden
    wood = root / "texture" / "wood_1.png"
    assert house.models[TABLE].materials == (
        Material("material_0", (0.8, 0.6, 0.4), wood, 1.0),
        Material("material_1", (0.2, 0.2, 0.2), None, 0.5),
    )
    assert house.levels[0].boxes[0].materials == (Material("a", (1.0, 1.0, 1.0)),) * 6


def test_empty_entries_keep_their_slot(edited):
    def change(nodes):
        nodes[2]["materials"] = [None, {"name": "b", "diffuse": "#000000", "texture": ""}]

    assert edited(change).levels[0].objects[0].materials == (Material(""), Material("b", (0.0, 0.0, 0.0)))


def test_materials_by_index(edited):
    def change(document):
        document["materials"] = [{"name": "x"}, {"name": "y", "diffuse": "#0000ff"}]
        table = document["levels"][0]["nodes"][2]
        del table["materials"]
        table["materialIndices"] = [1, 0]

    table = edited(document=change).levels[0].objects[0]
    assert table.materials == (Material("y", (0.0, 0.0, 1.0)), Material("x"))


@pytest.mark.parametrize(("flag", "part"), [("hideFloor", "floor"), ("hideCeiling", "ceiling"), ("hideWalls", "walls")])
def test_hidden_parts_are_not_read(edited, root, flag, part):
    (root / "room" / HOUSE_ID / f"fr_0rm_0{flag[4].lower()}.obj").write_text("broken")
    house = edited(lambda nodes: nodes[0].update({flag: 1}))
    (room,) = house.levels[0].rooms
    shown = {name for name in ("floor", "ceiling", "walls") if getattr(room, name)}
    assert shown == {"floor", "ceiling", "walls"} - {part}
    assert house.problems == ()


@pytest.mark.parametrize("value", [0, "0", False])
def test_invalid_nodes_are_skipped_unread(edited, value):
    house = edited(lambda nodes: nodes[2].update(valid=value, modelId="no such model"))
    assert [item.index for item in house.levels[0].objects] == [3]
    assert house.levels[0].rooms[0].members == (3, 4)
    assert house.problems == ()


@pytest.mark.parametrize("value", [1, "1", True, 1.0])
def test_valid_in_every_spelling(edited, value):
    assert len(edited(lambda nodes: nodes[2].update(valid=value)).levels[0].objects) == 2


def test_optional_fields(edited):
    def change(nodes):
        for key in ("valid", "nodeIndices", "roomTypes"):
            del nodes[0][key]
        for key in ("valid", "materials", "isMirrored", "state"):
            nodes[3].pop(key)

    house = edited(change)
    (room,) = house.levels[0].rooms
    door = house.levels[0].objects[1]
    assert (room.types, room.members, door.materials, door.model_key) == ((), (), (), DOOR)
    assert house.problems == ()


def test_node_types_in_any_case(edited):
    def change(nodes):
        for item in nodes:
            item["type"] = item["type"].lower()

    assert edited(change).problems == ()


def test_levels_keep_their_index(edited):
    def change(document):
        (level,) = document["levels"]
        document["levels"] = [{"id": "0", "nodes": []}, {"id": 1, "valid": 0, "nodes": 5}, level | {"id": 2}]

    first, second = edited(document=change).levels
    assert ([first.id, first.index], [second.id, second.index]) == (["0", 0], ["2", 2])
    assert second.objects[0].path == "levels[2].nodes[2]"


def test_units_are_scaled_to_metres(edited):
    plain, scaled = edited(), edited(document=lambda doc: doc.update(scaleToMeters=0.01))
    for one, hundredth in zip(plain.levels[0].objects, scaled.levels[0].objects, strict=True):
        point = np.array([0.3, 0.2, 0.1, 1.0])
        np.testing.assert_allclose(hundredth.transform @ point, [*(one.transform @ point)[:3] / 100, 1], rtol=1e-12)
        np.testing.assert_allclose(hundredth.bbox, one.bbox / 100, rtol=1e-12)
    floors = [house.levels[0].rooms[0].floor.vertices for house in (plain, scaled)]
    np.testing.assert_allclose(floors[1], floors[0] / 100, rtol=1e-12)
    corner = [house.levels[0].boxes[0].transform @ [0.25, 0.5, 0.25, 1] for house in (plain, scaled)]
    np.testing.assert_allclose(corner[1][:3], corner[0][:3] / 100, rtol=1e-12)


def test_empty_nodes(edited):
    house = edited(lambda nodes: nodes.append({}))
    assert noted(house, node(5), "empty node")


@pytest.mark.parametrize("kind", ["None", "Camera"])
def test_unknown_node_types(edited, kind):
    house = edited(lambda nodes: nodes[4].update(type=kind))
    assert noted(house, node(4, "type"), f'unknown node type "{kind}"')
    assert house.levels[0].boxes == ()
    assert house.levels[0].rooms[0].members == (2, 3)
    (kept,) = house.levels[0].unknown
    assert (kept.index, kept.path, kept.data["type"]) == (4, node(4), kind)
    assert kept.data["dimensions"]


def test_missing_id(edited):
    house = edited(lambda nodes: nodes[2].pop("id"))
    assert noted(house, node(2, "id"), "no id: `0_2` is used")
    assert house.levels[0].objects[0].id == "0_2"


def test_equal_nodes_are_left_out_and_stay_members(edited):
    def change(nodes):
        nodes.append(dict(nodes[2]))
        nodes[0]["nodeIndices"] = [5, 3, 4]

    house = edited(change)
    assert noted(house, node(5, "id"), f"`0_2` is also the id of {node(2)}, an equal node: left out")
    assert [item.index for item in house.levels[0].objects] == [2, 3]
    assert house.levels[0].rooms[0].members == (2, 3, 4)


def test_other_nodes_of_the_same_id_are_kept(edited):
    house = edited(lambda nodes: nodes[3].update(id="0_2"))
    assert noted(house, node(3, "id"), "another node: both kept")
    assert len(house.levels[0].objects) == 2


@pytest.mark.parametrize("index", [0, 1, 2, 4])
def test_missing_bbox(edited, index):
    house = edited(lambda nodes: nodes[index].pop("bbox"))
    assert noted(house, node(index, "bbox"), "no bounding box")


def test_bbox_inside_out(edited):
    house = edited(lambda nodes: nodes[2]["bbox"].update(min=[9, 9, 9]))
    assert noted(house, node(2, "bbox"), "inside out")
    assert house.levels[0].objects[0].bbox is None


def test_missing_transform(edited):
    house = edited(lambda nodes: nodes[2].pop("transform"))
    assert noted(house, node(2, "transform"), "identity")
    np.testing.assert_array_equal(house.levels[0].objects[0].transform, np.eye(4))


@pytest.mark.parametrize("index", [2, 4])
def test_flat_transform(edited, index):
    def change(nodes):
        nodes[index]["transform"][4:7] = [0, 0, 0]

    house = edited(change)
    assert noted(house, node(index, "transform"), "no volume")
    assert index not in house.levels[0].rooms[0].members


def test_box_without_volume(edited):
    house = edited(lambda nodes: nodes[4].update(dimensions=[1, 0, 1]))
    assert noted(house, node(4, "dimensions"), "box without volume")
    assert house.levels[0].boxes == ()


@pytest.mark.parametrize(("index", "value"), [(2, 1), (3, 0)])
def test_mirror_flag_that_contradicts_the_transform(edited, index, value):
    house = edited(lambda nodes: nodes[index].update(isMirrored=value))
    assert noted(house, node(index, "isMirrored"), "contradicts the transform")
    assert [item.is_mirrored for item in house.levels[0].objects] == [False, True]


def test_state_without_variant(edited):
    house = edited(lambda nodes: nodes[2].update(state=1))
    assert noted(house, node(2, "state"), f"no variant `{TABLE}_0`")
    assert house.levels[0].objects[0].model_key == TABLE


def test_more_overrides_than_slots(edited):
    house = edited(lambda nodes: nodes[2].update(materials=[{"name": "x"}] * 3))
    assert noted(house, node(2, "materials"), "3 materials for 2 slots")


@pytest.mark.parametrize(
    ("members", "message", "kept"),
    [
        ([2, 99, 3], "index 99 is out of range: the level has 5 nodes", (2, 3)),
        ([-1, 4], "index -1 is out of range", (4,)),
        ([2, 3, 2], "nodes listed twice", (2, 3)),
        ([0, 1, 2], "indices [0, 1] are rooms or grounds", (2,)),
    ],
)
def test_odd_members(edited, members, message, kept):
    house = edited(lambda nodes: nodes[0].update(nodeIndices=members))
    assert noted(house, node(0, "nodeIndices"), message)
    assert house.levels[0].rooms[0].members == kept


def test_unknown_room_type(edited):
    house = edited(lambda nodes: nodes[0].update(roomTypes=["Kitchen", "Cellar"]))
    assert noted(house, node(0, "roomTypes"), "unknown room type `Cellar`")
    assert house.levels[0].rooms[0].types == ("Kitchen", "Cellar")


@pytest.mark.parametrize(("index", "stem"), [(0, "fr_0rm_0c"), (1, "fr_0gd_1f")])
def test_missing_part_of_the_architecture(edited, root, index, stem):
    (root / "room" / HOUSE_ID / f"{stem}.obj").unlink()
    house = edited()
    assert noted(house, node(index, "modelId"), f"mesh {stem}.obj is missing")
    missing = house.levels[0].rooms[0].ceiling if index == 0 else house.levels[0].grounds[0].mesh
    assert missing is None


@pytest.mark.parametrize(
    ("change", "element", "message"),
    [
        ({"version": "scene@2"}, "version", 'version is "scene@2"'),
        ({"version": None}, "version", "version is null"),
        ({"id": "another"}, "id", 'id is "another"'),
        ({"up": [0, 0, 1]}, "up", "expected [0, 1, 0]"),
        ({"front": [1, 0, 0]}, "front", "expected [0, 0, 1]"),
    ],
)
def test_odd_headers(edited, change, element, message):
    house = edited(document=lambda doc: doc.update(change))
    assert noted(house, element, message)
    assert house.id == HOUSE_ID


def test_level_without_nodes_or_id(edited):
    house = edited(document=lambda doc: doc["levels"].append({"bbox": None}))
    assert [problem.element for problem in house.problems] == ["levels[1].nodes", "levels[1].id"]


def test_model_id_that_is_a_variant(edited):
    house = edited(lambda nodes: nodes[3].update(modelId=f"{DOOR}_0", state=0))
    assert house.levels[0].objects[1].model_key == f"{DOOR}_0"
    assert house.models[f"{DOOR}_0"].path.parent.name == DOOR


def test_texture_links_are_followed(edited, root, tmp_path_factory):
    """A dataset may keep its folders on another disk."""
    elsewhere = tmp_path_factory.mktemp("disk") / "texture"
    (root / "texture").rename(elsewhere)
    (root / "texture").symlink_to(elsewhere)
    assert edited().levels[0].objects[0].materials[0].texture == root / "texture" / "s" / "123.jpg"
