"""Garden objects: grills, parasols, pools, letter boxes, basketball hoops."""

from collections.abc import Iterator
from functools import partial

import numpy as np

from home_procgen.primitives.solids import Solid, box, cylinder, rotate
from home_procgen.shapes.revolve import revolve
from home_procgen.shapes.rounded import ball, rounded_box
from home_procgen.shapes.sheets import surface
from home_procgen.shapes.sweep import beam, prism, ring, rod
from home_procgen.things.family import FurnitureFamily, design_kinds
from home_procgen.things.joinery import disc
from home_procgen.things.outdoors.grills import gas_grill, round_grill, stone_grill


def _parasol(kind: str) -> Iterator[Solid]:
    yield revolve("concrete", [(0.26, 0.0), (0.25, 0.08), (0.05, 0.12)], sides=22, steps=1)
    yield rod("wood", (0.0, 0.05, 0.0), (0.0, 2.45, 0.0), 0.022, sides=10)
    count = 8
    for i in range(count):
        a, b = 2 * np.pi * i / count, 2 * np.pi * (i + 1) / count

        def gore(u: np.ndarray, v: np.ndarray, a: float = a, b: float = b) -> tuple[np.ndarray, ...]:
            r = 0.03 + 1.35 * v
            t = a + (b - a) * u
            flat = np.cos((b - a) / 2) / np.cos(t - (a + b) / 2)
            return r * flat * np.cos(t), 2.45 - 0.5 * v**1.3 - 0.05 * v * np.sin(np.pi * u), r * flat * np.sin(t)

        yield surface("textile" if i % 2 or kind == "parasol" else "white", gore, 4, 5, 0.008)
        yield rod(
            "wood",
            (0.03 * np.cos(a), 2.38, 0.03 * np.sin(a)),
            (1.36 * np.cos(a), 1.93, 1.36 * np.sin(a)),
            0.008,
            sides=6,
        )
        yield rod(
            "wood",
            (0.03 * np.cos(a), 1.85, 0.03 * np.sin(a)),
            (0.7 * np.cos(a), 2.15, 0.7 * np.sin(a)),
            0.007,
            sides=6,
        )
    yield ball("wood", 0.035, (0.0, 2.48, 0.0), 12, 8)


def _pool() -> Iterator[Solid]:
    yield revolve("blue", [(1.5, 0.0), (1.56, 0.3), (1.5, 0.62)], sides=44, steps=3)
    yield ring("white", 1.5, 0.12, (0.0, 0.62, 0.0), 1, 44)
    yield cylinder("blue", 1.44, 0.04, (0.0, 0.6, 0.0), sides=44)
    for s in (-1, 1):
        yield rod("chrome", (1.5, 0.0, s * 0.2), (1.45, 1.1, s * 0.2), 0.02)
    for i in range(3):
        yield rounded_box("white", (0.08, 0.02, 0.4), (1.63 - 0.04 * i, 0.2 + 0.25 * i, 0.0), 0.006, 1)


def _letter_box() -> Iterator[Solid]:
    yield beam("wood", (0.0, 0.0, 0.0), (0.0, 1.05, 0.0), 0.09)
    half = [
        (-0.1, 0.0),
        (0.1, 0.0),
        *[(0.1 * np.cos(a), 0.12 + 0.1 * np.sin(a)) for a in np.linspace(0, np.pi, 12)],
    ]
    yield prism("red", half, 0.46, (0.0, 1.04, 0.05))
    yield prism("black", [(0.9 * x, 0.9 * y) for x, y in half], 0.012, (0.0, 1.05, 0.282))
    yield rounded_box("yellow", (0.012, 0.16, 0.05), (0.108, 1.14, 0.0), 0.004, 1)
    yield rounded_box("chrome", (0.05, 0.02, 0.02), (0.0, 1.2, 0.29), 0.006, 1)


def _wall_box() -> Iterator[Solid]:
    yield rounded_box("black", (0.34, 0.3, 0.12), (0.0, 0.0, 0.0), 0.015, 2)
    yield rotate(rounded_box("black", (0.36, 0.02, 0.15), (0.0, 0.29, 0.015), 0.008, 1), 0, 0.15, (0.0, 0.29, 0.0))
    yield box("gray", (0.22, 0.02, 0.006), (0.0, 0.22, 0.061))
    yield disc("brass", 0.012, 0.01, (0.0, 0.1, 0.06), 14)
    yield rounded_box("white", (0.16, 0.06, 0.006), (0.0, 0.14, 0.06), 0.003, 1)


def _hoop() -> Iterator[Solid]:
    yield rounded_box("black", (0.7, 0.14, 0.5), (0.0, 0.0, -0.4), 0.05, 2)
    yield rod("gray", (0.0, 0.12, -0.4), (0.0, 2.3, -0.4), 0.04, sides=12)
    yield beam("gray", (0.0, 2.25, -0.4), (0.0, 2.4, -0.02), 0.05)
    yield rounded_box("white", (1.0, 0.7, 0.03), (0.0, 2.1, 0.0), 0.01, 1)
    for y in (2.2, 2.52):
        yield box("red", (0.44, 0.02, 0.006), (0.0, y, 0.017))
    for s in (-1, 1):
        yield box("red", (0.02, 0.34, 0.006), (s * 0.22, 2.2, 0.017))
    yield ring("orange", 0.225, 0.022, (0.0, 2.2, 0.27), 1, 26)
    for i in range(12):
        a, b = 2 * np.pi * i / 12, 2 * np.pi * (i + 1) / 12
        yield rod(
            "white",
            (0.225 * np.cos(a), 2.2, 0.27 + 0.225 * np.sin(a)),
            (0.13 * np.cos(b), 1.85, 0.27 + 0.13 * np.sin(b)),
            0.004,
            sides=4,
        )
        yield rod(
            "white",
            (0.225 * np.cos(b), 2.2, 0.27 + 0.225 * np.sin(b)),
            (0.13 * np.cos(a), 1.85, 0.27 + 0.13 * np.sin(a)),
            0.004,
            sides=4,
        )


_GARDEN_KINDS = {
    "kettle": round_grill,
    "gas": gas_grill,
    "stone": stone_grill,
    "parasol": partial(_parasol, "parasol"),
    "beach": partial(_parasol, "beach"),
    "pool": _pool,
    "letter": _letter_box,
    "box": _wall_box,
    "hoop": _hoop,
}


def garden(kind: str = "kettle") -> Iterator[Solid]:
    """Build a round, gas or stone grill, a parasol, a pool, a letter box or a basketball hoop."""
    yield from _GARDEN_KINDS[kind]()


FAMILIES = (
    FurnitureFamily("grill", "grill", design_kinds(garden, "kettle", "gas", "stone")),
    FurnitureFamily("parasol", "umbrella", design_kinds(garden, "parasol", "beach")),
    FurnitureFamily("pool", "pool", design_kinds(garden, "pool")),
    FurnitureFamily("mailbox", "mailbox", design_kinds(garden, "letter")),
    FurnitureFamily("wall_mailbox", "mailbox", design_kinds(garden, "box")),
    FurnitureFamily("hoop", "basketball_hoop", design_kinds(garden, "hoop")),
)
