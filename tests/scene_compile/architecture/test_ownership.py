"""Rooms that overlap: every place of a floor or ceiling has one room, that of navigation, from wherever it is seen."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats
from hypothesis import given, settings
from hypothesis import strategies as st
from scenes import scene_of

from home_mjx.datasets.outlines import RoomOutline, outline_house
from home_mjx.datasets.registry import open_dataset
from home_mjx.geometry.polygons import find_smallest_room, is_inside_polygon, polygon_area
from home_mjx.raycast_render.casting.cast import cast
from home_mjx.raycast_render.scene import surface
from home_mjx.scene_compile.architecture import shell as shell_module
from home_mjx.scene_compile.architecture.floor_assignment import ClippedSurface, clip_surface
from home_mjx.scene_compile.architecture.rooms import find_frame
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.house import Material, Metadata
from home_mjx.schema.semantic import Semantic
from home_mjx.schema.vocabulary import encode_name

HALL = RoomOutline("Hall", [(0, 0), (8, 0), (8, 6), (0, 6)])
NICHE = RoomOutline("Bedroom", [(5, 3), (8, 3), (8, 6), (5, 6)], floor=Material("red", (0.9, 0.1, 0.1)))
ELL = RoomOutline("Kitchen", [(1, 1), (4, 1), (4, 2), (2, 2), (2, 4), (1, 4)])


@pytest.fixture(scope="module")
def nested():
    return outline_house("nested", [NICHE, HALL, ELL])


def over(triangles: np.ndarray, points: np.ndarray) -> np.ndarray:
    """How many triangles cover each point of the plan; points on their edges count for none."""
    found = np.zeros(len(points), int)
    for (x0, y0), (x1, y1), (x2, y2) in triangles[..., :2]:
        det = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0)
        a = ((points[:, 0] - x0) * (y2 - y0) - (x2 - x0) * (points[:, 1] - y0)) / det
        b = ((x1 - x0) * (points[:, 1] - y0) - (points[:, 0] - x0) * (y1 - y0)) / det
        found += (a > 0) & (b > 0) & (a + b < 1)
    return found


def seen_faces(house, part: int, up: float) -> np.ndarray:
    model = house.models[house.instances.model[0]]
    triangles = model.triangle[model.part == part].astype(float)
    normal = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    return triangles[up * normal[:, 2] > 0.7 * np.linalg.norm(normal, axis=1)]


@pytest.mark.parametrize(("category", "up"), [("floor", 1.0), ("ceiling", -1.0)])
def test_every_place_is_covered_once_by_the_smallest_room(nested, rng, category, up):
    house = compile_house(nested, Metadata({}))
    frame = find_frame(nested)
    parts = [p for p in shell_module.build_shell(frame).parts if p.kind == category]
    points = rng.uniform([-4, -3], [4, 3], (4000, 2))
    covers = np.array([over(seen_faces(house, i, up), points) for i in part_rows(house, category)])
    assert (covers.sum(axis=0) == 1).mean() > 0.999  # points may lie on an edge
    owner = np.array([p.room for p in parts])[covers.argmax(axis=0)]
    assert (owner == find_smallest_room(house.rooms, np.arange(3), points))[covers.sum(axis=0) == 1].all()


def part_rows(house, category: str) -> list[int]:
    fine = encode_name(Semantic.FINE, category)
    is_part = (house.semantics[:, Semantic.FINE] == fine) & (house.semantics[:, Semantic.OBJECT_ID] < 0)
    return np.flatnonzero(is_part).tolist()


def agreement(house, num_points: int, eyes: np.ndarray) -> tuple[float, float]:
    """Shares of floor points to which all eyes give one room, and of looks that find navigation's room."""
    corners = np.concatenate(house.rooms.polygon)
    points = np.random.default_rng(0).uniform(corners.min(axis=0), corners.max(axis=0), (num_points, 2))
    owner = find_smallest_room(house.rooms, np.flatnonzero(house.rooms.level == house.rooms.level.min()), points)
    points, owner = points[owner >= 0], owner[owner >= 0]
    target = np.c_[points, house.rooms.floor[owner]]
    scene = scene_of(house)

    @jax.jit
    def look(eye, way):
        hit = cast(scene, eye, way, backend="cpu")
        return hit.instance, hit.t, surface.semantics(scene, hit, Semantic.ROOM)

    rooms = np.full((len(eyes), len(points)), -2)  # not seen
    for row, eye in zip(rooms, eyes, strict=True):
        way = target - eye
        found = look(jnp.asarray(eye, jnp.float32), jnp.asarray(way, jnp.float32))
        instance, t, room = (np.asarray(x) for x in found)
        seen = (instance == 0) & (abs(t - 1) * np.linalg.norm(way, axis=1) < 2e-3)
        row[seen] = room[seen]
    often = (rooms > -2).sum(axis=0) > 1
    assert often.sum() > 100
    same = [len(set(column) - {-2}) == 1 for column in rooms.T[often].tolist()]
    return float(np.mean(same)), float((rooms == owner)[rooms > -2].mean())


def test_rays_from_everywhere_find_the_room_of_navigation(nested, rng):
    house = compile_house(nested, Metadata({}))
    eyes = np.c_[rng.uniform([-3.5, -2.5], [3.5, 2.5], (12, 2)), rng.uniform(0.6, 2.4, 12)]
    assert agreement(house, 1500, eyes) == (1.0, 1.0)


def test_rays_in_the_real_house_find_the_room_of_navigation(suncg_root, rng):
    dataset = open_dataset(suncg_root)
    house = compile_house(dataset.load_house(dataset.house_ids[0]), dataset.metadata)
    starts = house.navigation.start[:: len(house.navigation.start) // 16]
    eyes = starts + np.array([0, 0, 1.2])
    same, right = agreement(house, 4000, eyes)
    assert same > 0.99  # strips of 4 cm where two floors reach under one wall
    assert right > 0.99


def test_textures_stay_where_they_were(nested):
    """Coordinates of the pieces are those of the floor that was cut."""
    shell = shell_module.build_shell(find_frame(nested))
    for i, part in enumerate(shell.parts):
        if part.kind != "floor":
            continue
        whole, uv = part.triangles, part.mesh.uv[part.faces]
        top = np.flatnonzero(np.ptp(whole[..., 2], axis=1) < 1e-9)
        plan, texture = whole[top].reshape(-1, 3)[:, :2], uv[top].reshape(-1, 2)
        rule, *_ = np.linalg.lstsq(np.c_[plan, np.ones(len(plan))], texture, rcond=None)
        mine = (shell.model.part == i) & (np.ptp(shell.model.triangle[..., 2], axis=1) < 1e-6)
        corners = shell.model.triangle[mine].reshape(-1, 3)[:, :2]
        expected = np.c_[corners, np.ones(len(corners))] @ rule
        np.testing.assert_allclose(shell.model.uv[mine].reshape(-1, 2), expected, atol=1e-4)


def test_generated_houses_are_not_cut(tmp_path, monkeypatch):
    """Their floors share strips of 4 cm under walls only: the compiled architecture is the same, byte for byte."""
    ids = generate_flats(tmp_path, range(2))
    dataset = open_dataset(tmp_path)
    houses = [dataset.load_house(house_id) for house_id in ids[:1]]
    ours = [shell_module.build_shell(find_frame(house)).model.key for house in houses]
    monkeypatch.setattr(shell_module, "_owned", uncut)
    assert ours == [shell_module.build_shell(find_frame(house)).model.key for house in houses]


def uncut(part, parts, rooms) -> ClippedSurface:
    return ClippedSurface(part.triangles, part.mesh.uv[part.faces], np.arange(len(part.faces)))


number = st.floats(-3, 3).map(lambda x: round(x, 2))
corners = st.lists(st.tuples(number, number), min_size=3, max_size=3).map(np.array)
triangle = corners.filter(lambda t: polygon_area(t) > 0.1)


@settings(max_examples=40)
@given(floor=triangle, cutters=st.lists(triangle, min_size=1, max_size=3))
def test_any_triangles_are_cut_out(floor, cutters):
    """Points stay covered if, and only if, no cutter holds them; the winding stays."""
    (x0, y0), (x1, y1), (x2, y2) = floor
    if (x1 - x0) * (y2 - y0) < (x2 - x0) * (y1 - y0):
        floor = floor[::-1]
    slab = np.c_[floor, np.zeros(3)][None]
    found = clip_surface(slab, floor[None].astype(float), 1.0, [cutters])
    points = np.random.default_rng(0).uniform(-3, 3, (400, 2))
    held = is_inside_polygon(floor, points)
    gone = np.any([is_inside_polygon(c, points) for c in cutters], axis=0)
    covered = over(found.triangles, points)
    if covered.max() == 0 or (gone | ~held).all():
        return  # all of it would have gone, so all stays
    near = np.min([edge_distance(t, points) for t in (floor, *cutters)], axis=0) < 1e-3
    assert (covered[~near] == (held & ~gone)[~near]).all()
    assert (found.triangle_index == 0).all()
    np.testing.assert_allclose(found.uv, found.triangles[..., :2], atol=1e-6)


def edge_distance(corners: np.ndarray, points: np.ndarray) -> np.ndarray:
    way = np.roll(corners, -1, axis=0) - corners
    along = ((points[:, None] - corners) * way).sum(-1) / (way**2).sum(-1)
    nearest = corners + np.clip(along, 0, 1)[..., None] * way
    return np.linalg.norm(points[:, None] - nearest, axis=-1).min(axis=1)
