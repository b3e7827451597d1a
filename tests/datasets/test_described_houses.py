"""What the guide says of generated houses is what their tables and designs have."""

import re
from collections import defaultdict
from pathlib import Path

import pytest

from home_procgen.primitives.categories import CATEGORIES
from home_procgen.v1.design import draw_design
from home_procgen.v1.furnish import RECIPES
from home_procgen.v1.furniture import library
from home_procgen.v1.plan import WANTS

TEXT = (Path(__file__).parents[2] / "docs" / "dataset.md").read_text()
ROWS = re.findall(r"^\| `(\w+)` \| ([\d.]+)–([\d.]+) \| (.*) \|$", TEXT, re.MULTILINE)
SAID = {room: set(re.findall(r"`(\w+)`", things)) for room, _, _, things in ROWS}
ANYWHERE = {"indoor_lamp", "door", "window", "picture_frame", "music"}


def test_rooms_and_their_areas_are_those_of_the_plan():
    assert {room: (float(low), float(high)) for room, low, high, _ in ROWS} == {
        room: (want.low, want.high) for room, want in WANTS.items()
    }
    assert set(SAID) == set(RECIPES)


def test_all_categories_are_named():
    known = {CATEGORIES[model.fine].coarse for model in library().values()}
    assert set().union(*SAID.values()) | ANYWHERE == known


@pytest.mark.parametrize("seeds", [15, pytest.param(250, marks=pytest.mark.slow)])
def test_rooms_have_what_is_said_of_them(seeds):
    found = defaultdict(set)
    for design in map(draw_design, range(seeds)):
        rooms = [room.type for room in design.plan.rooms]
        assert 3 <= len(rooms) <= 8
        assert set(rooms) >= {"Living_Room", "Bedroom", "Bathroom", *(["Kitchen"] if len(rooms) > 3 else [])}
        things = [CATEGORIES[placed.model.fine].coarse for placed, _ in design.objects]
        assert "music" in things
        for (_, room), thing in zip(design.objects, things, strict=True):
            found[rooms[room]].add(thing)
    wrong = {room: things - SAID[room] - ANYWHERE for room, things in found.items()}
    assert not any(wrong.values()), wrong
    if seeds > 100:
        assert {room: things - ANYWHERE for room, things in found.items()} == SAID
