"""Garage objects: ladders, mowers, tools."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import bow_handle
from home_procgen.things.vehicles.wheels import wheel


def _step_ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("steel", (s * 0.24, 0.0, 0.42), (s * 0.17, 1.5, 0.0), 0.03, 0.06)
        yield beam("steel", (s * 0.24, 0.0, -0.4), (s * 0.17, 1.46, -0.02), 0.025, 0.04)
    for i in range(5):
        y = 0.26 + 0.28 * i
        z, w = 0.42 * (1 - y / 1.5), 0.24 - 0.07 * y / 1.5
        yield rounded_box("steel", (2 * w - 0.02, 0.025, 0.1), (0.0, y, z), 0.006, 1)
    yield rounded_box("red", (0.4, 0.03, 0.26), (0.0, 1.48, 0.0), 0.01, 1)
    for y in (0.3, 0.9):
        yield rod("steel", (-0.22, y, -0.4 * (1 - y / 1.5)), (0.22, y, -0.4 * (1 - y / 1.5)), 0.01)


def _low_steps() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (s * 0.22, 0.0, 0.24), (s * 0.18, 0.62, 0.0), 0.03, 0.05)
        yield beam("wood", (s * 0.22, 0.0, -0.22), (s * 0.18, 0.62, -0.02), 0.03, 0.05)
    for i in range(3):
        yield rounded_box("wood", (0.42 - 0.02 * i, 0.024, 0.14), (0.0, 0.2 * (i + 1), 0.17 - 0.08 * i), 0.006, 1)


def _reel_mower() -> Iterator[Solid]:
    for s in (-1, 1):
        yield from wheel(s * 0.2, 0.13, 0.0, 0.13, 0.04, hub="red")
    for k in range(5):
        a = 2 * np.pi * k / 5
        yield rod(
            "steel",
            (-0.18, 0.13 + 0.08 * np.cos(a), 0.08 * np.sin(a)),
            (0.18, 0.13 + 0.08 * np.cos(a + 0.7), 0.08 * np.sin(a + 0.7)),
            0.006,
        )
    yield rod("black", (-0.2, 0.04, -0.14), (0.2, 0.04, -0.14), 0.025, sides=12)
    for s in (-1, 1):
        yield rod("wood", (s * 0.16, 0.13, 0.0), (s * 0.03, 0.9, -0.75), 0.013)
    yield rod("wood", (-0.22, 0.9, -0.75), (0.22, 0.9, -0.75), 0.016)


def _robot_mower() -> Iterator[Solid]:
    yield padded_block("green", (0.44, 0.2, 0.56), (0.0, 0.05, 0.0), 3.2, 7)
    yield rounded_box("black", (0.46, 0.06, 0.58), (0.0, 0.05, 0.0), 0.025, 2)
    for s in (-1, 1):
        yield from wheel(s * 0.21, 0.11, -0.16, 0.11, 0.05, hub="gray")
    yield revolve("black", [(0.04, 0.0), (0.045, 0.05)], (0.0, 0.0, 0.22), 14, 1)
    yield rounded_box("red", (0.07, 0.025, 0.07), (0.0, 0.235, -0.04), 0.012, 2)


def _long_ladder() -> Iterator[Solid]:
    for s in (-1, 1):
        yield beam("wood", (s * 0.2, 0.0, 0.28), (s * 0.18, 2.3, -0.28), 0.035, 0.06)
    for i in range(8):
        y = 0.2 + 0.28 * i
        z = 0.28 - 0.56 * y / 2.3
        yield rod("wood", (-0.2, y, z), (0.2, y, z), 0.016)


def _mower() -> Iterator[Solid]:
    yield rounded_box("red", (0.5, 0.16, 0.62), (0.0, 0.1, 0.0), 0.06, 3)
    yield revolve("black", [(0.16, 0.26), (0.16, 0.36), (0.1, 0.4), (0.03, 0.42)], (0.0, 0.0, 0.05), 22, 2)
    for x, z, r in ((-0.27, 0.22, 0.09), (0.27, 0.22, 0.09), (-0.28, -0.24, 0.13), (0.28, -0.24, 0.13)):
        yield from wheel(x, r, z, r, 0.05)
    yield tube(
        "black", fillet([(-0.2, 0.2, -0.28), (-0.2, 1.0, -0.95), (0.2, 1.0, -0.95), (0.2, 0.2, -0.28)], 0.08), 0.014
    )
    yield padded_block("green", (0.4, 0.32, 0.42), (0.0, 0.14, -0.5), 4.0, 6)


def _tool_box() -> Iterator[Solid]:
    yield rounded_box("red", (0.46, 0.18, 0.22), (0.0, 0.0, 0.0), 0.012, 2)
    yield rounded_box("black", (0.47, 0.05, 0.23), (0.0, 0.17, 0.0), 0.012, 2)
    yield bow_handle("black", 0.12, (0.21, 0.28), 0.0, 0.04, 0.012)
    for s in (-1, 1):
        yield rounded_box("chrome", (0.04, 0.06, 0.01), (s * 0.14, 0.14, 0.115), 0.003, 1)


def _helmet() -> Iterator[Solid]:
    yield revolve(
        "bright",
        [(0.11, 0.0), (0.135, 0.07), (0.12, 0.16), (0.07, 0.22), (0.01, 0.24)],
        sides=26,
        steps=3,
        stretch=1.15,
    )
    yield surface(
        "screen",
        lambda u, v: (
            0.142 * np.sin(2.2 * (u - 0.5)),
            0.06 + 0.09 * v,
            1.16 * (0.142 - 0.012 * v) * np.cos(2.2 * (u - 0.5)),
        ),
        14,
        3,
        0.006,
    )
    yield revolve("black", [(0.112, -0.004), (0.118, 0.012)], sides=26, steps=1, stretch=1.15)


def _cycle_helmet() -> Iterator[Solid]:
    shell = [(0.115, 0.0), (0.125, 0.04), (0.11, 0.1), (0.07, 0.14), (0.01, 0.155)]
    yield revolve("bright", shell, sides=26, steps=3, stretch=1.3)
    for i in range(5):
        x = 0.04 * (i - 2)
        yield tube(
            "black",
            [(x, 0.1 - 0.6 * abs(x), 0.135), (x, 0.158 - abs(x) / 3, 0.0), (x, 0.1 - 0.6 * abs(x), -0.135)],
            0.009,
            6,
        )
    for s in (-1, 1):
        yield tube("gray", [(s * 0.11, 0.02, 0.05), (s * 0.1, 0.004, 0.0), (s * 0.11, 0.02, -0.05)], 0.005, 6)


def _hard_hat() -> Iterator[Solid]:
    shell = [(0.115, 0.012), (0.115, 0.06), (0.09, 0.12), (0.05, 0.145), (0.01, 0.15)]
    yield revolve("yellow", shell, sides=26, steps=3, stretch=1.2)
    yield revolve("yellow", [(0.11, 0.004), (0.15, 0.008), (0.15, 0.016), (0.11, 0.02)], sides=28, steps=1, stretch=1.2)
    yield tube(
        "yellow",
        [(0.0, 0.06, 0.138), (0.0, 0.15, 0.05), (0.0, 0.156, 0.0), (0.0, 0.15, -0.05), (0.0, 0.06, -0.138)],
        0.012,
        8,
    )


def _barrow() -> Iterator[Solid]:
    yield from wheel(0.0, 0.18, 0.62, 0.18, 0.08)
    sides = [(-0.42, 0.42), (0.5, 0.42), (0.66, 0.68), (-0.55, 0.66)]
    yield prism("green", fillet(sides, 0.05, 3, True), 0.56, (0.0, 0.0, 0.0), "side")
    yield prism("soil", [(-0.46, 0.64), (0.58, 0.65), (0.3, 0.72), (-0.2, 0.74)], 0.5, (0.0, 0.0, 0.0), "side")
    for s in (-1, 1):
        yield tube("black", [(s * 0.06, 0.18, 0.62), (s * 0.24, 0.4, 0.1), (s * 0.28, 0.5, -0.95)], 0.018)
        yield rod("black", (s * 0.25, 0.4, -0.25), (s * 0.27, 0.0, -0.4), 0.016)
        yield rod("rubber", (s * 0.278, 0.49, -0.85), (s * 0.282, 0.505, -1.0), 0.024)


def _paint() -> Iterator[Solid]:
    for i in range(3):
        yield revolve(("white", "blue", "gray")[i], [(0.085, 0.0), (0.085, 0.19)], (-0.2 + 0.2 * i, 0.0, 0.0), 22, 1)
        yield revolve("chrome", [(0.088, 0.185), (0.088, 0.2), (0.075, 0.205)], (-0.2 + 0.2 * i, 0.0, 0.0), 22, 1)
        yield tube(
            "chrome",
            [
                (-0.2 + 0.2 * i + 0.088 * np.cos(a), 0.17 - 0.06 * np.sin(a), 0.03 + 0.06 * np.sin(a))
                for a in np.linspace(0, np.pi, 9)
            ],
            0.002,
            4,
        )
    yield rounded_box("wood", (0.03, 0.02, 0.16), (0.05, 0.205, 0.02), 0.008, 1)
    yield rounded_box("black", (0.07, 0.014, 0.06), (0.05, 0.206, -0.09), 0.004, 1)


_TOOLS_KINDS = {
    "ladder": _step_ladder,
    "long": _long_ladder,
    "steps": _low_steps,
    "mower": _mower,
    "reel": _reel_mower,
    "robot": _robot_mower,
    "box": _tool_box,
    "helmet": _helmet,
    "cycle": _cycle_helmet,
    "hat": _hard_hat,
    "barrow": _barrow,
    "paint": _paint,
}


def tools(kind: str = "ladder") -> Iterator[Solid]:
    """Build a step or extension ladder, a mower, a tool box, helmets, a wheelbarrow or a paint set."""
    yield from _TOOLS_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("ladder", "ladder", design_kinds(tools, "ladder", "long", "steps")),
    FurnitureFamily("lawn_mower", "lawn_mower", design_kinds(tools, "mower", "reel", "robot")),
    FurnitureFamily("tool_box", "household_appliance", design_kinds(tools, "box", "paint")),
    FurnitureFamily("helmet", "helmet", design_kinds(tools, "helmet", "cycle", "hat")),
    FurnitureFamily("barrow", "cart", design_kinds(tools, "barrow")),
)
