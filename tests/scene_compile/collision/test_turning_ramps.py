"""Stairs with landings and curved ones: their slopes against rays and posts by brute force."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from boxes_by_hand import Solids
from storeys import FLOOR, UP, Stairs, Storey, metadata_of, stacked

from home_mjx.datasets.outlines import RoomOutline
from home_mjx.scene_compile.pipeline.compile import compile_house
from home_mjx.schema.compiled import CompiledHouse, PortalKind

PLAN = Storey([RoomOutline("Living_Room", [(0, 0), (8, 0), (8, 6), (0, 6)])])
STAIRS = {
    "corner": Stairs((2.0, 4.0), shape="corner"),
    "corner turned": Stairs((6.0, 4.5), np.pi / 2, shape="corner", width=1.1),
    "back": Stairs((2.0, 4.0), shape="back"),
    "curve": Stairs((4.0, 5.0), shape="curve"),
    "curve askew": Stairs((4.0, 4.5), 0.6, shape="curve", steps=17, width=1.0),
}
RAMPS = {"corner": 3, "corner turned": 3, "back": 3}
STEP, MARGIN = 0.05, 0.15  # [m], that an agent steps up, and from its axis to what is beside it


@pytest.fixture(scope="module", params=STAIRS)
def house(request) -> tuple[str, CompiledHouse]:
    found = stacked([PLAN, PLAN], [STAIRS[request.param]])
    return request.param, compile_house(found, metadata_of(found))


def middle_line(house: CompiledHouse) -> np.ndarray:
    """Points every centimetre along the middles of the slopes, from before the first to beyond the last."""
    ramps = house.ramps
    half = ramps.size[:, 0] * np.cos(ramps.slope)
    top = ramps.pos[:, :2] - ramps.size[:, 2:] * np.sin(ramps.slope)[:, None] * ramps.up
    stops = [top[0] - (half[0] + 0.3) * ramps.up[0], *top, top[-1] + (half[-1] + 0.2) * ramps.up[-1]]
    ways = []
    for a, b in pairwise(stops):
        count = int(np.ceil(np.linalg.norm(b - a) / 0.01))
        ways.append(a + (b - a) * np.arange(count)[:, None] / count)
    return np.concatenate(ways)


def test_the_way_up_rises_without_a_step_and_nothing_stands_on_it(house):
    name, compiled = house
    assert len(compiled.ramps.slope) == RAMPS.get(name, len(compiled.ramps.slope))
    solids, way = Solids(compiled), middle_line(compiled)
    height = [FLOOR]
    for point in way:
        height.append(float(solids.below(np.array([[*point, height[-1] + 0.3]]))[0]))
    height = np.array(height[1:])
    assert height[0] == pytest.approx(FLOOR, abs=1e-6)
    assert height[-1] == pytest.approx(FLOOR + UP, abs=1e-6)
    rise = np.diff(height)
    assert rise.max() < STEP
    assert rise.min() > -STEP
    assert not solids.blocked(np.c_[way, height], 0.2, 1.6, 0.05).any()


def test_cells_lie_on_the_slopes_and_join_both_levels(house):
    _, compiled = house
    n = compiled.navigation
    cells = np.c_[n.origin + (n.cell_coords[:, :0:-1] + 0.5) * n.cell, n.height]
    np.testing.assert_allclose(Solids(compiled).below(cells + np.array([0, 0, 0.2])), cells[:, 2], atol=0.05)
    assert set(n.cell_coords[:, 0].tolist()) == {0, 1}
    assert (n.room_hops >= 0).all()
    (stairs,) = np.flatnonzero(n.portals.kind == PortalKind.STAIRS)
    assert n.portals.room[stairs].tolist() == [0, 1]
    assert n.region_area[0] > 0.98 * n.region_area.sum()


def test_nobody_walks_off_the_sides(house):
    """Around each slope, an agent's width beyond where its axis may be, something stands higher than its hips."""
    _, compiled = house
    ramps, solids = compiled.ramps, Solids(compiled)
    for i, up in enumerate(ramps.up):
        if ramps.slope[i] == 0:
            continue
        half, left = ramps.size[i, 0] * np.cos(ramps.slope[i]), np.array([-up[1], up[0]])
        top = ramps.pos[i, :2] - ramps.size[i, 2] * np.sin(ramps.slope[i]) * up
        for across in (-1, 1):
            side = top + np.linspace(-0.8, 0.8, 9)[:, None] * half * up + across * (ramps.size[i, 1] + 0.03) * left
            rise = ramps.pos[i, 2] + ramps.size[i, 2] * np.cos(ramps.slope[i])
            height = rise + np.linspace(-0.8, 0.8, 9) * half * np.tan(ramps.slope[i])
            assert solids.blocked(np.c_[side, height], 0.9, 1.0, 0.01).all()


@pytest.mark.parametrize("shape", ["corner", "back"])
def test_a_landing_is_as_high_as_its_tread_and_closed_around(shape):
    found = stacked([PLAN, PLAN], [Stairs((2.0, 4.0), shape=shape)])
    compiled = compile_house(found, metadata_of(found))
    ramps, solids = compiled.ramps, Solids(compiled)
    assert ramps.slope.tolist().index(0.0) == 1
    assert ramps.pos[1, 2] + ramps.size[1, 2] == pytest.approx(FLOOR + UP / 2, abs=1e-6)
    half, across = ramps.size[1, 0], ramps.size[1, 1]
    beyond = [[half + 0.03, 0], [0, -across - 0.03]] + ([[half + 0.03, 0.5]] if shape == "back" else [])
    places = [[*(ramps.pos[1, :2] + b), FLOOR + UP / 2] for b in beyond]
    assert solids.blocked(np.array(places), 0.5, 0.9, 0.01).all()


def test_stairs_of_a_full_turn_are_not_climbed():
    """One end would be above the other."""
    plain = Stairs((4.0, 5.0), shape="curve", steps=20)
    found = stacked([PLAN, PLAN], [plain])
    (key,) = found.models
    mesh = found.models[key]
    flat = mesh.vertices.copy()
    x, z = flat[:, 0], flat[:, 2] + 0.35 + plain.width / 2
    angle, away = (np.arctan2(x, z) % (2 * np.pi)) * 358 / 270, np.hypot(x, z)
    flat[:, 0], flat[:, 2] = away * np.sin(angle), away * np.cos(angle) - 0.35 - plain.width / 2
    compiled = compile_house(replace(found, models={key: replace(mesh, vertices=flat)}), metadata_of(found))
    assert compiled.report["stairs"] == 1
    assert len(compiled.ramps.slope) == 0
