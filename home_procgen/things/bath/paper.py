"""Toilet paper holders and soap."""

from collections.abc import Iterator

import numpy as np

from home_procgen.primitives.solids import Solid, cylinder, move, rotate
from home_procgen.shapes.curves import fillet
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import disc, legs, open_case


def _roll(x: float, y: float, z: float) -> Solid:
    return revolve("white", [(0.055, 0.0), (0.055, 0.1)], (x, y, z), 22, 1)


def _paper_holder() -> Iterator[Solid]:
    yield rounded_box("chrome", (0.05, 0.05, 0.012), (0.08, 0.09, -0.07), 0.005, 1)
    yield tube("chrome", fillet([(0.08, 0.115, -0.065), (0.08, 0.115, 0.0), (-0.08, 0.115, 0.0)], 0.02), 0.006)
    yield move(rotate(_roll(0.0, -0.05, 0.0), 2, np.pi / 2), (0.0, 0.115, 0.0))
    yield surface(
        "white", lambda u, v: ((u - 0.5) * 0.098, 0.115 - 0.115 * v, 0.056 + 0.006 * np.sin(3 * v)), 3, 5, 0.002
    )


def _paper_stand() -> Iterator[Solid]:
    yield revolve("chrome", [(0.09, 0.0), (0.085, 0.012), (0.01, 0.02)], sides=22, steps=1)
    yield rod("chrome", (0.0, 0.01, 0.0), (0.0, 0.6, 0.0), 0.008)
    for i in range(3):
        yield _roll(0.0, 0.03 + 0.105 * i, 0.0)
    yield ball("chrome", 0.016, (0.0, 0.61, 0.0), 10, 6)
    yield tube("chrome", fillet([(0.0, 0.52, 0.0), (0.1, 0.52, 0.0), (0.1, 0.52, 0.01)], 0.01), 0.006)


def _paper_basket() -> Iterator[Solid]:
    yield vessel("cane", [(0.14, 0.0), (0.16, 0.06), (0.16, 0.14)], 0.008, sides=24, steps=1)
    for i in range(3):
        a = 2 * np.pi * i / 3
        yield _roll(0.075 * np.cos(a), 0.012, 0.075 * np.sin(a))
        yield _roll(0.065 * np.cos(a + 1), 0.114, 0.065 * np.sin(a + 1))


def _horizontal_roll(x: float, y: float, z: float) -> Solid:
    """Build a roll whose axis points along x, with its centre at (x, y, z) [m]."""
    return move(rotate(_roll(0.0, -0.05, 0.0), 2, np.pi / 2), (x, y, z))


def _paper_covered() -> Iterator[Solid]:
    """Build a toilet paper roll under a bent lid."""
    yield rounded_box("steel", (0.15, 0.15, 0.01), (0.0, 0.04, -0.065), 0.004, 1)
    yield _horizontal_roll(0.0, 0.09, 0.0)
    lid = [(-0.065, 0.178), (0.01, 0.17), (0.06, 0.13), (0.068, 0.1), (0.064, 0.1), (0.056, 0.127), (0.008, 0.164)]
    yield prism("steel", fillet([*lid, (-0.065, 0.172)], 0.01, 3, True), 0.14, (0.0, 0.0, 0.0), "side")
    for s in (-1, 1):
        yield rod("steel", (s * 0.06, 0.09, -0.06), (s * 0.06, 0.09, 0.0), 0.006)


def _paper_shelf() -> Iterator[Solid]:
    """Build a wooden shelf for a telephone with a paper rod below."""
    yield rounded_box("wood", (0.2, 0.018, 0.12), (0.0, 0.13, -0.01), 0.006, 2)
    yield rounded_box("wood", (0.2, 0.13, 0.016), (0.0, 0.0, -0.062), 0.005, 1)
    for s in (-1, 1):
        yield prism("wood", [(-0.06, 0.02), (0.02, 0.02), (0.03, 0.13), (-0.06, 0.13)], 0.014, (s * 0.08, 0, 0), "side")
    yield rod("brass", (-0.08, 0.06, 0.0), (0.08, 0.06, 0.0), 0.008)
    yield _horizontal_roll(0.0, 0.06, 0.0)


def _paper_rope() -> Iterator[Solid]:
    """Build a toilet paper roll on a rope from a knob."""
    knob = revolve("wood", [(0.03, 0.0), (0.014, 0.01), (0.014, 0.04), (0.024, 0.05), (0.016, 0.066)], steps=2)
    yield move(rotate(knob, 0, np.pi / 2), (0.0, 0.26, -0.06))
    loop = [(0.0, 0.25, -0.02), (-0.075, 0.06, 0.0), (0.075, 0.06, 0.0), (0.0, 0.25, -0.02)]
    yield tube("cream", fillet(loop, 0.02), 0.005, 6)
    yield _horizontal_roll(0.0, 0.06, 0.0)


def _paper_double() -> Iterator[Solid]:
    """Build two toilet paper rolls on a bar between posts."""
    for x in (-0.13, 0.0, 0.13):
        yield rounded_box("iron", (0.024, 0.08, 0.01), (x, 0.05, -0.066), 0.003, 1)
        yield rod("iron", (x, 0.09, -0.064), (x, 0.09, 0.0), 0.007)
    yield rod("iron", (-0.14, 0.09, 0.0), (0.14, 0.09, 0.0), 0.007)
    for s in (-1, 1):
        yield _horizontal_roll(0.065 * s, 0.09, 0.0)


def _paper_spindle() -> Iterator[Solid]:
    """Build an upright toilet paper roll on a bracket."""
    yield disc("brass", 0.03, 0.01, (0.0, 0.02, -0.075), 18)
    yield tube("brass", fillet([(0.0, 0.02, -0.07), (0.0, 0.02, 0.0), (0.0, 0.05, 0.0)], 0.015), 0.008)
    yield revolve("brass", [(0.045, 0.02), (0.05, 0.026), (0.01, 0.03)], sides=20, steps=1)
    yield _roll(0.0, 0.032, 0.0)
    yield ball("brass", 0.014, (0.0, 0.145, 0.0), 12, 6)


def _paper_cage() -> Iterator[Solid]:
    """Build a wire cage of stacked toilet paper rolls."""
    yield cylinder("wood", 0.085, 0.02, sides=24)
    for a in np.arange(6) * np.pi / 3:
        yield rod(
            "iron", (0.066 * np.cos(a), 0.02, 0.066 * np.sin(a)), (0.066 * np.cos(a), 0.5, 0.066 * np.sin(a)), 0.003
        )
    for y in (0.18, 0.34, 0.5):
        yield ring("iron", 0.066, 0.006, (0.0, y, 0.0), 1, 24)
    for i in range(4):
        yield _roll(0.0, 0.022 + 0.104 * i, 0.0)


def _paper_box() -> Iterator[Solid]:
    """Build an open box on legs with toilet paper rolls inside and one on a side peg."""
    yield from open_case("paint", 0.2, 0.5, 0.16, (0.16, 0.32), (0.0, 0.04, 0.0), (), "paint")
    yield from legs("paint", 0.2, 0.16, 0.04, "square", 0.025)
    for k in range(3):
        yield move(rotate(_roll(0.0, -0.05, 0.0), 0, np.pi / 2), (0.0, 0.116 + 0.16 * k, 0.02))
    yield rounded_box("wood", (0.22, 0.02, 0.18), (0.0, 0.54, 0.0), 0.006, 1)


_PAPER_KINDS = {
    "wall": _paper_holder, "stand": _paper_stand, "basket": _paper_basket, "covered": _paper_covered,
    "shelf": _paper_shelf, "rope": _paper_rope, "double": _paper_double, "spindle": _paper_spindle,
    "cage": _paper_cage, "box": _paper_box,
}  # fmt: skip


def paper(kind: str = "wall") -> Iterator[Solid]:
    """Build toilet paper on a wall holder, on a stand, or in a basket, cage or box."""
    yield from _PAPER_KINDS[kind]()


def soap(kind: str = "pump") -> Iterator[Solid]:
    """Build a soap dispenser: a tall pump bottle, a round foam bottle or a square glass one."""
    if kind == "square":
        yield rounded_box("tint", (0.065, 0.12, 0.065), (0.0, 0.0, 0.0), 0.01, 2)
        yield rounded_box("paper", (0.045, 0.05, 0.002), (0.0, 0.03, 0.0325), 0.0008, 1)
    shape = (
        [(0.034, 0.0), (0.037, 0.01), (0.035, 0.1), (0.014, 0.13)]
        if kind == "pump"
        else [(0.03, 0.0), (0.04, 0.05), (0.03, 0.1), (0.016, 0.12)]
    )
    if kind != "square":
        yield revolve("glaze" if kind == "pump" else "tint", shape, sides=20, steps=2)
    yield cylinder("chrome", 0.017, 0.02, (0.0, 0.12, 0.0), sides=14)
    yield rod("chrome", (0.0, 0.13, 0.0), (0.0, 0.165, 0.0), 0.006)
    yield tube("chrome", fillet([(0.0, 0.165, -0.012), (0.0, 0.17, 0.03), (0.0, 0.16, 0.05)], 0.01), 0.007)


def soap_dish(kind: str = "oval") -> Iterator[Solid]:
    """Build a bar of soap on an oval dish or on a wooden grate, or three small ones in a bowl."""
    if kind == "grate":
        for i in range(5):
            yield rounded_box("wood", (0.012, 0.012, 0.08), (0.022 * (i - 2), 0.008, 0.0), 0.003, 1)
        for z in (-0.025, 0.025):
            yield rounded_box("wood", (0.11, 0.008, 0.012), (0.0, 0.0, z), 0.002, 1)
        yield padded_block("cream", (0.075, 0.03, 0.05), (0.0, 0.019, 0.0), 3.0, 5)
        return
    if kind == "bowl":
        yield vessel("ceramic", [(0.03, 0.0), (0.05, 0.015), (0.06, 0.04)], 0.004, sides=24, steps=2)
        for i, (x, z) in enumerate(((-0.018, 0.0), (0.018, 0.014), (0.006, -0.02))):
            yield padded_block(f"bright_{i}", (0.04, 0.024, 0.03), (x, 0.014 + 0.004 * i, z), 3.0, 5)
        return
    yield vessel("crockery", [(0.035, 0.0), (0.045, 0.008), (0.06, 0.025)], 0.004, sides=26, steps=2, stretch=0.7)
    yield padded_block("bright", (0.075, 0.026, 0.045), (0.0, 0.01, 0.0), 3.0, 5)


FAMILIES = (
    FurnitureFamily("toilet_paper", "toilet_paper", design_kinds(paper, *_PAPER_KINDS)),
    FurnitureFamily("soap_dispenser", "soap_dispenser", design_kinds(soap, "pump", "foam", "square")),
    FurnitureFamily("soap_dish", "soap_dish", design_kinds(soap_dish, "oval", "grate", "bowl")),
)
