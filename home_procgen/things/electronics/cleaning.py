"""Vacuum cleaners and irons."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet, spline
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import disc, roller


def vacuum(kind: str = "canister") -> Iterator[Solid]:
    """Build a vacuum cleaner: canister, upright or robot."""
    if kind == "robot":
        yield revolve("black", [(0.16, 0.0), (0.17, 0.015), (0.17, 0.07), (0.155, 0.085)], sides=36, steps=1)
        yield cylinder("gray", 0.13, 0.003, (0.0, 0.084, 0.0), sides=30)
        yield cylinder("black", 0.04, 0.015, (0.0, 0.086, -0.03), sides=20)
        yield disc("green", 0.01, 0.006, (0.0, 0.05, 0.166), 12)
        return
    if kind == "canister":
        yield padded_block("bright", (0.26, 0.2, 0.38), (0.0, 0.05, 0.0), 3.5, 7)
        for s in (-1, 1):
            yield roller("black", 0.09, 0.04, (s * 0.13, 0.09, -0.1), 22)
        yield ball("black", 0.025, (0.0, 0.025, 0.14), 10, 6)
        hose = spline([(0.0, 0.17, 0.17), (0.0, 0.4, 0.4), (0.25, 0.6, 0.35), (0.35, 0.85, 0.1)], 6)
        yield tube("gray", hose, 0.02, 10)
        yield rod("chrome", (0.35, 0.85, 0.1), (0.4, 0.06, 0.4), 0.014)
        yield rounded_box("black", (0.28, 0.05, 0.1), (0.4, 0.0, 0.42), 0.015, 2)
        return
    yield rounded_box("black", (0.28, 0.07, 0.2), (0.0, 0.0, 0.1), 0.02, 2)
    yield from (
        rotate(p, 0, -0.2, (0.0, 0.05, 0.05))
        for p in (
            rod("bright", (0.0, 0.05, 0.05), (0.0, 0.75, 0.05), 0.02),
            revolve("tint", [(0.05, 0.0), (0.055, 0.02), (0.055, 0.2), (0.04, 0.24)], (0.0, 0.75, 0.07), 20, 1),
            tube(
                "bright",
                fillet([(0.0, 0.98, 0.07), (0.0, 1.12, 0.05), (0.0, 1.12, -0.06), (0.0, 0.95, -0.03)], 0.05),
                0.016,
            ),
        )
    )


def ironing() -> Iterator[Solid]:
    """Build an ironing board on crossed legs, with an iron on it."""
    shape = fillet([(-0.6, -0.17), (0.35, -0.17), (0.66, 0.0), (0.35, 0.17), (-0.6, 0.17)], 0.14, 5, True)
    yield prism("patterned", shape, 0.03, (0.0, 0.86, 0.0), "top")
    yield prism("gray", 0.94 * shape, 0.012, (0.0, 0.85, 0.0), "top")
    for s in (-1, 1):
        yield rod("chrome", (s * 0.42, 0.01, -0.13), (-s * 0.3, 0.85, -0.1), 0.011)
        yield rod("chrome", (s * 0.42, 0.01, 0.13), (-s * 0.3, 0.85, 0.1), 0.011)
        yield rod("chrome", (s * 0.42, 0.012, -0.2), (s * 0.42, 0.012, 0.2), 0.012)
    yield rounded_box("chrome", (0.2, 0.01, 0.24), (-0.7, 0.86, 0.0), 0.004, 1)
    yield from (move(p, (-0.1, 0.89, 0.0)) for p in iron())


def folded_board(leaning: bool = False) -> Iterator[Solid]:
    """Build a folded ironing board that leans at a wall, or a short one on small legs for a table."""
    length, slot = (1.25, "patterned") if leaning else (0.72, "textile")
    half = length / 2
    shape = fillet([(-half, -0.16), (half - 0.3, -0.16), (half, 0.0), (half - 0.3, 0.16), (-half, 0.16)], 0.12, 5, True)
    pieces = [
        prism(slot, shape, 0.03, (0.0, 0.14, 0.0), "top"),
        prism("gray", 0.95 * shape, 0.01, (0.0, 0.13, 0.0), "top"),
    ]
    for s in (-1, 1):
        if leaning:
            pieces += [rod("chrome", (-half + 0.1, 0.12, s * 0.1), (half - 0.3, 0.11, s * 0.07), 0.01)]
        else:
            pieces += [
                tube(
                    "chrome",
                    fillet(
                        [
                            (s * 0.22, 0.13, -0.1),
                            (s * 0.22, 0.008, -0.12),
                            (s * 0.22, 0.008, 0.12),
                            (s * 0.22, 0.13, 0.1),
                        ],
                        0.02,
                    ),
                    0.008,
                    8,
                )
            ]
    for piece in pieces:
        yield rotate(rotate(piece, 2, 1.45), 1, np.pi / 2) if leaning else piece


def iron() -> Iterator[Solid]:
    """Build an iron."""
    sole = fillet([(-0.12, -0.055), (0.02, -0.055), (0.13, 0.0), (0.02, 0.055), (-0.12, 0.055)], 0.06, 4, True)
    yield prism("steel", sole, 0.012, plane="top")
    for k, (y, size) in enumerate(((0.012, 0.94), (0.03, 0.85), (0.048, 0.7))):
        yield prism("bright", sole * size, 0.02 if k < 2 else 0.014, (0.0, y, 0.0), "top")
    yield tube(
        "bright",
        fillet([(0.06, 0.05, 0.0), (0.03, 0.115, 0.0), (-0.1, 0.115, 0.0), (-0.1, 0.04, 0.0)], 0.05, 4),
        0.014,
        10,
    )
    yield disc("white", 0.015, 0.03, (-0.02, 0.068, -0.015), 14)


def steam_iron() -> Iterator[Solid]:
    """Build an iron that stands on its heel, beside its water tank."""
    yield from (move(rotate(p, 2, 1.35), (-0.12, 0.13, 0.0)) for p in iron())
    yield rounded_box("white", (0.16, 0.1, 0.2), (0.1, 0.0, 0.0), 0.03, 3)
    yield rounded_box("tint", (0.12, 0.06, 0.17), (0.1, 0.08, 0.0), 0.02, 2)


def travel_iron() -> Iterator[Solid]:
    """Build an old iron with a wooden grip on two posts."""
    sole = fillet([(-0.1, -0.05), (0.03, -0.05), (0.12, 0.0), (0.03, 0.05), (-0.1, 0.05)], 0.05, 4, True)
    yield prism("iron", sole, 0.035, plane="top")
    for x in (-0.07, 0.05):
        yield rod("iron", (x, 0.03, 0.0), (x, 0.1, 0.0), 0.007)
    yield tube(
        "wood",
        [(-0.085, 0.1, 0.0), (-0.05, 0.1, 0.0), (0.03, 0.1, 0.0), (0.065, 0.1, 0.0)],
        [0.012, 0.017, 0.017, 0.012],
        12,
    )


FAMILIES = (
    FurnitureFamily("vacuum_cleaner", "vacuum_cleaner", design_kinds(vacuum, "canister", "upright", "robot")),
    FurnitureFamily(
        "ironing_board", "ironing_board", (design(ironing), design(folded_board), design(folded_board, leaning=True))
    ),
    FurnitureFamily("iron", "iron", (design(iron), design(steam_iron), design(travel_iron))),
)
