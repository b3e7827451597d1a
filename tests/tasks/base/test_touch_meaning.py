"""What is known of both sides of a touch, against what the semantic engine says of the house's file."""

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats

from home_mjx.bank.bank import HouseBank
from home_mjx.datasets.registry import open_dataset
from home_mjx.houses.house_set import HouseSet
from home_mjx.physics.base.state import FLOOR, NOTHING, STATIC
from home_mjx.raycast_render.scene.scene import make_scene
from home_mjx.scene_compile.semantics.engine import house_semantics
from home_mjx.schema.categories import coarse_index
from home_mjx.schema.contact_materials import CONTACT_BY_KIND, DEFAULT_CONTACT, MAX_BOUNCING_MASS, RUBBER_CONTACT
from home_mjx.schema.material_kinds import MATERIAL_KINDS
from home_mjx.schema.semantic import Semantic
from home_mjx.tasks.sensors import BodyContacts, contact_semantics


class World:
    """Two generated houses in a bank; the second as compiled, and what its file means."""

    def __init__(self, root):
        ids = generate_flats(root, [0, 1])
        dataset = open_dataset(root)
        files = [dataset.load_house(i) for i in ids]
        houses = HouseSet(dataset, ids=ids).load()
        self.bank, self.house = HouseBank.from_compiled(houses), houses[1]
        self.file = house_semantics(files[1], dataset.metadata)

    def meaning(self, codes, pos=(0.0, 0.0, 0.8)):
        """Rows of all mobiles, and of what they touch; the agent is the first and stands at a place."""
        bodies = self.bank.physics.body_pos[1], self.bank.physics.body_quat[1]
        agent = jnp.asarray([pos], jnp.float32), jnp.array([[1.0, 0, 0, 0]])
        with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
            scene = make_scene(self.bank, jnp.int32(1), *bodies, *agent)
            other = np.full(scene.moving.instance.shape[0], NOTHING, np.int32)
            other[: len(codes)] = codes
            touch = BodyContacts(jnp.zeros(len(other)), jnp.zeros((len(other), 3)), jnp.asarray(other))
            found = contact_semantics(scene, touch)
        return np.asarray(found.body), np.asarray(found.other)

    def says(self, row, object_id) -> bool:
        """Whether a row is what the file says of an object."""
        item = self.file.objects_by_id[object_id]
        material = MATERIAL_KINDS.index(item.appearance.materials[0]) if item.appearance.materials else -1
        wanted = object_id, coarse_index(item.coarse), item.room, material
        columns = Semantic.OBJECT_ID, Semantic.COARSE, Semantic.ROOM, Semantic.MATERIAL
        return tuple(row[list(columns)].tolist()) == wanted


@pytest.fixture(scope="module")
def world(tmp_path_factory):
    return World(tmp_path_factory.mktemp("generated"))


def test_mobiles_mean_their_objects(world):
    own, other = world.meaning([])
    bodies, doors, owner = world.house.bodies, world.house.doors, world.house.instances.object_id
    assert own[0, Semantic.OBJECT_ID] == -1  # the agent, whose row is that of all agents
    assert own[0, Semantic.FINE] >= 0
    assert all(world.says(own[1 + k], int(owner[i])) for k, i in enumerate(bodies.instance))
    first = 1 + world.bank.spec.num_bodies
    assert all(world.says(own[first + h], int(owner[i])) for h, i in enumerate(doors.instance))
    assert (own[1 + len(bodies.mass) : first] == -1).all()
    assert (other == -1).all()


def test_static_boxes_mean_their_objects(world):
    boxes = world.house.colliders.object_id
    rows = np.flatnonzero(boxes >= 0)
    assert len(rows) > 10
    for row in rows.tolist():
        _, other = world.meaning([STATIC - row])
        assert world.says(other[0], int(boxes[row]))


def test_mobiles_meet_each_other(world):
    own, other = world.meaning([2, 0])
    np.testing.assert_array_equal(other[:2], own[[2, 0]])


def test_floors_and_walls_are_those_of_the_room(world):
    boxes = world.house.colliders
    wall = int(np.flatnonzero((boxes.object_id < 0) & (boxes.size[:, 2] > 1))[0])
    for room, polygon in enumerate(world.house.rooms.polygon):
        pos = (*polygon.mean(axis=0), world.house.rooms.floor[room] + 0.8)
        for code, kind in ((FLOOR, "floor"), (STATIC - wall, "wall")):
            row = world.meaning([code], pos)[1][0]
            parts = [p for p in world.file.parts if p.room == room and p.category == kind]
            assert row[Semantic.ROOM] == room
            assert row[Semantic.COARSE] == coarse_index(kind)
            materials = [
                MATERIAL_KINDS.index(p.appearance.materials[0]) if p.appearance.materials else -1 for p in parts
            ]
            assert row[Semantic.MATERIAL] == materials[0]
    _, outdoors = world.meaning([FLOOR], (500.0, 0.0, 0.8))
    assert (outdoors[0] == -1).all()


def test_bodies_slide_and_bounce_by_material(world):
    """Every number is one of the table's; what is heavy does not bounce; a bank holds them."""
    bodies = world.house.bodies
    known = {contact.friction for contact in (*CONTACT_BY_KIND.values(), RUBBER_CONTACT, DEFAULT_CONTACT)}
    assert set(bodies.friction.tolist()) <= known
    assert (bodies.restitution[bodies.mass > MAX_BOUNCING_MASS] == 0).all()
    assert set(CONTACT_BY_KIND) <= set(MATERIAL_KINDS)
    count = len(bodies.mass)
    np.testing.assert_allclose(world.bank.physics.body_friction[1, :count], bodies.friction)
    ratio = np.asarray(world.bank.physics.body_damping_ratio[1, :count], float)
    dull = bodies.restitution == 0
    assert (ratio[dull] == 1).all()
    back = np.exp(-np.pi * ratio[~dull] / np.sqrt(1 - ratio[~dull] ** 2))
    np.testing.assert_allclose(back, bodies.restitution[~dull], rtol=1e-5)
