"""Teddy bears, building blocks, toy trains and cars."""

from collections.abc import Iterator

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sweep import prism, rod, tube
from home_procgen.things.joinery import roller


def teddy(slot: str = "fur_coat", ears: str = "round") -> Iterator[Solid]:
    """Build a sitting teddy bear or rabbit."""
    yield ball(slot, (0.11, 0.12, 0.1), (0.0, 0.12, 0.0), 18, 10)
    yield ball("cream", (0.07, 0.08, 0.03), (0.0, 0.12, 0.08), 14, 8)
    yield ball(slot, 0.085, (0.0, 0.29, 0.02), 18, 10)
    yield ball("cream", (0.04, 0.032, 0.03), (0.0, 0.27, 0.095), 12, 8)
    yield ball("black", 0.012, (0.0, 0.285, 0.122), 8, 6)
    for s in (-1, 1):
        yield ball("black", 0.01, (s * 0.032, 0.315, 0.093), 8, 6)
        yield tube(
            slot, [(s * 0.09, 0.2, 0.0), (s * 0.14, 0.13, 0.06), (s * 0.13, 0.1, 0.09)], [0.035, 0.034, 0.036], 10
        )
        yield tube(
            slot, [(s * 0.06, 0.05, 0.04), (s * 0.1, 0.04, 0.13), (s * 0.11, 0.045, 0.18)], [0.05, 0.045, 0.042], 10
        )
        yield ball("cream", (0.026, 0.03, 0.01), (s * 0.112, 0.05, 0.215), 10, 6)
        if ears == "round":
            yield ball(slot, (0.034, 0.034, 0.018), (s * 0.065, 0.36, 0.01), 12, 8)
        else:
            yield ball(slot, (0.022, 0.09, 0.014), (s * 0.04, 0.42, 0.0), 12, 8)


def blocks() -> Iterator[Solid]:
    """Build a tower of building blocks with some beside it."""
    for i, (x, y, z, turn) in enumerate(
        (
            (0.0, 0.0, 0.0, 0.1),
            (0.075, 0.0, 0.01, -0.2),
            (0.035, 0.07, 0.0, 0.3),
            (0.03, 0.14, 0.005, 0.0),
            (-0.12, 0.0, 0.09, 0.7),
            (0.16, 0.0, 0.1, 0.4),
        )
    ):
        yield rotate(rounded_box(f"bright_{i % 4}", (0.07, 0.07, 0.07), (x, y, z), 0.006, 1), 1, turn, (x, 0.0, z))
    yield prism("bright_2", [(-0.01, 0.21), (0.07, 0.21), (0.03, 0.26)], 0.06)
    yield cylinder("bright_1", 0.03, 0.08, (-0.04, 0.0, 0.14), sides=16)


def train() -> Iterator[Solid]:
    """Build a wooden train of three cars."""
    for k in range(3):
        z = -0.17 * k
        yield rounded_box(f"bright_{k}", (0.07, 0.025, 0.14), (0.0, 0.03, z), 0.008, 1)
        for s in (-1, 1):
            for dz in (-0.045, 0.045):
                yield roller("wood", 0.024, 0.014, (s * 0.04, 0.024, z + dz), 14)
        if k:
            yield (
                rounded_box("wood", (0.06, 0.035, 0.11), (0.0, 0.055, z), 0.006, 1)
                if k == 1
                else cylinder("wood", 0.03, 0.05, (0.0, 0.055, z), sides=16)
            )
            yield rod("black", (0.0, 0.04, z + 0.06), (0.0, 0.04, z + 0.11), 0.005, sides=6)
    yield tube("bright", [(0.0, 0.085, -0.01), (0.0, 0.085, 0.065)], 0.03, 16)
    yield rounded_box("bright_1", (0.07, 0.08, 0.045), (0.0, 0.055, -0.045), 0.008, 1)
    yield revolve("black", [(0.01, 0.0), (0.01, 0.03), (0.018, 0.05)], (0.0, 0.11, 0.045), 12, 1)


def toy_car(kind: str = "car") -> Iterator[Solid]:
    """Build a toy car, lorry or fire engine."""
    if kind == "car":
        side = fillet(
            [
                (-0.12, 0.03),
                (0.12, 0.03),
                (0.12, 0.07),
                (0.07, 0.075),
                (0.03, 0.12),
                (-0.06, 0.12),
                (-0.1, 0.075),
                (-0.12, 0.07),
            ],
            0.02,
            3,
            True,
        )
        yield prism("bright", side, 0.1, (0.0, 0.0, 0.0), "side")
        yield prism(
            "screen",
            fillet([(0.055, 0.078), (0.025, 0.112), (-0.055, 0.112), (-0.085, 0.078)], 0.012, 2, True),
            0.102,
            (0.0, 0.0, 0.0),
            "side",
        )
    else:
        yield rounded_box("bright", (0.12, 0.1, 0.09), (0.0, 0.04, 0.1), 0.015, 2)
        yield box("screen", (0.1, 0.035, 0.006), (0.0, 0.09, 0.144))
        yield rounded_box("black", (0.1, 0.025, 0.3), (0.0, 0.03, -0.02), 0.005, 1)
        yield rounded_box("bright_1", (0.13, 0.09, 0.2), (0.0, 0.055, -0.06), 0.008, 1)
        if kind == "fire":
            for s in (-1, 1):
                yield rod("white", (s * 0.03, 0.16, -0.16), (s * 0.03, 0.18, 0.1), 0.006, sides=6)
            for i in range(7):
                yield rod(
                    "white",
                    (-0.03, 0.161 + 0.003 * i, -0.15 + 0.038 * i),
                    (0.03, 0.161 + 0.003 * i, -0.15 + 0.038 * i),
                    0.004,
                    sides=6,
                )
    for z in (-0.07, 0.075):
        for s in (-1, 1):
            yield roller("rubber", 0.032, 0.022, (s * 0.055, 0.032, z), 16)
            yield roller("white", 0.014, 0.026, (s * 0.055, 0.032, z), 12)
