"""Houses of SUNCG v2: walls, floors and ceilings from the architecture file, against closed forms and trimesh."""

import json

import numpy as np
import pytest
import trimesh
from tiny_arch import arch_path, edit_arch, write_tiny_v2
from tiny_dataset import DEPTH, DOOR, GROUND, HEIGHT, HOUSE_ID, WIDTH, box_of, edit_house, write_mesh

from home_mjx.datasets.registry import open_dataset
from home_mjx.errors import DatasetError
from home_mjx.geometry.slabs import slab
from home_mjx.geometry.wall_prisms import WallSegment, merge_holes, wall_prisms
from home_mjx.schema.house import Material


@pytest.fixture
def root(tmp_path):
    return write_tiny_v2(tmp_path)


def load(root):
    return open_dataset(root).load_house(HOUSE_ID)


def room_of(root):
    return load(root).levels[0].rooms[0]


def solids(mesh):
    """Each group of a mesh as a solid of its own."""
    found = {}
    for number, name in enumerate(mesh.groups):
        found[name] = trimesh.Trimesh(mesh.vertices, mesh.faces[mesh.group == number], process=False)
        found[name].remove_unreferenced_vertices()
    return found


def test_house_without_room_meshes(root):
    house = load(root)
    (level,) = house.levels
    assert (house.version, house.problems) == ("suncg@1.0.2", ())
    (room,) = level.rooms
    assert room.floor.groups == ("Floor#0_0",)
    assert room.ceiling.groups == ("Ceiling#0_0",)
    assert set(room.walls.groups) == {f"Wall{side}#0_0_{k}" for side in ("Inside", "Outside") for k in range(4)}
    assert room.walls.path == arch_path(root)
    vertices, outset = level.grounds[0].mesh.vertices, np.array([0.02, 0, 0.02])
    np.testing.assert_allclose(vertices.min(0), box_of(GROUND)["min"] - outset, atol=1e-12)
    np.testing.assert_allclose(vertices.max(0), box_of(GROUND)["max"] + outset, atol=1e-12)


def test_walls_are_closed_prisms_of_the_size_of_the_specification(root):
    parts = solids(room_of(root).walls)
    for k, length in enumerate((WIDTH, DEPTH, WIDTH, DEPTH)):
        hole = 0.76 * 2.06 if k == 2 else 0.0
        for side in ("Inside", "Outside"):
            solid = parts[f"Wall{side}#0_0_{k}"]
            assert solid.is_watertight
            assert solid.volume == pytest.approx(0.05 * ((length + 0.08) * 2.735 - hole))
            assert solid.bounds[:, 1].tolist() == pytest.approx([0, HEIGHT + 0.035])
    # the wall along z = 0 runs in x, its interior is at z > 0; the door's wall along z = DEPTH has it at z < DEPTH
    for name, low, high in (
        ("WallInside#0_0_0", 0, 0.05),
        ("WallOutside#0_0_0", -0.0447, 0.0053),
        ("WallInside#0_0_2", DEPTH - 0.05, DEPTH),
        ("WallOutside#0_0_2", DEPTH - 0.0053, DEPTH + 0.0447),
    ):
        assert parts[name].bounds[:, 2].tolist() == pytest.approx([low, high], abs=1e-4)


def test_floors_and_ceilings(root):
    room = room_of(root)
    for mesh, low, high in ((room.floor, 0.0, 0.05), (room.ceiling, 2.69, 2.74)):
        solid = trimesh.Trimesh(mesh.vertices, mesh.faces)
        assert solid.is_watertight
        assert solid.volume == pytest.approx((WIDTH + 0.04) * (DEPTH + 0.04) * 0.05)
        np.testing.assert_allclose(solid.bounds, [[-0.02, low, -0.02], [WIDTH + 0.02, high, DEPTH + 0.02]], atol=1e-12)
        top = mesh.vertices[mesh.faces].reshape(-1, 3)
        np.testing.assert_allclose(mesh.uv.reshape(-1, 2), top[:, [0, 2]], atol=1e-6)


def test_the_door_is_open_in_both_prisms(root):
    """Rays through the middle of the door's hole, at 0.2 m steps of its height, meet no wall; beside it, they do."""
    walls = trimesh.Trimesh(room_of(root).walls.vertices, room_of(root).walls.faces, process=False)
    heights = np.arange(0.1, 2.0, 0.2)
    # hole from 0.62 to 1.38 m along the wall, which starts at x = WIDTH
    origin = np.stack([np.full_like(heights, WIDTH - 1.0), heights, np.full_like(heights, 1.0)], -1)
    direction = np.broadcast_to([0.0, 0.0, 1.0], origin.shape)
    assert not walls.ray.intersects_any(origin, direction).any()
    beside, above = origin.copy(), origin.copy()
    beside[:, 0] -= 0.6
    above[:, 1] = np.linspace(2.12, 2.7, len(heights))
    assert walls.ray.intersects_any(beside, direction).all()
    assert walls.ray.intersects_any(above, direction).all()


def test_materials(root):
    room = room_of(root)
    assert room.floor.materials == (Material("material_0", (1.0, 1.0, 1.0), root / "texture" / "wood_1.png", 1.0),)
    inside, cut, outside = room.walls.materials[:3]
    assert inside == Material("material_0", (1.0, 0.0, 0.0), root / "texture" / "wallp_0.jpg", 1.0)
    assert (cut.texture, outside) == (None, Material("material_2", (1.0, 1.0, 1.0), None, 1.0))
    large = np.isin(room.walls.slot, range(0, 12, 3)) & (room.walls.group == 0)
    normal = trimesh.Trimesh(room.walls.vertices, room.walls.faces, process=False).face_normals[large]
    np.testing.assert_allclose(abs(normal), np.broadcast_to([0, 0, 1], normal.shape), atol=1e-9)
    assert len(room.walls.materials) == 12


def test_meshes_of_rooms_go_before_the_architecture(root):
    cuboid = ("Floor#0_0", "material_0", (0, 0, 0), (1, 1, 1))
    write_mesh(root / "room" / HOUSE_ID, "fr_0rm_0f", [cuboid], [("1 1 1", "")])
    room = room_of(root)
    assert room.floor.vertices.max() == 1
    assert room.walls.path == arch_path(root)


def test_hidden_parts_are_not_built(root):
    edit_house(root, lambda doc: doc["levels"][0]["nodes"][0].update(hideWalls=1))
    edit_arch(root, lambda doc: doc["elements"][0].update(points=5))
    assert room_of(root).walls is None


def test_units_are_scaled_to_metres(root):
    plain = room_of(root)
    edit_arch(root, lambda doc: doc.update(scaleToMeters=0.01, defaults=None))
    scaled = room_of(root)
    np.testing.assert_allclose(np.ptp(scaled.floor.vertices[:, 0]), (WIDTH + 2.0 * 1) / 100 + 0.02, atol=1e-3)
    assert np.ptp(plain.floor.vertices[:, 0]) == pytest.approx(WIDTH + 0.04)


def test_without_defaults_the_measures_are_those_of_suncg(root):
    plain = room_of(root)
    edit_arch(root, lambda doc: doc.pop("defaults"))
    bare = room_of(root)
    for part in ("floor", "ceiling", "walls"):
        np.testing.assert_array_equal(getattr(bare, part).vertices, getattr(plain, part).vertices)


def test_measures_of_an_element_go_before_defaults(root):
    edit_arch(root, lambda doc: doc["elements"][0].update(depth=0.3, height=2.0))
    solid = solids(room_of(root).walls)["WallInside#0_0_0"]
    np.testing.assert_allclose(np.ptp(solid.bounds, axis=0), [WIDTH + 0.24, 2.035, 0.15])


def test_several_polygons_make_one_floor(root):
    square = [[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]]
    far = [[x + 5, y, z] for x, y, z in square[::-1]]
    edit_arch(root, lambda doc: doc["elements"][4].update(points=[square, far]))
    floor = room_of(root).floor
    assert trimesh.Trimesh(floor.vertices, floor.faces).volume == pytest.approx(2 * 1.04**2 * 0.05)


def test_skewed_walls(root):
    edit_arch(root, lambda doc: doc["elements"][0].update(points=[[1, 0, 2], [4, 0, 6]], holes=[]))
    solid = solids(room_of(root).walls)["WallInside#0_0_0"]
    assert solid.is_watertight
    assert solid.volume == pytest.approx(5.08 * 2.735 * 0.05)
    way = np.array([0.6, 0, 0.8])
    off = (solid.vertices - [1, 0, 2]) @ np.cross(way, [0, 1, 0])
    assert off.min() == pytest.approx(0, abs=1e-12)
    assert off.max() == pytest.approx(0.05)


def test_wall_without_length_is_left_out(root):
    edit_arch(root, lambda doc: doc["elements"][1].update(points=[[1, 0, 1], [1, 0, 1]]))
    house = load(root)
    assert [(p.element, p.rule) for p in house.problems] == [("elements[1].points", "flat-wall")]
    assert len(house.levels[0].rooms[0].walls.groups) == 6


def test_unknown_elements_and_versions_are_noted(root):
    edit_arch(root, lambda doc: doc.update(version="x", elements=[*doc["elements"], {"type": "Roof", "id": "r"}]))
    house = load(root)
    assert {(p.element, p.rule) for p in house.problems} == {
        ("version", "format-version"),
        ("elements[7].type", "element-type"),
    }


def test_neither_meshes_nor_architecture(root):
    arch_path(root).unlink()
    with pytest.raises(DatasetError, match="no folder of room meshes") as caught:
        load(root)
    assert f"{HOUSE_ID}.arch.json" in (caught.value.hint or "")


@pytest.mark.parametrize(
    ("index", "change", "element", "message"),
    [
        (0, {"points": [[0, 0, 0]]}, "points", "expected 2 points, got 1"),
        (0, {"points": [[0, 0, 0], [1, 0]]}, "points[1]", "expected 3 numbers, got 2"),
        (0, {"points": [[0, 0, 0], [4, 1, 0]]}, "points", "expected ends of one height"),
        (0, {"points": [[0, 0, 0], [float("nan"), 0, 0]]}, "points[1][0]", "expected a finite number"),
        (0, {"points": [[0, 0, 0], [1e300, 0, 0]]}, "points[1][0]", "expected a number between"),
        (0, {"height": -1}, "height", "expected a length of at least 0.001, got -1"),
        (0, {"depth": 0}, "depth", "expected a length"),
        (0, {"holes": [{}]}, "holes[0].box", "expected an object"),
        (0, {"holes": [{"box": {"min": [1, 0], "max": [0, 1]}}]}, "holes[0].box", "hole is inside out"),
        (0, {"holes": [{}] * 51}, "holes", "expected at most 50 holes"),
        (0, {"materials": [{"texture": "nothing"}]}, "materials[0].texture", "texture `nothing` is missing"),
        (0, {"materials": [{"texture": "../../x"}]}, "materials[0].texture", "leads out of the dataset"),
        (0, {"id": 7}, "id", "expected a string"),
        (4, {"offset": None}, "offset", "expected a list"),
        (4, {"points": []}, "points", "expected at least one polygon"),
        (4, {"points": [[[0, 0, 0], [1, 0, 0]]]}, "points[0]", "expected 3 to 1000 corners"),
        (4, {"points": [[[0, 0, 0], [1, 0, 0], [2, 0, 0]]]}, "points", "polygon has no area"),
        (4, {"points": [[[0, 0, 0], [4, 0, 3], [4, 0, 0], [0, 0, 2]]]}, "points", "polygon crosses itself"),
        (4, {"depth": float("inf")}, "depth", "expected a finite number"),
    ],
)
def test_broken_elements(root, index, change, element, message):
    edit_arch(root, lambda doc: doc["elements"][index].update(change))
    with pytest.raises(DatasetError) as caught:
        load(root)
    assert (caught.value.file, caught.value.element) == (str(arch_path(root)), f"elements[{index}].{element}")
    assert message in caught.value.message
    assert caught.value.hint


@pytest.mark.parametrize(
    ("change", "element", "message"),
    [
        ({"elements": None}, "elements", "expected a list"),
        ({"elements": [{}]}, "elements[0].type", "expected a string"),
        ({"elements": [{"type": "Wall"}]}, "elements[0].roomId", "expected a string"),
        ({"elements": [{"type": "Roof"}] * 10_001}, "elements", "expected at most 10000 elements"),
        ({"scaleToMeters": 0}, "scaleToMeters", "expected metres per unit"),
        ({"defaults": 5}, "defaults", "expected an object"),
    ],
)
def test_broken_architecture_files(root, change, element, message):
    edit_arch(root, lambda doc: doc.update(change))
    with pytest.raises(DatasetError, match=message) as caught:
        load(root)
    assert (caught.value.file, caught.value.element) == (str(arch_path(root)), element)


def test_architecture_that_is_no_json(root):
    arch_path(root).write_text(json.dumps({"a": 1})[:-1])
    with pytest.raises(DatasetError, match="not valid JSON"):
        load(root)


@pytest.mark.parametrize(
    ("hole", "open_area"),
    [
        ((1.0, 2.0, 0.5, 1.5), 1.0),  # inside
        ((-1.0, 1.0, 0.5, 1.5), 1.04),  # beyond the start: open to the end of the prism
        ((3.0, 4.0, 0.5, 1.5), 1.04),
        ((1.0, 2.0, -1.0, 1.0), 1.0),  # down to the floor
        ((1.0, 2.0, 2.0, 2.7), 0.735),  # up to the nominal height: open to the top
        ((-1.0, 5.0, 1.0, 2.0), 4.08),  # all along: two pieces
    ],
)
def test_holes_at_the_edges_of_a_wall(hole, open_area):
    wall = WallSegment(np.zeros(3), np.array([4.0, 0, 0]), 2.7, (hole,))
    for prism in wall_prisms(wall):
        solid = trimesh.Trimesh(prism.vertices, prism.faces, process=False)
        assert solid.is_watertight
        assert solid.volume == pytest.approx(0.05 * (4.08 * 2.735 - open_area))


def test_a_hole_as_large_as_the_wall_leaves_nothing():
    inner, _ = wall_prisms(WallSegment(np.zeros(3), np.array([4.0, 0, 0]), 2.7, ((-1, 9, -1, 9),)))
    assert len(inner.faces) == 0


def test_holes_that_meet_are_merged(rng):
    for _ in range(50):
        corner, size = rng.uniform(0, 4, (6, 2)), rng.uniform(0.1, 1, (6, 2))
        holes = [(x, x + w, y, y + h) for (x, y), (w, h) in zip(corner.tolist(), size.tolist(), strict=True)]
        merged = merge_holes(holes)
        for a in merged:
            assert not any(a[0] <= b[1] and b[0] <= a[1] and a[2] <= b[3] and b[2] <= a[3] for b in merged if b != a)
        for x0, x1, y0, y1 in holes:
            assert any(a <= x0 and x1 <= b and c <= y0 and y1 <= d for a, b, c, d in merged)
    assert merge_holes([(0, 1, 0, 1), (2, 3, 0, 1), (1, 2, 0, 1)]) == [(0, 3, 0, 1)]


def star(rng, count):
    """A star-shaped polygon with random radii: simple, and mostly not convex."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, count))
    return rng.uniform(1, 5, count)[:, None] * np.stack([np.cos(angle), np.sin(angle)], 1)


def test_slabs_of_any_polygon_are_closed_and_have_its_area(rng):
    for count in rng.integers(6, 40, 60):
        polygon = star(rng, count)
        x, z = polygon.T
        area = abs((x * np.roll(z, -1) - np.roll(x, -1) * z).sum()) / 2
        vertices, faces, _ = slab([polygon], 0.0, 0.5, 0.0)
        solid = trimesh.Trimesh(vertices, faces, process=False)
        assert solid.is_watertight
        assert solid.volume == pytest.approx(0.5 * area)


def test_straight_and_repeated_corners_make_no_difference():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2]], float)
    odd = np.array([[0, 0], [1, 0], [1, 0], [2, 0], [2, 2], [2, 2], [1, 2], [0, 2], [0, 1e-9]], float)
    for polygon in (square, odd, odd[::-1]):
        vertices, faces, _ = slab([polygon], 0.0, 1.0, 0.1)
        solid = trimesh.Trimesh(vertices, faces, process=False)
        assert (len(vertices), len(faces), solid.is_watertight) == (8, 12, True)
        assert solid.volume == pytest.approx(2.2**2)


def test_narrow_notches_do_not_close_up():
    notch = np.array([[0, 0], [2, 0], [2, 1.99], [1, 1.99], [1, 2.01], [2, 2.01], [2, 4], [0, 4]], float)
    vertices, faces, _ = slab([notch], 0.0, 1.0, 0.05)
    assert trimesh.Trimesh(vertices, faces, process=False).volume == pytest.approx(8 - 0.02)


def test_frame_only_variants_are_reachable(root):
    write_mesh(root / "object" / DOOR, f"{DOOR}_2", [("", "material_0", (0, 0, 0), (1, 2, 1))], [], mtl=DOOR)
    mesh = open_dataset(root).load_model(f"{DOOR}_2")
    assert mesh.path.name == f"{DOOR}_2.obj"
    assert mesh.vertices.max() == 2
