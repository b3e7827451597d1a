import dataclasses

import jax
import numpy as np
import pytest
from bank_views import house_navigation, leaves, triangles_of, world_surfaces
from handmade import Furniture, shoebox, two_rooms
from PIL import Image

from home_mjx.bank.bank import HouseBank
from home_mjx.bank.packing.capacity import ragged_class, size_class
from home_mjx.bank.packing.library import HEIGHT, RADIUS, agent_model
from home_mjx.errors import ConfigError, DatasetError
from home_mjx.geometry.boxes import box_inertia
from home_mjx.geometry.meshes import FACE_NORMALS, box_triangles
from home_mjx.schema.categories import COARSE, FINE, NYU40
from home_mjx.schema.compiled import ARCHITECTURE, CompiledHouse
from home_mjx.schema.semantic import Semantic

STOOL = Furniture((1.0, 0.5), size=(0.4, 0.6, 0.5), yaw=0.3, mass=4.0)
DESK = Furniture((-1.5, -1.0), size=(1.2, 0.6, 0.7), category="desk")


@pytest.fixture(scope="module")
def houses() -> list[CompiledHouse]:
    return [shoebox(furniture=[STOOL, DESK]), two_rooms(), shoebox(furniture=[DESK, STOOL, DESK], absorption=0.5)]


@pytest.fixture(scope="module")
def bank(houses) -> HouseBank:
    return HouseBank.from_compiled(houses)


def test_every_model_is_stored_once(bank, houses):
    keys = {key for h in houses for key in h.instances.model[1:]}
    model = np.asarray(bank.geometry.instance_model)
    own = model[:, ARCHITECTURE].tolist()
    assert sorted(np.unique(model).tolist()) == [-1, *range(1, len(keys) + len(houses) + 1)]
    assert own == [1 + len(keys) + h for h in range(len(houses))]
    assert houses[0].instances.model[2] == houses[2].instances.model[1]
    assert bank.geometry.instance_model[0, 2] == bank.geometry.instance_model[2, 1]


def test_trees_hold_the_triangles_of_their_own_model(bank, houses):
    for h, house in enumerate(houses):
        for i, key in enumerate(house.instances.model):
            model = int(bank.geometry.instance_model[h, i])
            np.testing.assert_array_equal(triangles_of(bank, model), house.models[key].triangle)
            np.testing.assert_array_equal(bank.geometry.model_box[model], house.models[key].box.astype(np.float32))


def test_top_tree_holds_exactly_the_static_instances(bank, houses):
    for h, house in enumerate(houses):
        found = sorted(leaves(bank, int(bank.geometry.house_root[h])))
        static = [(i, 1) for i in np.flatnonzero(house.instances.body < 0).tolist()]
        assert found == static
        assert found[0][0] == ARCHITECTURE


def test_order_of_houses_changes_nothing_in_a_house(bank, houses):
    order = [2, 0, 1]
    other = HouseBank.from_compiled([houses[i] for i in order])
    assert other.spec == bank.spec
    for new, old in enumerate(order):
        for a, b in zip(world_surfaces(bank, old), world_surfaces(other, new), strict=True):
            jax.tree.map(np.testing.assert_array_equal, a, b)
        jax.tree.map(lambda a, b, o=old, n=new: np.testing.assert_array_equal(a[o], b[n]), bank.physics, other.physics)
        jax.tree.map(np.testing.assert_array_equal, house_navigation(bank, old), house_navigation(other, new))


def test_poses_and_inverses_undo_each_other(bank):
    pose, inverse = np.asarray(bank.geometry.instance_pose), np.asarray(bank.geometry.instance_inverse)
    product = pose[..., :3] @ inverse[..., :3]
    np.testing.assert_allclose(product, np.broadcast_to(np.eye(3), product.shape), atol=1e-6)
    shift = (pose[..., :3] @ inverse[..., 3:])[..., 0] + pose[..., 3]
    np.testing.assert_allclose(shift, 0, atol=1e-5)


def test_body_frames_agree_with_instance_poses(bank):
    """World from model = world from body after body from model."""
    for h in (0, 2):
        for k in np.flatnonzero(np.asarray(bank.physics.body_valid[h])):
            i = int(bank.physics.body_instance[h, k])
            w, x, y, z = np.asarray(bank.physics.body_quat[h, k], float)
            assert x == y == 0
            turn = np.array([[w * w - z * z, -2 * w * z, 0], [2 * w * z, w * w - z * z, 0], [0, 0, 1]])
            inner = np.asarray(bank.physics.body_from_model[h, k])
            world = np.c_[turn @ inner[:, :3], turn @ inner[:, 3] + np.asarray(bank.physics.body_pos[h, k])]
            np.testing.assert_allclose(world, bank.geometry.instance_pose[h, i], atol=1e-6)
            assert int(bank.geometry.instance_body[h, i]) == k


def test_padding_is_inert(bank):
    g, p = bank.geometry, bank.physics
    empty = np.asarray(g.instance_model) < 0
    for name in ("instance_object", "instance_body"):
        assert (np.asarray(getattr(g, name))[empty] == -1).all()
    used = np.arange(g.node_child.shape[0]) < sum(map(len, [leaves(bank, int(r)) for r in g.model_root[:5]]))
    assert (np.asarray(g.node_child)[~used][-1] == -1).all()
    assert (np.asarray(p.collider_pos)[..., 2] <= -99).any(axis=1).all()
    assert not np.asarray(bank.acoustics.plane_valid)[0, 6:].any()
    assert (np.asarray(bank.materials.absorption) <= 1).all()
    assert (np.asarray(p.body_inertia) > 0).all()


def test_similar_banks_share_shapes_and_structure(bank, houses):
    """One compiled step serves both."""
    other = HouseBank.from_compiled([shoebox(furniture=[DESK] * 3), two_rooms((3.9, 5.0, 3.0)), houses[0]])
    assert jax.tree.structure(bank) == jax.tree.structure(other)
    assert jax.tree.map(lambda a: (a.shape, a.dtype), bank) == jax.tree.map(lambda a: (a.shape, a.dtype), other)


def test_a_house_is_chosen_by_a_traced_index(bank, houses):
    pick = jax.jit(lambda b, h: (b.navigation.start[h, 0], b.physics.body_mass[h]))
    for h, house in enumerate(houses):
        start, mass = pick(bank, np.int32(h))
        np.testing.assert_allclose(start, house.navigation.start[0], rtol=1e-6)
        np.testing.assert_allclose(mass[: len(house.bodies.mass)], house.bodies.mass)


def test_object_ids_stay_below_those_of_agents(houses):
    many = dataclasses.replace(houses[0].instances, object_id=np.array([-1, 40, 41]))
    bank = HouseBank.from_compiled([dataclasses.replace(houses[0], instances=many)])
    assert bank.spec.num_instances > 41


def test_agent_is_a_capsule_that_faces_x(bank):
    model = agent_model()
    np.testing.assert_array_equal(triangles_of(bank, int(bank.geometry.agent_model)), model.triangle)
    body = model.triangle[model.slot == 0].reshape(-1, 3)
    axis = np.clip(body[:, 2], -HEIGHT / 2 + RADIUS, HEIGHT / 2 - RADIUS)
    np.testing.assert_allclose(np.hypot(np.hypot(body[:, 0], body[:, 1]), body[:, 2] - axis), RADIUS, atol=1e-6)
    np.testing.assert_allclose([body[:, 2].min(), body[:, 2].max()], [-HEIGHT / 2, HEIGHT / 2], atol=1e-6)
    visor = model.triangle[model.slot == 1].reshape(-1, 3)
    assert visor[:, 0].min() > 0
    assert visor[:, 0].max() > RADIUS
    np.testing.assert_allclose(visor[:, 2].mean(), 1.5 - HEIGHT / 2, atol=1e-6)  # at eye height
    row = np.asarray(bank.semantics)[int(bank.geometry.agent_semantic)]
    names = FINE[row[Semantic.FINE]], COARSE[row[Semantic.COARSE]], NYU40[row[Semantic.NYU40]]
    assert names == ("person",) * 3


def test_agent_surface_points_outwards():
    triangle = agent_model().triangle[agent_model().slot == 0]
    normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
    centroid = triangle.mean(axis=1)
    outwards = centroid - np.c_[np.zeros((len(centroid), 2)), np.clip(centroid[:, 2], -0.7, 0.7)]
    assert (np.einsum("td,td->t", normal, outwards) > 0).all()


def test_box_faces_point_outwards():
    triangle = box_triangles(np.array([1.0, 2, 3]), np.array([0.5, 1, 2]))
    normal = np.cross(triangle[:, 1] - triangle[:, 0], triangle[:, 2] - triangle[:, 0])
    unit = normal / np.linalg.norm(normal, axis=1, keepdims=True)
    np.testing.assert_allclose(unit, np.repeat(FACE_NORMALS, 2, axis=0), atol=1e-12)
    np.testing.assert_allclose(np.linalg.norm(normal, axis=1).sum() / 2, 2 * (1 * 2 + 1 * 4 + 2 * 4))


def test_inertia_of_a_box_is_that_of_its_points(rng):
    half = np.array([0.2, 0.5, 0.3])
    points = rng.uniform(-half, half, (400_000, 3))
    square = points**2
    expected = 3.0 * (square.sum(axis=1, keepdims=True) - square).mean(axis=0)
    np.testing.assert_allclose(box_inertia(np.array(3.0), half), expected, rtol=0.01)


def test_size_classes_hold_and_waste_little():
    for count in (0, 1, 63, 64, 65, 1000, 102_076):
        assert count <= size_class(count, 32)
        assert count <= ragged_class(count) <= max(64, 1.25 * count + 64)


def test_textures_are_shared_by_path_and_keep_their_rows(tmp_path, houses):
    image = np.zeros((64, 32, 3), np.uint8)
    image[:32] = (255, 0, 0)
    Image.fromarray(image).save(tmp_path / "half.png")
    Image.new("RGB", (8, 8), (0, 0, 255)).save(tmp_path / "blue.png")
    textured = [_with_textures(h, [tmp_path / "half.png", tmp_path / "blue.png"]) for h in houses]
    bank = HouseBank.from_compiled(textured)
    layer = np.asarray(bank.materials.texture)
    assert sorted(set(layer.tolist())) == [-1, 0, 1]
    textures = np.asarray(bank.materials.textures)[:, : 128 * 128].view(np.uint8).reshape(-1, 128, 128, 4)
    red = next(t for t in textures if t[4, 4, 0] > 250)
    assert (red[:56, :, 0] > 250).all()
    assert (red[72:, :, 0] < 5).all()
    assert (red[..., 3] == 255).all()


def _with_textures(house: CompiledHouse, paths) -> CompiledHouse:
    texture = [str(paths[i % 2]) for i in range(len(house.materials.texture))]
    return dataclasses.replace(house, materials=dataclasses.replace(house.materials, texture=tuple(texture)))


def test_missing_and_broken_textures_are_named(tmp_path, houses):
    (tmp_path / "broken.png").write_bytes(b"no image")
    for name in ("absent.png", "broken.png"):
        with pytest.raises(DatasetError, match=name):
            HouseBank.from_compiled([_with_textures(houses[0], [tmp_path / name] * 2)])


def test_albedo_is_linear_light(bank, houses):
    house = houses[0]
    row = int(bank.geometry.instance_material[0, 1])
    color = house.materials.albedo[house.instances.material[1], :3]
    np.testing.assert_allclose(bank.materials.albedo[row, :3], ((color + 0.055) / 1.055) ** 2.4, rtol=1e-5)
    assert bank.materials.albedo[row, 3] == 1


def test_refusals(houses):
    with pytest.raises(ConfigError, match="at least one"):
        HouseBank.from_compiled([])
    with pytest.raises(ConfigError, match="ASCII"):
        HouseBank.from_compiled([dataclasses.replace(houses[0], id="ü")])


@pytest.mark.parametrize("name", ["cell", "agent_radius", "agent_height"])
def test_houses_compiled_for_different_agents_or_cells_share_no_bank(houses, name):
    other = dataclasses.replace(houses[0].navigation, **{name: 0.2})
    with pytest.raises(ConfigError, match=name.replace("_", " ")):
        HouseBank.from_compiled([houses[0], dataclasses.replace(houses[0], navigation=other)])


def test_a_bank_tells_what_its_houses_were_compiled_for(bank, houses):
    navigation = houses[0].navigation
    assert (bank.spec.cell, bank.spec.agent_radius, bank.spec.agent_height) == (navigation.cell, 0.1, 1.6)


def test_ids_can_be_read_back(bank, houses):
    ids = [bytes(row).rstrip(b"\0").decode() for row in np.asarray(bank.house_id)]
    assert ids == [h.id for h in houses]
