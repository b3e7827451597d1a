"""What other readers of SUNCG are known to have stumbled over: one test for each pitfall that concerns a reader.

Those of renderers, physics and navigation (light through corners, doorways without floor, open components) are not
here.
"""

import json
import shutil

import numpy as np
import pytest
import trimesh
from PIL import Image
from tiny_arch import write_tiny_v2
from tiny_dataset import (
    DEPTH,
    DOOR,
    DOOR_AT,
    FRAME,
    HOUSE_ID,
    TABLE,
    WIDTH,
    edit_house,
    object_node,
    room_node,
    write_mesh,
    write_tiny_dataset,
)

from home_mjx.datasets.base import ReadOptions
from home_mjx.datasets.registry import open_dataset
from home_mjx.datasets.suncg.validate.rooms import footprint
from home_mjx.datasets.suncg.validate.validate import validate_house
from home_mjx.errors import DatasetError


@pytest.fixture
def root(tmp_path):
    return write_tiny_dataset(tmp_path)


def load(root, options=None):
    dataset = open_dataset(root)
    return dataset.load_house(HOUSE_ID, options) if options else dataset.load_house(HOUSE_ID)


def change_nodes(root, change):
    edit_house(root, lambda document: change(document["levels"][0]["nodes"]))


def add_category(root, model_id, fine, coarse, nyu40="otherprop"):
    path = root / "metadata" / "ModelCategoryMapping.csv"
    path.write_text(path.read_text() + f"\n9,{model_id},{fine},{coarse},2,{nyu40},,")


def world(item, mesh):
    return mesh.vertices @ item.transform[:3, :3].T + item.transform[:3, 3]


def test_01_v2_comes_without_meshes_of_rooms(tmp_path):
    """Others show objects without walls and floors."""
    room = load(write_tiny_v2(tmp_path)).levels[0].rooms[0]
    assert None not in (room.floor, room.ceiling, room.walls)


def test_02_houses_and_rooms_are_separate_folders(root):
    """Whoever fetched only `house` is told what else to fetch."""
    shutil.rmtree(root / "room")
    with pytest.raises(DatasetError, match=r"download_suncg\.py -v v1 -t room"):
        load(root)


def test_03_boxes_and_ids_may_be_absent_and_nodes_empty_or_repeated(root):
    def change(document):
        document.pop("bbox")
        level = document["levels"][0]
        level.pop("bbox")
        for node in level["nodes"][:4]:
            node.pop("bbox")
        level["nodes"][4].pop("id")
        level["nodes"] += [{}, dict(level["nodes"][2])]
        level["nodes"][0]["nodeIndices"] += [6, 2, 2]

    edit_house(root, change)
    level = load(root).levels[0]
    assert [len(level.rooms), len(level.objects), len(level.boxes), len(level.grounds)] == [1, 2, 1, 1]
    assert level.rooms[0].members == (2, 3, 4)
    assert level.rooms[0].bbox is None


def test_04_rooms_may_overlap(root):
    """Both are kept with what they are; the validator says so."""
    change_nodes(root, lambda nodes: nodes.append(room_node() | {"id": "0_5", "roomTypes": ["Hall"]}))
    rooms = load(root).levels[0].rooms
    assert [(room.index, room.types) for room in rooms] == [(0, ("Living_Room", "Kitchen")), (5, ("Hall",))]
    assert "room-overlap" in {finding.rule for finding in validate_house(open_dataset(root), HOUSE_ID)}


def test_05_the_box_of_a_room_is_no_floor_plan(root):
    """It encloses the members, open door leaves among them."""
    change_nodes(root, lambda nodes: nodes[0].update(bbox={"min": [-5, 0, -5], "max": [9, 3, 9]}))
    room = load(root).levels[0].rooms[0]
    outline = footprint(room)
    assert outline is not None
    np.testing.assert_array_equal([outline.min((0, 1)), outline.max((0, 1))], [[0, 0], [WIDTH, DEPTH]])
    assert np.ptp(room.bbox[:, 0]) == 14


def test_06_closed_doors_have_the_box_of_open_ones(root):
    """The state is told apart, the mesh is the closed one, and the frame alone can be had where v2 has it."""
    write_mesh(root / "object" / DOOR, f"{DOOR}_2", [FRAME], [], mtl=DOOR)
    house = load(root)
    door = house.levels[0].objects[1]
    assert door.model_key == f"{DOOR}_0"
    shown = np.ptp(world(door, house.models[door.model_key])[:, 2])
    assert shown == pytest.approx(0.14)
    assert np.ptp(door.bbox[:, 2]) == pytest.approx(0.67)  # with the open leaf
    assert np.ptp(open_dataset(root).load_model(f"{DOOR}_2").vertices[:, 1]) == pytest.approx(0.1)


def test_07_garage_doors_and_arches_are_doors_only_for_nyu40(root):
    add_category(root, "361", "garage_door", "garage_door", "door")
    add_category(root, "778", "arch", "arch", "door")
    metadata = open_dataset(root).metadata
    for model_id, coarse in (("361_0", "garage_door"), ("778", "arch")):
        assert (metadata.info(model_id).coarse, metadata.info(model_id).nyu40) == (coarse, "door")


def test_08_mirrored_models_turn_inside_out(root):
    """The transform decides, whatever the flag says; the volume of a mirrored mesh is negative."""
    change_nodes(root, lambda nodes: nodes[3].pop("isMirrored"))
    house = load(root)
    door, mesh = house.levels[0].objects[1], house.models[f"{DOOR}_0"]
    assert door.is_mirrored
    solid = trimesh.Trimesh(world(door, mesh), mesh.faces, process=False)
    assert solid.volume == pytest.approx(-trimesh.Trimesh(mesh.vertices, mesh.faces, process=False).volume)
    assert np.mean(world(door, mesh)[:, 0]) == pytest.approx(DOOR_AT[0] - mesh.vertices[:, 0].mean())


def test_09_each_instance_has_its_own_scale(root):
    linear = np.diag([0.5, 2.0, 1.25])
    node = object_node("0_5", TABLE, linear, (1, 0.05, 1), [("", "", (-0.6, 0, -0.4), (0.6, 0.75, 0.4))])
    change_nodes(root, lambda nodes: nodes.append(node))
    house = load(root)
    one, other = house.levels[0].objects[0], house.levels[0].objects[2]
    assert one.model_key == other.model_key
    np.testing.assert_array_equal(other.transform[:3, :3], linear)
    np.testing.assert_allclose(np.ptp(world(other, house.models[TABLE]), axis=0), [0.6, 1.5, 1.0])
    assert validate_house(open_dataset(root), HOUSE_ID) == ()


def box_at(root, center, size, turn=0.0):
    """Makes the box of the house another one, turned about the vertical."""
    matrix = np.eye(4)
    matrix[:3, :3] = [[np.cos(turn), 0, np.sin(turn)], [0, 1, 0], [-np.sin(turn), 0, np.cos(turn)]]
    matrix[:3, 3] = center
    change_nodes(root, lambda nodes: nodes[4].update(transform=matrix.T.reshape(-1).tolist(), dimensions=size))


@pytest.mark.parametrize("turn", [0.0, np.pi / 2])
def test_10_landscapes_of_a_hundred_metres_are_cut_to_the_house(root, turn):
    size = [100, 1, 60] if turn == 0 else [60, 1, 100]
    box_at(root, (2, 0, 1), size, turn)
    house = load(root)
    (box,) = house.levels[0].boxes
    half = abs(box.transform[:3, :3]) @ box.dimensions / 2
    low, high = box.transform[:3, 3] - half, box.transform[:3, 3] + half
    # from the ground at (-2, -0.04, -2) to its far end at x = 6, the table, door and walls up to z = 3, y = 0.5
    np.testing.assert_allclose([low[0], low[1], low[2]], [-2, -0.04, -2], atol=1e-9)
    np.testing.assert_allclose([high[0], high[1]], [6, 0.5], atol=1e-9)
    assert 3 <= high[2] < 4
    assert [problem.rule for problem in house.problems] == ["backdrop"]
    (whole,) = load(root, ReadOptions(backdrops=True)).levels[0].boxes
    assert whole.dimensions.tolist() == size


@pytest.mark.parametrize(
    ("center", "size", "turn"),
    [((0, 20, 80), [100, 50, 0.1], 0.0), ((2, -30, 1), [100, 1, 100], 0.0), ((2, 0, 1), [100, 1, 100], 0.5)],
)
def test_10_landscapes_away_from_the_house_are_left_out(root, center, size, turn):
    box_at(root, center, size, turn)
    house = load(root)
    assert house.levels[0].boxes == ()
    assert house.levels[0].rooms[0].members == (2, 3)
    assert [(problem.element, problem.rule) for problem in house.problems] == [("levels[0].nodes[4]", "backdrop")]
    assert len(load(root, ReadOptions(backdrops=True)).levels[0].boxes) == 1


def test_10_boxes_of_the_size_of_furniture_stay_whole_wherever_they_are(root):
    box_at(root, (40, 1, 1), [15, 3, 0.1])
    assert load(root).levels[0].boxes[0].dimensions.tolist() == [15, 3, 0.1]


def test_11_every_level_is_read_and_stairs_are_objects(root):
    def change(document):
        upper = json.loads(json.dumps(document["levels"][0]))
        for index, node in enumerate(upper["nodes"]):
            node["id"] = f"1_{index}"
        upper["nodes"][0] |= {"hideFloor": 1, "modelId": "fr_1rm_0"}
        upper["id"] = "1"
        document["levels"].append(upper)

    edit_house(root, change)
    add_category(root, "151", "stairs", "stairs", "floor")
    for part in "cw":
        for kind in ("obj", "mtl"):
            folder = root / "room" / HOUSE_ID
            shutil.copy(folder / f"fr_0rm_0{part}.{kind}", folder / f"fr_1rm_0{part}.{kind}")
    text = (root / "room" / HOUSE_ID / "fr_1rm_0w.obj").read_text()
    (root / "room" / HOUSE_ID / "fr_1rm_0w.obj").write_text(text.replace("fr_0rm_0w.mtl", "fr_1rm_0w.mtl"))
    levels = load(root).levels
    assert [level.index for level in levels] == [0, 1]
    assert (levels[0].rooms[0].floor is None, levels[1].rooms[0].floor is None) == (False, True)
    assert levels[1].objects[0].path == "levels[1].nodes[2]"


def test_12_people_and_plants_by_option(root):
    add_category(root, "323", "person", "person", "person")
    add_category(root, "130", "plant", "plant")
    for model_id in ("323", "130"):
        write_mesh(root / "object" / model_id, model_id, [("", "material_0", (0, 0, 0), (1, 1, 1))], [("1 1 1", "")])

    def change(nodes):
        for index, model_id in ((5, "323"), (6, "130")):
            nodes.append(dict(nodes[2]) | {"id": f"0_{index}", "modelId": model_id, "materials": []})
        nodes[0]["nodeIndices"] += [5, 6]

    change_nodes(root, change)

    def shown(**options):
        level = load(root, ReadOptions(**options)).levels[0]
        assert set(level.rooms[0].members) == {4, *(item.index for item in level.objects)}
        return [item.model_id for item in level.objects]

    assert shown() == [TABLE, DOOR, "323", "130"]
    assert shown(people=False) == [TABLE, DOOR, "130"]
    assert shown(plants=False) == [TABLE, DOOR, "323"]
    assert shown(people=False, plants=False) == [TABLE, DOOR]


def test_12_models_that_are_left_out_need_not_be_there(root):
    add_category(root, "323", "person", "person", "person")
    change_nodes(root, lambda nodes: nodes[2].update(modelId="323"))
    with pytest.raises(DatasetError, match="model `323` has no OBJ file"):
        load(root)
    assert len(load(root, ReadOptions(people=False)).levels[0].objects) == 1


def test_13_both_sides_of_a_wall_can_be_told_apart(tmp_path):
    """Rooms bring copies of a shared wall: each side's group says which room it belongs to, and they overlap 5 mm."""
    walls = load(write_tiny_v2(tmp_path)).levels[0].rooms[0].walls
    inner, outer = (walls.groups.index(f"Wall{side}#0_0_0") for side in ("Inside", "Outside"))
    depth = [walls.vertices[walls.faces[walls.group == group]][..., 2] for group in (inner, outer)]
    assert depth[1].max() - depth[0].min() == pytest.approx(0.1 / 19)


def test_14_walls_are_closed_solids_that_meet_at_corners(tmp_path):
    """Others export single planes, which let light through."""
    walls = load(write_tiny_v2(tmp_path)).levels[0].rooms[0].walls
    boxes = []
    for group in range(len(walls.groups)):
        solid = trimesh.Trimesh(walls.vertices, walls.faces[walls.group == group], process=False)
        solid.remove_unreferenced_vertices()
        assert solid.is_watertight
        boxes.append(solid.bounds)
    inner = boxes[::2]
    for one, other in zip(inner, inner[1:] + inner[:1], strict=True):
        assert (np.minimum(one[1], other[1]) - np.maximum(one[0], other[0]) > 0.03).all()


def test_15_colours_without_texture_and_names_in_any_case(root):
    folder = root / "texture"
    (folder / "wood_1.png").rename(folder / "Wood_1.PNG")
    Image.new("RGB", (2, 2)).save(folder / "leaf.jpg")
    change_nodes(root, lambda nodes: nodes[4].update(materials=[{"texture": "leaf"}]))
    house = load(root)
    first, second = house.models[TABLE].materials
    assert first.texture == folder / "Wood_1.PNG"
    assert (second.texture, second.diffuse) == (None, (0.2, 0.2, 0.2))
    assert house.levels[0].boxes[0].materials[0].texture == folder / "leaf.jpg"


@pytest.mark.parametrize("at", [(1.5, -0.45, 1.2), (50.0, 0.05, 1.2), (0.0, 0.05, 0.0)])
def test_16_objects_in_walls_below_ground_or_outdoors_are_kept(root, at):
    change_nodes(root, lambda nodes: nodes[2]["transform"].__setitem__(slice(12, 15), at))
    assert load(root).levels[0].objects[0].transform[:3, 3].tolist() == list(at)


def test_17_booleans_numbers_and_strings_for_flags_and_ids(root):
    def change(document):
        level = document["levels"][0]
        level["id"] = 0
        level["nodes"][0] |= {"valid": True, "hideCeiling": "1"}
        level["nodes"][2] |= {"valid": "1", "id": 2}
        level["nodes"][3] |= {"isMirrored": True, "state": 1.0}
        level["nodes"][4]["valid"] = False

    edit_house(root, change)
    (level,) = load(root).levels
    assert (level.id, level.rooms[0].ceiling, level.boxes) == ("0", None, ())
    assert [(item.id, item.model_key) for item in level.objects] == [("2", TABLE), ("0_3", f"{DOOR}_0")]


def test_17_ids_with_two_underscores(root):
    for stem in ("s__12", "s__12_0"):
        write_mesh(root / "object" / "s__12", stem, [FRAME], [("1 1 1", "")])
    change_nodes(root, lambda nodes: nodes[2].update(modelId="s__12", state=1, materials=[]))
    house = load(root)
    assert house.levels[0].objects[0].model_key == "s__12_0"
    assert house.models["s__12_0"].path.parent.name == "s__12"


def test_18_a_table_of_categories_without_the_models_of_a_house(root):
    """Copies of the tables are about that were cut down to one house."""
    path = root / "metadata" / "ModelCategoryMapping.csv"
    path.write_text("\n".join(path.read_text().split("\n")[:2]))
    dataset = open_dataset(root)
    info = dataset.metadata.info(TABLE)
    assert (info.fine, info.coarse, info.nyu40) == ("unknown", "unknown", "void")
    assert len(dataset.load_house(HOUSE_ID).levels[0].objects) == 2
    assert "unknown-model" in {finding.rule for finding in validate_house(dataset, HOUSE_ID)}


def test_19_variants_and_raw_names_have_no_row_of_their_own(root):
    metadata = open_dataset(root).metadata
    assert [metadata.info(f"{DOOR}{variant}").fine for variant in ("", "_0", "_2")] == ["door"] * 3
    assert metadata.info("stores__3__1183").fine == "unknown"


def test_20_houses_without_rooms(root):
    def change(nodes):
        for index in (0, 1):
            nodes[index]["valid"] = 0

    change_nodes(root, change)
    (level,) = load(root).levels
    assert (level.rooms, level.grounds, len(level.objects)) == ((), (), 2)
