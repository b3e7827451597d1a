"""Pets and fish."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder
from home_procgen.shapes.curves import spline
from home_procgen.shapes.revolve import revolve, vessel
from home_procgen.shapes.rounded import ball, padded_block, rounded_box
from home_procgen.shapes.sheets import leaf
from home_procgen.shapes.sweep import beam, prism, ring, rod, tube
from home_procgen.things.family import FurnitureFamily, design, design_kinds
from home_procgen.things.joinery import corners


def _cat() -> Iterator[Solid]:
    yield revolve("fur_coat", [(0.09, 0.0), (0.1, 0.06), (0.07, 0.17), (0.05, 0.23)], (0.0, 0.0, -0.02), 18, 3)
    yield ball("fur_coat", (0.055, 0.05, 0.055), (0.0, 0.28, 0.02), 16, 10)
    for s in (-1, 1):
        yield revolve("fur_coat", [(0.02, 0.0), (0.002, 0.045)], (s * 0.03, 0.31, 0.01), 8, 1)
        yield tube(
            "fur_coat",
            [(s * 0.03, 0.16, 0.04), (s * 0.032, 0.02, 0.07), (s * 0.032, 0.015, 0.1)],
            [0.024, 0.018, 0.018],
            8,
        )
        yield ball("green", 0.009, (s * 0.022, 0.29, 0.066), 8, 6)
    yield ball("red", 0.007, (0.0, 0.272, 0.075), 8, 4)
    yield tube(
        "fur_coat",
        spline([(0.05, 0.02, -0.08), (0.14, 0.02, -0.06), (0.15, 0.03, 0.06)], 5),
        np.linspace(0.018, 0.01, 11),
        8,
    )


def _dog() -> Iterator[Solid]:
    yield tube(
        "fur_coat",
        [(0.0, 0.33, -0.24), (0.0, 0.34, -0.18), (0.0, 0.34, 0.14), (0.0, 0.36, 0.22)],
        [0.06, 0.095, 0.1, 0.08],
        14,
    )
    for x in (-0.055, 0.055):
        for z in (-0.19, 0.15):
            yield tube(
                "fur_coat",
                [(x, 0.3, z), (x, 0.12, z - 0.01), (x, 0.02, z), (x, 0.015, z + 0.035)],
                [0.045, 0.026, 0.024, 0.024],
                8,
            )
    yield tube("fur_coat", [(0.0, 0.38, 0.2), (0.0, 0.48, 0.28)], [0.065, 0.055], 12)
    yield ball("fur_coat", (0.065, 0.062, 0.075), (0.0, 0.5, 0.3), 16, 10)
    yield tube("fur_coat", [(0.0, 0.485, 0.34), (0.0, 0.47, 0.42)], [0.042, 0.03], 12)
    yield ball("black", 0.016, (0.0, 0.485, 0.445), 10, 6)
    for s in (-1, 1):
        yield ball("fur_coat", (0.014, 0.06, 0.032), (s * 0.068, 0.49, 0.28), 12, 8)
        yield ball("black", 0.009, (s * 0.03, 0.525, 0.362), 8, 6)
    yield tube(
        "fur_coat",
        spline([(0.0, 0.37, -0.24), (0.0, 0.48, -0.34), (0.0, 0.56, -0.33)], 4),
        np.linspace(0.024, 0.01, 9),
        8,
    )
    yield ring("red", 0.062, 0.014, (0.0, 0.435, 0.245), 1, 18)


def _dog_basket() -> Iterator[Solid]:
    yield vessel("cane", [(0.28, 0.0), (0.33, 0.06), (0.35, 0.16)], 0.03, sides=30, steps=2, stretch=0.8)
    yield padded_block("textile", (0.56, 0.1, 0.44), (0.0, 0.03, 0.0), 2.5, 6)
    curl = [(0.16 * np.cos(a), 0.15, 0.12 * np.sin(a)) for a in np.linspace(0.6, 5.2, 12)]
    yield tube("fur_coat", curl, np.concatenate([np.linspace(0.03, 0.075, 8), [0.07, 0.06, 0.05, 0.03]]), 10)
    yield ball("fur_coat", (0.06, 0.05, 0.065), (0.13, 0.17, 0.06), 14, 8)
    for s in (-1, 1):
        yield ball("fur_coat", (0.02, 0.04, 0.03), (0.13 + 0.05 * s, 0.18, 0.05), 10, 6)


def _cage() -> Iterator[Solid]:
    yield cylinder("gold", 0.17, 0.03, sides=26)
    for i in range(22):
        a = 2 * np.pi * i / 22
        c, s = 0.16 * np.cos(a), 0.16 * np.sin(a)
        yield tube("gold", [(c, 0.02, s), (c, 0.3, s), (0.6 * c, 0.4, 0.6 * s), (0.0, 0.44, 0.0)], 0.003, 4)
    yield ring("gold", 0.16, 0.008, (0.0, 0.3, 0.0), 1, 24)
    yield rod("wood", (-0.15, 0.16, 0.0), (0.15, 0.16, 0.0), 0.006, sides=6)
    yield ball("yellow", (0.026, 0.032, 0.042), (0.02, 0.2, 0.0), 12, 8)
    yield ball("yellow", 0.022, (0.02, 0.238, 0.02), 12, 8)
    yield ring("gold", 0.02, 0.006, (0.0, 0.46, 0.0), 2, 14)


_PET_KINDS = {
    "cat": _cat,
    "dog": _dog,
    "basket": _dog_basket,
    "cage": _cage,
}


def pet(kind: str = "cat") -> Iterator[Solid]:
    """Build a sitting cat, a standing dog, a dog in its basket or a bird cage."""
    yield from _PET_KINDS[kind]()


def _one(x: float, y: float, z: float, slot: str, size: float = 1.0) -> Iterator[Solid]:
    yield ball(slot, (0.035 * size, 0.018 * size, 0.01 * size), (x, y, z), 12, 8)
    yield prism(
        slot,
        [(x - 0.03 * size, y), (x - 0.06 * size, y + 0.02 * size), (x - 0.06 * size, y - 0.02 * size)],
        0.003,
        (0.0, 0.0, z),
    )


def fish(kind: str = "tank") -> Iterator[Solid]:
    """Build a fish tank on a cabinet, or a bowl with a goldfish."""
    if kind == "bowl":
        yield vessel("glass", [(0.08, 0.0), (0.14, 0.08), (0.13, 0.16), (0.09, 0.2)], 0.003, sides=26, steps=3)
        yield revolve("water", [(0.08, 0.006), (0.134, 0.08), (0.128, 0.15)], sides=24, steps=2)
        yield revolve("cream", [(0.075, 0.006), (0.09, 0.02), (0.05, 0.03)], sides=20, steps=2)
        yield from _one(0.02, 0.09, 0.0, "orange", 1.2)
        for i in range(4):
            yield leaf("leaf", 0.1, 0.012, (-0.04, 0.02, 0.02), 1.6 * i, 1.4, 0.4, pieces=3)
        return
    yield rounded_box("wood", (1.0, 0.7, 0.4), (0.0, 0.02, 0.0), 0.006, 1)
    for i in range(2):
        yield rounded_box("wood_1", (0.48, 0.62, 0.02), ((i - 0.5) * 0.5, 0.06, 0.205), 0.004, 1)
        yield ball("chrome", 0.012, ((i - 0.5) * 0.1, 0.4, 0.225), 10, 6)
    yield box("cream", (0.96, 0.05, 0.36), (0.0, 0.725, 0.0))
    yield box("water", (0.95, 0.36, 0.35), (0.0, 0.776, 0.0))
    for s in (-1, 1):
        yield box("glass", (0.98, 0.46, 0.008), (0.0, 0.72, s * 0.186))
        yield box("glass", (0.008, 0.46, 0.364), (s * 0.486, 0.72, 0.0))
    yield rounded_box("black", (1.0, 0.05, 0.4), (0.0, 1.18, 0.0), 0.01, 1)
    for i in range(5):
        yield from _one(-0.3 + 0.15 * i, 0.86 + 0.06 * (i % 3), 0.08 * (-1) ** i, ("orange", "yellow", "blue")[i % 3])
    for k, x in enumerate((-0.36, -0.1, 0.3)):
        for i in range(5):
            yield leaf("leaf", 0.26, 0.02, (x, 0.77, -0.08), 1.3 * i + k, 1.45, 0.3, pieces=3)
    yield ball("gray", (0.09, 0.06, 0.07), (0.14, 0.79, -0.06), 12, 8)


def small_tank(wide: float = 0.36, lid: bool = False) -> Iterator[Solid]:
    """Build a small glass tank for a table, with a lamp on its lid or open."""
    yield box("black", (wide, 0.012, 0.2))
    yield box("cream", (wide - 0.016, 0.025, 0.184), (0.0, 0.013, 0.0))
    yield box("water", (wide - 0.018, 0.15, 0.182), (0.0, 0.039, 0.0))
    for s in (-1, 1):
        yield box("glass", (wide, 0.22, 0.005), (0.0, 0.012, s * 0.0975))
        yield box("glass", (0.005, 0.22, 0.188), (s * (wide / 2 - 0.0025), 0.012, 0.0))
    for i in range(3):
        yield from _one(
            -0.08 + 0.08 * i, 0.09 + 0.025 * (i % 2), 0.03 * (-1) ** i, ("orange", "yellow", "blue")[i], 0.6
        )
    for i in range(6):
        yield leaf("leaf", 0.12, 0.012, (0.3 * wide * (-1) ** i, 0.04, -0.05), 1.1 * i, 1.4, 0.4, pieces=3)
    if lid:
        yield rounded_box("black", (wide + 0.01, 0.03, 0.21), (0.0, 0.233, 0.0), 0.008, 1)


def tank_on_frame(tall: bool = False) -> Iterator[Solid]:
    """Build a fish tank on an iron frame, long or tall."""
    size = 0.62 if tall else 1.0
    for piece in small_tank(0.36 if tall else 0.5, True):
        yield replace(piece, vertices=piece.vertices * (1.6, 2.4 if tall else 1.9, 1.8) + (0.0, 0.7, 0.0))
    for x, z in corners(size - 0.2, 0.3):
        yield beam("iron", (x, 0.0, z), (x, 0.68, z), 0.03)
    for y in (0.14, 0.66):
        yield rounded_box("wood", (size - 0.14, 0.035, 0.36), (0.0, y, 0.0), 0.006, 1)


FAMILIES = (
    FurnitureFamily("pet", "pet", design_kinds(pet, "cat", "dog", "basket")),
    FurnitureFamily("bird_cage", "pet", design_kinds(pet, "cage")),
    FurnitureFamily(
        "fish_tank", "fish_tank", (*design_kinds(fish, "tank"), design(tank_on_frame), design(tank_on_frame, tall=True))
    ),
    FurnitureFamily(
        "fishbowl",
        "fishbowl",
        (*design_kinds(fish, "bowl"), design(small_tank), design(small_tank, wide=0.28, lid=True)),
    ),
)
