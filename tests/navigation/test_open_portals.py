"""Which ways doors leave open: closed forms on a hand-made house, flood fills with leaves drawn in on others."""

from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
import pytest
from generated import generate_flats
from handmade import Furniture, shoebox, two_rooms
from numpy.testing import assert_allclose, assert_array_equal
from scipy import ndimage

from home_mjx.bank.bank import HouseBank
from home_mjx.geometry.boxes import BoxSet
from home_mjx.houses.house_set import HouseSet
from home_mjx.navigation import connected_rooms, door_angles, passable_portals
from home_mjx.scene_compile.navigation.clearance import compute_clearance
from home_mjx.scene_compile.navigation.portals import room_hops
from home_mjx.schema.compiled import CompiledHouse, Doors, PortalKind, Portals

KEY, HOUSE = jax.random.key(0), jnp.int32(0)
WIDTH, CLOSED, LOW, HIGH = 0.8, 0.3, -1.2, 0.3
LEAST = 2 * np.arcsin(0.2 / (2 * WIDTH))  # [rad] from closed, at which the gap is as wide as an agent


def leaves(count: int) -> Doors:
    """Leaves of 0.8 m, as placed not in their range."""
    box = {"pos": np.tile([0.4, 0, 1.0], (count, 1)), "quat": np.tile([1.0, 0, 0, 0], (count, 1))}
    size = np.tile([WIDTH / 2, 0.02, 1.0], (count, 1))
    low, high, closed = (np.full(count, angle) for angle in (LOW - 1, HIGH - 1, CLOSED - 1))
    pivot, rows = np.zeros((count, 2)), np.ones(count, np.int32)
    return Doors(
        rows, pivot, closed, low, low, high, **box, size=size, mass=np.full(count, 12.0), slide=np.zeros((count, 2)),
        is_front=np.zeros(count, bool),
    )  # fmt: skip


def house_with_doors() -> CompiledHouse:
    """Portals: a door of one leaf, one of two, an opening to the second room, a door outdoors, one that is blocked."""
    kinds = np.array([PortalKind.DOOR, PortalKind.DOOR, PortalKind.OPENING, PortalKind.DOOR, PortalKind.DOOR])
    portals = Portals(
        room=np.array([[0, 1], [0, 1], [0, 1], [-1, 0], [0, 1]], np.int32),
        pos=np.zeros((5, 3)),
        width=np.array([0.5, 1.0, 2.0, 0.5, 0.0]),
        kind=kinds.astype(np.int32),
        leaf=np.array([[0, -1], [1, 2], [-1, -1], [0, -1], [-1, -1]], np.int32),
    )
    house = two_rooms(furniture=[Furniture((1.0, 1.0))])
    return replace(house, doors=leaves(3), navigation=replace(house.navigation, portals=portals))


@pytest.fixture(scope="module")
def bank() -> HouseBank:
    return HouseBank.from_compiled([house_with_doors()])


def angles(bank: HouseBank, *from_closed: float) -> jax.Array:
    turned = jnp.zeros(bank.spec.num_doors, jnp.float32).at[: len(from_closed)].set(jnp.array(from_closed))
    return bank.physics.door_closed[0] - turned


def strictly(function, *args):
    with jax.numpy_dtype_promotion("strict"), jax.numpy_rank_promotion("raise"):
        return np.asarray(jax.jit(function)(*args))


@pytest.mark.parametrize("state", ["open", "closed", "initial", "random"])
def test_doors_stand_within_their_range(bank, state):
    found = strictly(lambda k: door_angles(bank, HOUSE, state, k), KEY)
    wanted = {"open": LOW - 1, "closed": CLOSED - 1, "initial": HIGH - 1}
    if state == "random":
        assert set(found[:3].round(5).tolist()) <= {np.float32(LOW - 1).round(5), np.float32(CLOSED - 1).round(5)}
    else:
        assert_allclose(found[:3], wanted[state], rtol=1e-6)
    assert_array_equal(found[3:], 0)


def test_random_doors_are_open_or_closed_each_for_itself(bank):
    keys = jax.random.split(KEY, 500)
    found = strictly(jax.vmap(lambda k: door_angles(bank, HOUSE, "random", k)), keys)[:, :3]
    shut = found > (LOW + CLOSED) / 2 - 1
    assert_allclose(shut.mean(axis=0), 0.5, atol=5 * 0.5 / np.sqrt(500))
    assert_allclose(np.corrcoef(shut.T), np.eye(3), atol=5 / np.sqrt(500))


def test_a_door_is_open_from_where_its_gap_is_as_wide_as_an_agent(bank):
    for turned, opens in ((0.0, False), (LEAST - 0.005, False), (LEAST + 0.005, True), (1.5, True)):
        found = strictly(lambda a: passable_portals(bank, HOUSE, a), angles(bank, turned))
        assert found[[0, 3]].tolist() == [opens, opens]
        assert found[[1, 2, 4]].tolist() == [False, True, False]
        assert not found[5:].any()


@pytest.mark.parametrize("turned", [(0, 1.0, 0), (0, 0, 1.0), (0, 1.0, 1.0)])
def test_one_leaf_of_two_is_enough(bank, turned):
    assert strictly(lambda a: passable_portals(bank, HOUSE, a), angles(bank, *turned))[:3].tolist() == [
        False,
        True,
        True,
    ]


def test_rooms_are_joined_by_what_is_open():
    house = house_with_doors()
    portals = house.navigation.portals
    doors_only = replace(house.navigation, portals=replace(portals, width=portals.width * (portals.kind == 1)))
    bank = HouseBank.from_compiled([replace(house, navigation=doors_only)])
    for turned, joined in (((0, 0, 0), False), ((1, 0, 0), True), ((0, 0, 1), True)):
        found = strictly(lambda a: connected_rooms(bank, HOUSE, a), angles(bank, *turned))
        assert found[:2, :2].tolist() == [[True, joined], [joined, True]]
        assert_array_equal(found[2:], np.eye(len(found), dtype=bool)[2:])


def test_a_chain_of_rooms_is_joined_from_end_to_end(rng):
    """Portals in any order, one of which is closed: two chains."""
    house, count = two_rooms(), 16
    order = rng.permutation(count)
    pairs = np.sort(np.stack([order[:-1], order[1:]], axis=1)).astype(np.int32)
    width = np.where(np.arange(count - 1) == 9, 0.0, 1.0)
    flat = np.zeros(count - 1, np.int32)
    portals = Portals(pairs, np.zeros((count - 1, 3)), width, flat, np.full((count - 1, 2), -1, np.int32))
    nav = replace(house.navigation, portals=portals)
    bank = HouseBank.from_compiled([replace(house, navigation=nav)])
    found = strictly(lambda: connected_rooms(bank, HOUSE, jnp.zeros(0, jnp.float32)))
    assert_array_equal(found, room_hops(portals, count) >= 0)
    assert found.sum() == 10**2 + 6**2


def test_a_bank_without_doors_has_open_openings_only():
    bank = HouseBank.from_compiled([shoebox()])
    assert bank.spec.num_doors == 0
    assert strictly(lambda k: door_angles(bank, HOUSE, "random", k), KEY).shape == (0,)
    assert not strictly(lambda: passable_portals(bank, HOUSE, jnp.zeros(0, jnp.float32))).any()


@pytest.fixture(scope="module")
def generated(tmp_path_factory) -> list[CompiledHouse]:
    root = tmp_path_factory.mktemp("generated")
    return list(HouseSet.coerce(root, ids=generate_flats(root, range(4))).load(False))


def turned_boxes(doors: Doors, angle: np.ndarray) -> BoxSet:
    """The leaves at angles from as placed."""
    cos, sin = np.cos(angle)[:, None], np.sin(angle)[:, None]
    arm = doors.pos[:, :2] - doors.pivot
    plan = doors.pivot + cos * arm + sin * np.stack([-arm[:, 1], arm[:, 0]], axis=1)
    yaw = 2 * np.arctan2(doors.quat[:, 3], doors.quat[:, 0]) + angle
    return BoxSet(np.c_[plan, doors.pos[:, 2]], doors.size, yaw)


def flooded(house: CompiledHouse, angle: np.ndarray) -> np.ndarray:
    """Which rooms the grid joins with leaves drawn in: the largest patch of each room stands for it."""
    n = house.navigation
    standable, room = n.region[0] >= 0, n.room[0]
    y, x = (n.origin[1 - a] + (np.arange(room.shape[a]) + 0.5) * n.cell for a in (0, 1))
    floor = house.rooms.floor[room]
    boxes = turned_boxes(house.doors, angle)
    away = compute_clearance(boxes, floor, x, y, (0.03, n.agent_height), n.agent_radius)
    patch = ndimage.label(standable & (away >= n.agent_radius))[0]
    counts = [np.bincount(patch[(room == r) & (patch > 0)], minlength=1) for r in range(len(house.rooms.type))]
    stands = np.array([c.argmax() if c.any() else -1 - r for r, c in enumerate(counts)])
    return stands[:, None] == stands[None]


def test_what_doors_join_is_what_a_flood_fill_finds(generated):
    bank = HouseBank.from_compiled(generated)
    separated = 0
    for h, house in enumerate(generated):
        count, doors = len(house.rooms.type), len(house.doors.mass)
        for state in ("open", "closed", "random"):
            angle = door_angles(bank, jnp.int32(h), state, jax.random.key(h))
            joined = strictly(lambda a, h=h: connected_rooms(bank, jnp.int32(h), a), angle)[:count, :count]
            if state == "open":
                assert_array_equal(joined, house.navigation.room_hops >= 0)
            assert_array_equal(joined, flooded(house, np.asarray(angle, float)[:doors]))
            separated += int((~joined).sum())
    assert separated > 50
