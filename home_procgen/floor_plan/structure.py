"""Models that belong to the building: stairs, railings and garage doors."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from home_procgen.primitives.family import FurnitureModel, Meshes, VariantFamily, make_slots, make_variant
from home_procgen.primitives.solids import Solid, box, cushion, move, rotate
from home_procgen.textures.recipes import repeat_uv

# [m], dimensions of the stairs; instances are stretched to the storey height and the stairwell.
STAIR_RISE, STAIR_RUN, STAIR_WIDTH, LANDING_DEPTH = 2.8, 0.26, 2.06, 1.0
RISERS_PER_FLIGHT = 8  # risers per flight, including those to the landing and to the upper floor
FLIGHT_GAP = 0.08  # [m], between the flights
STAIR_LENGTH = (RISERS_PER_FLIGHT - 1) * STAIR_RUN + LANDING_DEPTH  # [m], from the front to the back of the landing
FLIGHT_WIDTH = (STAIR_WIDTH - FLIGHT_GAP) / 2  # [m], width of a flight

HANDRAIL_HEIGHT = 1.0  # [m], of the tops of handrails above the middle of the treads
HANDRAIL_WIDTH = 0.034  # [m], less than half of `FLIGHT_GAP`: two handrails are side by side in it
RAIL_FRONT = 0.12  # [m], from the front edge of stairs to the ends of their handrails
RAILING_HEIGHT = 1.0  # [m], of a railing
RAILING_DEPTH = 0.05  # [m], thickness of a railing
RAILING_LENGTHS = (1.0, 1.5, 2.2, 3.2, 4.5)  # [m], of the railing models


def u_stairs(closed: bool, left: bool = False) -> Iterator[Solid]:
    """Generate stairs that go up towards -z at +x and return to the front at -x. The front edge is at z = 0.

    Args:
        closed: Add riser boards between the treads.
        left: Mirror the stairs: up at -x, back at +x.
    """
    rise = STAIR_RISE / (2 * RISERS_PER_FLIGHT)
    yield box(
        "wood",
        (STAIR_WIDTH, 0.06, LANDING_DEPTH),
        (0.0, RISERS_PER_FLIGHT * rise - 0.06, -STAIR_LENGTH + LANDING_DEPTH / 2),
    )
    for side, first in ((1, 0), (-1, RISERS_PER_FLIGHT)):
        x = (-side if left else side) * (STAIR_WIDTH - FLIGHT_WIDTH) / 2
        for i in range(1, RISERS_PER_FLIGHT):
            z = -(i - 0.5) * STAIR_RUN if side > 0 else -(RISERS_PER_FLIGHT - 1 - i + 0.5) * STAIR_RUN
            yield box("wood", (FLIGHT_WIDTH - 0.06, 0.04, STAIR_RUN + 0.02), (x, (first + i) * rise - 0.04, z))
        for i in range(1, RISERS_PER_FLIGHT + 1) if closed else ():
            z = -(i - 1) * STAIR_RUN - 0.02 if side > 0 else -(RISERS_PER_FLIGHT - i) * STAIR_RUN + 0.02
            yield box("wood_1", (FLIGHT_WIDTH - 0.06, rise - 0.04, 0.015), (x, (first + i - 1) * rise, z))
        yield from _stringers(x, first * rise, side)


def _stringers(x: float, bottom: float, side: int) -> Iterator[Solid]:
    """Generate the two boards that carry a flight."""
    rise = STAIR_RISE / (2 * RISERS_PER_FLIGHT)
    run, climb = (RISERS_PER_FLIGHT - 1) * STAIR_RUN, (RISERS_PER_FLIGHT - 1) * rise
    slope = float(np.arctan2(climb, run))
    for edge in (-1, 1):
        board = box("wood_1", (0.04, 0.2, float(np.hypot(run, climb))), (0.0, -0.21, 0.0))
        turned = rotate(board, 0, side * slope)
        yield move(turned, (x + edge * (FLIGHT_WIDTH / 2 - 0.02), bottom + rise + climb / 2, -run / 2))


def stair_rails(left: bool = False) -> Iterator[Solid]:
    """Generate the handrails of both flights of `u_stairs`, side by side between the flights, in its coordinates.

    Args:
        left: Mirror them, for mirrored stairs.
    """
    rise = STAIR_RISE / (2 * RISERS_PER_FLIGHT)
    low, high = RAIL_FRONT, (RISERS_PER_FLIGHT - 1) * STAIR_RUN - 0.03  # [m], from the front edge to a rail's ends
    slope, length = float(np.arctan2(rise, STAIR_RUN)), float(np.hypot(high - low, (high - low) * rise / STAIR_RUN))
    for side, first in ((1, 0), (-1, RISERS_PER_FLIGHT)):
        x = (-side if left else side) * FLIGHT_GAP / 4
        for step in np.linspace(low, high, RISERS_PER_FLIGHT).tolist():
            along = step if side > 0 else (RISERS_PER_FLIGHT - 1) * STAIR_RUN - step
            foot = (first + 1) * rise + along / STAIR_RUN * rise  # [m], the line of the treads' front edges
            yield box("chrome", (0.016, HANDRAIL_HEIGHT, 0.016), (x, foot - rise / 2, -step))
        middle = (low + high) / 2
        along = middle if side > 0 else (RISERS_PER_FLIGHT - 1) * STAIR_RUN - middle
        top = (first + 1) * rise + along / STAIR_RUN * rise + HANDRAIL_HEIGHT - rise / 2
        beam = rotate(box("wood", (HANDRAIL_WIDTH, 0.05, length), (0.0, -0.03, 0.0)), 0, side * slope)
        yield move(beam, (x, top, -middle))


def railing(length: float, boards: bool) -> Iterator[Solid]:
    """Generate the solids of a straight railing along x on posts.

    Args:
        length: Length [m].
        boards: Horizontal boards instead of vertical bars.
    """
    yield box("wood", (length, 0.05, RAILING_DEPTH), (0.0, RAILING_HEIGHT - 0.05, 0.0))
    posts = max(round(length / 1.2), 1)
    for i in range(posts + 1):
        yield box("chrome", (0.04, RAILING_HEIGHT - 0.05, 0.04), ((i / posts - 0.5) * (length - 0.04), 0.0, 0.0))
    if boards:
        for k in range(5):
            yield box("wood", (length - 0.02, 0.12, 0.02), (0.0, 0.1 + 0.165 * k, 0.025 - 0.01))
        return
    yield box("chrome", (length, 0.03, 0.03), (0.0, 0.08, 0.0))
    bars = round(length / 0.12)
    for i in range(1, bars):
        yield box("chrome", (0.014, RAILING_HEIGHT - 0.16, 0.014), ((i / bars - 0.5) * length, 0.11, 0.0))


def garage_door(width: float, height: float, panels: int) -> Iterator[Solid]:
    """Generate the solids of a sectional door in its frame.

    Args:
        width: Width over the frame [m].
        height: Height over the frame [m].
        panels: Number of sections, one above the other.
    """
    rim = 0.08
    for side in (-1, 1):
        yield box("color", (rim, height, 0.13), (side * (width - rim) / 2, 0.0, 0.0))
    yield box("color", (width - 2 * rim, rim, 0.13), (0.0, height - rim, 0.0))
    high = (height - rim) / panels
    for i in range(panels):
        yield box("steel", (width - 2 * rim, high - 0.008, 0.03), (0.0, i * high, 0.0))
        for k in range(4):
            wide = (width - 2 * rim) / 4
            at = ((k - 1.5) * wide, i * high + 0.08, 0.0)
            yield cushion("steel", (wide - 0.12, high - 0.16, 0.046), at, 0.008)
    yield box("chrome", (0.14, 0.03, 0.05), (0.0, 0.9, 0.03))


_FAMILIES = (
    VariantFamily(
        "stairs",
        "stairs",
        u_stairs,
        make_slots("wood", "wood_1"),
        tuple(make_variant(closed=closed, left=left) for left in (False, True) for closed in (True, False)),
        centred=False,
    ),
    VariantFamily(
        "stair_rails",
        "fence",
        stair_rails,
        make_slots("wood", "chrome"),
        (make_variant(left=False), make_variant(left=True)),
        centred=False,
    ),
    VariantFamily(
        "railing",
        "fence",
        railing,
        make_slots("wood", "chrome"),
        tuple(make_variant(length=length, boards=boards) for boards in (False, True) for length in RAILING_LENGTHS),
        centred=False,
    ),
    VariantFamily(
        "garage_door",
        "garage_door",
        garage_door,
        make_slots("color", "steel", "chrome"),
        (make_variant(width=2.5, height=2.15, panels=4), make_variant(width=3.0, height=2.15, panels=5)),
        centred=False,
    ),
)


@cache
def structure_models() -> Mapping[str, Sequence[FurnitureModel]]:
    """Return the models of every family, by family name.

    Example:
        >>> list(structure_models())
        ['stairs', 'stair_rails', 'railing', 'garage_door']
    """
    return {family.name: tuple(map(_repeat, family.models())) for family in _FAMILIES}


def _repeat(model: FurnitureModel) -> FurnitureModel:
    meshes = Meshes(repeat_uv(model.mesh, model.slots.values()))
    return replace(model, load_meshes=lambda: meshes)
