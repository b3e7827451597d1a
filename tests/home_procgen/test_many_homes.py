"""A thousand homes without their furniture, which takes most of the time; seeds that nobody has looked at."""

import itertools

import numpy as np
import pytest
from walked_homes import KINDS, LINKS, Home, likeness, may_be_alike, reachable

from home_mjx.datasets import open_dataset, validate_house
from home_procgen import generate_dataset
from home_procgen.design import draw_design
from home_procgen.generate import write_home
from home_procgen.plan.home import HomePlan
from home_procgen.presets import Variant

FIRST, PART = 500_000, 125
ALIKE, MOST = 0.85, 5  # part of a room map, and how many of 499,500 pairs may have more than that in common
CELL = 0.25  # [m], of room maps


def without_furniture(monkeypatch) -> list[HomePlan]:
    """The plans of the homes that are made from then on."""
    plans: list[HomePlan] = []

    def unfurnished(plan, style):
        plans.append(plan)
        return tuple(tuple(() for _ in level.rooms) for level in plan.levels)

    monkeypatch.setattr("home_procgen.design.furnish_home", unfurnished)
    return plans


@pytest.mark.slow
@pytest.mark.parametrize("part", range(8))
def test_a_thousand_homes_are_valid_and_their_private_rooms_are_ends(part, tmp_path, monkeypatch):
    without_furniture(monkeypatch)
    root, first = tmp_path / "homes", FIRST + PART * part
    generate_dataset(root, [first])
    for seed in range(first, first + PART):
        write_home(root, seed)
    dataset = open_dataset(root)
    for seed in range(first, first + PART):
        assert validate_house(dataset, Variant().house_id(seed)) == ()
        home = Home(dataset.load_house(Variant().house_id(seed)), dataset.metadata)
        joined, (entrance,) = home.graph(), home.entrances()
        assert all(len(joined[r]) == 1 for r in home.rooms() if home.kind(*r) not in LINKS)
        assert reachable(joined, entrance, lambda room: home.kind(*room) in LINKS) == set(home.rooms())  # noqa: B023


def plan_map(plan: HomePlan) -> np.ndarray:
    """As `walked_homes.room_map` of the written home: points in polygons, by crossings of a ray."""
    rooms = plan.levels[0].rooms
    corners = np.concatenate([room.polygon for room in rooms])
    axes = [np.arange(a + CELL / 2, b, CELL) for a, b in zip(corners.min(axis=0), corners.max(axis=0), strict=True)]
    x, z = np.meshgrid(*axes, indexing="ij")
    found = np.zeros(x.shape, int)
    for room in rooms:
        inside = np.zeros(x.shape, bool)
        for (x0, z0), (x1, z1) in zip(room.polygon, np.roll(room.polygon, -1, axis=0), strict=True):
            if z0 != z1:
                inside ^= ((z0 > z) != (z1 > z)) & (x < (x1 - x0) * (z - z0) / (z1 - z0) + x0)
        found[inside] = KINDS.index(room.type) + 1
    return found


@pytest.mark.slow
def test_no_two_of_a_thousand_homes_have_the_same_room_map(monkeypatch):
    """However one is turned or mirrored; hardly any are alike."""
    plans = without_furniture(monkeypatch)
    for seed in range(FIRST, FIRST + 1000):
        draw_design(seed)
    pairs = itertools.combinations(map(plan_map, plans), 2)
    parts = [likeness(a, b) for a, b in pairs if may_be_alike(a, b, ALIKE)]
    assert len(plans) == 1000
    assert max(parts, default=0.0) < 0.97
    assert sum(part > ALIKE for part in parts) <= MOST
